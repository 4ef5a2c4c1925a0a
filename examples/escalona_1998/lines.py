"""What every part of this example returns: lines of the table, a number beside what it should be."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

REFERENCE = json.loads((Path(__file__).parent / "reference.json").read_text(encoding="utf-8"))


class Line(NamedTuple):
    """A quantity: as the paper prints it, the reference (a number of its own or the largest of many), mbd's, their difference and its limit."""

    what: str
    paper: str
    reference: str
    found: str
    difference: float
    limit: float

    def __str__(self) -> str:
        verdict = "" if self.difference <= self.limit else "  TOO FAR"
        return f"{self.what:<58} {self.paper:>12} {self.reference:>24} {self.found:>24} {self.difference:9.1e} {self.limit:9.1e}{verdict}"


HEAD = f"{'':<58} {'paper':>12} {'reference':>24} {'mbd':>24} {'differ by':>9} {'allowed':>9}"


def number(what: str, paper: str, reference: float, found: float, limit: float) -> Line:
    return Line(what, paper, f"{reference:.9g}", f"{found:.9g}", abs(found - reference), limit)


def series(what: str, paper: str, reference: np.ndarray, found: np.ndarray, limit: float) -> Line:
    """Many values: the largest difference counts, the last values are shown."""
    last = [" ".join(f"{x:.8f}" for x in np.atleast_1d(values[-1])) for values in (np.asarray(reference), np.asarray(found))]
    return Line(what, paper, *last, float(np.max(np.abs(np.asarray(found) - reference))), limit)


def bound(what: str, paper: str, expected: str, found: float, limit: float) -> Line:
    """A number that is to stay below its limit."""
    return Line(what, paper, expected, f"{found:.3g}", found, limit)
