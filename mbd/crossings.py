"""Zero crossings of a function of time in one step, from few samples taken in batches.

Values at the ends are exact, others at first only rough (``t``, ``g``): they tell where to look. There exact values are asked for, a batch
at a time, since a call of ``look(times)`` may cost as much as a step whatever its length. A crossing is a change of sign, or an arrival
at zero; a zero at the first time is none, and neither is a jump over zero, as of an angle from pi to -pi.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .affine import Array

Look = Callable[[Array], Array]

UNIT = 0.5 - 0.5 * np.cos(np.pi * np.arange(7) / 6)  # Chebyshev's extreme points on [0, 1]
MARGIN = 0.1  # of a span that looks suspicious, on either side of it
NEAR, NEARER = 0.3, 0.02  # a bottom below this share of the values around it may reach zero: by rough samples, by exact ones
BOTTOMS, ROUNDS = 4, 20  # limits of the searches
SHARES = np.arange(1, 16) / 16
JUMP = 1e3  # a function that changes by half of its change around within so many times the resolution is taken to jump


def crossings(t: Array, g: Array, look: Look, resolution: float) -> list[tuple[float, int]]:
    """Ascending times and directions (+1 rising, -1 falling); each time is one that was looked at, or an end, within ``resolution``."""
    points = _suspects(t, g)
    if not points.size:
        return []
    t, g = _more(t[[0, -1]], g[[0, -1]], points, look)
    for _ in range(BOTTOMS):
        bottoms = _bottoms(t, g, NEARER)[0]
        bottoms = bottoms[np.min(np.abs(bottoms[:, None] - t), axis=1, initial=np.inf) > resolution]
        if not bottoms.size:
            break
        t, g = _more(t, g, bottoms, look)
    found = []
    for k in np.flatnonzero(_crossed(g)):
        time = _refined(t, g, int(k), look, resolution)
        if time is not None:
            found.append((time, 1 if g[k] < 0.0 else -1))
    return found


def _crossed(g: Array) -> NDArray[np.bool_]:
    """Whether zero is crossed, or reached, between each sample and the next."""
    return (g[:-1] != 0.0) & (np.sign(g[:-1]) * g[1:] <= 0.0)


def _suspects(t: Array, g: Array) -> Array:
    """Times worth an exact value: where rough samples change sign, or where a parabola through three of them comes near zero."""
    k, middle = np.flatnonzero(_crossed(g)), _bottoms(t, g, NEAR)[1]
    low, high = np.concatenate((t[k], t[middle - 1])), np.concatenate((t[k + 1], t[middle + 1]))
    margin = MARGIN * (high - low)
    points = np.unique((low - margin)[:, None] + (high - low + 2.0 * margin)[:, None] * UNIT)
    inside = points[(points > t[0]) & (points < t[-1])]
    return inside if inside.size or not k.size else np.array([0.5 * (t[0] + t[-1])])


def _bottoms(t: Array, g: Array, near: float) -> tuple[Array, NDArray[np.intp]]:
    """Where |g| has a minimum near or below zero between values of one sign: by parabolas, their bottoms and middle samples."""
    t0, t1, t2, g0, g1, g2 = t[:-2], t[1:-1], t[2:], g[:-2], g[1:-1], g[2:]
    first = (g1 - g0) / (t1 - t0)
    bend = ((g2 - g1) / (t2 - t1) - first) / (t2 - t0)
    bottom = 0.5 * (t0 + t1) - 0.5 * first / np.where(bend == 0.0, np.inf, bend)
    depth = g0 + (bottom - t0) * (first + bend * (bottom - t1))
    sign = np.sign(g1)
    same = (sign * g0 >= 0.0) & (sign * g2 >= 0.0) & (sign * bend > 0.0) & (bottom > t0) & (bottom < t2)
    low = same & (sign * depth < near * np.maximum(np.maximum(np.abs(g0), np.abs(g1)), np.abs(g2)))
    middle = np.flatnonzero(low)
    return bottom[middle], middle + 1


def _more(t: Array, g: Array, points: Array, look: Look) -> tuple[Array, Array]:
    """The samples together with those at more points."""
    points = np.setdiff1d(points, t)
    if not points.size:
        return t, g
    t, g = np.concatenate((t, points)), np.concatenate((g, look(points)))
    order = np.argsort(t)
    return t[order], g[order]


def _refined(t: Array, g: Array, k: int, look: Look, resolution: float) -> float | None:
    """The crossing between samples k and k + 1; None where it is a jump. Guesses by interpolation come with a sample on either side, the
    farther off the more they fail, and soon with shares of the span."""
    sign, change, close = np.sign(g[k]), abs(g[k + 1] - g[k]), 0.4 * resolution
    apart = close
    for attempt in range(ROUNDS):
        low, high = t[k], t[k + 1]
        if g[k + 1] == 0.0 or high - low <= resolution:
            break
        if high - low < JUMP * resolution and abs(g[k + 1] - g[k]) > 0.5 * change:
            return None
        guess = _interpolated(t, g, k) + apart * np.array([-1.0, 0.0, 1.0])
        if attempt > 1:
            guess = np.concatenate((guess, low + (high - low) * SHARES))
        guess = guess[(guess > low) & (guess < high)]
        t, g = _more(t, g, guess if guess.size else np.array([0.5 * (low + high)]), look)
        k = int(np.searchsorted(t, low))
        k += int(np.argmax(sign * g[k + 1 :] <= 0.0))
        enclosed = t[k + 1] - t[k] <= 2.1 * apart
        apart = close if enclosed else min(100.0 * apart, 0.25 * (t[k + 1] - t[k]))
    return float(t[k] if abs(g[k]) < abs(g[k + 1]) else t[k + 1])


def _interpolated(t: Array, g: Array, k: int) -> float:
    """Where the inverse function through up to six samples is zero (Neville's scheme); by the secant where it is none."""
    some = slice(max(k - 2, 0), k + 4)
    x, y = t[some].copy(), g[some]
    if np.all(np.diff(y) > 0.0) or np.all(np.diff(y) < 0.0):
        for j in range(1, y.size):
            x = (y[j:] * x[:-1] - y[:-j] * x[1:]) / (y[j:] - y[:-j])
        if t[k] < x[0] < t[k + 1]:
            return float(x[0])
    return float(t[k] - g[k] * (t[k + 1] - t[k]) / (g[k + 1] - g[k]))
