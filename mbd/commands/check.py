"""Checks how a scene can move before it runs: degrees of freedom, loops, joints that hold something twice, singular positions."""

from __future__ import annotations

import argparse

from .scenes import job_of, scene_arguments

HELP = "degrees of freedom, loops, redundant joints and singular positions, in words"


def arguments(parser: argparse.ArgumentParser) -> None:
    scene_arguments(parser)


def run(options: argparse.Namespace) -> int:
    """1 where something should be changed: joints hold something twice, a coordinate is held by nothing, or it cannot be assembled."""
    from ..structure import check

    found = check(job_of(options).scene)
    print(found)
    return 1 if found.redundant or found.unheld or found.complaints else 0
