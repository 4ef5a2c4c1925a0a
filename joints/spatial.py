"""Joints of space between two axes or planes of bodies: universal, cylindrical, planar. In a plane they are refused, by their planar names."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbd import validate
from mbd.affine import Array
from mbd.fields import Matrix, Vector
from mbd.marker import Marker
from mbd.rows import Row, dot

from .lines import fixed_axis, on_line
from .placed import Joint, Pose, direction, fixed_in, normals, points

IN_BODY = "give axis=(x, y, z) in the axes of the second marker's body"


@dataclass(frozen=True, eq=False)
class Universal(Joint):
    """Cardan's joint: the points coincide, and an axis of the first body stays perpendicular to one of the second.

    axes   two directions [2, 3], inertial components at the start, perpendicular to each other: the first is carried by a, the second by b
    """

    a: Marker
    b: Marker
    axes: Matrix = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "universal joint"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", validate.floats(self.axes))

    def faults(self, dimension: int) -> list[str]:
        found = _spatial(self, dimension, "a Pin")
        if found:
            return found
        if not isinstance(self.axes, np.ndarray) or self.axes.shape != (2, 3) or not np.isfinite(self.axes).all():
            return [f"axes: expected two directions of 3 numbers, found {validate.show(self.axes)}; give axes=(of a, of b)"]
        sizes = np.linalg.norm(self.axes, axis=1)
        if not sizes.all() or abs(self.axes[0] @ self.axes[1]) > 1e-6 * sizes[0] * sizes[1]:
            return [f"axes: expected two perpendicular directions, found {validate.show(self.axes)}; turn one of them"]
        return []

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        first, second = self.axes / np.linalg.norm(self.axes, axis=1)[:, None]
        return [*points(a, b), ("axes", dot(fixed_in(a, pose.axes[0], first), fixed_in(b, pose.axes[1], second)))]


@dataclass(frozen=True, eq=False)
class Cylindrical(Joint):
    """A body slides along a straight line of another and turns about it.

    axis   [3], of the line through b, in the axes of b's body; it keeps its direction in a's body too
    """

    a: Marker
    b: Marker
    axis: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "cylindrical joint"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))

    def faults(self, dimension: int) -> list[str]:
        return _spatial(self, dimension, "a Slider or a PointOnLine") or direction("axis", self.axis, IN_BODY)

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return on_line(a, b, self.axis) + _parallel(a, b, pose, self.axis)


@dataclass(frozen=True, eq=False)
class Planar(Joint):
    """A body glides on a plane of another: its point stays in the plane through b, and it turns about the normal only.

    normal   [3], of the plane, in the axes of b's body; it keeps its direction in a's body too
    """

    a: Marker
    b: Marker
    normal: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "planar joint"

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", validate.floats(self.normal))

    def faults(self, dimension: int) -> list[str]:
        if dimension == 2:
            return ["scene: expected a spatial one (in a planar one everything moves so), found a planar one; leave the joint out"]
        return _spatial(self, dimension, "") or direction("normal", self.normal, IN_BODY.replace("axis", "normal"))

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        height = dot(fixed_axis(b, self.normal / np.linalg.norm(self.normal)), a.point - b.point)
        return [("distance", height), *_parallel(a, b, pose, self.normal)]


def _spatial(joint: Any, dimension: int, instead: str) -> list[str]:
    if dimension == 2:
        return [f"scene: expected a spatial one, found a planar one; use {instead}"]
    expected = "marker: expected a body or the ground (a thin cable has no torsion, a particle no axes)"
    return [f"{expected}, found {m!r}; put a body between them" for m in joint.markers if not (m.rigid and m.turns())]


def _parallel(a: Marker, b: Marker, pose: Pose, axis: Array) -> list[tuple[str, Row]]:
    """The axis, in the axes of b's body, stays parallel to what lies along it in a's body at the start: two rows."""
    now = pose.axes[1] @ (axis / np.linalg.norm(axis))
    axle = fixed_in(a, pose.axes[0], now)
    return [(f"axis {k + 1}", dot(axle, fixed_in(b, pose.axes[1], n))) for k, n in enumerate(normals(now))]
