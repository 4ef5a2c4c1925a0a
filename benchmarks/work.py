"""Sweeps of runs: ladders of ever finer runs, taken in turn, repeated, medians of the times."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

FINEST = 16
"""Rungs of a ladder of steps: each has twice as many steps as the one before."""
FAILURES = 8
"""A ladder ends after so many failed runs in a row: coarse steps may fail where finer ones succeed."""


class Sample(NamedTuple):
    """One run: solve time [s], the output [d] [m] or None where it failed, what it counted, what to note, and, where it was audited, the
    error of its energy balance over the energy exchanged."""

    seconds: float
    value: np.ndarray | None
    counts: dict[str, int] = {}  # noqa: RUF012
    note: str = ""
    energy: float | None = None


class Rung(NamedTuple):
    """A setting and how to run it."""

    setting: str
    run: Callable[[], Sample]
    rtol: float | None = None


@dataclass
class Ladder:
    """A method of a program, and its settings from loose to tight."""

    program: str
    method: str
    rungs: Iterator[Rung]
    rows: list[Row] = field(default_factory=list)


@dataclass
class Row:
    """A setting with its measured times [s] and its error as a share of the scene's scale, infinite where it failed."""

    program: str
    method: str
    rung: Rung
    error: float
    sample: Sample
    seconds: list[float]

    @property
    def time(self) -> float:
        return statistics.median(self.seconds)


def sweep(ladders: list[Ladder], error: Callable[[str, np.ndarray], float], repeats: int, budget: float) -> list[Row]:
    """All ladders rung by rung, in turn between the programs. A ladder ends where a run takes longer than the budget [s], or fails too
    often. Runs that may be on their program's front are then repeated, in the same turn."""
    active = list(ladders)
    while active:
        active = [ladder for ladder in active if _climb(ladder, error, budget)]
    longest = max((len(ladder.rows) for ladder in ladders), default=0)
    for _ in range(repeats - 1):
        for k in range(longest):
            for ladder in ladders:
                if k < len(ladder.rows) and _matters(ladder.rows[k], ladders):
                    ladder.rows[k].seconds.append(ladder.rows[k].rung.run().seconds)
    return [row for ladder in ladders for row in ladder.rows]


def _matters(row: Row, ladders: list[Ladder]) -> bool:
    """Whether no run of the same program was as accurate in half the time: other runs decide nothing, and are not repeated."""
    rivals = (other for ladder in ladders if ladder.program == row.program for other in ladder.rows)
    return bool(np.isfinite(row.error)) and not any(other.error <= row.error and 2.0 * other.seconds[0] < row.seconds[0] for other in rivals)


def _climb(ladder: Ladder, error: Callable[[str, np.ndarray], float], budget: float) -> bool:
    """Runs the next rung; False where the ladder ends."""
    rung = next(ladder.rungs, None)
    if rung is None:
        return False
    sample = rung.run()
    size = np.inf if sample.value is None else error(ladder.program, sample.value)
    ladder.rows.append(Row(ladder.program, ladder.method, rung, size, sample, [sample.seconds]))
    failing = len(ladder.rows) >= FAILURES and not any(np.isfinite(row.error) for row in ladder.rows[-FAILURES:])
    return sample.seconds <= budget and not failing
