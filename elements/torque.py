"""Torques at markers that carry axes: constants or functions of time, dead or following the marker.

    f_a = c T x e_a / |e_a|^2      on every axis e_a that the marker carries: c = 1 (one axis), 1/2 (three)

It does the work T . rotation; T in inertial axes, or T = sum_k T_k u_k, u_k = e_k / |e_k|, where it follows. A torque component along a
thin spatial cable does no work and is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array
from mbd.errors import SimulationError
from mbd.fields import Function
from mbd.maps import Maps
from mbd.marker import Marker
from mbd.signal import Samples, Signal

from .load_axes import Axes, along, crossing, inverse_gradient, squares, unit_gradient

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])  # turns counter-clockwise
MIRRORS = np.array([[[1.0, 0.0], [0.0, -1.0]], [[0.0, 1.0], [1.0, 0.0]]])  # x -> conj(x) and x -> i conj(x)


@dataclass(frozen=True, eq=False)
class Torque:
    """A torque [N m] at a marker that carries an axis: a number (planar, counter-clockwise) or [3] (spatial, inertial axes;
    with follower=True in the marker's axes), or callable(t)."""

    marker: Marker
    value: Function
    follower: bool = field(default=False, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "torque"

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.marker,)

    def faults(self, dimension: int) -> list[str]:
        signal = Signal(self.value, () if dimension == 2 else (3,), "", "[N m]")
        found = signal.faults("value")
        if not self.marker.turns():
            return [*found, f"marker: expected one that can turn, found {self.marker!r}; attach it to a body or a cable"]
        if dimension == 3 and not self.marker.rigid and self.follower:
            found.append("follower: expected a dead torque on a thin spatial cable (its axes are not defined), found follower=True; leave it out")
        return found

    def place(self, site: Site) -> PlacedTorque:
        return PlacedTorque(self, site)


class PlacedTorque:
    """A torque in a scene."""

    def __init__(self, description: Torque, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        t = self.description
        if t.marker.dimension == 2:
            planar = RigidTorques if t.marker.rigid else PlanarTorques
            model.load(planar, (), axes=[t.marker.axes[0]], signals=[Signal(t.value, (), self.name, "[N m]")])
            return
        signal = Signal(t.value, (3,), self.name, "[N m]")
        if not t.marker.rigid:
            torque, tangent = self._now(signal), t.marker.axes[0].value(model.q0)
            along = abs(torque @ tangent) / np.linalg.norm(tangent)
            if along > 1e-9 * np.linalg.norm(torque):
                model.complain(self, f"expected no component along the thin cable (it has no torsion), found {along:.6g} N m; remove it")
                return
        kernel = FollowerTorques if t.follower else DeadTorques
        model.load(kernel, (len(t.marker.axes),), axes=[t.marker.axes], signals=[signal])

    def _now(self, signal: Signal) -> Array:
        """[3] at t = 0; zero where a function fails there: the run that calls it says so."""
        try:
            return signal.sample(np.zeros(1))[0]
        except SimulationError:
            return np.zeros(3)


class RigidTorques:
    """The kernel of planar torques on rigid bodies, whose axes have the length 1: linear."""

    def __init__(self, *, axes: Sequence[Affine], signals: Sequence[Signal]):
        self.maps, self.signals, self._samples = Maps(axes), signals, Samples(signals)
        self.dofs = self.maps.dofs
        self.constant_in_q, self.linear_in_q = False, True
        self._turned = np.swapaxes(self.maps.matrix, -1, -2) @ QUARTER @ self.maps.matrix

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def force(self, q: Array, inputs: Array) -> Array:
        return inputs[..., None] * (self._turned @ q.take(self.dofs, axis=-1)[..., None])[..., 0]

    def gradient(self, q: Array, inputs: Array) -> Array:
        return inputs[..., None, None] * self._turned


class PlanarTorques:
    """The kernel of planar torques on axes that stretch. With complex numbers for vectors f = i T / conj(e): what the axis e turns and
    stretches by, de, changes it by -i T / conj(e)^2 conj(de)."""

    def __init__(self, *, axes: Sequence[Affine], signals: Sequence[Signal]):
        self.maps, self.signals, self._samples = Maps(axes), signals, Samples(signals)
        self.dofs = self.maps.dofs
        self.constant_in_q = self.linear_in_q = False
        p, k = self.maps.matrix[:, None], self.dofs.shape[1]
        self._mirrored, self._square = (np.swapaxes(p, -1, -2) @ MIRRORS @ p).reshape(-1, 2, k * k), (k, k)

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def force(self, q: Array, inputs: Array) -> Array:
        return self.maps.pull((1j * inputs[..., None] / self._axis(q).conj()).view(float))

    def gradient(self, q: Array, inputs: Array) -> Array:
        change = (-1j * inputs[..., None] / self._axis(q).conj() ** 2).view(float)
        return (change[..., None, :] @ self._mirrored).reshape(*change.shape[:-1], *self._square)

    def _axis(self, q: Array) -> NDArray[np.complex128]:
        """[..., n, 1]."""
        return self.maps.value(q).view(complex)


class _SpatialTorques:
    """What dead and follower torques share: T x e_a / |e_a|^2 on each axis for a torque T(q) [..., n, 3] with gradient [..., n, 3, k]."""

    def __init__(self, count: int, axes: Sequence[Sequence[Affine]]):
        self.axes, self.share = Axes(axes), 1.0 if count == 1 else 0.5
        self.dofs = self.axes.dofs

    def force(self, q: Array, torque: Array) -> Array:
        e = self.axes.value(q)
        return self.axes.pull(e @ crossing(self.share * torque) / squares(e)[..., None])

    def gradient(self, q: Array, torque: Array, torque_gradient: Array | None) -> Array:
        e = self.axes.value(q)
        by_axis = inverse_gradient(e) @ self.axes.matrix
        turned = np.swapaxes(crossing(torque), -1, -2)[..., None, :, :] @ by_axis
        if torque_gradient is not None:
            turned = turned + crossing(e / squares(e)[..., None]) @ torque_gradient[..., None, :, :]  # x cross y as a matrix on x
        return self.share * np.einsum("nadk,...nadl->...nkl", self.axes.matrix, turned)


class DeadTorques:
    """The kernel of all spatial torques of given direction."""

    def __init__(self, count: int, *, axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.common, self.signals, self._samples = _SpatialTorques(count, axes), signals, Samples(signals)
        self.dofs = self.common.dofs
        self.constant_in_q = self.linear_in_q = False

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def force(self, q: Array, inputs: Array) -> Array:
        return self.common.force(q, inputs)

    def gradient(self, q: Array, inputs: Array) -> Array:
        return self.common.gradient(q, inputs, None)


class FollowerTorques:
    """The kernel of all spatial torques that turn with their body."""

    def __init__(self, count: int, *, axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.common, self.signals, self._samples = _SpatialTorques(count, axes), signals, Samples(signals)
        self.dofs = self.common.dofs
        self.constant_in_q = self.linear_in_q = False

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def _torque(self, q: Array, inputs: Array) -> Array:
        return along(self.common.axes.value(q), inputs)

    def force(self, q: Array, inputs: Array) -> Array:
        return self.common.force(q, self._torque(q, inputs))

    def gradient(self, q: Array, inputs: Array) -> Array:
        axes = self.common.axes
        by = np.einsum("...na,...nade,naek->...ndk", inputs, unit_gradient(axes.value(q)), axes.matrix)
        return self.common.gradient(q, self._torque(q, inputs), by)
