"""Strains of a thin ANCF cable: stretch and curvature at Gauss points.

    stretch    |r'| / |r0'| - 1                                 U = 1/2 int EA stretch^2 + EI |curvature|^2 ds
    curvature  (r' x r'') / (|r'|^2 |r0'|) - its rest value     (one component in the plane, three in space)

The curvature is d theta/ds, the rotation of the tangent by reference arc length s; x runs over [0, l] and ds = |r0'| dx. Primes are
taken by xi = x/l here: the length cancels. Limits: |r'| > 0; in space no torsion, and the rest shape is straight (a cable
without torsion has no material frame that could carry a rest curvature along).
Sources: Escalona, Hussien and Shabana (1998) for the element; Gerstmayr and Irschik (2008), J. Sound Vib. 318, for these strains.
"""

from __future__ import annotations

import numpy as np

from mbd.affine import Array

from .shapes import gauss, hermite_bend, hermite_slope


def _cross_planar(x: Array, y: Array) -> Array:
    return (x[..., 0, :] * y[..., 1, :] - x[..., 1, :] * y[..., 0, :])[..., None, :]


def _cross_spatial(x: Array, y: Array) -> Array:
    a, b, c = x[..., 0, :], x[..., 1, :], x[..., 2, :]
    u, v, w = y[..., 0, :], y[..., 1, :], y[..., 2, :]
    return np.stack((b * w - c * v, c * u - a * w, a * v - b * u), axis=-2)


def _turned(x: Array, s: Array) -> Array:
    """x cross s for a moment s about the plane's normal [..., 1, g]."""
    return np.stack((x[..., 1, :] * s[..., 0, :], -x[..., 0, :] * s[..., 0, :]), axis=-2)


def _skew(s: Array) -> Array:
    """E [..., d, d, g] with E y = y cross s."""
    if s.shape[-2] == 1:
        e = np.zeros((*s.shape[:-2], 2, 2, s.shape[-1]))
        e[..., 0, 1, :], e[..., 1, 0, :] = s[..., 0, :], -s[..., 0, :]
        return e
    e = np.zeros((*s.shape[:-2], 3, 3, s.shape[-1]))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        e[..., i, j, :], e[..., j, i, :] = s[..., k, :], -s[..., k, :]
    return e


class Continuum:
    """The kernel of all cables with one number of Gauss points.

    nodes [n, d, 4] indices of the nodal vectors' components, length [n], rest_tangent and rest_bend [n, d, 4] the reference shape's
    nodal vectors, EA, EI [n] and damping [n] (relaxation time [s]).
    """

    def __init__(self, points: int, *, nodes: np.ndarray, length: Array, rest: Array, EA: Array, EI: Array, damping: Array):
        xi, weight = gauss(points)
        self.shape = np.concatenate((hermite_slope(xi), hermite_bend(xi)), axis=1)
        self.points, self.items, self.dimension = points, len(nodes), nodes.shape[1]
        self.nodes, self.dofs = nodes, nodes.reshape(len(nodes), -1)
        one = np.ones_like(length)
        self.scale = np.stack((one, length, one, length), axis=1)[:, None, :]
        self.components = 1 if self.dimension == 2 else 3
        self._cross = _cross_planar if self.dimension == 2 else _cross_spatial
        self._turn = _turned if self.dimension == 2 else _cross_spatial
        self.m = points * (1 + self.components)
        self.rest_length = np.ones((self.items, points))
        self.rest_curvature = np.zeros((self.items, self.components, points))
        at_rest = ContinuumAt(self, rest)
        self.rest_length = at_rest.stretched[..., 0, :] * 1.0
        self.rest_curvature = ContinuumAt(self, rest).curvature if self.dimension == 2 else self.rest_curvature
        arc = weight * self.rest_length
        bending = np.repeat((EI[:, None] * arc)[:, None, :], self.components, axis=1).reshape(self.items, -1)
        self.modulus = np.concatenate((EA[:, None] * arc, bending), axis=1)
        self.viscosity = damping[:, None] * self.modulus
        pairs = self.shape.reshape(4, 2, points)
        self._pairs = np.einsum("apg,bqg->gpqab", pairs, pairs).reshape(points * 4, 16)

    def at(self, q: Array) -> ContinuumAt:
        return ContinuumAt(self, q[..., self.nodes])


