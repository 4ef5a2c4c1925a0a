"""Frequencies of a scene's slowest modes about where it is described, or about its equilibrium."""

from __future__ import annotations

import argparse

from .scenes import job_of, scene_arguments

HELP = "frequencies and damping of the slowest modes"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)
    parser.add_argument("-n", type=int, default=6, metavar="N", help="how many (default 6)")
    parser.add_argument("--about", choices=("start", "equilibrium"), default="start", help="where it is described (default), or its equilibrium")


def run(options: argparse.Namespace) -> int:
    from ..statics import equilibrium
    from ..vibration import modes

    scene = job_of(options).scene
    found = modes(scene, options.n, equilibrium(scene) if options.about == "equilibrium" else None)
    print(f"{'mode':>4}  {'f [Hz]':>12}  {'omega [rad/s]':>13}  {'damping ratio':>13}")
    for k, (hertz, omega, ratio) in enumerate(zip(found.hertz, found.frequencies, found.damping_ratios)):
        print(f"{k + 1:>4}  {hertz:>12.6g}  {omega:>13.6g}  {ratio + 0.0:>13.4g}{_said(found, k)}")
    return 0


def _said(found: object, k: int) -> str:
    unstable, rigid = found.unstable, found.rigid  # type: ignore[attr-defined]
    return "  unstable" if k < unstable else "  rigid" if k < unstable + rigid else ""
