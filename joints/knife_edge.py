"""A knife edge, skate or wheel on the plane: nonholonomic."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbd import validate
from mbd.marker import Marker
from mbd.rows import Row
from mbd.slip import SlipRow

from .lines import fixed_axis, line_faults
from .placed import Joint, Pose, as_marker


@dataclass(frozen=True, eq=False)
class KnifeEdge(Joint):
    """The point of a body moves along an axis of the body only, never across it: a skate, a blade, a wheel that rolls freely (planar).

    a      of a body: the point of contact
    axis   [2], the direction of the edge in the axes of the body

    For ``Radau`` and ``DormandPrince``. The force that it exerts does no work.
    """

    a: Any
    axis: Any = field(kw_only=True)
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

    def slips(self, a: Marker, pose: Pose) -> list[tuple[str, SlipRow]]:  # type: ignore[override]
        """n . dp/dt, n across the edge."""
        along = self.axis / np.linalg.norm(self.axis)
        across = fixed_axis(a, np.array((-along[1], along[0])))
        return [("slip", list(zip(across.components(), a.point.components())))]
