"""Gears and racks: linear equations between turns, or a turn and a displacement, relative to a carrier that may move.

No geometry of teeth: shafts are held by other joints, and forces act along the coupled motions only.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mbd import validate
from mbd.affine import Scalar
from mbd.fields import Matrix, Number, Place, Vector
from mbd.marker import Marker
from mbd.rows import Row, shifted
from mbd.turn import Turning

from .lines import line_faults
from .measures import along
from .placed import Joint, Placed, Pose, as_marker, carried, with_ground
from .turns import across_cables, turn_scalar, turning, turning_faults

if TYPE_CHECKING:
    from mbd.scene import Site

CHOICES = ("ratio", "radii", "teeth")


class _Geared(Joint):
    """What wheels on a carrier share: bodies stand for their markers, no carrier is the ground."""

    wheels: tuple[str, ...] = ("a", "b")
    carrier: Any

    def _prepare(self, *arrays: str) -> None:
        for name in arrays:
            object.__setattr__(self, name, validate.floats(getattr(self, name)))
        for name in (*self.wheels, "carrier"):
            object.__setattr__(self, name, as_marker(getattr(self, name)))

    @property
    def markers(self) -> tuple[Marker, ...]:
        given = tuple(getattr(self, name) for name in self.wheels)
        return given if self.carrier is None else (*given, self.carrier)

    @property
    def sides(self) -> tuple[Marker, ...]:
        return self.markers if len(self.markers) > len(self.wheels) else with_ground(*self.markers)

    def place(self, site: Site) -> Placed:
        return Placed(self, site)

    def _carried(self) -> list[str]:
        *wheels, carrier = self.sides
        held = [m for m in wheels if m.item == carrier.item and m.rigid]
        return [f"marker: expected wheels that move relative to the carrier, found {m!r}, which is the carrier; choose another carrier" for m in held]


@dataclass(frozen=True, eq=False)
class Gear(_Geared):
    """Two wheels in mesh: the turns of a and b since the start, relative to a carrier, have a constant ratio. Exactly one of

    ratio   turn of a over turn of b; negative where they turn against each other
    radii   (of a, of b) [m]: outside meshing; a negative one is that of an internal ring
    teeth   (of a, of b): the same, in teeth

    carrier   what both shafts are mounted on; None: the ground
    axis      in space: [3], or [2, 3] for bevel gears: the axes of rotation of a and b, inertial components at the start
    """

    a: Place
    b: Place
    ratio: Number = field(default=None, kw_only=True)
    radii: Vector = field(default=None, kw_only=True)
    teeth: Vector = field(default=None, kw_only=True)
    carrier: Place = field(default=None, kw_only=True)
    axis: Vector | Matrix = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "gear"

    def __post_init__(self) -> None:
        self._prepare("ratio", "radii", "teeth", "axis")

    def _axes(self) -> list[Any]:
        """Of a and of b."""
        axis = self.axis
        return list(axis) if isinstance(axis, np.ndarray) and axis.ndim == 2 and len(axis) == 2 else [axis, axis]

    def faults(self, dimension: int) -> list[str]:
        a, b, carrier = self.sides
        given = [name for name in CHOICES if getattr(self, name) is not None]
        if len(given) != 1:
            return [f"expected exactly one of ratio=, radii= and teeth=, found {' and '.join(given) or 'none'}; give one"]
        value = getattr(self, given[0])
        expected, shape = ("a number", ()) if given[0] == "ratio" else ("two numbers", (2,))
        found = self._carried()
        if not isinstance(value, np.ndarray) or value.shape != shape or not np.isfinite(value).all() or not value.all():
            found.append(f"{given[0]}: expected {expected} other than 0, found {validate.show(value)}; correct it")
        for side, axis in zip((a, b), self._axes()):
            found += [line for line in turning_faults(side, carrier, axis, dimension) if line not in found]
        return found

    def misfits(self, pose: Pose) -> list[str]:
        a, b, carrier = self.sides
        pairs = (((side, carrier), Pose((own, pose.axes[2]), ()), axis) for side, own, axis in zip((a, b), pose.axes, self._axes()))
        return [line for markers, own_pose, axis in pairs for line in across_cables(markers, own_pose, axis)]

    def scalars(self, site: Site) -> list[int]:
        *wheels, carrier = self.sides
        return [turn_scalar(wheel, carrier, axis, site) for wheel, axis in zip(wheels, self._axes())]

    def turns(self, a: Marker, b: Marker, carrier: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        sides = zip((a, b), pose.axes, self._axes(), scalars)
        return [turning(wheel, carrier, (own, pose.axes[2]), axis, scalar) for wheel, own, axis, scalar in sides]

    def rows(self, a: Marker, b: Marker, carrier: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        """r_a phi_a + r_b phi_b = 0."""
        sizes = self.radii if self.radii is not None else self.teeth if self.teeth is not None else np.array([1.0, -float(self.ratio)])
        return [("mesh", Row(Scalar(np.array(scalars), sizes, 0.0)))]


@dataclass(frozen=True, eq=False)
class Rack(_Geared):
    """A pinion and a rack: the rack moves along a line by radius times the counter-clockwise turn of the pinion, both since the start and
    relative to a carrier.

    axis      [d], direction of the rack's motion in the axes of the carrier's body
    radius    [m], of the pinion; negative where a counter-clockwise turn moves the rack backwards
    carrier   what pinion and rack are mounted on; None: the ground
    shaft     in space: [3], axis of rotation of the pinion, inertial components at the start
    """

    pinion: Place
    rack: Place
    axis: Vector = field(kw_only=True)
    radius: Number = field(kw_only=True)
    carrier: Place = field(default=None, kw_only=True)
    shaft: Vector = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "rack"
    wheels = ("pinion", "rack")

    def __post_init__(self) -> None:
        self._prepare("axis", "radius", "shaft")

    def faults(self, dimension: int) -> list[str]:
        pinion, _, carrier = self.sides
        found = self._carried() + line_faults(carrier, self.axis, dimension) + radius_faults(self.radius, signed=True)
        return found + [line.replace("axis:", "shaft:") for line in turning_faults(pinion, carrier, self.shaft, dimension)]

    def scalars(self, site: Site) -> list[int]:
        pinion, _, carrier = self.sides
        return [turn_scalar(pinion, carrier, self.shaft, site)]

    def turns(self, pinion: Marker, rack: Marker, carrier: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        return [turning(pinion, carrier, (pose.axes[0], pose.axes[2]), self.shaft, scalars[0])]

    def rows(self, pinion: Marker, rack: Marker, carrier: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        """Displacement since the start - radius phi."""
        unit = self.axis / np.linalg.norm(self.axis)
        start = float(carried(unit, pose.axes[2]) @ (pose.points[1] - pose.points[2]))
        turn = Scalar.coordinate(scalars[0]).scaled(-float(self.radius))
        return [("mesh", shifted(along(rack, carrier, unit, turn), -start))]


def radius_faults(value: Any, *, signed: bool) -> list[str]:
    if not signed:
        return validate.number("radius", value, positive=True)
    return validate.number("radius", value) or ([] if float(value) else ["radius: expected a number other than 0, found 0; give it in metres"])
