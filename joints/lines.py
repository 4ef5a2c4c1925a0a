"""Joints that leave a point free along a straight line of a body: with rotations free (PointOnLine) or held (Slider)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbd import validate
from mbd.affine import Affine, Array
from mbd.fields import Vector
from mbd.marker import Marker
from mbd.rows import Row, cross, dot

from .placed import Joint, Pose, directions, normals


@dataclass(frozen=True, eq=False)
class PointOnLine(Joint):
    """A point stays on a straight line of a body or the ground; all rotations are free.

    point            any marker
    marker_on_line   of a body or the ground: the line goes through it
    axis             [d], the line's direction in the axes of that body
    """

    point: Marker
    marker_on_line: Marker
    axis: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "point on line"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.point, self.marker_on_line)

    def faults(self, dimension: int) -> list[str]:
        return line_faults(self.marker_on_line, self.axis, dimension)

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return on_line(a, b, self.axis)


@dataclass(frozen=True, eq=False)
class Slider(Joint):
    """Prismatic: the first marker's point stays on a straight line of the second one's body, without relative rotation.

    a      of a body or the ground, or of a cable, whose tangent is held (in space a thin cable has no torsion: two rows)
    b      of a body or the ground: the line goes through it
    axis   [d], the line's direction in the axes of b's body
    """

    a: Marker
    b: Marker
    axis: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "slider"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))

    def faults(self, dimension: int) -> list[str]:
        found = line_faults(self.b, self.axis, dimension)
        if not self.a.turns():
            found.append(f"marker: expected one that carries an axis, found {self.a!r}; use a PointOnLine on a particle")
        return found

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return on_line(a, b, self.axis) + directions(a, b, pose)


def line_faults(line: Marker, axis: Any, dimension: int) -> list[str]:
    found = validate.vector("axis", axis, dimension)
    if not found and not np.linalg.norm(axis):
        found = ["axis: expected a direction, found a zero vector; give one in the axes of the second marker's body"]
    if not (line.rigid and line.turns()):
        found.append(f"marker: expected the line on a body or the ground, found {line!r}; exchange the markers")
    return found


def fixed_axis(marker: Marker, direction: Array) -> Affine:
    """A direction [d] in the axes of a marker's body, as an axis that turns with it."""
    if marker.dimension == 2:
        return marker.axes[0].scaled(complex(*direction))
    parts = [axis.scaled(float(c)) for axis, c in zip(marker.axes, direction)]
    return parts[0] + parts[1] + parts[2]


def on_line(a: Marker, b: Marker, axis: Array) -> list[tuple[str, Row]]:
    """The point of a has no distance [m] from the line through b: one row in the plane, two in space."""
    unit, apart = axis / np.linalg.norm(axis), a.point - b.point
    if a.dimension == 2:
        return [("distance", cross(fixed_axis(b, unit), apart))]
    return [(f"distance {k + 1}", dot(fixed_axis(b, n), apart)) for k, n in enumerate(normals(unit))]
