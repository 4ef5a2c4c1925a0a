"""Waves and ramps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..fields import Number, Vector
from .function import AsData, scaled


@dataclass(frozen=True)
class Sine(AsData):
    """offset + amplitude sin(2 pi frequency t + phase).

    amplitude   a number, or numbers [d]
    frequency   [Hz]
    phase       [rad]
    offset      as the amplitude
    """

    amplitude: Number | Vector
    frequency: Number
    phase: Number = 0.0
    offset: Number | Vector = 0.0

    def __post_init__(self) -> None:
        for name in ("amplitude", "offset"):
            self._numbers(name)
        for name in ("frequency", "phase"):
            self._number(name)

    def __call__(self, t: float) -> Any:
        return scaled(math.sin(self._angle(t)), self.amplitude, self.offset)

    def rate(self, t: float) -> Any:
        return scaled(math.tau * self.frequency * math.cos(self._angle(t)), self.amplitude)

    def acceleration(self, t: float) -> Any:
        return scaled(-((math.tau * self.frequency) ** 2) * math.sin(self._angle(t)), self.amplitude)

    def _angle(self, t: float) -> float:
        return math.tau * self.frequency * t + self.phase


@dataclass(frozen=True)
class Ramp(AsData):
    """From one value to another along a straight line: ``before`` until ``start``, ``after`` from ``end``.

    start, end      [s]
    before, after   numbers, or numbers [d]

    Its rate jumps at both times, so as a motion of a drive it asks for infinite accelerations: see ``SmoothStep``.
    """

    start: Number
    end: Number
    before: Number | Vector = 0.0
    after: Number | Vector = 1.0

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            self._number(name)
        for name in ("before", "after"):
            self._numbers(name)
        if not self.start < self.end:
            raise self._wrong("end", f"a time after the start at {self.start:g} s", self.end)

    @property
    def discontinuities(self) -> tuple[float, float]:
        return self.start, self.end

    def __call__(self, t: float) -> Any:
        return self._at(t, 0)

    def rate(self, t: float) -> Any:
        return self._at(t, 1)

    def acceleration(self, t: float) -> Any:
        return self._at(t, 2)

    def _at(self, t: float, order: int) -> Any:
        """before (1 - s) + after s, or a derivative of it."""
        span = self.end - self.start
        share = self._shape((t - self.start) / span)[order] / span**order
        return scaled(share, self.after, scaled((order == 0) - share, self.before))

    def _shape(self, x: float) -> tuple[float, float, float]:
        """s and its first two derivatives at the fraction x of the time."""
        return min(max(x, 0.0), 1.0), float(0.0 <= x < 1.0), 0.0


@dataclass(frozen=True)
class SmoothStep(Ramp):
    """From one value to another with continuous rate and acceleration, zero at both ends: s = 10 x^3 - 15 x^4 + 6 x^5.

    start, end      [s]
    before, after   numbers, or numbers [d]
    """

    def _shape(self, x: float) -> tuple[float, float, float]:
        u = min(max(x, 0.0), 1.0)
        return u**3 * (10.0 - 15.0 * u + 6.0 * u**2), 30.0 * u**2 * (1.0 - u) ** 2, 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
