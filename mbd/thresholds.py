"""Numbers that a user's function compares its time with: where its value may jump, however short what lies between two of them.

The function is called with times that note every comparison they or what is computed from them take part in: such a number carries its
rate of change (forward differentiation), so that a comparison that has not come out yet tells when it will, by one step of Newton's
method. These times are gone to in turn, and what is compared there is noted as well. Sums, products, powers, remainders, rounding and
NumPy's functions of that kind keep the rate; other functions give plain numbers, and what they are compared with stays unknown.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from heapq import heappop, heappush
from typing import Any

import numpy as np

MOST = 4096
"""Times that are gone to at most."""


class Noting(float):
    """A number at a time, its ``rate`` of change, and ``notes``: how much later what was compared would be equal [s]."""

    __slots__ = ("notes", "rate")
    rate: float
    notes: list[float]

    def __new__(cls, value: float, rate: float, notes: list[float]) -> Noting:
        made = super().__new__(cls, value)
        made.rate, made.notes = rate, notes
        return made

    def like(self, value: Any, rate: float) -> Any:
        """A number computed from this one; plain where it does not change or is no real number."""
        return Noting(value, rate, self.notes) if rate and isinstance(value, float) else value

    def note(self, other: Any) -> None:
        """That the two were compared."""
        if rate := self.rate - _rate(other):
            self.notes.append((float(other) - float(self)) / rate)

    def note_cells(self, width: float, offset: float) -> None:
        """That what was computed jumps where this number leaves its cell: one of equal width, in which it is at an offset."""
        if self.rate and width:
            self.notes += [-offset / self.rate, (width - offset) / self.rate]

    def note_table(self, table: Any) -> None:
        """That it was looked up in an ascending table: the entries around it."""
        values = np.ravel(table)
        at = int(np.searchsorted(values, float(self)))
        for value in values[max(at - 1, 0) : at + 2].tolist():
            self.note(value)

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **more: Any) -> Any:
        known = _KNOWN.get(function)
        if known and method == "__call__" and not more and all(np.ndim(x) == 0 for x in inputs):
            return known(*(x if isinstance(x, Noting) else float(x) for x in inputs))
        if function in _COMPARISONS:
            for x in (x for x in inputs if not isinstance(x, Noting)):
                self.note_table(np.sort(x, axis=None))
        return getattr(function, method)(*map(_plain, inputs), **more)

    def __array_function__(self, function: Any, types: Any, inputs: Any, more: Any) -> Any:
        if function is np.clip and not more and all(np.ndim(x) == 0 for x in inputs):
            return min(max(inputs[0], inputs[1]), inputs[2])
        if function in _TABLES:
            x, table = (inputs[k] for k in _TABLES[function])
            if isinstance(x, Noting):
                x.note_table(table)
        return function(*map(_plain, inputs), **{name: _plain(x) for name, x in more.items()})

    def __floor__(self) -> int:
        self.note_cells(1.0, float(self) % 1.0)
        return math.floor(float(self))

    def __ceil__(self) -> int:
        return -math.floor(-self)

    def __trunc__(self) -> int:
        return math.floor(self) if self >= 0.0 else math.ceil(self)

    __int__ = __trunc__

    def __round__(self, digits: Any = None) -> Any:
        width = 10.0 ** -(digits or 0)
        self.note_cells(width, (float(self) + 0.5 * width) % width)
        return round(float(self), digits)

    def __neg__(self) -> Any:
        return self.like(-float(self), -self.rate)

    def __pos__(self) -> Noting:
        return self

    def __abs__(self) -> Any:
        return self if self >= 0.0 else -self


def _plain(x: Any) -> Any:
    return float(x) if isinstance(x, Noting) else x


def _rate(x: Any) -> float:
    return x.rate if isinstance(x, Noting) else 0.0


def _compared(compare: Callable[[float, float], bool]) -> Callable[[Noting, Any], Any]:
    def method(self: Noting, other: Any) -> Any:
        if not isinstance(other, (int, float)):
            return NotImplemented
        self.note(other)
        return compare(float(self), float(other))

    return method


def _computed(compute: Callable[[Any, Any], Any], rate: Callable[[float, float, float, float], float], swapped: bool) -> Callable[[Noting, Any], Any]:
    """An operator, and the rate of its result by those of what it takes: rate(x, y, x', y')."""

    def method(self: Noting, other: Any) -> Any:
        if not isinstance(other, (int, float)):
            return NotImplemented
        x, y = (other, self) if swapped else (self, other)
        a, b = float(x), float(y)
        return self.like(compute(a, b), rate(a, b, _rate(x), _rate(y)))

    return method


def _cut(compute: Callable[[Any, Any], Any], keeps: float) -> Callable[[Noting, Any], Any]:
    """x // y and x % y: what they give jumps where x reaches a multiple of y; the remainder keeps the rate."""

    def method(self: Noting, other: Any) -> Any:
        if not isinstance(other, (int, float)) or isinstance(other, Noting):
            return NotImplemented
        value = compute(float(self), other)
        self.note_cells(abs(other), float(self) % abs(other))
        return self.like(value, keeps * self.rate)

    return method


