"""A joint in a scene, the pose of its markers at the start, and the directions and rows that many joints are made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mbd import validate
from mbd.affine import Affine, Array
from mbd.marker import Marker, frame
from mbd.rows import Row, coincide, cross, dot
from mbd.slip import SlipRow
from mbd.turn import Turning

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


class Pose(NamedTuple):
    """Markers at the start: the axes of each as columns [d, n_axes], and their points [d] [m]."""

    axes: tuple[Array, ...]
    points: tuple[Array, ...]

    @property
    def apart(self) -> float:
        """The distance between the first two [m]."""
        return float(np.linalg.norm(self.points[0] - self.points[1]))


def pose_of(markers: Sequence[Marker], q: Array) -> Pose:
    d = markers[0].dimension
    axes = tuple(frame(marker, q) if marker.turns() else np.zeros((d, 0)) for marker in markers)
    return Pose(axes, tuple(marker.point.value(q) for marker in markers))


class Joint:
    """What descriptions say of themselves unless they know better: two markers, a and b, and no coordinates of their own.

    ``rows(*sides, pose, scalars)`` lists the quadratic equations, labelled, ``turns`` the turning angles among them.
    """

    a: Any
    b: Any

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    @property
    def sides(self) -> tuple[Marker, ...]:
        """The markers that ``rows`` and ``turns`` take: the same, or the ground's behind them."""
        return self.markers

    def faults(self, dimension: int) -> list[str]:
        """Complaints about the description alone."""
        return []

    def misfits(self, pose: Pose) -> list[str]:
        """Complaints about where the markers are."""
        return []

    def scalars(self, site: Site) -> list[int]:
        """New scalar coordinates."""
        return []

    def turns(self, *markers_pose_scalars: Any) -> list[Turning]:
        return []

    def slips(self, *markers_pose_scalars: Any) -> list[tuple[str, SlipRow]]:
        """Equations of velocities alone, labelled."""
        return []

    def place(self, site: Site) -> Placed:
        return PlacedJoint(self, site)


class Placed:
    """What constrains markers, in a scene: its quadratic rows and turning angles, over its markers and coordinates of its own."""

    def __init__(self, description: Any, site: Site):
        self.description, self.name, self.site = description, site.name, site
        self.markers: tuple[Marker, ...] = description.sides
        self.scalars: list[int] = description.scalars(site)

    def pose(self, q0: Array) -> Pose:
        """The markers at the start coordinates q0 [n]."""
        return pose_of(self.markers, q0)

    def rows(self, markers: Sequence[Marker], pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return self.description.rows(*markers, pose, scalars)

    def turns(self, markers: Sequence[Marker], pose: Pose, scalars: list[int]) -> list[Turning]:
        return self.description.turns(*markers, pose, scalars)

    def slips(self, markers: Sequence[Marker], pose: Pose, scalars: list[int]) -> list[tuple[str, SlipRow]]:
        return self.description.slips(*markers, pose, scalars)

    def assemble(self, model: Model) -> None:
        pose = self.pose(model.q0)
        complaints = self.description.misfits(pose)
        for complaint in complaints:
            model.complain(self, complaint)
        if not complaints:
            self.equations(model, pose)
            for label, slip in self.slips(self.markers, pose, self.scalars):
                model.slip(self.name, label, slip)
            for turn in self.turns(self.markers, pose, self.scalars):
                model.turning(self.name, turn)

    def equations(self, model: Model, pose: Pose) -> None:
        for label, row in self.rows(self.markers, pose, self.scalars):
            model.equation(self.name, label, row)


class PlacedJoint(Placed):
    """A joint in a scene; ``pivot = scene.add(mbd.Pin(...))``, then ``result.reaction(pivot)``."""


def fixed_in(marker: Marker, axes: Array, direction: Array) -> Affine:
    """The direction [3] at the start as an axis that turns with a rigid spatial marker."""
    parts = [axis.scaled(float(c)) for axis, c in zip(marker.axes, axes.T @ direction)]
    return parts[0] + parts[1] + parts[2]


def carried(direction: Array, axes: Array) -> Array:
    """A direction [d] in the axes of a rigid marker, in inertial ones; axes as columns [d, n_axes]."""
    if direction.size == 3:
        return axes @ direction
    turned = complex(*direction) * complex(*axes[:, 0])
    return np.array([turned.real, turned.imag])


def normals(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to an axis [3] and to each other."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    return first, second / np.linalg.norm(second)


def points(a: Marker, b: Marker) -> list[tuple[str, Row]]:
    return [(f"position {axis}", row) for axis, row in zip("xyz", coincide(a.point, b.point))]


def mate(axes_a: Array, axes_b: Array) -> complex:
    """What turns the second planar marker's axis into the direction of the first one's at the start, of length 1."""
    turn = complex(*axes_a[:, 0]) / complex(*axes_b[:, 0])
    return turn / abs(turn)


def directions(a: Marker, b: Marker, pose: Pose) -> list[tuple[str, Row]]:
    """Axes keep their relative direction, one of the markers at least being rigid in space; of a cable the tangent is held."""
    if a.dimension == 2:
        return [("direction", cross(a.axes[0], b.axes[0].scaled(mate(pose.axes[0], pose.axes[1]))))]
    if a.rigid and b.rigid:
        mates = [fixed_in(b, pose.axes[1], axis) for axis in pose.axes[0].T]
        return [(f"axis {k + 1}", dot(a.axes[k], mates[(k + 1) % 3])) for k in range(3)]
    body, axes, cable, tangent = (a, pose.axes[0], b, pose.axes[1]) if a.rigid else (b, pose.axes[1], a, pose.axes[0])
    across = normals(tangent[:, 0] / np.linalg.norm(tangent[:, 0]))
    return [(f"tangent {k + 1}", dot(fixed_in(body, axes, n), cable.axes[0])) for k, n in enumerate(across)]


def as_marker(side: Any) -> Any:
    """A body or the ground stands for its marker; anything else is left for the scene to judge."""
    at: Callable[[], Marker] | None = getattr(side, "at", None)
    try:
        return side if at is None or isinstance(side, Marker) else at()
    except TypeError:  # of a cable: at(s) needs to be told where
        return side


def direction(name: str, value: Any, advice: str) -> list[str]:
    """Complaints about a direction in space."""
    if value is None:
        return [f"{name}: expected a direction in space, found none; {advice}"]
    found = validate.vector(name, value, 3)
    return [f"{name}: expected a direction, found a zero vector; {advice}"] if not found and not np.linalg.norm(value) else found


def with_ground(*markers: Any) -> tuple[Any, ...]:
    """The markers and, behind them, that of the ground of their scene."""
    if not isinstance(markers[0], Marker):
        return markers
    scene: Any = markers[0].scene
    return (*markers, scene.ground.at())
