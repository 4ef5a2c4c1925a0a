"""Strains of a thin spatial ANCF cable: stretch and curvature at Gauss points.

    stretch    |r'| / |r0'| - 1                   U = 1/2 int EA stretch^2 + EI |curvature|^2 ds
    curvature  (r' x r'') / (|r'|^2 |r0'|)

The curvature is d theta/ds, the rotation of the tangent by reference arc length s; x runs over [0, l] and ds = |r0'| dx. Primes are
taken by xi = x/l here: the length cancels. Limits: |r'| > 0; in space no torsion, and the rest shape is straight (a cable
without torsion has no material frame that could carry a rest curvature along).
Sources: Escalona, Hussien and Shabana (1998) for the element; Gerstmayr and Irschik (2008), J. Sound Vib. 318, for these strains.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from mbd.affine import Array

from .shapes import gauss, hermite_bend, hermite_slope


def _cross(x: Array, y: Array) -> Array:
    """x cross y of vectors [..., 3, n, g]."""
    out = np.empty(np.broadcast_shapes(x.shape, y.shape))
    for i, j, k in CYCLES:
        np.subtract(x[..., j, :, :] * y[..., k, :, :], x[..., k, :, :] * y[..., j, :, :], out=out[..., i, :, :])
    return out


def _skew(s: Array) -> Array:
    """E [..., 3, 3, n, g] with E y = y cross s."""
    e = np.zeros((*s.shape[:-3], 3, 3, *s.shape[-2:]))
    for i, j, k in CYCLES:
        e[..., i, j, :, :] = s[..., k, :, :]
        e[..., j, i, :, :] = -s[..., k, :, :]
    return e


CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


class SpatialContinuum:
    """The kernel of all spatial cables with one number of Gauss points.

    nodes [n, 3, 4] indices of the nodal vectors' components, length [n], rest [n, 3, 4] the nodal vectors of the shape without stress,
    EA, EI [n] and damping [n] (relaxation time [s]). Strains and stresses are [..., n, 4, g], the stretch before the curvatures.
    """

    def __init__(self, points: int, *, nodes: np.ndarray, length: Array, rest: Array, EA: Array, EI: Array, damping: Array):
        xi, weight = gauss(points)
        self.by_x, self.by_y = hermite_slope(xi), hermite_bend(xi)
        self.points, self.items = points, len(nodes)
        self.nodes, self.dofs = np.moveaxis(nodes, 1, 0).copy(), nodes.reshape(len(nodes), -1)
        one = np.ones_like(length)
        self.scale = np.stack((one, length, one, length), axis=1)
        self.x_shape, self.y_shape = (by[:, None, :] * self.scale.T[:, :, None] for by in (self.by_x, self.by_y))
        self.rest_length = np.ones((self.items, points))
        self.rest_length = SpatialContinuumAt(self, np.moveaxis(rest, 1, 0)).stretched
        arc = weight * self.rest_length
        self.modulus = np.stack([EA[:, None] * arc] + [EI[:, None] * arc] * 3, axis=1)
        self.viscosity = damping[:, None, None] * self.modulus
        pairs = np.stack((self.by_x, self.by_y), axis=1)
        self._pairs = np.einsum("apg,bqg->pqgab", pairs, pairs).reshape(4 * points, 16)

    def at(self, q: Array) -> SpatialContinuumAt:
        return SpatialContinuumAt(self, q.take(self.nodes, axis=-1))

    def slopes(self, nodal: Array) -> tuple[Array, Array]:
        """dr/dxi and d2r/dxi2 [..., 3, n, g] from nodal vectors [..., 3, n, 4]."""
        scaled = nodal * self.scale
        return scaled @ self.by_x, scaled @ self.by_y


class SpatialContinuumAt:
    """The cables at configurations [...]: strains, and their first and second derivatives. x = dr/dxi, y = d2r/dxi2."""

    def __init__(self, kernel: SpatialContinuum, nodal: Array):
        self.kernel = kernel
        self.x, self.y = kernel.slopes(nodal)
        self.square = np.sum(self.x * self.x, axis=-3)
        self.stretched = np.sqrt(self.square)
        self.per = 1.0 / (self.square * kernel.rest_length)
        self.along = self.stretched * self.per
        self.twice = 2.0 / self.square
        self.curvature = _cross(self.x, self.y) * self.per[..., None, :, :]

    @property
    def value(self) -> Array:
        """[..., n, 4, g]."""
        k = self.kernel
        out = np.empty((*self.square.shape[:-1], 4, k.points))
        np.divide(self.stretched, k.rest_length, out=out[..., 0, :])
        out[..., 0, :] -= 1.0
        out[..., 1:, :] = np.swapaxes(self.curvature, -3, -2)
        return out

    def _work(self, moment: Array) -> Array:
        """moment . curvature [..., n, g]."""
        return np.sum(moment * self.curvature, axis=-3)

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 12] from sigma [..., n, 4, g]."""
        k = self.kernel
        axial, moment = stress[..., 0, :], np.swapaxes(stress[..., 1:, :], -3, -2)
        turning = moment * self.per[..., None, :, :]
        along = axial * self.along - self._work(moment) * self.twice
        on_x = along[..., None, :, :] * self.x + _cross(self.y, turning)
        local = (on_x @ k.by_x.T - _cross(self.x, turning) @ k.by_y.T) * k.scale
        return np.swapaxes(local, -3, -2).reshape(*local.shape[:-3], k.items, -1)

    def push(self, change: Array) -> Array:
        """B dq [..., n, 4, g] from dq [..., n_coordinates]."""
        k = self.kernel
        dx, dy = k.slopes(change.take(k.nodes, axis=-1))
        along = np.sum(self.x * dx, axis=-3)
        out = np.empty((*along.shape[:-1], 4, k.points))
        np.multiply(along, self.along, out=out[..., 0, :])
        bend = (_cross(dx, self.y) + _cross(self.x, dy)) * self.per[..., None, :, :]
        out[..., 1:, :] = np.swapaxes(bend - self.curvature * (along * self.twice)[..., None, :, :], -3, -2)
        return out

    def _by_slopes(self) -> Array:
        """Strains by (x, y): [..., 4, 2, 3, n, g]."""
        k = self.kernel
        out = np.zeros((*self.square.shape[:-2], 4, 2, 3, k.items, k.points))
        np.multiply(self.x, self.along[..., None, :, :], out=out[..., 0, 0, :, :, :])
        turned = np.stack((self.y, -self.x), axis=-4) * self.per[..., None, None, :, :]
        for i, j, c in CYCLES:
            out[..., 1 + i, :, j, :, :] = turned[..., c, :, :]
            np.negative(turned[..., c, :, :], out=out[..., 1 + j, :, i, :, :])
        bend = self.curvature * self.twice[..., None, :, :]
        out[..., 1:, 0, :, :, :] -= bend[..., :, None, :, :] * self.x[..., None, :, :, :]
        return out

    def _curve(self, stress: Array) -> Array:
        """sigma . d2(strain) by (x, y): [..., 2, 3, 2, 3, n, g]."""
        k, x = self.kernel, self.x
        moment = np.swapaxes(stress[..., 1:, :], -3, -2)
        s = moment * self.per[..., None, :, :]
        swept = _cross(s, x) * self.twice[..., None, :, :]
        work, axial = self._work(moment) * self.twice, stress[..., 0, :] * self.along
        half = ((work - 0.25 * axial) * self.twice)[..., None, :, :] * x - _cross(self.y, s) * self.twice[..., None, :, :]
        half = x[..., :, None, :, :] * half[..., None, :, :, :]
        blocks = np.zeros((*axial.shape[:-1], 3, 3, 2, 2, k.points))  # as products with the shapes of nodes take them
        out = np.einsum("...nijpqg->...piqjng", blocks)
        np.add(half, np.swapaxes(half, -4, -3), out=out[..., 0, :, 0, :, :, :])
        for i in range(3):
            out[..., 0, i, 0, i, :, :] += axial - work
        cross = _skew(s) - x[..., :, None, :, :] * swept[..., None, :, :, :]
        out[..., 0, :, 1, :, :, :] = cross
        out[..., 1, :, 0, :, :, :] = np.swapaxes(cross, -4, -3)
        return out

    @cached_property
    def gradient(self) -> Array:
        """B [..., n, 4 g, 12]."""
        k, by_slopes = self.kernel, self._by_slopes()[..., None, :, :]
        by_shape = by_slopes[..., 0, :, :, :, :] * k.x_shape
        by_shape[..., 1:, :, :, :, :] += by_slopes[..., 1:, 1, :, :, :, :] * k.y_shape
        out = np.einsum("...cdang->...ncgda", by_shape)  # a view, and faster than moveaxis
        return out.reshape(*out.shape[:-4], 4 * k.points, 12)

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, 12, 12]."""
        k = self.kernel
        h = np.einsum("...piqjng->...nijpqg", self._curve(stress))
        full = (h.reshape(*h.shape[:-3], 4 * k.points) @ k._pairs).reshape(*h.shape[:-3], 4, 4)
        full = full * (k.scale[:, :, None] * k.scale[:, None, :])[:, None, None]
        weighed = modulus.reshape(*modulus.shape[:-2], -1, 1) * self.gradient
        return np.swapaxes(full, -3, -2).reshape(*full.shape[:-4], 12, 12) + np.swapaxes(self.gradient, -1, -2) @ weighed

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., n, 4, g, 12]: what damping adds to the tangent."""
        k = self.kernel
        rate = np.stack(k.slopes(v.take(k.nodes, axis=-1)), axis=-4)
        rows = []
        for c in range(4):
            unit = np.zeros((k.items, 4, k.points))
            unit[:, c] = 1.0
            unit = np.broadcast_to(unit, (*self.square.shape[:-2], *unit.shape))
            rows.append(np.einsum("...piqjng,...qjng->...ping", self._curve(unit), rate))
        by = np.stack(rows, axis=-5)
        shape = np.stack((k.by_x, k.by_y), axis=1)
        out = np.einsum("...cping,apg,na->...ncgia", by, shape, k.scale)
        return out.reshape(*out.shape[:-2], 12)

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., n, 4, g]."""
        return np.sum(self.swirl(v) * change.take(self.kernel.dofs, axis=-1)[..., None, None, :], axis=-1)

    def energy(self) -> Array:
        """[...]: of all cables together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-3, -2, -1))
