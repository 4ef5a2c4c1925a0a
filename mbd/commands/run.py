"""Runs a scene and says where it went, how well the joints closed and the energy balances, and what it took."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import Interrupted, SimulationError
from .scenes import end_of, job_of, run_arguments, scene_arguments

if TYPE_CHECKING:
    from ..job import Job
    from ..result import Result

HELP = "run a scene; --out run.npz, --plot run.png and --report run.html keep the result"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)
    run_arguments(parser)
    parser.add_argument("--out", type=Path, metavar="FILE", help="the result (.npz), for mbd.load")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="a picture: shapes over time, and the paths of the outputs (.png, .pdf, .svg)")
    parser.add_argument("--report", type=Path, metavar="FILE", help="a page with animation and plots (.html)")
    parser.add_argument("--progress", action=argparse.BooleanOptionalAction, help="a bar with simulated time; default: on a terminal")


def run(options: argparse.Namespace) -> int:
    from ..run import simulate

    job = job_of(options)
    more: dict[str, Any] = {} if job.rtol is None else {"rtol": job.rtol}
    try:
        result = simulate(job.scene, end_of(job), solver=job.solver, progress=_shows_progress(options.progress), **more)
    except (Interrupted, SimulationError) as error:
        if error.result is not None and len(error.result.t) > 1:
            _keep(error.result, job, options)
        raise
    _keep(result, job, options)
    return 0


def _shows_progress(wanted: bool | None) -> bool:
    """Asked for, or possible on this terminal."""
    if wanted is None:
        from importlib.util import find_spec

        return sys.stderr.isatty() and find_spec("tqdm") is not None
    return wanted


def _keep(result: Result, job: Job, options: argparse.Namespace) -> None:
    """Says what a run gave, and writes what is asked for."""
    print(summary(result, job))
    if options.out:
        result.save(options.out)
    if options.plot:
        _picture(result, job, options.plot)
    if options.report:
        result.report(options.report, outputs=job.outputs or None)
    for path in filter(None, (options.out, options.plot, options.report)):
        print(f"written: {path}")


def summary(result: Result, job: Job) -> str:
    """Where the outputs are at the end, the audit and the statistics."""
    width = max(map(len, job.outputs), default=0)
    places = [f"{name:<{width}}  {numbers(result.position(marker)[-1])} m" for name, marker in job.outputs.items()]
    stats = ", ".join(f"{name} {_short(result.stats[name])}" for name in ("solver", "rtol", "steps", "rejected", "wall time") if name in result.stats)
    return "\n".join([f"t = {result.t[-1]:g} s", *places, str(result.audit), f"{stats} s"])


def _short(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def numbers(values: Any) -> str:
    """Numbers beside each other, aligned; rounding beside larger ones is 0."""
    least = 1e-12 * max(map(abs, values))
    return "  ".join(f"{value if abs(value) > least else 0.0: .6g}".ljust(12) for value in values).rstrip()


def _picture(result: Result, job: Job, path: Path) -> None:
    from ..plot import plot_path

    axes = result.plot()
    for k, (name, marker) in enumerate(job.outputs.items()):
        plot_path(result, marker, axes, label=name, color=f"C{k + 1}", linewidth=0.8)
    if job.outputs:
        axes.legend(loc="best")
    axes.figure.savefig(path, dpi=150)
