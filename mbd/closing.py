"""Positions on the joints, from wherever a scene is described: at once where Newton's method can, in steps where it cannot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .errors import SceneError
from .system import System

if TYPE_CHECKING:
    from .solvers.linear import Linear

SHORTEST = 1e-3
"""The share of all gaps at which closing them bit by bit gives up."""

MOST_PARTS = 10000
"""Half radians, or half lengths of the scene, between a start and where its drives ask it to be: beyond is a mistake."""


def closed(system: System, linear: Linear, q: Array, target: Array) -> Array:
    """q projected to the joints and, in parts of half a radian at most, to the targets of drives: a turn far away would end on the
    wrong side of its axis, where its equation holds too."""
    from .solvers.formats import Singular
    from .solvers.start import Inconsistent, project_positions

    gap = system.joints.at(q).value - target
    asked = np.where(driven_rows(system), gap, 0.0)
    parts = np.ceil(np.max(np.abs(asked) * linear.reach, initial=0.0) / (0.5 * system.length))
    if not parts < MOST_PARTS:
        raise SceneError([conflict(system, [int(np.argmax(np.abs(asked) * linear.reach))], f"a drive that starts at {np.max(np.abs(asked)):.6g}")])
    try:
        near = q
        for left in np.arange(parts - 1, 0, -1):
            near = project_positions(system, linear, near, target + left / parts * asked)
        return project_positions(system, linear, near, target)
    except (Inconsistent, Singular):
        return _closed_gradually(system, q, target)


def _closed_gradually(system: System, q: Array, target: Array) -> Array:
    """q where Newton's method failed at once: all gaps are closed bit by bit, from where the items are and, since these may lie in line
    so that no joint knows which way to go, from a little beside. Raises Inconsistent with the smallest gap that was reached."""
    from .solvers.linear import Linear
    from .solvers.start import Defect, Inconsistent

    linear = Linear(system, q)
    linear.soften()  # positions on the way may be singular; those at their end need not be
    beside = 0.01 * system.length * np.random.default_rng(1).standard_normal(system.n) / np.where(system.levers > 0.0, system.levers, np.inf)
    found = []
    for start in (q, q + beside):
        closed, left, rows = _deformed(system, linear, start, target)
        if not left:
            return closed
        found.append((left, rows))
    left, rows = min(found)
    raise Inconsistent(Defect(f"positions cannot satisfy them together (a distance of {left:.6g} remains)", rows, []))


def _deformed(system: System, linear: Linear, q: Array, target: Array) -> tuple[Array, float, list[int]]:
    """q as near to the target as gaps could be closed, all in proportion, by steps that are halved where they fail and doubled where they
    do not; the largest gap left, as a length, and the equations to blame for it."""
    from .solvers.formats import Singular
    from .solvers.start import Inconsistent, project_positions

    own = np.array([item in system.internal for item, _ in system.joints.labels])  # bodies hold themselves together all the way
    gap = np.where(own, 0.0, system.joints.at(q).value - target)
    apart, left, step = np.abs(gap) * distances(system, linear, q), 1.0, 0.25
    blamed = set(np.flatnonzero(apart > 0.1 * np.max(apart, initial=0.0)).tolist())
    stuck: list[int] = []
    while left > 0.0 and step > SHORTEST:
        try:
            q = project_positions(system, linear, q, target + max(left - step, 0.0) * gap)
            left, step = max(left - step, 0.0), 2.0 * step
        except Singular:
            step *= 0.5
        except Inconsistent as failure:
            step, stuck = 0.5 * step, failure.defect.rows
    return q, left * float(np.max(apart, initial=0.0)), sorted(blamed | set(stuck))


def distances(system: System, linear: Linear, q: Array) -> Array:
    """[m]: what turns a residual into the distance that an item would have to move, where the equation is about places; else ``reach``,
    which counts on turning it about the most effective arm."""
    joints, d = system.joints, system.dimension
    places = (system.levers[joints.cols] == 1.0) & (joints.cols < system.n_table)
    squares = joints.at(q).gradient[places] ** 2
    keys, slot = np.unique(joints.rows[places] * system.n + joints.cols[places] // d, return_inverse=True)
    effect = np.zeros(system.m)
    np.maximum.at(effect, keys // system.n, np.sqrt(np.bincount(slot, squares, minlength=keys.size)))
    return np.where(effect > 1e-6, 1.0 / np.maximum(effect, 1e-6), linear.reach)


def driven_rows(system: System) -> NDArray[np.bool_]:
    """[m]: which equations follow targets."""
    driven = np.zeros(system.m, dtype=bool)
    for rows, _ in system.joints.drives:
        driven[rows] = True
    return driven


def conflict(system: System, rows: list[int], what: str) -> str:
    labels = [system.label(row) for row in rows]
    names = quoted([label for label in labels if label not in system.internal] or labels)
    return f"joints {names}: expected equations that can hold together, found {what}; correct positions or lengths"


def quoted(names: list[str]) -> str:
    return ", ".join(repr(name) for name in dict.fromkeys(names))
