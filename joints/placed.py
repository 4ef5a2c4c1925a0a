"""A joint in a scene, the pose of its markers at the start, and the directions and rows that many joints are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mbd.affine import Affine, Array
from mbd.marker import Marker, frame
from mbd.rows import Row, coincide, cross, dot

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


class Pose(NamedTuple):
    """Two markers at the start: their axes as columns [d, n_axes], and the distance between them [m]."""

    axes_a: Array
    axes_b: Array
    apart: float


def pose_of(a: Marker, b: Marker, q: Array) -> Pose:
    d = a.dimension
    axes = [frame(marker, q) if marker.turns() else np.zeros((d, 0)) for marker in (a, b)]
    return Pose(axes[0], axes[1], float(np.linalg.norm((a.point - b.point).value(q))))


class PlacedJoint:
    """A joint in a scene; ``pivot = scene.add(mbd.Pin(...))``, then ``result.reaction(pivot)``."""

    def __init__(self, description: Any, site: Site, scalars: list[int]):
        self.description, self.name, self.site, self.scalars = description, site.name, site, scalars

    def pose(self, q0: Array) -> Pose:
        """The markers at the start coordinates q0 [n]."""
        return pose_of(self.description.a, self.description.b, q0)

    def turns(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[Affine, Affine, int]]:
        """Turning angles among its equations: none."""
        return []

    def assemble(self, model: Model) -> None:
        joint, pose = self.description, self.pose(model.q0)
        for complaint in joint.misfits(pose):
            model.complain(self, complaint)
            return
        for label, row in joint.rows(joint.a, joint.b, pose, self.scalars):
            model.equation(self.name, label, row)


def fixed_in(marker: Marker, axes: Array, direction: Array) -> Affine:
    """The direction [3] at the start as an axis that turns with a rigid spatial marker."""
    parts = [axis.scaled(float(c)) for axis, c in zip(marker.axes, axes.T @ direction)]
    return parts[0] + parts[1] + parts[2]


def normals(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to an axis [3] and to each other."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    return first, second / np.linalg.norm(second)


def points(a: Marker, b: Marker) -> list[tuple[str, Row]]:
    return [(f"position {axis}", row) for axis, row in zip("xyz", coincide(a.point, b.point))]


def mate(pose: Pose) -> complex:
    """What turns the second planar marker's axis into the direction of the first one's at the start, of length 1."""
    turn = complex(*pose.axes_a[:, 0]) / complex(*pose.axes_b[:, 0])
    return turn / abs(turn)


def directions(a: Marker, b: Marker, pose: Pose) -> list[tuple[str, Row]]:
    """Axes keep their relative direction, one of the markers at least being rigid in space; of a cable the tangent is held."""
    if a.dimension == 2:
        return [("direction", cross(a.axes[0], b.axes[0].scaled(mate(pose))))]
    if a.rigid and b.rigid:
        mates = [fixed_in(b, pose.axes_b, axis) for axis in pose.axes_a.T]
        return [(f"axis {k + 1}", dot(a.axes[k], mates[(k + 1) % 3])) for k in range(3)]
    body, axes, cable, tangent = (a, pose.axes_a, b, pose.axes_b) if a.rigid else (b, pose.axes_b, a, pose.axes_a)
    across = normals(tangent[:, 0] / np.linalg.norm(tangent[:, 0]))
    return [(f"tangent {k + 1}", dot(fixed_in(body, axes, n), cable.axes[0])) for k, n in enumerate(across)]
