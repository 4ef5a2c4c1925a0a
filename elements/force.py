"""Forces at markers: constants or functions of time, dead or following the marker's axes.

dead force        f = P' F                       P the point's map
follower force    f = P' sum_k F_k u_k           u_k = axis_k / |axis_k|; in the plane u_2 = i u_1
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd.affine import Affine, Array
from mbd.fields import Function
from mbd.maps import Maps
from mbd.marker import Marker
from mbd.signal import Samples, Signal

from .load_axes import Axes, along, unit_gradient

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Force:
    """A force [d] [N] at a marker: numbers or callable(t); with follower=True in the marker's axes (a cable's: along its tangent,
    in the plane also across)."""

    marker: Marker
    vector: Function
    follower: bool = field(default=False, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "force"

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.marker,)

    def faults(self, dimension: int) -> list[str]:
        signal = Signal(self.vector, (dimension,), "", "[N]")
        found = signal.faults("vector")
        if not self.follower:
            return found
        if not self.marker.turns():
            return [*found, f"marker: expected one that carries axes for a follower force, found {self.marker!r}; use follower=False"]
        if dimension == 3 and not self.marker.rigid and (signal.function or (not found and np.any(np.asarray(signal.constant)[1:]))):
            why = "a thin spatial cable carries its tangent, no other axis"
            found.append(f"vector: expected only a first component ({why}), found others; use a dead force")
        return found

    def place(self, site: Site) -> PlacedForce:
        return PlacedForce(self, site)


class PlacedForce:
    """A force in a scene."""

    def __init__(self, description: Force, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        f = self.description
        signal = Signal(f.vector, (f.marker.dimension,), self.name, "[N]")
        if f.follower:
            model.load(FollowerForces, (len(_axes(f.marker)),), points=[f.marker.point], axes=[_axes(f.marker)], signals=[signal])
        elif signal.function is None:
            model.dead(f.marker.point, np.asarray(signal.constant))
        else:
            model.load(DeadForces, (), points=[f.marker.point], signals=[signal])


def _axes(marker: Marker) -> tuple[Affine, ...]:
    if marker.dimension == 2:
        return (marker.axes[0], marker.axes[0].scaled(1j))
    return marker.axes


class DeadForces:
    """The kernel of all forces of given direction that vary in time."""

    def __init__(self, *, points: Sequence[Affine], signals: Sequence[Signal]):
        self.maps, self.signals, self._samples = Maps(points), signals, Samples(signals)
        self.dofs = self.maps.dofs
        self.constant_in_q = self.linear_in_q = True

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def force(self, q: Array, inputs: Array) -> Array:
        """[..., n, k]."""
        return self.maps.pull(inputs)


class FollowerForces:
    """The kernel of all forces that turn with their marker."""

    def __init__(self, count: int, *, points: Sequence[Affine], axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.axes, self.count = Axes(axes, points), count
        self.signals, self._samples = signals, Samples(signals)
        self.dofs = self.axes.dofs
        self.constant_in_q = self.linear_in_q = False

    def inputs(self, times: Array) -> Array:
        return self._samples(times)[..., : self.count]

    def _axis_values(self, q: Array) -> Array:
        return self.axes.value(q)[..., : self.count, :]

    def force(self, q: Array, inputs: Array) -> Array:
        return (along(self._axis_values(q), inputs)[..., None, :] @ self.axes.matrix[:, -1])[..., 0, :]

    def gradient(self, q: Array, inputs: Array) -> Array:
        """df/dq [..., n, k, k]."""
        turning = np.einsum("...na,...nade,naek->...ndk", inputs, unit_gradient(self._axis_values(q)), self.axes.matrix[:, : self.count])
        return np.swapaxes(self.axes.matrix[:, -1], -1, -2) @ turning
