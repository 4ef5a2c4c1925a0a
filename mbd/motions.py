"""Motions in words: which items move, and how."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .dependence import ZERO, Spaces, minimal_sets
from .marker import Marker
from .parts import Part

if TYPE_CHECKING:
    from .scene import Scene

LISTED = 12
"""More independent motions than these are counted, not described."""


def motions(scene: Scene, part: Part, found: Spaces, q: Array) -> list[str]:
    """A line for each smallest set of items that may move by themselves; q [n] of the whole scene."""
    system = part.system
    owners = [name for name, _ in system.owners[: system.n_table]]
    names = list(dict.fromkeys(owners))
    groups = [np.array([k for k, name in enumerate(owners) if name == each]) for each in names]
    lines, known = [], np.zeros((system.n, 0))
    for members, vectors in minimal_sets(found.right, groups):
        fresh = vectors - known @ (known.T @ vectors)  # what the sets before have not said yet
        left, sizes, _ = np.linalg.svd(fresh, full_matrices=False)
        for vector in left[:, sizes > 1e-3].T:
            moving = [i for i in members if np.max(np.abs(vector[groups[i]])) > ZERO]
            v = part.widened(vector * found.units, len(q))
            lines.append(", ".join(describe(scene, names[i], q, v) for i in moving))
        known = np.hstack((known, left[:, sizes > 1e-3]))
    return lines


def describe(scene: Scene, name: str, q: Array, v: Array) -> str:
    """How one item moves: turns about a point or an axis, slides along a direction, or, without a frame, just moves."""
    marker = _marker(scene[name])
    if marker is None:
        return f"{name!r} moves or bends"
    place, velocity = marker.point.value(q), marker.point.rate(v)
    spin = _spin(marker, q, v)
    if spin is None or np.linalg.norm(spin) * scene.build().length <= 1e-6 * np.linalg.norm(velocity):
        return f"{name!r} slides along {_numbers(_unit(velocity))}"
    if len(place) == 2:
        return f"{name!r} turns about {_numbers(place + np.array([-velocity[1], velocity[0]]) / spin[0])}"
    size = float(spin @ spin)
    through = place + np.cross(spin, velocity) / size
    pitch = abs(float(spin @ velocity)) / np.sqrt(size)
    how = "turns" if pitch <= 1e-6 * (np.linalg.norm(velocity) + np.sqrt(size) * scene.build().length) else "turns and slides"
    return f"{name!r} {how} about the axis {_numbers(_unit(spin))} through {_numbers(through)}"


def _marker(item: Any) -> Marker | None:
    try:
        found = item.at()
    except (AttributeError, TypeError):  # a cable's at(s) wants to be told where: it has no one frame
        return None
    return found if isinstance(found, Marker) and found.rigid else None


def _spin(marker: Marker, q: Array, v: Array) -> Array | None:
    """The angular velocity [1] or [3] of a marker that carries axes."""
    if not marker.axes:
        return None
    e, rate = (np.array([getattr(axis, what)(x) for axis in marker.axes]) for what, x in (("value", q), ("rate", v)))
    if marker.dimension == 2:
        return np.array([e[0, 0] * rate[0, 1] - e[0, 1] * rate[0, 0]])
    return 0.5 * np.sum(np.cross(e, rate), axis=0)


def _unit(direction: Array) -> Array:
    unit = direction / max(float(np.linalg.norm(direction)), 1e-300)
    return unit * np.sign(unit[np.argmax(np.abs(unit) > 1e-9)] or 1.0)


def _numbers(x: Array) -> str:
    rounded = np.where(np.abs(x) < 1e-9 * max(1.0, float(np.max(np.abs(x)))), 0.0, x)
    return "(" + ", ".join(f"{number:.4g}" for number in rounded) + ")"
