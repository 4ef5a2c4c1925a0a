"""Strains of a thin planar ANCF cable: stretch and curvature at Gauss points. The plane is that of the complex numbers, r = x + i y.

    stretch    |r'| / |r0'| - 1                     U = 1/2 int EA stretch^2 + EI curvature^2 ds
    curvature  Im(r'' / r') / |r0'| - its rest value

The curvature is d theta/ds, the rotation of the tangent by reference arc length s; x runs over [0, l] and ds = |r0'| dx. Primes are
taken by xi = x/l here: the length cancels. Limit: |r'| > 0. One product of complex arrays takes the place of four real ones: of a
short cable a call of NumPy costs more than its numbers. For the same reason slopes are kept as x = r'* and y = i r''*: with b = y / x the curvature
is Re(b) / |r0'| - its rest value, and its gradients by r' and r'' are -b / (x |r0'|) and i / (x |r0'|), where i is left to constant matrices.
Sources: Escalona, Hussien and Shabana (1998) for the element; Gerstmayr and Irschik (2008), J. Sound Vib. 318, for these strains.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Array

from .shapes import gauss, hermite_bend, hermite_slope

Complex = NDArray[np.complex128]


class PlanarContinuum:
    """The kernel of all planar cables with one number of Gauss points.

    nodes [n, 2, 4] indices of the nodal vectors' components, length [n], rest [n, 2, 4] the nodal vectors of the shape without stress,
    EA, EI [n] and damping [n] (relaxation time [s]). Strains and stresses are [..., n, 2, g], the stretch before the curvature.
    """

    def __init__(self, points: int, *, nodes: np.ndarray, length: Array, rest: Array, EA: Array, EI: Array, damping: Array):
        xi, weight = gauss(points)
        self.points, self.items = points, len(nodes)
        self.dofs = np.swapaxes(nodes, 1, 2).reshape(len(nodes), 8)
        one = np.ones_like(length)
        scale = np.stack((one, length, one, length), axis=1)
        self.scale = np.repeat(scale, 2, axis=1)
        self.pair_scale = (self.scale[:, :, None] * self.scale[:, None, :]).reshape(-1, 64)
        by_x, by_y = hermite_slope(xi), hermite_bend(xi)
        self.by_x, self.by_y = np.kron(by_x, np.diag((1.0, -1.0))), np.kron(by_y, np.array(((0.0, 1.0), (1.0, 0.0))))
        self._compile(by_x, by_y)
        at_rest = PlanarContinuumAt(self, np.swapaxes(rest, 1, 2).reshape(self.items, 8))
        rest_length = at_rest.size
        self.per_length = 1.0 / rest_length
        self.at_rest = np.stack((np.ones_like(rest_length), at_rest.bend.real * self.per_length), axis=1)
        arc = weight * rest_length
        self.modulus = np.stack((EA[:, None] * arc, EI[:, None] * arc), axis=1)
        self.viscosity = damping[:, None, None] * self.modulus

    def _compile(self, by_x: Array, by_y: Array) -> None:
        """What goes to nodal vectors by one product: ``x_to_nodes`` and ``y_to_nodes`` [2 g, 8] take forces on r' and, over i, on r'' at Gauss points
        there, ``spread`` [6 g, 16 g] ``_gradients`` to B, ``pairs`` [7 g, 64] what ``_curve`` gives to matrices."""
        g, here, plane, turn = self.points, np.eye(self.points), np.eye(2), np.array(((0.0, 1.0), (-1.0, 0.0)))
        self.x_to_nodes, self.y_to_nodes = np.kron(by_x.T, plane), np.kron(by_y.T, turn)
        on_x, on_y = (np.einsum("gh,ag,ij->gihaj", here, by, unit).reshape(2 * g, 8 * g) for by, unit in ((by_x, plane), (by_y, turn)))
        none = np.zeros_like(on_x)
        self.spread = np.block([[on_x, none], [none, on_x], [none, on_y]])
        alike, mixed = (np.einsum("ag,bg->gab", by_x, by) for by in (by_x, by_y))
        real, imaginary = np.diag((1.0, -1.0)), np.array(((0.0, 1.0), (1.0, 0.0)))  # of c, in Re(c* u w)
        terms = ((-0.5 * alike, real, imaginary), (-2.0 * alike, real, imaginary), (-mixed - np.swapaxes(mixed, 1, 2), imaginary, -real))
        by_parts = [np.stack([np.kron(shape, part) for part in parts], axis=1).reshape(2 * g, 64) for shape, *parts in terms]
        self.pairs = np.concatenate((*by_parts, 0.5 * np.kron(alike, plane).reshape(g, 64)))

    def at(self, q: Array) -> PlanarContinuumAt:
        return PlanarContinuumAt(self, q.take(self.dofs, axis=-1))

    def slopes(self, nodal: Array) -> tuple[Complex, Complex]:
        """x and y [..., n, g] from nodal vectors [..., n, 8]; two arrays, as strided halves of one cost more."""
        flat, shape = (nodal * self.scale).reshape(-1, 8), (*nodal.shape[:-1], self.points)
        return flat.dot(self.by_x).view(complex).reshape(shape), flat.dot(self.by_y).view(complex).reshape(shape)

    def real(self, values: Complex) -> Array:
        """[k, 2 g] of complex [..., g], which have the layout of what they were computed from."""
        return np.ascontiguousarray(values).reshape(-1, self.points).view(float)


class PlanarContinuumAt:
    """The cables at configurations [...]: strains, and their first and second derivatives. size = |x|, inverse = 1 / x, bend = y / x [..., n, g]."""

    def __init__(self, kernel: PlanarContinuum, nodal: Array):
        self.kernel = kernel
        x, y = kernel.slopes(nodal)
        self.size = np.abs(x)
        self.inverse = 1.0 / x
        self.bend = y * self.inverse

    @property
    def value(self) -> Array:
        """[..., n, 2, g]."""
        k = self.kernel
        out = np.empty((*self.size.shape[:-1], 2, k.points))
        np.multiply(self.size, k.per_length, out=out[..., 0, :])
        np.multiply(self.bend.real, k.per_length, out=out[..., 1, :])
        out -= k.at_rest
        return out

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 8] from sigma [..., n, 2, g]."""
        k = self.kernel
        on_y = stress[..., 1, :] * k.per_length * self.inverse
        on_x = stress[..., 0, :] * (k.per_length * self.size) * self.inverse
        on_x -= self.bend * on_y
        local = k.real(on_x).dot(k.x_to_nodes)
        local += k.real(on_y).dot(k.y_to_nodes)
        out: Array = local.reshape(*on_x.shape[:-1], 8)
        out *= k.scale
        return out

    def push(self, change: Array) -> Array:
        """B dq [..., n, 2, g] from dq [..., n_coordinates]."""
        k = self.kernel
        dx, dy = k.slopes(change.take(k.dofs, axis=-1))
        stretch = self.inverse * dx
        bend = self.inverse * dy - self.bend * stretch
        return np.stack((stretch.real * (k.per_length * self.size), bend.real * k.per_length), axis=-2)

    @cached_property
    def _gradients(self) -> Complex:
        """Of the stretch by r', of the curvature by r' and, over i, by r'' [..., n, 3, g]."""
        k = self.kernel
        out = np.empty((*self.size.shape[:-1], 3, k.points), dtype=complex)
        np.multiply(self.inverse, k.per_length * self.size, out=out[..., 0, :])
        by_y = np.multiply(self.inverse, k.per_length, out=out[..., 2, :])
        np.multiply(self.bend, -by_y, out=out[..., 1, :])
        return out

    @cached_property
    def gradient(self) -> Array:
        """B [..., n, 2 g, 8]."""
        k = self.kernel
        flat = self._gradients.view(float).reshape(-1, 6 * k.points).dot(k.spread)
        out: Array = flat.reshape(*self.size.shape[:-1], 2 * k.points, 8)
        out *= k.scale[:, None, :]
        return out

    def _curve(self, stress: Array) -> Array:
        """sigma . d2(strain) by changes u of r' and w of r'': e |u|^2 / 2 - Re(c0* u^2 / 2 + 2 c1* u^2 - 2 i c2* u w), as parts of c0, c1, c2,
        then e [k, 7 g]."""
        k = self.kernel
        c = stress.take((0, 1, 1), axis=-2) * self._gradients
        c *= self.inverse[..., None, :]
        even = stress[..., 0, :] * (k.per_length / self.size)
        return np.concatenate((c.reshape(-1, 3 * k.points).view(float), even.reshape(-1, k.points)), axis=-1)

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, 8, 8]."""
        k, gradient = self.kernel, self.gradient
        weighed = modulus.reshape(*modulus.shape[:-2], -1, 1) * gradient
        out = np.swapaxes(gradient, -1, -2) @ weighed
        curve = self._curve(stress).dot(k.pairs).reshape(*self.size.shape[:-1], 64)
        curve *= k.pair_scale
        out += curve.reshape(out.shape)
        return out

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., n, 2, g, 8]: what damping adds to the tangent."""
        k = self.kernel
        vx, vy = k.slopes(v.take(k.dofs, axis=-1))
        unit, square = self.inverse * self.size, self.inverse * self.inverse * k.per_length
        stretch = (vx.conj() - unit * (unit * vx).real) * (k.per_length / self.size)
        on_x, on_y = square * (2.0 * self.bend * vx - vy), -square * vx
        flat = np.stack((stretch, on_x, on_y), axis=-2).view(float).reshape(-1, 6 * k.points).dot(k.spread)
        return flat.reshape(*stretch.shape[:-1], 2, k.points, 8) * k.scale[:, None, None, :]

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., n, 2, g]."""
        return np.sum(self.swirl(v) * change.take(self.kernel.dofs, axis=-1)[..., None, None, :], axis=-1)

    def energy(self) -> Array:
        """[...]: of all cables together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-3, -2, -1))
