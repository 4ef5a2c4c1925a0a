"""Derivatives of formulas by arithmetic: a number with its first two derivatives along a line, exact to rounding.

    f(u)'  = f'(u) u'          (u v)'  = u' v + u v'
    f(u)'' = f''(u) u'^2 + f'(u) u''
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

Slopes = Callable[[float], tuple[float, float]]


class Jet(NamedTuple):
    """u, u' and u''. As operands jets and numbers mix."""

    value: float
    first: float
    second: float

    def __add__(self, other: Jet | float) -> Jet:  # type: ignore[override]
        v = jet(other)
        return Jet(self.value + v.value, self.first + v.first, self.second + v.second)

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.first, -self.second)

    def __sub__(self, other: Jet | float) -> Jet:
        return self + -other

    def __rsub__(self, other: float) -> Jet:
        return -self + other

    def __mul__(self, other: Jet | float) -> Jet:  # type: ignore[override]
        v = jet(other)
        first = self.first * v.value + self.value * v.first
        return Jet(self.value * v.value, first, self.second * v.value + 2.0 * self.first * v.first + self.value * v.second)

    __radd__, __rmul__ = __add__, __mul__  # type: ignore[assignment]

    def __truediv__(self, other: Jet | float) -> Jet:
        return self * power(jet(other), -1.0)

    def __rtruediv__(self, other: float) -> Jet:
        return power(self, -1.0) * other


def jet(x: Jet | float) -> Jet:
    return x if isinstance(x, Jet) else Jet(x, 0.0, 0.0)


def chain(value: float, slopes: tuple[float, float], u: Jet) -> Jet:
    """f(u), of f, f' and f'' at u."""
    first, second = slopes
    return Jet(value, first * u.first, second * u.first**2 + first * u.second)


def power(u: Jet | float, v: Jet | float) -> Jet | float:
    if isinstance(v, Jet):
        logarithm = chain(math.log(u.value), SLOPES["log"](u.value), u) if isinstance(u, Jet) else math.log(u)
        exponent = v * logarithm
        return chain(math.exp(exponent.value), SLOPES["exp"](exponent.value), exponent)
    if not isinstance(u, Jet):
        return real_power(u, v)
    return chain(real_power(u.value, v), (_term(v, u.value, v - 1.0), _term(v * (v - 1.0), u.value, v - 2.0)), u)


def _term(factor: float, u: float, v: float) -> float:
    """Zero where the factor is, also for a power that has no value."""
    return factor * real_power(u, v) if factor else 0.0


def real_power(u: float, v: float) -> float:
    if u < 0.0 and v != math.floor(v):
        raise ValueError(f"{u:g} to the power {v:g} is no real number")
    return float(u**v)


def _root(x: float) -> tuple[float, float]:
    return 0.5 / math.sqrt(x), -0.25 / x / math.sqrt(x)


def _tan(x: float) -> tuple[float, float]:
    slope = 1.0 + math.tan(x) ** 2
    return slope, 2.0 * math.tan(x) * slope


def _tanh(x: float) -> tuple[float, float]:
    slope = 1.0 - math.tanh(x) ** 2
    return slope, -2.0 * math.tanh(x) * slope


def _asin(x: float) -> tuple[float, float]:
    slope = 1.0 / math.sqrt(1.0 - x * x)
    return slope, x * slope**3


SLOPES: dict[str, Slopes] = {
    "sin": lambda x: (math.cos(x), -math.sin(x)),
    "cos": lambda x: (-math.sin(x), -math.cos(x)),
    "tan": _tan,
    "asin": _asin,
    "acos": lambda x: (-_asin(x)[0], -_asin(x)[1]),
    "atan": lambda x: (1.0 / (1.0 + x * x), -2.0 * x / (1.0 + x * x) ** 2),
    "sinh": lambda x: (math.cosh(x), math.sinh(x)),
    "cosh": lambda x: (math.sinh(x), math.cosh(x)),
    "tanh": _tanh,
    "exp": lambda x: (math.exp(x), math.exp(x)),
    "log": lambda x: (1.0 / x, -1.0 / (x * x)),
    "sqrt": _root,
    "abs": lambda x: (math.copysign(1.0, x), 0.0),
    "sign": lambda x: (0.0, 0.0),
    "floor": lambda x: (0.0, 0.0),
    "ceil": lambda x: (0.0, 0.0),
    "round": lambda x: (0.0, 0.0),
}
"""f' and f'' of functions of one number; of those with kinks and steps, beside them."""


def atan2(y: Jet | float, x: Jet | float) -> Jet | float:
    if not isinstance(x, Jet) and not isinstance(y, Jet):
        return math.atan2(y, x)
    b, a = jet(y), jet(x)
    square = a.value**2 + b.value**2
    first = (a.value * b.first - b.value * a.first) / square
    second = (a.value * b.second - b.value * a.second - 2.0 * first * (a.value * a.first + b.value * b.first)) / square
    return Jet(math.atan2(b.value, a.value), first, second)
