"""Rolling without slip where it is holonomic: a disc on a straight line, in the plane."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd import validate
from mbd.affine import Scalar
from mbd.fields import Number, Place, Vector
from mbd.marker import Marker
from mbd.rows import Row, cross, shifted
from mbd.turn import Turning

from .gears import radius_faults
from .lines import fixed_axis, line_faults
from .measures import along
from .placed import Joint, Pose, as_marker, carried
from .turns import turn_scalar, turning, turning_faults

if TYPE_CHECKING:
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Rolling(Joint):
    """A disc rolls on a straight line of a body or the ground without slip, in the plane: its centre keeps the distance of its radius, on
    the side where it is at the start, and moves along by radius times its turn.

    a        the disc, at its centre
    b        of a body or the ground: the line goes through it
    axis     [2], the line's direction in the axes of b's body
    radius   [m]
    """

    a: Place
    b: Place
    axis: Vector = field(kw_only=True)
    radius: Number = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "rolling disc"

    def __post_init__(self) -> None:
        for name in ("axis", "radius"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))
        for side in ("a", "b"):
            object.__setattr__(self, side, as_marker(getattr(self, side)))

    def faults(self, dimension: int) -> list[str]:
        if dimension != 2:
            return ["scene: expected a planar one (rolling in space is not holonomic), found a spatial one; use a Rack on an axle"]
        return line_faults(self.b, self.axis, 2) + turning_faults(self.a, self.b, None, 2) + radius_faults(self.radius, signed=False)

    def misfits(self, pose: Pose) -> list[str]:
        if self._height(pose) == 0.0:
            return ["markers: expected the disc on one side of the line, found its centre on it; move it by its radius"]
        return []

    def _height(self, pose: Pose) -> float:
        """Of the centre above the line, to the left of its direction."""
        x, y = carried(self.axis / np.linalg.norm(self.axis), pose.axes[1])
        gap = pose.points[0] - pose.points[1]
        return float(x * gap[1] - y * gap[0])

    def scalars(self, site: Site) -> list[int]:
        return [turn_scalar(self.a, self.b, None, site)]

    def turns(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        return [turning(a, b, pose.axes, None, scalars[0])]

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        unit, radius = self.axis / np.linalg.norm(self.axis), float(self.radius) * np.sign(self._height(pose))
        start = float(carried(unit, pose.axes[1]) @ (pose.points[0] - pose.points[1]))
        above = cross(fixed_axis(b, unit), a.point - b.point)
        rolled = along(a, b, unit, Scalar.coordinate(scalars[0]).scaled(radius))
        return [("distance", shifted(above, -radius)), ("rolling", shifted(rolled, -start))]
