"""Elastic measures whose kernels give the gradient and the curvature of their strains as matrices; all else follows from these.

A kernel has ``nodes`` [n, ...] and ``dofs`` [n, k] (indices into q), ``modulus`` and ``viscosity`` [n, m]. A measure is that kernel at
configurations [...]: it defines ``value`` [..., n, m], ``gradient`` B [..., n, m, k] and ``curve(stress)``, the second
derivative of sigma . strain [..., n, k, k].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mbd.affine import Array


class Measure:
    """The items of a kernel at configurations [...]."""

    kernel: Any
    value: Array
    gradient: Array

    def curve(self, stress: Array) -> Array:
        raise NotImplementedError

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, k]."""
        return (stress[..., None, :] @ self.gradient)[..., 0, :]

    def push(self, change: Array) -> Array:
        """B dq [..., n, m]."""
        return (self.gradient @ change[..., self.kernel.dofs][..., None])[..., 0]

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, k, k]."""
        b = self.gradient
        return np.swapaxes(b, -1, -2) @ (modulus[..., :, None] * b) + self.curve(stress)

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., n, m, k]."""
        rate = v[..., self.kernel.dofs][..., None]
        units = np.eye(self.kernel.modulus.shape[1])
        return np.stack([(self.curve(np.broadcast_to(unit, self.value.shape)) @ rate)[..., 0] for unit in units], axis=-2)

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., n, m]."""
        return (self.swirl(v) @ change[..., self.kernel.dofs][..., None])[..., 0]

    def energy(self) -> Array:
        """[...]: of all items together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))


def turn(x: Array) -> Array:
    """The gradient of the angle of vectors x [..., 2]: (-x2, x1) / |x|^2."""
    return np.stack((-x[..., 1], x[..., 0]), axis=-1) / np.sum(x**2, axis=-1, keepdims=True)


def turn_curve(x: Array) -> Array:
    """The second derivative [..., 2, 2] of the angle of vectors x [..., 2]."""
    t = turn(x)
    radial = x / np.sum(x**2, axis=-1, keepdims=True)
    mixed = t[..., :, None] * radial[..., None, :]
    return -(mixed + np.swapaxes(mixed, -1, -2))


def angle_between(a: Array, b: Array) -> Array:
    """The angle [...] from vectors a to b [..., 2], within half a turn."""
    return np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], np.sum(a * b, axis=-1))
