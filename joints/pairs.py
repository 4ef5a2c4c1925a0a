"""Joints between two markers: each is a short list of quadratic rows over the markers' points and axes.

``rows(a, b, pose, scalars)`` is all that a joint says of itself; ``pose`` holds what the markers' axes were at the start. The same rows
give values, gradients and curvatures in the system, and the joint's reaction on its first marker.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd import validate
from mbd.fields import Number, Vector
from mbd.marker import Marker
from mbd.rows import Row, distance, dot, parallel

from .placed import Joint, Pose, direction, directions, fixed_in, normals, points
from .turns import across_cables

if TYPE_CHECKING:
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Pin(Joint):
    """The points coincide; in the plane both sides turn freely, in space about ``axis`` (revolute; [3], inertial components at the start)."""

    a: Marker
    b: Marker
    axis: Vector = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "pin"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))

    def faults(self, dimension: int) -> list[str]:
        if dimension == 2:
            return [] if self.axis is None else ["axis: expected none in a planar scene, found one; leave it out"]
        if self.axis is None:
            return ["axis: expected the axis of rotation of a spatial pin, found none; give axis=(x, y, z), or use a Ball"]
        found = direction("axis", self.axis, "give axis=(x, y, z)")
        found += [f"marker: expected one that carries axes, found {m!r}; use a Ball on a particle" for m in self.markers if not m.turns()]
        if not (self.a.rigid or self.b.rigid):
            found.append("marker: expected at least one on a body or the ground (two thin cables hold no common axis), found two cables; use a Ball")
        return found

    def misfits(self, pose: Pose) -> list[str]:
        return across_cables(self.markers, pose, self.axis)

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        if self.axis is None:
            return points(a, b)
        unit = self.axis / np.linalg.norm(self.axis)
        if not (a.rigid and b.rigid):
            body, axes, cable = (a, pose.axes[0], b) if a.rigid else (b, pose.axes[1], a)
            return [*points(a, b), ("axis", dot(fixed_in(body, axes, unit), cable.axes[0]))]
        axle = fixed_in(a, pose.axes[0], unit)
        return points(a, b) + [(f"axis {k + 1}", dot(axle, fixed_in(b, pose.axes[1], n))) for k, n in enumerate(normals(unit))]


@dataclass(frozen=True, eq=False)
class Ball(Joint):
    """The points coincide; all rotations are free."""

    a: Marker
    b: Marker
    name: str | None = field(default=None, kw_only=True)

    kind = "ball joint"

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return points(a, b)


@dataclass(frozen=True, eq=False)
class Distance(Joint):
    """The points keep their distance: a massless rigid rod. length [m]; None: the distance at the start."""

    a: Marker
    b: Marker
    length: Number = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "distance"

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", validate.floats(self.length))

    def faults(self, dimension: int) -> list[str]:
        return validate.number("length", self.length, positive=True) if self.length is not None else []

    def misfits(self, pose: Pose) -> list[str]:
        if pose.apart == 0.0:
            return ["markers: expected points apart (a rod between coinciding points has no direction), found distance 0; move one, or use a Ball"]
        return []

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return [("length", distance(a.point, b.point, pose.apart if self.length is None else float(self.length)))]


@dataclass(frozen=True, eq=False)
class Clamp(Joint):
    """The points coincide and the axes keep their relative direction.

    A cable is held by its tangent's direction, while the length of the slope, its axial stretch, stays free. In space a thin cable has
    no torsion: clamped to a body it holds the tangent (two rows), clamped to a cable its tangent must be parallel to the other's.
    """

    a: Marker
    b: Marker
    name: str | None = field(default=None, kw_only=True)

    kind = "clamp"

    def faults(self, dimension: int) -> list[str]:
        return [f"marker: expected one that carries an axis, found {m!r}; use a Pin or Ball on a particle" for m in self.markers if not m.turns()]

    def scalars(self, site: Site) -> list[int]:
        if self.a.dimension == 3 and not self.a.rigid and not self.b.rigid:
            return [site.scalar(*_stretch_ratio(self.a, self.b, site), "ratio of stretches")]
        return []

    def misfits(self, pose: Pose) -> list[str]:
        if len(pose.axes[0]) == 2 or self.a.rigid or self.b.rigid:
            return []
        a, b = (axes[:, 0] / np.linalg.norm(axes[:, 0]) for axes in (pose.axes[0], pose.axes[1]))
        sine = float(np.linalg.norm(np.cross(a, b)))
        if sine > 1e-6:
            angle = np.arcsin(min(sine, 1.0))
            return [f"tangents: expected parallel ones between two thin spatial cables, found an angle of {angle:.6g} rad; put a body between them"]
        return []

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        if scalars:
            return points(a, b) + [(f"tangent {axis}", row) for axis, row in zip("xyz", parallel(a.axes[0], b.axes[0], scalars[0]))]
        return points(a, b) + directions(a, b, pose)


def _stretch_ratio(a: Marker, b: Marker, site: Site) -> tuple[float, float]:
    q, _ = site.scene.layout.start()
    ta, tb = a.axes[0].value(q), b.axes[0].value(q)
    return float(ta @ tb / (tb @ tb)), 0.0