class ContinuumAt:
    """The cables at configurations [...]: strains, and their first and second derivatives."""

    def __init__(self, kernel: Continuum, nodal: Array):
        self.kernel = k = kernel
        w = (nodal * k.scale) @ k.shape
        self.x, self.y = w[..., : k.points], w[..., k.points :]
        self.square = np.einsum("...ig,...ig->...g", self.x, self.x)[..., None, :]
        self.stretched = np.sqrt(self.square)
        self.rest = k.rest_length[:, None, :]
        self.per = 1.0 / (self.square * self.rest)
        self.curvature = k._cross(self.x, self.y) * self.per

    @property
    def value(self) -> Array:
        """[..., n, m]: the stretches, then the curvatures component by component."""
        k = self.kernel
        stretch = self.stretched / self.rest - 1.0
        bend = self.curvature - k.rest_curvature
        return np.concatenate((stretch, bend), axis=-2).reshape(*bend.shape[:-3], k.items, k.m)

    def _split(self, stress: Array) -> tuple[Array, Array]:
        k = self.kernel
        s = stress.reshape(*stress.shape[:-1], 1 + k.components, k.points)
        return s[..., :1, :], s[..., 1:, :]

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 4 d] from sigma [..., n, m]."""
        k = self.kernel
        axial, moment = self._split(stress)
        turning = moment * self.per
        along = axial / (self.stretched * self.rest) - 2.0 * np.sum(moment * self.curvature, axis=-2, keepdims=True) / self.square
        force = np.concatenate((along * self.x + k._turn(self.y, turning), -k._turn(self.x, turning)), axis=-1)
        return ((force @ k.shape.T) * k.scale).reshape(*force.shape[:-2], -1)

    def push(self, change: Array) -> Array:
        """B dq [..., n, m] from dq [..., n_coordinates]."""
        k = self.kernel
        w = (change[..., k.nodes] * k.scale) @ k.shape
        dx, dy = w[..., : k.points], w[..., k.points :]
        along = np.einsum("...ig,...ig->...g", self.x, dx)[..., None, :]
        stretch = along / (self.stretched * self.rest)
        bend = (k._cross(dx, self.y) + k._cross(self.x, dy)) * self.per - 2.0 * self.curvature * along / self.square
        both = np.concatenate((stretch, bend), axis=-2)
        return both.reshape(*both.shape[:-2], k.m)

    def _slopes(self) -> tuple[Array, Array]:
        """Gradients of the strains by (r', r''): [..., n, c, 2 d, g], c = 1 (stretch) + components."""
        k = self.kernel
        stretch = np.concatenate((self.x / (self.stretched * self.rest), np.zeros_like(self.x)), axis=-2)[..., None, :, :]
        unit = np.broadcast_to(np.eye(k.components)[..., None], (*self.x.shape[:-2], k.components, k.components, k.points))
        bends = []
        for c in range(k.components):
            s = unit[..., c, :, :] * self.per
            by_x = k._turn(self.y, s) - 2.0 * self.curvature[..., c : c + 1, :] * self.x / self.square
            bends.append(np.concatenate((by_x, -k._turn(self.x, s)), axis=-2))
        return stretch, np.stack(bends, axis=-3)

    def _curve(self, axial: Array, moment: Array) -> Array:
        """sigma . d2(strain) by (r', r''): [..., n, 2 d, 2 d, g]."""
        d = self.kernel.dimension
        x, square = self.x, self.square
        xx = x[..., :, None, :] * x[..., None, :, :]
        eye = np.eye(d)[..., None]
        wide = square[..., None, :]
        s = moment * self.per
        yy, xs = self.kernel._turn(self.y, s), -self.kernel._turn(x, s)
        work = np.sum(moment * self.curvature, axis=-2, keepdims=True)[..., None, :]
        a = (axial / (self.stretched * self.rest))[..., None, :]
        h_xx = a * (eye - xx / wide) - 2.0 * (yy[..., :, None, :] * x[..., None, :, :] + x[..., :, None, :] * yy[..., None, :, :]) / wide
        h_xx = h_xx - 2.0 * work * eye / wide + 8.0 * work * xx / wide**2
        h_xy = _skew(s) - 2.0 * x[..., :, None, :] * xs[..., None, :, :] / wide
        h = np.zeros((*x.shape[:-2], 2 * d, 2 * d, x.shape[-1]))
        h[..., :d, :d, :], h[..., :d, d:, :] = h_xx, h_xy
        h[..., d:, :d, :] = np.swapaxes(h_xy, -3, -2)
        return h

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, 4 d, 4 d]."""
        k, d = self.kernel, self.kernel.dimension
        axial, moment = self._split(stress)
        stiff, bend_stiff = self._split(np.broadcast_to(modulus, stress.shape))
        stretch, bend = self._slopes()
        slopes = np.concatenate((stretch, bend), axis=-3)
        weighted = slopes * np.concatenate((stiff, bend_stiff), axis=-2)[..., None, :]
        h = self._curve(axial, moment) + np.einsum("...cig,...cjg->...ijg", weighted, slopes)
        h = np.moveaxis(h.reshape(*h.shape[:-3], 2, d, 2, d, k.points), (-5, -4, -3, -2, -1), (-2, -5, -1, -4, -3))
        full = (h.reshape(*h.shape[:-3], 4 * k.points) @ k._pairs).reshape(*h.shape[:-3], 4, 4)
        full = np.swapaxes(full, -3, -2) * (k.scale[..., 0, :, None, None] * k.scale[..., 0, None, None, :]).reshape(k.items, 1, 4, 1, 4)
        return full.reshape(*full.shape[:-4], 4 * d, 4 * d)

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., n, m, 4 d]: what damping adds to the tangent."""
        k = self.kernel
        w = (v[..., k.nodes] * k.scale) @ k.shape
        rate = np.concatenate((w[..., : k.points], w[..., k.points :]), axis=-2)
        rows = []
        for c in range(1 + k.components):
            unit = np.zeros((1 + k.components, k.points))
            unit[c] = 1.0
            shape = (*self.x.shape[:-2], 1 + k.components, k.points)
            unit = np.broadcast_to(unit, shape)
            rows.append(np.einsum("...ijg,...jg->...ig", self._curve(unit[..., :1, :], unit[..., 1:, :]), rate))
        d = k.dimension
        by = np.stack(rows, axis=-3).reshape(*self.x.shape[:-2], 1 + k.components, 2, d, k.points)
        out = np.einsum("...cpig,apg->...cgia", by, k.shape.reshape(4, 2, k.points)) * k.scale[:, None, None]
        return out.reshape(*out.shape[:-4], k.m, 4 * d)

    def energy(self) -> Array:
        """[...]: of all cables together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))
