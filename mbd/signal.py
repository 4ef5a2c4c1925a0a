"""Numbers that a user gives as constants or as functions of time, sampled with checks that name the item; and the jumps of the latter.

A function of time may say where it or a derivative jumps, by an attribute ``discontinuities``: a sequence of times [s]. Any callable may
have one; ``piecewise`` makes one, and those of loads that nobody declared are looked for (``jumps.py``).
Runs land on these times and start there anew. Functions are seen from the right at such a time, so accelerations and reactions asked there
are those after the jump; but a step that ends there must see them as they were within it: ``OneSided`` integrators look a few units of
rounding earlier. So it does not matter which of the two values a function has at the time itself, nor whether its own arithmetic jumps an
ulp beside it.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import validate
from .affine import Array
from .called import called
from .fields import Function, Vector

SAME, BESIDE = 32.0, 64.0
"""In units of rounding: times this near to a jump are the jump, and how far beside it a function is called instead."""


@dataclass(frozen=True)
class Piecewise:
    """A function of time that is smooth but at its ``discontinuities``."""

    function: Function
    discontinuities: Vector

    def __call__(self, t: float) -> Any:
        return self.function(t)


def piecewise(function: Callable[[float], Any], *, at: Sequence[float]) -> Piecewise:
    """A function of time, for a load, that is smooth but at the times ``at`` [s], where it or a derivative may jump.

    Steps end exactly there, so that the jump costs no accuracy. Its value at such a time itself does not matter.
    """
    return Piecewise(function, at)


class Signal:
    """A constant or callable(t) with values of one shape. ``faults`` complains about a constant; a callable is checked when called."""

    def __init__(self, value: Any, shape: tuple[int, ...], item: str, unit: str):
        self.function: Callable[[float], Any] | None = value if callable(value) else None
        self.constant = None if self.function else validate.floats(value)
        self.shape, self.item, self.unit = shape, item, unit
        self._declared = validate.floats(getattr(value, "discontinuities", ())) if self.function else np.zeros(0)
        sound = isinstance(self._declared, np.ndarray) and self._declared.ndim == 1 and np.isfinite(self._declared).all()
        self.discontinuities: Array = np.unique(self._declared) if sound else np.zeros(0)
        self._sound = bool(sound)
        self._jumps: list[float] = self.discontinuities.tolist()
        self._expected = f"{'a number' if not shape else f'{shape[0]} numbers'} {unit}"

    def faults(self, field: str) -> list[str]:
        if self.function:
            found = validate.show(self._declared)
            return [] if self._sound else [f"{field}: discontinuities: expected a sequence of finite times [s], found {found}; correct them"]
        if not isinstance(self.constant, np.ndarray) or self.constant.shape != self.shape:
            return [f"{field}: expected {self._expected} or a function of t, found {validate.show(self.constant)}; correct it"]
        return validate.finite(field, self.constant)

    def sample(self, times: Array) -> Array:
        """[..., *shape] for times [...]; at a discontinuity from the right."""
        if self.function is None:
            return np.broadcast_to(np.asarray(self.constant), (*times.shape, *self.shape))
        values = np.empty((times.size, *self.shape))
        for k, t in enumerate(self.seen(times).ravel().tolist()):
            values[k] = self._call(t)  # copied: a function may return the same array each time
        return values.reshape((*times.shape, *self.shape))

    def seen(self, times: Array) -> Array:
        """The times [...] at which the function is called for times: at a discontinuity, to the right of it."""
        if not self._jumps:
            return times
        return np.array([self._beside(t) for t in times.ravel().tolist()]).reshape(times.shape)

    def _beside(self, t: float) -> float:
        k = bisect_left(self._jumps, t)
        at = (k < len(self._jumps) and same(t, self._jumps[k])) or (k > 0 and same(t, self._jumps[k - 1]))
        return t + BESIDE * math.ulp(t) if at else t

    def _call(self, t: float) -> Array:
        assert self.function is not None
        what, expected = "the function given for it", self._expected
        return called(self.function, t, fits=lambda _, value: value.shape == self.shape, expected=expected, what=what, item=self.item, time=t)


class Samples:
    """The values of signals [n] of one shape at times [...]: [..., n, *shape], or [n, *shape] where all are constants."""

    def __init__(self, signals: Sequence[Signal]):
        shape = signals[0].shape
        self._constant = np.array([np.zeros(shape) if signal.function else signal.constant for signal in signals])
        places = (slice(None),) * len(shape)
        self._functions: list[tuple[Any, Signal]] = [((..., k, *places), signal) for k, signal in enumerate(signals) if signal.function]

    def __call__(self, times: Array) -> Array:
        if not self._functions:
            return self._constant
        values = np.empty((*times.shape, *self._constant.shape))
        values[...] = self._constant
        for place, signal in self._functions:
            values[place] = signal.sample(times)
        return values


def same(t: float, jump: float) -> bool:
    """Whether a time is that of a jump, but for rounding."""
    return abs(t - jump) <= SAME * math.ulp(jump)


def discontinuities(system: Any) -> Array:
    """The declared times [k] of all functions of a system, ascending."""
    driven = [signal.discontinuities for _, target in system.joints.drives for signal in target.signals]
    declared = driven + [signal.discontinuities for kernel in system.loads for signal in kernel.signals]
    return np.unique(np.concatenate(declared or [np.zeros(0)]))


def stops(jumps: Array, start: float, end: float) -> list[float]:
    """Those between start and end, each once: times apart by rounding only are one."""
    found: list[float] = []
    for t in jumps.tolist():
        if start < t < end and not any(same(other, t) for other in (start, end, *found[-1:])):
            found.append(t)
    return found


def from_inside(system: Any, jumps: Array, start: float, end: float) -> Any:
    """The system as a step from start to end sees it: the same unless a jump is at its end."""
    ulp = math.ulp(max(abs(start), abs(end)))
    k = bisect_left(jumps, end - SAME * ulp)
    if k == len(jumps) or jumps[k] > end + SAME * ulp:
        return system
    latest, view = end - 2.0 * BESIDE * ulp, copy(system)
    view.inputs = lambda times: system.inputs(np.minimum(times, latest))
    return view


class OneSided:
    """An integrator whose steps see functions of time from inside: where one ends at a jump, as they were before it."""

    def __init__(self, method: Any, jumps: Array):
        self.method, self.jumps = method, jumps

    @property
    def name(self) -> str:
        return self.method.name

    @property
    def fixed(self) -> float | None:
        return self.method.fixed

    def step(self, system: Any, linear: Any, state: Any, h: float, tolerance: float) -> Any:
        return self.method.step(from_inside(system, self.jumps, state.t, state.t + h), linear, state, h, tolerance)

    def inside(self, system: Any, linear: Any, before: Any, after: Any, t: Array) -> tuple[Array, Array]:
        return self.method.inside(from_inside(system, self.jumps, before.t, after.t), linear, before, after, t)

    def kept(self, memory: Any) -> Any:
        return self.method.kept(memory)

    def first_step(self, system: Any, state: Any, acceleration: Array, span: float, tolerance: float) -> float:
        return self.method.first_step(system, state, acceleration, span, tolerance)
