"""A point that slides along a cable."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd.fields import Beam, Place
from mbd.marker import Marker
from mbd.rows import Row
from mbd.track import Track

from .placed import Joint, PlacedJoint, Pose, as_marker

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class BeamSlider(Joint):
    """A point slides along a cable without friction, over all its elements; it starts where the cable is nearest to it.

    point   any marker: of a body, a particle, another cable or the ground (a sleeve through which the cable runs)
    beam    the cable, as ``scene.add(mbd.AncfCable(...))`` returned it

    The place s along the cable [m], from 0 to its length in the rest shape, is ``result.q[:, slider.coordinate]``. The run ends with a
    SimulationError where the point gets to an end of the cable; stop it before by an event. A body that shall follow the cable's
    direction takes two of them.
    """

    point: Place
    beam: Beam
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "beam slider", "m"

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", as_marker(self.point))

    @property
    def markers(self) -> tuple[Marker, ...]:
        start = getattr(self.beam, "start", None)
        return (self.point, start) if isinstance(start, Marker) else (self.point,)

    def faults(self, dimension: int) -> list[str]:
        if not (hasattr(self.beam, "lengths") and hasattr(self.beam, "rows")):
            return [f"beam: expected a cable as scene.add(mbd.AncfCable(...)) returned it, found {self.beam!r}; give the cable, not a marker"]
        if self.point.item == self.beam.name:
            return [f"point: expected one of another item, found one of the cable {self.beam.name!r} itself; attach it elsewhere"]
        return []

    def place(self, site: Site) -> PlacedBeamSlider:
        return PlacedBeamSlider(self, site)

    def track(self, place: int) -> Track:
        return Track(self.point.point, self.beam.rows, self.beam.lengths, place, self.beam.name)

    def scalars(self, site: Site) -> list[int]:
        (q, v), track = site.scene.layout.start(), self.track(0)
        s = track.nearest(self.point.point.value(q), q)
        tangent, moved = track.weights(np.array(s), 1) @ track.nodes(q), track.weights(np.array(s), 0) @ track.nodes(v)
        rate = float((self.point.point.rate(v) - moved) @ tangent / (tangent @ tangent))
        return [site.scalar(s, rate, "place along the cable", True)]

    def rows(self, point: Marker, start: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        """As far as they concern the point, for the reaction on it."""
        return [(f"position {axis}", Row(component)) for axis, component in zip("xyz", point.point.components())]


class PlacedBeamSlider(PlacedJoint):
    """A sliding point in a scene."""

    @property
    def coordinate(self) -> int:
        """Index of the place along the cable in q and v, counted from their end."""
        return self.scalars[0]

    def equations(self, model: Model, pose: Pose) -> None:
        model.track(self.name, self.description.track(self.scalars[0]))
