"""The best of a program at every error: its front of work and precision, interpolated in logarithms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from .work import Row

ERRORS = tuple(10.0**-k for k in range(2, 11))


class Cost(NamedTuple):
    """The time [s] of a program at an error, and the setting that comes next to it on the front."""

    seconds: float
    by: str


class Front:
    """Rows that no other row beats in both time and error, from fast and coarse to slow and accurate."""

    def __init__(self, rows: Iterable[Row]):
        self.rows: list[Row] = []
        for row in sorted((row for row in rows if np.isfinite(row.error)), key=lambda row: row.time):
            if not self.rows or row.error < self.rows[-1].error:
                self.rows.append(row)

    def at(self, error: float) -> Cost | None:
        """The cheapest run as accurate as that, between two runs by log-log interpolation; None where the program cannot reach it."""
        for k, row in enumerate(self.rows):
            if row.error <= error:
                return Cost(row.time if k == 0 else _between(self.rows[k - 1], row, error), f"{row.method}, {row.rung.setting}")
        return None

    @property
    def best(self) -> float:
        """The smallest error reached."""
        return self.rows[-1].error if self.rows else np.inf


def _between(coarse: Row, fine: Row, error: float) -> float:
    x = np.log([coarse.error, fine.error + 1e-300])
    share = (x[0] - np.log(error)) / (x[0] - x[1])
    return float(np.exp((1.0 - share) * np.log(coarse.time) + share * np.log(fine.time)))


def fronts(rows: Sequence[Row]) -> dict[str, Front]:
    """By program, in order of appearance."""
    return {program: Front(row for row in rows if row.program == program) for program in dict.fromkeys(row.program for row in rows)}
