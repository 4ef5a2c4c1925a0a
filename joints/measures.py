"""Measures: how far one marker has turned, moved or is apart from another, as a coordinate s that others may couple, drive or load.

    scene.add(mbd.Angle(wheel.at(), frame.at()))     an item with ``coordinate``: s is result.q[:, item.coordinate], ds/dt that of result.v

Every measure is a coordinate without mass and one equation; what acts on s acts on the bodies through the multiplier of that equation,
and ``result.reaction(measure)`` is the force and moment of all that, on the measure's first marker.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd import validate
from mbd.affine import Array, Scalar
from mbd.fields import Place, Vector
from mbd.marker import Marker
from mbd.rows import Row, dot
from mbd.turn import Turning

from .lines import fixed_axis, line_faults
from .placed import Joint, Placed, Pose, as_marker
from .turns import across_cables, turn_scalar, turning, turning_faults

if TYPE_CHECKING:
    from mbd.scene import Site


class PlacedMeasure(Placed):
    """A measure in a scene."""

    @property
    def coordinate(self) -> int:
        """Its index in q and v, counted from their end."""
        return self.scalars[0]


class Measure(Joint):
    """What measures share."""

    unit: str

    def place(self, site: Site) -> PlacedMeasure:
        return PlacedMeasure(self, site)


@dataclass(frozen=True, eq=False)
class Angle(Measure):
    """The counter-clockwise turn of a relative to b since the start [rad], turns counted; between bodies, cables or the ground.

    axis   in space: [3], inertial components at the start, of the axis of rotation, which joints between a and b hold
    """

    a: Place
    b: Place
    axis: Vector = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "angle", "rad"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))
        for side in ("a", "b"):
            object.__setattr__(self, side, as_marker(getattr(self, side)))

    def faults(self, dimension: int) -> list[str]:
        return turning_faults(self.a, self.b, self.axis, dimension)

    def misfits(self, pose: Pose) -> list[str]:
        return across_cables(self.markers, pose, self.axis)

    def scalars(self, site: Site) -> list[int]:
        return [turn_scalar(self.a, self.b, self.axis, site)]

    def turns(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        return [turning(a, b, pose.axes, self.axis, scalars[0])]

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return []


@dataclass(frozen=True, eq=False)
class Displacement(Measure):
    """How far the point of a lies from that of b along a line of b's body [m].

    axis   [d], the line's direction in the axes of b's body
    """

    a: Place
    b: Place
    axis: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "displacement", "m"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))
        for side in ("a", "b"):
            object.__setattr__(self, side, as_marker(getattr(self, side)))

    def faults(self, dimension: int) -> list[str]:
        return line_faults(self.b, self.axis, dimension)

    def scalars(self, site: Site) -> list[int]:
        q, v = site.scene.layout.start()
        apart, line = self.a.point - self.b.point, fixed_axis(self.b, self.axis / np.linalg.norm(self.axis))
        value = float(apart.value(q) @ line.value(q))
        return [site.scalar(value, float(apart.rate(v) @ line.value(q) + apart.value(q) @ line.rate(v)), "displacement", True)]

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return [("displacement", along(a, b, self.axis, Scalar.coordinate(scalars[0]).scaled(-1.0)))]


@dataclass(frozen=True, eq=False)
class Length(Measure):
    """The distance between the points of a and b [m]."""

    a: Place
    b: Place
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "length", "m"

    def __post_init__(self) -> None:
        for side in ("a", "b"):
            object.__setattr__(self, side, as_marker(getattr(self, side)))

    def misfits(self, pose: Pose) -> list[str]:
        if pose.apart == 0.0:
            return ["markers: expected points apart (a distance of zero has no direction), found them at one point; move one"]
        return []

    def scalars(self, site: Site) -> list[int]:
        q, v = site.scene.layout.start()
        apart = self.a.point - self.b.point
        value = float(np.linalg.norm(apart.value(q)))
        return [site.scalar(value, float(apart.value(q) @ apart.rate(v)) / value if value else 0.0, "length", True)]

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        """(|p|^2 - s^2) / (2 length at the start)."""
        s, gap = Scalar.coordinate(scalars[0]), a.point - b.point
        squares = dot(gap, gap, factor=0.5 / pose.apart)
        return [("length", Row(squares.linear, [*squares.products, (s.scaled(-0.5 / pose.apart), s)]))]


def along(a: Marker, b: Marker, axis: Array, others: Scalar) -> Row:
    """The displacement of a from b along an axis in b's body, plus other scalars."""
    row = dot(fixed_axis(b, axis / np.linalg.norm(axis)), a.point - b.point)
    return Row(others, row.products)
