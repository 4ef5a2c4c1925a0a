"""What runs are compared with: closed forms and integrations that know nothing of the library."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

GRAVITY = 9.81


def swing(start: float, frequency: float, t: float) -> float:
    """The angle from hanging [rad] of x'' = -frequency^2 sin x at t, released at rest at the angle ``start``: elliptic functions."""
    k = np.sin(0.5 * start)
    quarter = ellipk(k * k)
    sn = ellipj(quarter - np.remainder(frequency * t, 4.0 * quarter), k * k)[0]
    return float(2.0 * np.arcsin(k * sn))


def period(start: float, frequency: float) -> float:
    """Of ``swing`` [s]."""
    return float(4.0 * ellipk(np.sin(0.5 * start) ** 2) / frequency)


def flat(t: float, length: float = 1.2, gravity: float = GRAVITY) -> np.ndarray:
    """The end [2] of a uniform rigid rod, pinned at the origin, released horizontally at rest."""
    angle = swing(0.5 * np.pi, np.sqrt(1.5 * gravity / length), t)
    return length * np.array([np.sin(angle), -np.cos(angle)])


def damped(ratio: float, frequency: float, t: float) -> float:
    """x(t) of x'' + 2 ratio frequency x' + frequency^2 x = 0 from x = 1 at rest, for all ratios without cancellation."""
    wt = frequency * t
    if ratio < 1.0:
        w = np.sqrt((1.0 - ratio) * (1.0 + ratio))
        return float(np.exp(-ratio * wt) * (np.cos(w * wt) + ratio / w * np.sin(w * wt)))
    root = np.sqrt((ratio - 1.0) * (ratio + 1.0))
    if root == 0.0:
        return float((1.0 + wt) * np.exp(-wt))
    slow, fast = 1.0 / (ratio + root), ratio + root
    return float((fast * np.exp(-slow * wt) - slow * np.exp(-fast * wt)) / (fast - slow))


def integrated(rate: Callable[[float, np.ndarray], np.ndarray], start: np.ndarray, t: float, method: str = "DOP853") -> np.ndarray:
    """y(t) of y' = rate(t, y), by SciPy at its tightest."""
    found = solve_ivp(rate, (0.0, t), np.asarray(start, dtype=float), method=method, rtol=3e-13, atol=1e-13)
    if not found.success:
        raise ArithmeticError(f"no reference: {found.message}")
    return found.y[:, -1]


def double_pendulum(ratio: float, start: float, t: float) -> np.ndarray:
    """The outer particle [2] of two on massless rods of 1 m, the outer ``ratio`` times as heavy, in line at rest, ``start`` from hanging."""
    if ratio > 1e5:  # rods in line: what the inner mass adds is of the order of 1 / ratio
        angle = swing(start, np.sqrt(0.5 * GRAVITY), t)
        return 2.0 * np.array([np.sin(angle), -np.cos(angle)])
    share = ratio / (1.0 + ratio)

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        a, b, wa, wb = y
        s, c = np.sin(a - b), np.cos(a - b)
        top, low = -share * wb * wb * s - GRAVITY * np.sin(a), wa * wa * s - GRAVITY * np.sin(b)
        turn = (top - share * c * low) / ((1.0 - share) + share * s * s)
        return np.array([wa, wb, turn, low - c * turn])

    a, b = integrated(rate, np.array([start, start, 0.0, 0.0]), t)[:2]
    return np.array([np.sin(a) + np.sin(b), -np.cos(a) - np.cos(b)])
