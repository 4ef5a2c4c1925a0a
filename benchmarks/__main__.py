"""``python -m benchmarks [--scene NAME ...] [--quick] [--repeats 3]``: run time against error, mbd and Exudyn in turn."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from . import mbd_runs, report, tables
from .checks import disagreement
from .fronts import Front, fronts
from .scenes import BY_NAME, CASES, Case
from .work import Ladder, Row, sweep


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--scene", nargs="+", default=list(BY_NAME), choices=list(BY_NAME), metavar="NAME", help=", ".join(BY_NAME))
    parser.add_argument("--repeats", type=int, default=3, help="runs of each setting; the median counts")
    parser.add_argument("--budget", type=float, default=5.0, help="a sweep of tolerances or steps ends with the first run that takes longer [s]")
    parser.add_argument("--quick", action="store_true", help="one repeat, a budget of 0.3 s, nothing written unless --out is given")
    parser.add_argument("--out", type=Path, help=f"folder for pages and plots; default {report.OUT}")
    found = parser.parse_args(given)
    if found.quick:
        found.repeats, found.budget = 1, 0.3
    elif found.out is None:
        found.out = report.OUT
    return found


def peers(case: Case) -> list[Ladder]:
    """Exudyn's ladders; none, with a warning, where it is not installed."""
    try:
        from . import exudyn_runs
    except ImportError:
        warnings.warn('Exudyn is missing: python -m pip install ".[bench]"', stacklevel=2)
        return []
    return exudyn_runs.ladders(case)


def in_turn(own: list[Ladder], other: list[Ladder]) -> list[Ladder]:
    """One of each, alternately."""
    longest = max(len(own), len(other))
    return [ladder for k in range(longest) for ladder in (*own[k : k + 1], *other[k : k + 1])]


def measure(case: Case, repeats: int, budget: float) -> tuple[list[Row], dict[str, Front], list[str]]:
    """All runs of a scene, the fronts of the programs that solve it, and why others were left out."""

    def error(program: str, value: np.ndarray) -> float:
        return case.error(program.split()[0], value)

    rows = sweep(in_turn(mbd_runs.ladders(case), peers(case)), error, repeats, case.patience * budget)
    rows.sort(key=lambda row: (row.program, row.method))
    best = fronts(sorted(rows, key=lambda row: row.program != "mbd"))
    excluded = [f"{program}: {why}" for program, front in best.items() if (why := disagreement(case, program.split()[0], front))]
    left = {text.split(":")[0] for text in excluded} - {"mbd"}
    return rows, {program: front for program, front in best.items() if program not in left}, excluded


def main() -> None:
    options = arguments()
    where = report.machine()
    print(where, flush=True)
    for case in (case for case in CASES if case.name in options.scene):
        rows, best, excluded = measure(case, options.repeats, options.budget)
        length = case.build()[0].build().length
        text = report.page(case, rows, best, excluded, length, options, where)
        print(f"\n{text}", flush=True)
        if options.out:
            from .plots import plot

            report.write(options.out, case, text, report.record(case, rows, best, excluded, where))
            plot(options.out / f"{case.key}.png", case.name, rows)
    if options.out:
        print(tables.table(["written to"], [[str(options.out)]]))


if __name__ == "__main__":
    main()
