"""Singular positions that a run went through, as where all bars of a linkage lie in line.

There the joints hold less than elsewhere and the mechanism could go on in another way. Between two neighbouring states the determinant of
G(q1) W G(q2)', W a metric, stays positive unless such a position lies between: a regular motion that only comes near one does not
change it. So it also tells a run that has left its branch across a gap finer than its tolerance. It is asked of all steps: an explicit one
may leap across such a position without a stage near it.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .system import System
from .trajectory import Trajectory

MOST, AT_ONCE = 100, 64
"""Equations up to which it is asked, and steps that are compared at once."""

COARSE, FINE = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 33)
"""Fractions of a step at which it is looked at, and looked at again: bodies may turn far in a step, not between two of these."""

FAR = 0.5
"""Change of a slope within a step, as a share of the largest, above which its ends do not tell what lies between."""


class Passage(NamedTuple):
    """The time [s] and the items whose equations depend on each other there."""

    t: float
    items: list[str]


def passages(trajectory: Trajectory) -> list[Passage]:
    """Those of one part, in order of time."""
    system, linear, states = trajectory.part.system, trajectory.linear, trajectory.states
    if not 0 < system.m <= MOST or system.joints.linear or linear.softened:
        return []
    steps = list(zip(states, states[1:]))
    parts = [steps[k : k + AT_ONCE] for k in range(0, len(steps), AT_ONCE)]
    turned = [step for part in parts for step, turns in zip(part, _turns(system, linear, part)) if turns]
    found = (_passage(system, linear, *step) for step in turned)
    return [passage for passage in found if passage]


def _turns(system: System, linear: Any, steps: list[tuple[Any, Any]]) -> Array:
    """Whether the determinant is negative anywhere along each of these steps, one after the other."""
    from .solvers.start import hermite

    ends = _slopes(system, linear, [steps[0][0].q, *(after.q for _, after in steps)])
    turns = _flips(ends[:-1], ends[1:])
    far = np.flatnonzero(np.max(np.abs(np.diff(ends, axis=0)), axis=(1, 2)) > FAR * np.max(np.abs(ends)))
    if far.size:
        before, after = (_stacked([steps[k][side] for k in far]) for side in (0, 1))
        slopes = [_slopes(system, linear, q) for q in hermite(before, after, COARSE)[0]]
        turns[far] = np.any([_flips(*pair) for pair in zip(slopes, slopes[1:])], axis=0)
    return turns


def _stacked(states: list[Any]) -> Any:
    """As one, with arrays [k, 1] and [k, n]."""
    return SimpleNamespace(**{name: np.array([np.atleast_1d(getattr(state, name)) for state in states]) for name in ("t", "q", "v")})


def _flips(before: Array, after: Array) -> Array:
    return np.linalg.slogdet(before @ np.swapaxes(after, -1, -2))[0] < 0.0


def _slopes(system: System, linear: Any, q: Any) -> Array:
    """G [k, m, n] in scaled unknowns at q [k, n]; constant slopes come without the first axis."""
    from .solvers.start import scaled_gradient

    return np.broadcast_to(scaled_gradient(system, linear, np.asarray(q)), (len(q), system.m, system.n))


def _passage(system: System, linear: Any, before: Any, after: Any) -> Passage | None:
    """Where within a step, and which items; None where the step only turned far."""
    from .solvers.start import hermite

    slopes = _slopes(system, linear, hermite(before, after, FINE)[0])
    if not _flips(slopes[:-1], slopes[1:]).any():
        return None
    left, sizes, _ = np.linalg.svd(slopes, full_matrices=False)
    nearest = int(np.argmin(sizes[:, -1]))
    weights = np.abs(left[nearest, :, -1])
    rows = np.flatnonzero(weights > 0.2 * weights.max())
    items = list(dict.fromkeys(system.label(int(row)) for row in rows))
    return Passage(before.t + float(FINE[nearest]) * (after.t - before.t), [item for item in items if item not in system.internal] or items)
