"""Forces and torques at markers: constants or functions of time, dead or following the marker's axes.

dead force        f = P' F                       P the point's map
follower force    f = P' sum_k F_k u_k           u_k = axis_k / |axis_k|; in the plane u_2 = i u_1
torque            f_a = c T x e_a / |e_a|^2      on every axis e_a that the marker carries: c = 1 (one axis), 1/2 (three); it does the
                                                 work T . rotation; T in inertial axes, or T = sum_k T_k u_k where it follows
A torque component along a thin spatial cable does no work and is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mbd.affine import Affine, Array
from mbd.errors import SimulationError
from mbd.maps import Maps
from mbd.marker import Marker
from mbd.signal import Signal

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Force:
    """A force [d] [N] at a marker: numbers or callable(t); with follower=True in the marker's axes (a cable's: along its tangent,
    in the plane also across)."""

    marker: Marker
    vector: Any
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


@dataclass(frozen=True, eq=False)
class Torque:
    """A torque [N m] at a marker that carries an axis: a number (planar, counter-clockwise) or [3] (spatial, inertial axes;
    with follower=True in the marker's axes), or callable(t)."""

    marker: Marker
    value: Any
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
            model.load(PlanarTorques, (), axes=[t.marker.axes[0]], signals=[Signal(t.value, (), self.name, "[N m]")])
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


def _axes(marker: Marker) -> tuple[Affine, ...]:
    if marker.dimension == 2:
        return (marker.axes[0], marker.axes[0].scaled(1j))
    return marker.axes


def _samples(signals: Sequence[Signal], times: Array) -> Array:
    """[..., n, *shape]."""
    return np.stack([signal.sample(times) for signal in signals], axis=times.ndim)


class DeadForces:
    """The kernel of all forces of given direction that vary in time."""

    def __init__(self, *, points: Sequence[Affine], signals: Sequence[Signal]):
        self.maps, self.signals = Maps(points), signals
        self.dofs = self.maps.dofs
        self.constant_in_q = True

    def inputs(self, times: Array) -> Array:
        return _samples(self.signals, times)

    def force(self, q: Array, inputs: Array) -> Array:
        """[..., n, k]."""
        return self.maps.pull(inputs)


class _Axes:
    """Axes e_a of items [n] with a axes each, on the joint coordinates of an item: values, and gradients [n, d, k]."""

    def __init__(self, axes: Sequence[Sequence[Affine]], points: Sequence[Affine] = ()):
        groups = [[*group, *points[i : i + 1]] for i, group in enumerate(axes)]
        k = max(sum(m.rows.size * m.dimension for m in group) for group in groups)
        d, a = groups[0][0].dimension, len(groups[0])
        self.dofs = np.zeros((len(groups), k), dtype=np.intp)
        self.matrix, self.constant = np.zeros((len(groups), a, d, k)), np.zeros((len(groups), a, d))
        for i, group in enumerate(groups):
            first = 0
            for j, m in enumerate(group):
                last = first + m.rows.size * d
                self.dofs[i, first:last], self.matrix[i, j, :, first:last], self.constant[i, j] = m.columns(), m.matrix(), m.constant
                first = last

    def value(self, q: Array) -> Array:
        """[..., n, a, d]."""
        return self.constant + np.einsum("nadk,...nk->...nad", self.matrix, q[..., self.dofs])


def _unit_gradient(e: Array) -> Array:
    """d(e/|e|)/de [..., d, d]."""
    size = np.linalg.norm(e, axis=-1)[..., None, None]
    u = e / size[..., 0]
    return (np.eye(e.shape[-1]) - u[..., :, None] * u[..., None, :]) / size


def _inverse_gradient(e: Array) -> Array:
    """d(e/|e|^2)/de [..., d, d]."""
    square = np.sum(e**2, axis=-1)[..., None, None]
    return (np.eye(e.shape[-1]) - 2.0 * e[..., :, None] * e[..., None, :] / square) / square


class FollowerForces:
    """The kernel of all forces that turn with their marker."""

    def __init__(self, count: int, *, points: Sequence[Affine], axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.axes, self.signals, self.count = _Axes(axes, points), signals, count
        self.dofs = self.axes.dofs
        self.constant_in_q = False

    def inputs(self, times: Array) -> Array:
        return _samples(self.signals, times)[..., : self.count]

    def _axis_values(self, q: Array) -> Array:
        return self.axes.value(q)[..., : self.count, :]

    def force(self, q: Array, inputs: Array) -> Array:
        e = self._axis_values(q)
        total = np.einsum("...na,...nad->...nd", inputs, e / np.linalg.norm(e, axis=-1, keepdims=True))
        return np.einsum("...nd,ndk->...nk", total, self.axes.matrix[:, -1])

    def gradient(self, q: Array, inputs: Array) -> Array:
        """df/dq [..., n, k, k]."""
        turning = np.einsum("...na,...nade,naek->...ndk", inputs, _unit_gradient(self._axis_values(q)), self.axes.matrix[:, : self.count])
        return np.swapaxes(self.axes.matrix[:, -1], -1, -2) @ turning


class PlanarTorques:
    """The kernel of all planar torques."""

    def __init__(self, *, axes: Sequence[Affine], signals: Sequence[Signal]):
        self.maps, self.signals = Maps(axes), signals
        self.dofs = self.maps.dofs
        self.constant_in_q = False
        self._quarter = np.array([[0.0, -1.0], [1.0, 0.0]])

    def inputs(self, times: Array) -> Array:
        return _samples(self.signals, times)

    def force(self, q: Array, inputs: Array) -> Array:
        e = self.maps.value(q)
        return self.maps.pull(inputs[..., None] * (e @ self._quarter.T) / np.sum(e**2, axis=-1, keepdims=True))

    def gradient(self, q: Array, inputs: Array) -> Array:
        p = self.maps.matrix
        return np.swapaxes(p, -1, -2) @ (inputs[..., None, None] * self._quarter @ _inverse_gradient(self.maps.value(q))) @ p


class _SpatialTorques:
    """What dead and follower torques share: T x e_a / |e_a|^2 on each axis for a torque T(q) [..., n, 3] with gradient [..., n, 3, k]."""

    def __init__(self, count: int, axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.axes, self.signals, self.share = _Axes(axes), signals, 1.0 if count == 1 else 0.5
        self.dofs = self.axes.dofs

    def force(self, q: Array, torque: Array) -> Array:
        e = self.axes.value(q)
        on_axes = self.share * np.cross(torque[..., None, :], e) / np.sum(e**2, axis=-1, keepdims=True)
        return np.einsum("...nad,nadk->...nk", on_axes, self.axes.matrix)

    def gradient(self, q: Array, torque: Array, torque_gradient: Array | None) -> Array:
        e = self.axes.value(q)
        by_axis = _inverse_gradient(e) @ self.axes.matrix
        turned = np.cross(torque[..., None, :, None], by_axis, axisa=-2, axisb=-2, axisc=-2)
        if torque_gradient is not None:
            arm = (e / np.sum(e**2, axis=-1, keepdims=True))[..., None]
            turned = turned + np.cross(torque_gradient[..., None, :, :], arm, axisa=-2, axisb=-2, axisc=-2)
        return self.share * np.einsum("nadk,...nadl->...nkl", self.axes.matrix, turned)


class DeadTorques:
    """The kernel of all spatial torques of given direction."""

    def __init__(self, count: int, *, axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.common, self.signals = _SpatialTorques(count, axes, signals), signals
        self.dofs = self.common.dofs
        self.constant_in_q = False

    def inputs(self, times: Array) -> Array:
        return _samples(self.signals, times)

    def force(self, q: Array, inputs: Array) -> Array:
        return self.common.force(q, inputs)

    def gradient(self, q: Array, inputs: Array) -> Array:
        return self.common.gradient(q, inputs, None)


class FollowerTorques:
    """The kernel of all spatial torques that turn with their body."""

    def __init__(self, count: int, *, axes: Sequence[Sequence[Affine]], signals: Sequence[Signal]):
        self.common, self.signals = _SpatialTorques(count, axes, signals), signals
        self.dofs = self.common.dofs
        self.constant_in_q = False

    def inputs(self, times: Array) -> Array:
        return _samples(self.signals, times)

    def _torque(self, q: Array, inputs: Array) -> Array:
        e = self.common.axes.value(q)
        return np.einsum("...na,...nad->...nd", inputs, e / np.linalg.norm(e, axis=-1, keepdims=True))

    def force(self, q: Array, inputs: Array) -> Array:
        return self.common.force(q, self._torque(q, inputs))

    def gradient(self, q: Array, inputs: Array) -> Array:
        axes = self.common.axes
        by = np.einsum("...na,...nade,naek->...ndk", inputs, _unit_gradient(axes.value(q)), axes.matrix)
        return self.common.gradient(q, self._torque(q, inputs), by)
