"""How long the next step is: by the estimated error, by its trend, and by what Newton's iteration contracted or could not take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .protocol import Attempt

SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0
CONTRACTION = 0.25
"""Newton's rate that steps aim at. Where tolerances are loose it is what limits them, and it grows with about their fourth power."""

CORRECTIONS = 4
"""Steps grow while Newton's iteration takes fewer, whatever the rate: that of two or three corrections tells more of rounding than of the step."""

BELOW_FAILURE, RELAX = 0.7, 1.1
"""After a failed iteration steps stay below this share of the failed one; the limit relaxes by this factor with each easy step."""


SHORTEST_TICKS = 4.0
"""The shortest step, in units of rounding of the time."""

COARSE = 1e-6
"""Of a run, as a share, the shortest step that the clock allows where it is to blame for a failure."""


class Rhythm(NamedTuple):
    """What the next steps depend on: where the run began (of fixed steps: their grid), the length planned, the limit after a failure, and
    length and error of the last step, where they say something."""

    start: float
    h: float
    ceiling: float = np.inf
    last: tuple[float, float] | None = None


class Pace:
    """The step sizes of one run: adaptive from a first step, or ``fixed`` on a grid to which it returns after a division.

    Steps land on every one of the ``stops``, ascending times ahead; the last is the end. ``free`` until the end bends a step: so far
    the run is the same as one that ends later.
    """

    def __init__(self, rhythm: Rhythm, stops: Sequence[float], fixed: float | None):
        self.start, self.h, self._ceiling, self._last = rhythm
        self.t_end, self.fixed, self.free = stops[-1], fixed, True
        self._stops = list(stops)

    @property
    def rhythm(self) -> Rhythm:
        """What a run that goes on from here is given."""
        return Rhythm(self.start, self.h, self._ceiling, self._last)

    def offer(self, t: float) -> tuple[float, float | None]:
        """The step to try at t, and the stop that it lands on, if any: without a tiny last step."""
        remaining = self._stops[0] - t
        lands, nears = self.h >= remaining * (1.0 - 1e-10), self.fixed is None and self.h > 0.55 * remaining
        self.free = self.free and not ((lands or nears) and len(self._stops) == 1)
        if lands:
            return remaining, self._stops[0]
        return self._on_clock(t, 0.5 * remaining if nears else self.h), None

    def _on_clock(self, t: float, h: float) -> float:
        """The step that t + h is away as a number: late in a run h is far finer than the clock."""
        return max((t + h) - t, float(np.spacing(t))) if self.fixed is None else h

    def accepted(self, t: float, h: float, attempt: Attempt) -> None:
        """After a step of length h that ended at t."""
        stopped = t == self._stops[0]
        if stopped:
            self._stops.pop(0)
        if self.fixed is not None:
            done = (t - self.start) / self.fixed
            whole = round(done) if abs(done - round(done)) < 1e-6 else np.floor(done)
            self.h = self.start + (whole + 1) * self.fixed - t
            return
        self._ceiling *= RELAX if attempt.rate < CONTRACTION else 1.0
        longer = h * self._growth(h, attempt)
        if stopped:  # where the step was cut short it says nothing against the length planned, and nothing of the error after a jump
            longer, self._last = max(longer, self.h), None
        self.h = min(longer, self._ceiling)

    def refused(self, h: float, attempt: Attempt) -> None:
        """After an iteration that did not converge, or a step whose error was above the tolerance."""
        if attempt.state is None:
            self.h, self._ceiling = 0.5 * h, BELOW_FAILURE * h
        else:
            self.h = h * max(SHRINK, SAFETY * attempt.error ** (-1.0 / attempt.order))

    def late(self, t: float) -> bool:
        """Whether the clock, which rounds t, is what keeps steps from becoming shorter, long before they are short for the run."""
        return SHORTEST_TICKS * float(np.spacing(max(abs(t), abs(self.t_end)))) > COARSE * (self.t_end - self.start)

    def exhausted(self, t: float) -> bool:
        """Whether the step is too short to go on."""
        return self.h < 1e-12 * (self.t_end - self.start) or self.h < SHORTEST_TICKS * np.spacing(max(abs(t), abs(self.t_end)))

    def _growth(self, h: float, attempt: Attempt) -> float:
        """The factor by the error, its trend (Gustafsson 1994, ACM Trans. Math. Softw. 20), and the contraction."""
        error = max(attempt.error, 1e-8)
        factor = SAFETY * error ** (-1.0 / attempt.order)
        if self._last is not None:
            last_h, last_error = self._last
            factor = min(factor, SAFETY * (h / last_h) * (last_error / error**2) ** (1.0 / attempt.order))
        self._last = (h, error)
        by_contraction = (CONTRACTION / max(attempt.rate, 1e-4)) ** 0.25
        by_contraction = max(by_contraction, CORRECTIONS / max(attempt.solves, 1))
        return min(max(factor, SHRINK), max(by_contraction, 0.5), GROW)
