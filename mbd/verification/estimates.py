"""What differences between runs say: the observed order, an estimated error over time, how long it can be believed, how fast motions part.

Runs 0, 1, 2, from coarse to fine, with tolerances or steps h_0, h_1, h_2. Where the error is C h^p
    |y0 - y1| / |y1 - y2| = ((h_0/h_1)^p - 1) / (1 - (h_2/h_1)^p)      gives the observed p,
    |y2 - exact| = |y1 - y2| / ((h_1/h_2)^p - 1)                       the error of the finest run.
The order p of fixed steps is known, and is used where the observed one confirms it. Errors follow tolerances less smoothly: p is taken as observed,
but not above 1/2 (on the reference cases true errors are 0.01 to 1 times |y1 - y2| when these tolerances are ten apart). Differences pass
through zero by accident where errors do not: at each time the largest one nearby counts. Where only one step in n is compared, a difference is
taken for sqrt(n) of what is seen: peaks, of forces above all, lie between.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..affine import Array

CAUTIOUS, POWER = 0.3, 0.5
"""Of the tolerance: errors are taken to fall as fast as observed between these powers, where nothing could be observed like the first."""
LEAST_POWER, LEAST_ORDER = 0.1, 0.7
"""What is observed must reach this power of the tolerance, and this share of the order of fixed steps."""
NEARBY = 0.2
"""Share of the run, to either side of a time, in which the largest difference counts; but two times of comparison at least."""
LOST, NOTHING = 0.1, 1e-3
"""An output is lost where its error exceeds this share of its range, and also this share of its size."""
ROUNDING = 8.0 * np.finfo(float).eps
"""Of the largest value: what no estimate goes below."""
NOISE = 100.0
"""Differences below so many times that say nothing of an order."""

ORDERS = np.linspace(-3.0, 20.0, 2301)


class Estimate(NamedTuple):
    """Of one output: raw errors [k] of the finest run at the times of comparison, the observed order (NaN where none can be seen), the time
    from which the output is lost (infinite if it is not), and its range."""

    errors: Array
    order: float
    lost: float
    range: float


def order_of(coarse: Array, fine: Array, ratios: tuple[float, float]) -> float:
    """The observed p of differences |y0 - y1| and |y1 - y2| [k], by their mean squares; h_0/h_1 and h_1/h_2 are the ratios."""
    sizes = np.array([np.sqrt(np.mean(x**2)) for x in (coarse, fine)])
    if not sizes.all():
        return np.nan
    p = np.where(ORDERS == 0.0, 1e-9, ORDERS)
    expected = np.log((ratios[0] ** p - 1.0) / (1.0 - ratios[1] ** -p))
    return float(np.interp(np.log(sizes[0] / sizes[1]), expected, ORDERS))


class Values(NamedTuple):
    """Of one output: [k, m] in the middle and the finest run at times [k], and in the coarsest, if there is one, at ``times[seldom]``; the
    times are a share ``density`` of the finest run's steps."""

    times: Array
    coarse: Array | None
    seldom: NDArray[np.intp]
    middle: Array
    fine: Array
    density: float = 1.0


def estimate(values: Values, ratios: tuple[float, float], order: int | None, size: float) -> Estimate:
    """``order``: of fixed steps, None for tolerances; ``size``: of the output."""
    difference = np.linalg.norm(values.middle - values.fine, axis=1) / np.sqrt(values.density)
    reach = float(np.linalg.norm(np.ptp(values.fine, axis=0)))
    limit = max(LOST * reach, NOTHING * size)
    floor = ROUNDING * float(np.max(np.abs(values.fine), initial=0.0))
    observed = _observed(values, difference, ratios, 0.5 * limit, floor)
    power = order or (CAUTIOUS if np.isnan(observed) else min(max(observed, CAUTIOUS), POWER))
    errors = np.maximum(difference / (ratios[1] ** power - 1.0), floor)
    return Estimate(errors, observed, _first(values.times, errors > limit), reach)


def _observed(values: Values, difference: Array, ratios: tuple[float, float], limit: float, floor: float) -> float:
    """The order while the coarsest run is not lost itself, and unless all is rounding."""
    if values.coarse is None:
        return np.nan
    times, fine = values.times[values.seldom], difference[values.seldom] * np.sqrt(values.density)
    coarse = np.linalg.norm(values.coarse - values.middle[values.seldom], axis=1)
    seen = times < _first(times, coarse > limit)
    if np.count_nonzero(seen) < 2 or np.max(fine[seen]) < NOISE * floor:
        return np.nan
    return order_of(coarse[seen], fine[seen], ratios)


def _first(times: Array, where: NDArray[np.bool_]) -> float:
    return float(times[np.argmax(where)]) if where.any() else np.inf


def plausible(observed: float, order: float | None) -> bool:
    """Whether an observed order lets the estimate stand; one that cannot be seen does."""
    return np.isnan(observed) or observed >= (LEAST_POWER if order is None else LEAST_ORDER * order)


def envelope(t: Array, times: Array, errors: Array, lost: float) -> Array:
    """Estimated errors at t [n_t] from those at times [k]: the largest nearby; infinite after the last of these at which the output is not lost."""
    kept = times < lost
    if not kept.any():
        return np.full(t.shape, np.inf)
    width = max(NEARBY * (times[-1] - times[0]), 2.0 * np.max(np.diff(times), initial=0.0))
    near = np.abs(t[:, None] - times[kept]) <= width
    largest = np.max(np.where(near, errors[kept], 0.0), axis=1)
    end = np.inf if kept.all() else times[kept][-1]
    return np.where(t <= end, np.maximum(largest, np.min(errors)), np.inf)


class Growth(NamedTuple):
    """How neighbouring motions part: the finite-time exponent [1/s], and whether they do so exponentially rather than like a power of t."""

    exponent: float
    exponential: bool


def growth(times: Array, distances: Array) -> Growth:
    """From distances [k] between two runs, as shares of the scene's length, while they are small: the least-squares slope of their logarithm."""
    small = times < _first(times, distances > LOST)
    used = small & (distances > 0.0) & (times - times[0] > 0.05 * (times[-1] - times[0]))
    if np.count_nonzero(used) < 4:
        return Growth(np.nan, False)
    t, y = times[used] - times[0], np.log(distances[used])
    (slope, rest), (_, power_rest) = _line(t, y), _line(np.log(t), y)
    return Growth(slope, bool(rest < power_rest and slope * (t[-1] - t[0]) > np.log(100.0)))


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope and sum of squares left, of the line through points by least squares."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y / (x @ x))
    return slope, float(np.sum((y - slope * x) ** 2))
