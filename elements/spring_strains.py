"""Strains of springs.

Stretch    |p| - length, p = a - b: force stiffness strain + damping d(strain)/dt along the line
Offset     p itself, d components: springs of zero length, smooth where the ends meet
Twist      phi - angle, phi the counter-clockwise turn of the first marker relative to the second since assembly (planar)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array
from mbd.maps import Maps


class Stretch:
    """The kernel of all springs with a length."""

    def __init__(self, *, apart: Sequence[Affine], length: Array, stiffness: Array, damping: Array):
        self.maps, self.length = Maps(apart), length
        self.dofs, self.items, self.m = self.maps.dofs, len(length), 1
        self.modulus, self.viscosity = stiffness[:, None], damping[:, None]

    def at(self, q: Array) -> StretchAt:
        return StretchAt(self, self.maps.value(q))


class StretchAt:
    """The springs at configurations [...]."""

    def __init__(self, kernel: Stretch, apart: Array):
        self.kernel = kernel
        self.distance = np.sqrt(np.sum(apart**2, axis=-1, keepdims=True))
        self.unit = apart / self.distance

    @property
    def value(self) -> Array:
        return self.distance - self.kernel.length[:, None]

    @property
    def gradient(self) -> Array:
        """B [..., n, 1, k]."""
        return self.unit[..., None, :] @ self.kernel.maps.matrix

    def pull(self, stress: Array) -> Array:
        return self.kernel.maps.pull(stress * self.unit)

    def push(self, change: Array) -> Array:
        return np.sum(self.unit * self.kernel.maps.push(change), axis=-1, keepdims=True)

    def _across(self) -> Array:
        """d2|p|/dp2 [..., n, d, d]."""
        u = self.unit
        return (np.eye(u.shape[-1]) - u[..., :, None] * u[..., None, :]) / self.distance[..., None]

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        u, p = self.unit, self.kernel.maps.matrix
        h = modulus[..., None] * u[..., :, None] * u[..., None, :] + stress[..., None] * self._across()
        return np.swapaxes(p, -1, -2) @ h @ p

    def swirl_times(self, v: Array, change: Array) -> Array:
        return (self.swirl(v) @ change[..., self.kernel.dofs][..., None])[..., 0]

    def swirl(self, v: Array) -> Array:
        rate = self._across() @ self.kernel.maps.push(v)[..., None]
        return np.swapaxes(rate, -1, -2) @ self.kernel.maps.matrix

    def energy(self) -> Array:
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))


class Offset:
    """The kernel of all springs of zero length: linear."""

    def __init__(self, *, apart: Sequence[Affine], stiffness: Array, damping: Array):
        self.maps = Maps(apart)
        d = apart[0].dimension
        self.dofs, self.items, self.m = self.maps.dofs, len(apart), d
        self.modulus, self.viscosity = np.repeat(stiffness[:, None], d, axis=1), np.repeat(damping[:, None], d, axis=1)

    def at(self, q: Array) -> LinearAt:
        return LinearAt(self, self.maps.value(q), self.maps)


class _Coordinates:
    """One coordinate for each item, as ``Maps`` gives vectors."""

    def __init__(self, index: NDArray[np.intp]):
        self.dofs, self.matrix = index[:, None], np.ones((index.size, 1, 1))

    def push(self, dq: Array) -> Array:
        return dq[..., self.dofs]

    def pull(self, force: Array) -> Array:
        return force


class Twist:
    """The kernel of all torsion springs: linear in their turns."""

    def __init__(self, *, turn: NDArray[np.intp], angle: Array, stiffness: Array, damping: Array):
        self.maps, self.angle = _Coordinates(turn), angle[:, None]
        self.dofs, self.items, self.m = self.maps.dofs, turn.size, 1
        self.modulus, self.viscosity = stiffness[:, None], damping[:, None]

    def at(self, q: Array) -> LinearAt:
        return LinearAt(self, q[..., self.dofs] - self.angle, self.maps)


class LinearAt:
    """A measure whose gradient is constant."""

    def __init__(self, kernel: Offset | Twist, value: Array, maps: Maps | _Coordinates):
        self.kernel, self.value, self.maps = kernel, value, maps

    @property
    def gradient(self) -> Array:
        """B [n, m, k]."""
        return self.maps.matrix

    def pull(self, stress: Array) -> Array:
        return self.maps.pull(stress)

    def push(self, change: Array) -> Array:
        return self.maps.push(change)

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        p = self.maps.matrix
        return np.swapaxes(p, -1, -2) @ (modulus[..., None] * p)

    def swirl_times(self, v: Array, change: Array) -> Array:
        return np.zeros((*np.broadcast_shapes(v.shape[:-1], change.shape[:-1]), self.kernel.items, self.kernel.m))

    def swirl(self, v: Array) -> Array:
        return np.zeros((*v.shape[:-1], self.kernel.items, self.kernel.m, self.maps.dofs.shape[1]))

    def energy(self) -> Array:
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))
