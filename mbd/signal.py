"""Numbers that a user gives as constants or as functions of time, sampled with checks that name the item; and the jumps of the latter.

A function of time may say where it or a derivative jumps, by an attribute ``discontinuities``: a sequence of times [s]. Any callable may
have one; ``piecewise`` makes one, and those of loads that nobody declared are looked for (``jumps.py``).
Runs land on these times and start there anew. Functions are seen from the right at such a time, so accelerations and reactions asked there are those after the jump; but a step that ends there must see them as they were within it:
``OneSided`` integrators look a few units of rounding earlier. So it does not matter which of the two values a function has at the
time itself, nor whether its own arithmetic jumps an ulp beside it.
"""

from __future__ import annotations

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

    def faults(self, field: str) -> list[str]:
        if self.function:
            found = validate.show(self._declared)
            return [] if self._sound else [f"{field}: discontinuities: expected a sequence of finite times [s], found {found}; correct them"]
        if not isinstance(self.constant, np.ndarray) or self.constant.shape != self.shape:
            expected = "a number" if not self.shape else f"{self.shape[0]} numbers"
            return [f"{field}: expected {expected} {self.unit} or a function of t, found {validate.show(self.constant)}; correct it"]
        return validate.finite(field, self.constant)

    def sample(self, times: Array) -> Array:
        """[..., *shape] for times [...]; at a discontinuity from the right."""
        if self.function is None:
            return np.broadcast_to(np.asarray(self.constant), (*times.shape, *self.shape))
        return np.array([self._call(float(t)) for t in self.seen(times).ravel()]).reshape((*times.shape, *self.shape))

    def seen(self, times: Array) -> Array:
        """The times [...] at which the function is called for times: at a discontinuity, to the right of it."""
        if not self.discontinuities.size:
            return times
        at = np.any(_same(times[..., None], self.discontinuities), axis=-1)
        return np.where(at, times + BESIDE * np.spacing(np.abs(times)), times)

    def _call(self, t: float) -> Array:
        assert self.function is not None
        expected = "a number" if not self.shape else f"{self.shape[0]} numbers"
        what, wanted = "the function given for it", f"{expected} {self.unit}"
        return called(self.function, t, fits=lambda _, value: value.shape == self.shape, expected=wanted, what=what, item=self.item, time=t)


def _same(times: Array, jumps: Array) -> Any:
    return np.abs(times - jumps) <= SAME * np.spacing(np.abs(jumps))


def discontinuities(system: Any) -> Array:
    """The declared times [k] of all functions of a system, ascending."""
    driven = [signal.discontinuities for _, target in system.joints.drives for signal in target.signals]
    declared = driven + [signal.discontinuities for kernel in system.loads for signal in kernel.signals]
    return np.unique(np.concatenate(declared or [np.zeros(0)]))


def stops(jumps: Array, start: float, end: float) -> list[float]:
    """Those between start and end, each once: times apart by rounding only are one."""
    found: list[float] = []
    for t in jumps.tolist():
        if start < t < end and not _same(np.array([start, end, *found[-1:]]), np.array(t)).any():
            found.append(t)
    return found


def from_inside(system: Any, jumps: Array, start: float, end: float) -> Any:
    """The system as a step from start to end sees it: the same unless a jump is at its end."""
    ulp = np.spacing(max(abs(start), abs(end)))
    if not np.any(np.abs(end - jumps) <= SAME * ulp):
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
