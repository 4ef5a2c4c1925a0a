"""How long the next step is: by the estimated error, by its trend, and by what Newton's iteration contracted or could not take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .protocol import Attempt

SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0
CONTRACTION = 0.25
"""Newton's rate that steps aim at. Where tolerances are loose it is what limits them, and it grows with about their fourth power."""

BELOW_FAILURE, RELAX = 0.7, 1.1
"""After a failed iteration steps stay below this share of the failed one; the limit relaxes by this factor with each easy step."""


class Pace:
    """The step sizes of one run: adaptive from a first step, or ``fixed`` on a grid to which it returns after a division.

    Steps land on every one of the ``stops``, ascending times after the start; the last is the end.
    """

    def __init__(self, t: float, stops: Sequence[float], first: float, fixed: float | None):
        self.start, self.t_end, self.fixed = t, stops[-1], fixed
        self.h = fixed or min(first, self.t_end - t)
        self._stops = list(stops)
        self._ceiling = np.inf
        self._last: tuple[float, float] | None = None

    def offer(self, t: float) -> tuple[float, float | None]:
        """The step to try at t, and the stop that it lands on, if any: without a tiny last step."""
        remaining = self._stops[0] - t
        if self.h >= remaining * (1.0 - 1e-10):
            return remaining, self._stops[0]
        if self.fixed is None and self.h > 0.55 * remaining:
            return self._on_clock(t, 0.5 * remaining), None
        return self._on_clock(t, self.h), None

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

    def exhausted(self, t: float) -> bool:
        """Whether the step is too short to go on."""
        return self.h < 1e-12 * (self.t_end - self.start) or self.h < 4.0 * np.spacing(max(abs(t), abs(self.t_end)))

    def _growth(self, h: float, attempt: Attempt) -> float:
        """The factor by the error, its trend (Gustafsson 1994, ACM Trans. Math. Softw. 20), and the contraction."""
        error = max(attempt.error, 1e-8)
        factor = SAFETY * error ** (-1.0 / attempt.order)
        if self._last is not None:
            last_h, last_error = self._last
            factor = min(factor, SAFETY * (h / last_h) * (last_error / error**2) ** (1.0 / attempt.order))
        self._last = (h, error)
        by_contraction = (CONTRACTION / max(attempt.rate, 1e-4)) ** 0.25
        return min(max(factor, SHRINK), max(by_contraction, 0.5), GROW)
