"""Runs a scene with estimates of the error in each output."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..errors import SceneError
from .scenes import end_of, job_of, run_arguments, scene_arguments

HELP = "run a scene with an estimated error for each output"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)
    run_arguments(parser)
    parser.add_argument("--report", type=Path, metavar="FILE", help="a page with animation, plots and the estimates (.html)")


def run(options: argparse.Namespace) -> int:
    """1 where an output's error cannot be estimated over the whole run."""
    from ..verification.verification import verify

    job = job_of(options)
    if not job.outputs:
        raise SceneError(["outputs: expected what to verify, found none; name markers under [simulate] outputs in the scene file"])
    more: dict[str, Any] = {name: value for name in ("rtol", "solver") if (value := getattr(job, name)) is not None}
    found = verify(job.scene, end_of(job), outputs=job.outputs, **more)
    print(found)
    if options.report:
        found.result.report(options.report, outputs=job.outputs, verification=found)
        print(f"written: {options.report}")
    return 0 if found.ok else 1