def _power_rate(x: float, y: float, dx: float, dy: float) -> float:
    """Of constant exponents; others are seldom compared."""
    return y * x ** (y - 1.0) * dx if (dx and x > 0.0) or (float(y).is_integer() and y >= 1.0) else 0.0


_RATES: dict[str, tuple[Callable[[Any, Any], Any], Callable[[float, float, float, float], float]]] = {
    "add": (operator.add, lambda x, y, dx, dy: dx + dy),
    "sub": (operator.sub, lambda x, y, dx, dy: dx - dy),
    "mul": (operator.mul, lambda x, y, dx, dy: dx * y + x * dy),
    "truediv": (operator.truediv, lambda x, y, dx, dy: (dx - x / y * dy) / y),
    "pow": (operator.pow, _power_rate),
}

for _name, (_compute, _by) in _RATES.items():
    setattr(Noting, f"__{_name}__", _computed(_compute, _by, False))
    setattr(Noting, f"__r{_name}__", _computed(_compute, _by, True))
for _name in ("lt", "le", "gt", "ge"):
    setattr(Noting, f"__{_name}__", _compared(getattr(operator, _name)))
Noting.__mod__, Noting.__floordiv__ = _cut(operator.mod, 1.0), _cut(operator.floordiv, 0.0)  # type: ignore[method-assign, assignment]

_COMPARISONS = dict(zip((np.less, np.less_equal, np.greater, np.greater_equal), (operator.lt, operator.le, operator.gt, operator.ge)))

_TABLES = {np.interp: (0, 1), np.searchsorted: (1, 0), np.digitize: (0, 1)}
"""Which of a function's arguments is looked up in which."""

_KNOWN: dict[Any, Callable[..., Any]] = {
    **_COMPARISONS,
    **dict(zip((np.add, np.subtract, np.multiply, np.divide, np.power), (operator.add, operator.sub, operator.mul, operator.truediv, operator.pow))),
    np.remainder: operator.mod, np.floor_divide: operator.floordiv, np.negative: operator.neg, np.square: lambda x: x * x,
    np.absolute: abs, np.fabs: abs, np.maximum: max, np.minimum: min, np.fmax: max, np.fmin: min,
    np.floor: lambda x: float(math.floor(x)), np.ceil: lambda x: float(math.ceil(x)), np.trunc: lambda x: float(math.trunc(x)),
    np.rint: lambda x: float(round(x)), np.sign: lambda x: float(x > 0.0) - float(x < 0.0),
    np.heaviside: lambda x, half: 1.0 if x > 0.0 else 0.0 if x < 0.0 else half,
}


def thresholds(function: Callable[[float], Any], times: list[float], end: float) -> tuple[list[float], bool]:
    """The times between the first of ``times`` and the end at which comparisons of the function come out, ascending: those that show at
    the times, and those that show at such; and whether these are all. Raises what the function raises."""
    beside = 4.0 * math.ulp(max(abs(times[0]), abs(end)))
    found: set[float] = set()
    gone, waiting = set(times), sorted(times)
    while waiting and len(gone) < MOST:
        now = heappop(waiting)
        notes: list[float] = []
        function(Noting(now, 1.0, notes))
        onward = {now + later for later in notes if math.isfinite(later)}
        if any(abs(then - now) <= beside for then in onward) and times[0] < now < end:
            found.add(now)
            onward |= {now - 2.0 * beside, now + 2.0 * beside}
        for then in onward - gone:
            if times[0] < then < end:
                gone.add(then)
                heappush(waiting, then)
    return sorted(found), not waiting
