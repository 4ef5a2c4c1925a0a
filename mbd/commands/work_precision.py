"""Compares solvers on a scene: run time against the error of an output."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..errors import SceneError
from .scenes import end_of, job_of, listed, number, scene_arguments, solver

HELP = "run time against error, solver by solver"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)
    parser.add_argument("--t-end", type=number, metavar="T", help="end of the run [s]; default: what the scene file says")
    parser.add_argument("--output", metavar="NAME", help="the output whose error counts; default: the first of the scene file")
    parser.add_argument("--solvers", type=listed(solver), metavar="A,B", help="such as 'Radau(stages=3),Radau(stages=7)'; default: mbd's choice")
    parser.add_argument("--rtols", type=listed(number), metavar="R,S", help="such as 1e-3,1e-6; default: 1e-3 to 1e-9")
    parser.add_argument("--repeats", type=int, default=1, metavar="N", help="runs of each setting; the median counts")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="a picture of the curves")


def run(options: argparse.Namespace) -> int:
    from ..precision import work_precision

    job = job_of(options)
    more = {name: given for name in ("solvers", "rtols") if (given := getattr(options, name)) is not None}
    try:
        found = work_precision(job.scene, end_of(job), output=_output(job.outputs, options.output), repeats=options.repeats, **more)
    except SceneError:
        raise
    except ValueError as error:
        raise SceneError(str(error).splitlines()) from error
    print(found)
    if options.plot:
        found.plot().figure.savefig(options.plot, dpi=150)
        print(f"written: {options.plot}")
    return 0


def _output(outputs: dict[str, Any], name: str | None) -> Any:
    if not outputs or (name is not None and name not in outputs):
        found = f"{name!r}, there are {', '.join(map(repr, outputs)) or 'none'}" if name else "none"
        raise SceneError([f"output: expected one of the outputs under [simulate] in the scene file, found {found}"])
    return next(iter(outputs.values())) if name is None else outputs[name]
