"""A knife edge or skate, and a wheel that rolls, on the plane: nonholonomic."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mbd import validate
from mbd.affine import Affine, Scalar
from mbd.fields import Number, Place, Vector
from mbd.marker import Marker
from mbd.rows import Row
from mbd.slip import SlipRow

from .gears import radius_faults
from .lines import fixed_axis, line_faults
from .measures import Measure
from .placed import Joint, Pose, as_marker

if TYPE_CHECKING:
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class KnifeEdge(Joint):
    """The point of a body moves along an axis of the body only, never across it: a skate, a blade (planar).

    a      of a body: the point of contact
    axis   [2], the direction of the edge in the axes of the body

    For ``Radau`` and ``DormandPrince``. The force that it exerts does no work.
    """

    a: Place
    axis: Vector = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "knife edge"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))
        object.__setattr__(self, "a", as_marker(self.a))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a,)

    def faults(self, dimension: int) -> list[str]:
        if dimension != 2:
            return ["scene: expected a planar one, found a spatial one; knife edges in space are not built yet"]
        return line_faults(self.a, self.axis, 2)

    def rows(self, a: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return []

    def slips(self, a: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, SlipRow]]:  # type: ignore[override]
        return [("slip", moving(a, _along(a, self.axis).scaled(1j)))]


@dataclass(frozen=True, eq=False)
class Wheel(Measure):
    """A wheel under a vehicle that is seen from above: the point of a body moves along an axis of the body by radius times the wheel's
    turn, and never across.

    a        of a body: the point of contact, below the axle
    axis     [2], the direction of rolling in the axes of the body
    radius   [m]

    Its turn since the start [rad] is a measure, for an ``Actuator(force=)`` (the engine's torque), ``Friction`` (the brake) or
    ``ForceLaw``; a ``Coupling`` to the ``Angle`` of a body gives it inertia. For ``Radau`` and ``DormandPrince``.
    """

    a: Place
    axis: Vector = field(kw_only=True)
    radius: Number = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "wheel", "rad"

    def __post_init__(self) -> None:
        for name in ("axis", "radius"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))
        object.__setattr__(self, "a", as_marker(self.a))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a,)

    def faults(self, dimension: int) -> list[str]:
        if dimension != 2:
            return ["scene: expected a planar one, found a spatial one; wheels in space are not built yet"]
        return line_faults(self.a, self.axis, 2) + radius_faults(self.radius, signed=False)

    def scalars(self, site: Site) -> list[int]:
        q, v = site.scene.layout.start()
        return [site.scalar(0.0, float(_along(self.a, self.axis).value(q) @ self.a.point.rate(v)) / float(self.radius), "turn")]

    def rows(self, a: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return []

    def slips(self, a: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, SlipRow]]:  # type: ignore[override]
        ahead = _along(a, self.axis)
        turn = Scalar.coordinate(scalars[0]).scaled(-float(self.radius))
        return [("slip", moving(a, ahead.scaled(1j))), ("rolling", [*moving(a, ahead), (ONE, turn)])]


ONE = Scalar(np.zeros(0, np.intp), np.zeros(0), 1.0)


def _along(a: Marker, axis: Any) -> Affine:
    return fixed_axis(a, axis / np.linalg.norm(axis))


def moving(a: Marker, direction: Affine) -> SlipRow:
    """direction . dp/dt of the marker's point p."""
    return list(zip(direction.components(), a.point.components()))
