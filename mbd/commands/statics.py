"""Finds the equilibrium of a scene under its loads: where the outputs come to rest, and whether they stay there."""

from __future__ import annotations

import argparse
from typing import Any

from .run import numbers
from .scenes import job_of, scene_arguments

HELP = "the equilibrium under all loads: positions, reactions, stability"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)
    parser.add_argument("--load-steps", type=int, default=1, metavar="N", help="at least so many increments of the loads (default 1)")


def run(options: argparse.Namespace) -> int:
    from ..statics import equilibrium

    job = job_of(options)
    rest = equilibrium(job.scene, load_steps=options.load_steps)
    print(f"equilibrium: {rest.kind}, in {rest.stats.get('iterations', 0)} iterations")
    rows = [(name, numbers(rest.position(marker)), "m") for name, marker in job.outputs.items()]
    rows += [(f"reaction at {name!r}", *reaction) for name in _joints(job.scene) if (reaction := _reaction(rest, name))]
    width = max((len(row[0]) for row in rows), default=0)
    print("\n".join(f"{name:<{width}}  {told} {unit}" for name, told, unit in rows))
    print(f"elastic energy {rest.elastic_energy:.6g} J, potential energy {rest.potential_energy:.6g} J")
    return 0


def _joints(scene: Any) -> list[str]:
    from ..joints.placed import PlacedJoint

    return [item.name for item in scene.items if isinstance(item, PlacedJoint)]


def _reaction(rest: Any, name: str) -> tuple[str, str]:
    values = rest.reaction(rest.scene[name])
    return numbers(values), "N, N m"
