"""Derivatives and integrals of functions of time that are known by their values only.

Derivatives: central differences of order 8 beside those of order 6, with steps from 0.74 s downwards until the two agree to rounding.
Polynomials of degree 6 are exact at the first step. For smooth functions the relative error is about 1e-12 (first derivative) and
1e-10 (second), in units of the function's own time scale; beside a kink the step shrinks until it is on one side, on it the result is
the mean of both sides.
Integrals: Gauss-Legendre with 10 points, halved until the halves agree with the whole to rounding.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .affine import Array
from .errors import SimulationError

STEPS = 0.7390851332151607 * 4.0 ** -np.arange(14.0)
"""[s]; no simple fraction, so that no stencil falls in step with a periodic function."""

OFFSETS = np.arange(-4.0, 5.0)


def _both_sides(right: list[float], centre: float, sign: float) -> Array:
    half = np.array(right + [0.0] * (4 - len(right)))
    return np.concatenate((sign * half[::-1], [centre], half))


WEIGHTS = {
    1: (_both_sides([4 / 5, -1 / 5, 4 / 105, -1 / 280], 0.0, -1.0), _both_sides([3 / 4, -3 / 20, 1 / 60], 0.0, -1.0)),
    2: (_both_sides([8 / 5, -1 / 5, 8 / 315, -1 / 560], -205 / 72, 1.0), _both_sides([3 / 2, -3 / 20, 1 / 90], -49 / 18, 1.0)),
}
"""Order 8 and order 6 for the first and the second derivative (Fornberg 1988, Math. Comp. 51)."""

NODES, GAUSS = np.polynomial.legendre.leggauss(10)


def derivative(f: Callable[[Array], Array], t: float, order: int) -> Array:
    """The first or second derivative at t of f, which takes times [k] to values [k, ...]."""
    tried: list[tuple[float, Array]] = []
    trouble: SimulationError | None = None
    for h in STEPS:
        try:
            values = f(t + h * OFFSETS)
        except SimulationError as error:  # not defined that far away, or not at all
            trouble = error
            continue
        fine, coarse = (np.tensordot(w, values, 1) for w in WEIGHTS[order])
        # Values are as good as their rounding, and as that of t lets them be.
        noise = np.finfo(float).eps * (np.max(np.abs(values)) + abs(t) / h * np.max(np.ptp(values, axis=0)))
        spread = float(np.max(np.abs(fine - coarse)))
        tried.append((spread, fine / h**order))
        if spread <= 4.0 * noise:
            return tried[-1][1]
    if not tried:
        assert trouble is not None
        raise trouble
    # The function is noisier than its rounding: the largest step whose disagreement is about the least there is.
    least = sorted(spread for spread, _ in tried)[min(2, len(tried) - 1)]
    return next(found for spread, found in tried if spread <= 4.0 * least)


def integral(f: Callable[[Array], Array], a: float, b: float, depth: int = 40) -> float:
    """Of f from a to b."""
    return _halved(f, a, b, *_gauss(f, a, b), depth)


def _gauss(f: Callable[[Array], Array], a: float, b: float) -> tuple[float, float]:
    """The sum, and the size of its terms and of what the rounding of times, in units of rounding, makes of them."""
    values = f(0.5 * (a + b) + 0.5 * (b - a) * NODES)
    size = 0.5 * abs(b - a) * float(GAUSS @ np.abs(values)) + max(abs(a), abs(b)) * float(np.ptp(values))
    return 0.5 * (b - a) * float(GAUSS @ values), size


def _halved(f: Callable[[Array], Array], a: float, b: float, whole: float, size: float, depth: int) -> float:
    middle = 0.5 * (a + b)
    (left, left_size), (right, right_size) = _gauss(f, a, middle), _gauss(f, middle, b)
    if depth == 0 or abs(left + right - whole) <= 8.0 * np.finfo(float).eps * size:
        return left + right
    return _halved(f, a, middle, left, left_size, depth - 1) + _halved(f, middle, b, right, right_size, depth - 1)
