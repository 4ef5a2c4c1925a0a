"""Values of an explicit step next to a singular position of the joints, where accelerations are not known: by those on both sides of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .places import NearlySingular
from .system import Array
from .workspace import Memory

NEAREST = 2.0**-8
"""Distance in time at which values are first asked for, as a share of the step; it is doubled until they are known."""

Reached = Callable[[float], Memory]
"""The state at a time of the step, with its accelerations; raises NearlySingular."""


def value(reached: Reached, t: float, early: float, late: float) -> Array:
    """w [2, width] at a time within a step from ``early`` to ``late``. What moves is smooth: next to a singular position it is Hermite's polynomial
    of degree 5 between the nearest states that are known. Raises NearlySingular where those at the ends of the step are not."""
    try:
        return reached(t).w
    except NearlySingular:
        d = NEAREST * (late - early)
        return _hermite(t, _nearest(reached, t, -d, early), _nearest(reached, t, d, late))


def _nearest(reached: Reached, t: float, d: float, end: float) -> tuple[float, Memory]:
    """The first of the times t + d, t + 2 d, t + 4 d, ... with a known state, or the end that lies there."""
    while abs(d) < abs(end - t):
        try:
            return t + d, reached(t + d)
        except NearlySingular:
            d *= 2.0
    return end, reached(end)


def _hermite(t: float, *sides: tuple[float, Memory]) -> Array:
    from scipy.interpolate import BPoly

    (a, left), (b, right) = sides
    path = BPoly.from_derivatives((a, b), [np.vstack((each.w, each.acceleration)) for each in (left, right)])
    return np.stack((path(t), path.derivative()(t)))
