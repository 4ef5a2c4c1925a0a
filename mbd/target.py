"""What driven equations follow: gamma(q) = c(t), with G v = c'(t) and G a = c''(t) - v' d2(gamma)/dq2 v at the other two levels.

Derivatives are the user's own where the function carries them (``Motion``), otherwise differences (``differences.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from .affine import Array
from .differences import derivative, integral
from .fields import Function
from .signal import Signal


@dataclass(frozen=True, eq=False)
class Motion:
    """A function of t [s] for drives, with its first two derivatives: callables of t, each omitted one found by differences.

    ``mbd.Motion(lambda t: np.sin(3 * t), rate=lambda t: 3 * np.cos(3 * t), acceleration=lambda t: -9 * np.sin(3 * t))``
    Any callable with attributes ``rate`` and ``acceleration`` will do as well.
    """

    value: Function
    rate: Function = None
    acceleration: Function = None

    def __call__(self, t: float) -> Any:
        return self.value(t)


class Target(Protocol):
    """c, c' and c'' [..., k] at times [...] for the k rows of one drive; ``signals`` are the user's functions behind it."""

    signals: tuple[Signal, ...]

    def value(self, times: Array) -> Array: ...
    def rate(self, times: Array) -> Array: ...
    def acceleration(self, times: Array) -> Array: ...


def _differences(f: Callable[[Array], Array], times: Array, order: int) -> Array:
    values = np.array([derivative(f, float(t), order) for t in times.ravel()])
    return values.reshape(times.shape + values.shape[1:])


class Position:
    """c is given: a callable(t) with values [k], or numbers where k = 1."""

    def __init__(self, value: Any, shape: tuple[int, ...], item: str, unit: str):
        self._value = Signal(value, shape, item, unit)
        rate, acceleration = (getattr(value, name, None) for name in ("rate", "acceleration"))
        self._rate = Signal(rate, shape, item, f"{unit[:-1]}/s]") if rate else None
        self._acceleration = Signal(acceleration, shape, item, f"{unit[:-1]}/s^2]") if acceleration else None
        self.signals = tuple(signal for signal in (self._value, self._rate, self._acceleration) if signal)

    def value(self, times: Array) -> Array:
        return self._rows(self._value.sample(times), times)

    def rate(self, times: Array) -> Array:
        return self._rows(self._rate.sample(times) if self._rate else _differences(self._value.sample, times, 1), times)

    def acceleration(self, times: Array) -> Array:
        if self._acceleration:
            return self._rows(self._acceleration.sample(times), times)
        known, order = (self._rate, 1) if self._rate else (self._value, 2)
        return self._rows(_differences(known.sample, times, order), times)

    def _rows(self, values: Array, times: Array) -> Array:
        return values.reshape(*times.shape, -1)


PANELS = 256
"""Sums of an integral that are kept for each power of two of the time."""


class Integral:
    """c' is given, a number or callable(t), and c is its integral from t = 0: exact for a number, otherwise by quadrature to rounding."""

    def __init__(self, speed: Any, item: str, unit: str):
        acceleration = getattr(speed, "rate", None)
        self._rate = Signal(speed, (), item, unit)
        self._acceleration = Signal(acceleration, (), item, f"{unit[:-1]}^2]") if acceleration else None
        self.signals: tuple[Signal, ...] = (self._rate, self._acceleration) if self._acceleration else (self._rate,)
        self._known: dict[float, float] = {}  # at times that do not depend on which were asked for before: nor do the values, to the last bit

    def value(self, times: Array) -> Array:
        if self._rate.function is None:
            return self._rate.sample(times)[..., None] * times[..., None]
        return np.array([self._up_to(float(t)) for t in times.ravel()]).reshape(*times.shape, 1)

    def _up_to(self, t: float) -> float:
        """By way of every PANELS-th part of the power of two below t."""
        octave = np.copysign(2.0 ** np.floor(np.log2(abs(t))), t) if t else 0.0
        panel, done = octave / PANELS, octave
        if octave and octave not in self._known:
            self._known[octave] = integral(self._rate.sample, 0.0, octave)
        for k in range(int((t - octave) / panel) if octave else 0):
            start, done = octave + k * panel, octave + (k + 1) * panel
            if done not in self._known:
                self._known[done] = self._known[start] + integral(self._rate.sample, start, done)
        return self._known.get(done, 0.0) + (integral(self._rate.sample, done, t) if t != done else 0.0)

    def rate(self, times: Array) -> Array:
        return self._rate.sample(times)[..., None]

    def acceleration(self, times: Array) -> Array:
        if self._rate.function is None:
            return np.zeros((*times.shape, 1))
        return (self._acceleration.sample(times) if self._acceleration else _differences(self._rate.sample, times, 1))[..., None]


class Targets:
    """All driven rows of a scene at times [...]: arrays [..., m], zero where nothing is driven, each evaluated once, when it is asked for."""

    def __init__(self, drives: Sequence[tuple[slice, Target]], m: int, times: Array):
        self.drives, self.m, self.times = drives, m, times

    def _fill(self, level: str) -> Array:
        if not self.drives:
            return np.zeros(1)  # broadcasts like [m], and costs nothing
        out = np.zeros((*self.times.shape, self.m))
        for rows, target in self.drives:
            out[..., rows] = getattr(target, level)(self.times)
        return out

    @cached_property
    def value(self) -> Array:
        """c."""
        return self._fill("value")

    @cached_property
    def rate(self) -> Array:
        """c'."""
        return self._fill("rate")

    @cached_property
    def acceleration(self) -> Array:
        """c''."""
        return self._fill("acceleration")
