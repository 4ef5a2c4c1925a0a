"""Functions through given points: straight between them, or a cubic spline."""

from __future__ import annotations

import bisect
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fields import Matrix, Vector
from .function import AsData


@dataclass(frozen=True)
class Table(AsData):
    """Straight lines through points: for measured loads. Its rate jumps at the points, where steps end; for drives see ``Spline``.

    times    [k] [s], ascending, at least two
    values   [k], or [k, d]

    Outside of its times it has no value, and a run that asks for one stops there.
    """

    times: Vector
    values: Vector | Matrix

    def __post_init__(self) -> None:
        self._numbers("times")
        self._numbers("values", most=2)
        if not isinstance(self.times, tuple) or len(self.times) < 2 or not all(a < b for a, b in zip(self.times, self.times[1:])):
            raise self._wrong("times", "two or more ascending times [s]", self.times)
        if not isinstance(self.values, tuple) or len(self.values) != len(self.times):
            raise self._wrong("values", f"one for each of the {len(self.times)} times", self.values)
        self._set(_values=np.array(self.values))

    @property
    def discontinuities(self) -> tuple[float, ...]:
        return self.times

    def __call__(self, t: float) -> Any:
        k = self._piece(t)
        return self._values[k] + (t - self.times[k]) * self._slope(k)  # type: ignore[attr-defined]

    def rate(self, t: float) -> Any:
        return self._slope(self._piece(t))

    def acceleration(self, t: float) -> Any:
        return 0.0 * self._slope(self._piece(t))

    def _slope(self, k: int) -> Any:
        return (self._values[k + 1] - self._values[k]) / (self.times[k + 1] - self.times[k])  # type: ignore[attr-defined]

    def _piece(self, t: float) -> int:
        """The index of the point before t."""
        self._check(t)
        return min(max(bisect.bisect_right(self.times, t) - 1, 0), len(self.times) - 2)

    def _check(self, t: float) -> None:
        first, last = self.times[0], self.times[-1]
        slack = 1e-9 * (last - first)  # times beside a jump are asked for too
        if not first - slack <= t <= last + slack:
            raise ValueError(f"t = {t:g} s is outside of the {type(self).__name__.lower()}, which goes from {first:g} to {last:g} s")


@dataclass(frozen=True)
class Spline(Table):
    """The cubic spline through points, with continuous rate and acceleration: for drives (not-a-knot at the ends; SciPy's CubicSpline).

    times    [k] [s], ascending, at least two
    values   [k], or [k, d]

    Outside of its times it has no value, and a run that asks for one stops there.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        from scipy.interpolate import CubicSpline

        curve = CubicSpline(self.times, self._values)  # type: ignore[attr-defined]
        self._set(_curves=(curve, curve.derivative(1), curve.derivative(2)))

    @property
    def discontinuities(self) -> tuple[float, ...]:
        return ()

    def __call__(self, t: float) -> Any:
        return self._at(t, 0)

    def rate(self, t: float) -> Any:
        return self._at(t, 1)

    def acceleration(self, t: float) -> Any:
        return self._at(t, 2)

    def _at(self, t: float, order: int) -> Any:
        self._check(t)
        return self._curves[order](t)  # type: ignore[attr-defined]
