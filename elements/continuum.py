"""Strains of a thin ANCF cable: stretch and curvature at Gauss points.

    stretch    |r'| / |r0'| - 1                                 U = 1/2 int EA stretch^2 + EI |curvature|^2 ds
    curvature  (r' x r'') / (|r'|^2 |r0'|) - its rest value     (one component in the plane, three in space)

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
    """x cross y [..., c, n, g] of vectors [..., d, n, g]: c = 1 in the plane, 3 in space."""
    if x.shape[-3] == 2:
        return (x[..., 0, :, :] * y[..., 1, :, :] - x[..., 1, :, :] * y[..., 0, :, :])[..., None, :, :]
    out = np.empty(np.broadcast_shapes(x.shape, y.shape))
    for i, j, k in CYCLES:
        np.subtract(x[..., j, :, :] * y[..., k, :, :], x[..., k, :, :] * y[..., j, :, :], out=out[..., i, :, :])
    return out


def _turn(x: Array, s: Array) -> Array:
    """x cross s [..., d, n, g] for a moment s [..., c, n, g], in the plane one about its normal."""
    if x.shape[-3] == 3:
        return _cross(x, s)
    out = np.empty((*np.broadcast_shapes(x.shape[:-3], s.shape[:-3]), *x.shape[-3:]))
    np.multiply(x[..., 1, :, :], s[..., 0, :, :], out=out[..., 0, :, :])
    np.multiply(x[..., 0, :, :], s[..., 0, :, :], out=out[..., 1, :, :])
    np.negative(out[..., 1, :, :], out=out[..., 1, :, :])
    return out


def _skew(s: Array, d: int) -> Array:
    """E [..., d, d, n, g] with E y = y cross s."""
    e = np.zeros((*s.shape[:-3], d, d, *s.shape[-2:]))
    for i, j, k in CYCLES if d == 3 else [(0, 1, 0)]:
        e[..., i, j, :, :] = s[..., k, :, :]
        e[..., j, i, :, :] = -s[..., k, :, :]
    return e


CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


class Continuum:
    """The kernel of all cables with one number of Gauss points.

    nodes [n, d, 4] indices of the nodal vectors' components, length [n], rest [n, d, 4] the nodal vectors of the shape without stress,
    EA, EI [n] and damping [n] (relaxation time [s]). Strains and stresses are [..., 1 + c, n, g], the stretch before the curvatures.
    """

    def __init__(self, points: int, *, nodes: np.ndarray, length: Array, rest: Array, EA: Array, EI: Array, damping: Array):
        xi, weight = gauss(points)
        self.by_x, self.by_y = hermite_slope(xi), hermite_bend(xi)
        self.points, self.items, self.dimension = points, len(nodes), nodes.shape[1]
        self.nodes, self.dofs = np.moveaxis(nodes, 1, 0).copy(), nodes.reshape(len(nodes), -1)
        one = np.ones_like(length)
        self.scale = np.stack((one, length, one, length), axis=1)
        self.x_shape, self.y_shape = (by[:, None, :] * self.scale.T[:, :, None] for by in (self.by_x, self.by_y))
        self.components = 1 if self.dimension == 2 else 3
        self.rest_length = np.ones((self.items, points))
        shape = np.moveaxis(rest, 1, 0)
        self.rest_length = ContinuumAt(self, shape).stretched
        self.rest_curvature = ContinuumAt(self, shape).curvature * (self.dimension == 2)
        arc = weight * self.rest_length
        self.modulus = np.stack([EA[:, None] * arc] + [EI[:, None] * arc] * self.components)
        self.viscosity = damping[:, None] * self.modulus
        pairs = np.stack((self.by_x, self.by_y), axis=1)
        self._pairs = np.einsum("apg,bqg->pqgab", pairs, pairs).reshape(4 * points, 16)

    def at(self, q: Array) -> ContinuumAt:
        return ContinuumAt(self, q[..., self.nodes])

    def slopes(self, nodal: Array) -> tuple[Array, Array]:
        """dr/dxi and d2r/dxi2 [..., d, n, g] from nodal vectors [..., d, n, 4]."""
        scaled = nodal * self.scale
        return scaled @ self.by_x, scaled @ self.by_y


def _by_item(stress: Array) -> Array:
    """[..., n, (1 + c) g] from [..., 1 + c, n, g]."""
    moved = np.swapaxes(stress, -3, -2)
    return moved.reshape(*moved.shape[:-2], -1)


class Frozen:
    """The strains' first derivatives at one configuration, as matrices: fewer and larger products than ``ContinuumAt`` makes."""

    def __init__(self, kernel: Continuum, matrix: Array):
        self.kernel, self.matrix, self.transpose = kernel, matrix, np.ascontiguousarray(np.swapaxes(matrix, -1, -2))

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 4 d] from sigma [..., 1 + c, n, g]."""
        return (self.transpose @ _by_item(stress)[..., None])[..., 0]

    def push(self, change: Array) -> Array:
        """B dq [..., 1 + c, n, g] from dq [..., n_coordinates]."""
        k = self.kernel
        local = (self.matrix @ change[..., k.dofs][..., None]).reshape(*change.shape[:-1], k.items, 1 + k.components, k.points)
        return np.swapaxes(local, -3, -2)


class ContinuumAt:
    """The cables at configurations [...]: strains, and their first and second derivatives. x = dr/dxi, y = d2r/dxi2."""

    def __init__(self, kernel: Continuum, nodal: Array):
        self.kernel = kernel
        self.x, self.y = kernel.slopes(nodal)
        square = self.x * self.x
        self.square = square[..., 0, :, :] + square[..., 1, :, :]
        if kernel.dimension == 3:
            self.square += square[..., 2, :, :]
        self.stretched = np.sqrt(self.square)
        self.per = 1.0 / (self.square * kernel.rest_length)
        self.along = self.stretched * self.per
        self.twice = 2.0 / self.square
        self.curvature = _cross(self.x, self.y) * self.per[..., None, :, :]

    @property
    def value(self) -> Array:
        """[..., 1 + c, n, g]."""
        k = self.kernel
        out = np.empty((*self.square.shape[:-2], 1 + k.components, k.items, k.points))
        np.divide(self.stretched, k.rest_length, out=out[..., 0, :, :])
        out[..., 0, :, :] -= 1.0
        np.subtract(self.curvature, k.rest_curvature, out=out[..., 1:, :, :])
        return out

    def _work(self, moment: Array) -> Array:
        """moment . curvature [..., n, g]."""
        product = moment * self.curvature
        return product[..., 0, :, :] if self.kernel.components == 1 else product.sum(axis=-3)

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 4 d] from sigma [..., 1 + c, n, g]."""
        k = self.kernel
        axial, moment = stress[..., 0, :, :], stress[..., 1:, :, :]
        turning = moment * self.per[..., None, :, :]
        along = axial * self.along - self._work(moment) * self.twice
        on_x = along[..., None, :, :] * self.x + _turn(self.y, turning)
        local = (on_x @ k.by_x.T - _turn(self.x, turning) @ k.by_y.T) * k.scale
        return np.swapaxes(local, -3, -2).reshape(*local.shape[:-3], k.items, -1)

    def push(self, change: Array) -> Array:
        """B dq [..., 1 + c, n, g] from dq [..., n_coordinates]."""
        k = self.kernel
        dx, dy = k.slopes(change[..., k.nodes])
        product = self.x * dx
        along = product[..., 0, :, :] + product[..., 1, :, :]
        if k.dimension == 3:
            along = along + product[..., 2, :, :]
        out = np.empty((*along.shape[:-2], 1 + k.components, k.items, k.points))
        np.multiply(along, self.along, out=out[..., 0, :, :])
        bend = (_cross(dx, self.y) + _cross(self.x, dy)) * self.per[..., None, :, :]
        np.subtract(bend, self.curvature * (along * self.twice)[..., None, :, :], out=out[..., 1:, :, :])
        return out

    def _gradient(self) -> Array:
        """Strains by (x, y): [..., 1 + c, 2, d, n, g]."""
        k = self.kernel
        out = np.zeros((*self.square.shape[:-2], 1 + k.components, 2, k.dimension, k.items, k.points))
        out[..., 0, 0, :, :, :] = self.x * self.along[..., None, :, :]
        for c in range(k.components):
            s = np.zeros((*self.square.shape[:-2], k.components, k.items, k.points))
            s[..., c, :, :] = self.per
            bend = self.curvature[..., c : c + 1, :, :] / self.square[..., None, :, :]
            out[..., 1 + c, 0, :, :, :] = _turn(self.y, s) - 2.0 * bend * self.x
            out[..., 1 + c, 1, :, :, :] = -_turn(self.x, s)
        return out

    def _curve(self, stress: Array) -> Array:
        """sigma . d2(strain) by (x, y): [..., 2, d, 2, d, n, g]."""
        d, x = self.kernel.dimension, self.x
        wide = self.square[..., None, None, :, :]
        moment = stress[..., 1:, :, :]
        s = moment * self.per[..., None, :, :]
        turned, swept = _turn(self.y, s), -_turn(x, s)
        xx, eye = x[..., :, None, :, :] * x[..., None, :, :, :], np.eye(d)[:, :, None, None]
        mixed = turned[..., :, None, :, :] * x[..., None, :, :, :]
        work = self._work(moment)[..., None, None, :, :] / wide
        axial = (stress[..., 0, :, :] * self.along)[..., None, None, :, :]
        out = np.zeros((*mixed.shape[:-4], 2, d, 2, d, *mixed.shape[-2:]))
        out[..., 0, :, 0, :, :, :] = (
            (axial - 2.0 * work) * eye + (8.0 * work - axial) * (xx / wide) - 2.0 * (mixed + np.swapaxes(mixed, -4, -3)) / wide
        )
        cross = _skew(s, d) - 2.0 * x[..., :, None, :, :] * swept[..., None, :, :, :] / wide
        out[..., 0, :, 1, :, :, :] = cross
        out[..., 1, :, 0, :, :, :] = np.swapaxes(cross, -4, -3)
        return out

    @cached_property
    def matrix(self) -> Array:
        """B [..., n, (1 + c) g, 4 d]."""
        k, gradient = self.kernel, self._gradient()[..., None, :, :]
        by_shape = gradient[..., 0, :, :, :, :] * k.x_shape
        by_shape[..., 1:, :, :, :, :] += gradient[..., 1:, 1, :, :, :, :] * k.y_shape
        out = np.einsum("...cdang->...ncgda", by_shape)  # a view, and faster than moveaxis
        return out.reshape(*out.shape[:-4], (1 + k.components) * k.points, 4 * k.dimension)

    def frozen(self) -> Frozen:
        """B alone, for many products."""
        return Frozen(self.kernel, self.matrix)

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, 4 d, 4 d]."""
        k, d = self.kernel, self.kernel.dimension
        h = np.einsum("...piqjng->...nijpqg", self._curve(stress))
        full = (h.reshape(*h.shape[:-3], 4 * k.points) @ k._pairs).reshape(*h.shape[:-3], 4, 4)
        full = full * (k.scale[:, :, None] * k.scale[:, None, :])[:, None, None]
        weighed = _by_item(modulus)[..., None] * self.matrix
        return np.swapaxes(full, -3, -2).reshape(*full.shape[:-4], 4 * d, 4 * d) + np.swapaxes(self.matrix, -1, -2) @ weighed

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., 1 + c, n, g, 4 d]: what damping adds to the tangent."""
        k = self.kernel
        rate = np.stack(k.slopes(v[..., k.nodes]), axis=-4)
        rows = []
        for c in range(1 + k.components):
            unit = np.zeros((1 + k.components, k.items, k.points))
            unit[c] = 1.0
            unit = np.broadcast_to(unit, (*self.square.shape[:-2], *unit.shape))
            rows.append(np.einsum("...piqjng,...qjng->...ping", self._curve(unit), rate))
        by = np.stack(rows, axis=-5)
        shape = np.stack((k.by_x, k.by_y), axis=1)
        out = np.einsum("...cping,apg,na->...cngia", by, shape, k.scale)
        return out.reshape(*out.shape[:-2], 4 * k.dimension)

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., 1 + c, n, g]."""
        return np.sum(self.swirl(v) * change[..., self.kernel.dofs][..., None, :, None, :], axis=-1)

    def energy(self) -> Array:
        """[...]: of all cables together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-3, -2, -1))
