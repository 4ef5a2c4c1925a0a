"""Strains of the 1998 element: small strains seen from the frame of the element's chord. Planar, straight at rest.

    d = r_A - r_O,  i = d/|d|,  j = k x i                                  chord frame, eqs. 14-17
    u = i . e, w = j . e (nodal 4-vectors),  u_l' = N' u - 1,  u_t'' = N'' w     eq. 18
    U = 1/2 int EA u_l'^2 + EI u_t''^2 dx

u_l' is quadratic and u_t'' linear in x, so 3 and 2 Gauss points integrate the energy exactly: these five strains are the shape
integrals A_ij, B_ij, A_i of eq. 24. Gradients and curvatures include the frame's rotation t = d theta/de,
    di/de = j t',  dj/de = -i t',  dt/de = -(1/|d|^2) G' (i j' + j i') G,  G = d(d)/de.
Limits: |d| > 0; strains and curvatures small within one element; converges to EA (|r'| - 1)^2 + EI (r' x r''/|r'|)^2.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from mbd.affine import Array

from .shapes import gauss, hermite_bend, hermite_slope

END = np.array([-1.0, 0.0, 1.0, 0.0])
"""The chord from nodal 4-vectors: d = END . X."""


class LocalFrame:
    """The kernel of all chord-frame cables. Arguments as of ``PlanarContinuum``, without rest shape."""

    def __init__(self, *, nodes: np.ndarray, length: Array, EA: Array, EI: Array, damping: Array):
        (xi_a, weight_a), (xi_b, weight_b) = gauss(3), gauss(2)
        self.nodes, self.dofs = nodes, nodes.reshape(len(nodes), -1)
        self.items, self.m = len(nodes), 5
        one = np.ones_like(length)
        scale = np.stack((one, length, one, length), axis=1)[:, None, :]
        self.axial = hermite_slope(xi_a).T * scale / length[:, None, None]
        self.bending = hermite_bend(xi_b).T * scale / length[:, None, None] ** 2
        self.modulus = np.concatenate(((EA * length)[:, None] * weight_a, (EI * length)[:, None] * weight_b), axis=1)
        self.viscosity = damping[:, None] * self.modulus

    def at(self, q: Array) -> LocalFrameAt:
        return LocalFrameAt(self, q[..., self.nodes])


class LocalFrameAt:
    """The elements at configurations [...]. Local coordinates are ordered (X [4], Y [4])."""

    def __init__(self, kernel: LocalFrame, nodal: Array):
        self.kernel = kernel
        self.chord = nodal @ END
        self.length = np.sqrt(np.sum(self.chord**2, axis=-1))
        self.i = self.chord / self.length[..., None]
        ix, iy = self.i[..., 0, None], self.i[..., 1, None]
        x, y = nodal[..., 0, :], nodal[..., 1, :]
        self.u, self.w = ix * x + iy * y, ix * y - iy * x
        self.turn = np.concatenate((-iy * END, ix * END), axis=-1) / self.length[..., None]

    @property
    def value(self) -> Array:
        """[..., n, 5]: u_l' at three points, u_t'' at two."""
        axial = (self.kernel.axial @ self.u[..., None])[..., 0] - 1.0
        return np.concatenate((axial, (self.kernel.bending @ self.w[..., None])[..., 0]), axis=-1)

    def _along(self, x: Array) -> Array:
        """i . x, back in X, Y: the transpose of u's map for the frame held fixed."""
        return np.concatenate((self.i[..., 0, None] * x, self.i[..., 1, None] * x), axis=-1)

    def _across(self, x: Array) -> Array:
        return np.concatenate((-self.i[..., 1, None] * x, self.i[..., 0, None] * x), axis=-1)

    def _nodal(self, stress: Array) -> tuple[Array, Array]:
        """The stresses on u and w [..., n, 4]."""
        k = self.kernel
        return (stress[..., None, :3] @ k.axial)[..., 0, :], (stress[..., None, 3:] @ k.bending)[..., 0, :]

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, 8]; the term with the frame's rotation makes it a gradient."""
        on_u, on_w = self._nodal(stress)
        moment = np.sum(on_u * self.w - on_w * self.u, axis=-1, keepdims=True)
        return self._along(on_u) + self._across(on_w) + moment * self.turn

    def push(self, change: Array) -> Array:
        """B dq [..., n, 5]."""
        nodal = change[..., self.kernel.nodes]
        ix, iy = self.i[..., 0, None], self.i[..., 1, None]
        x, y = nodal[..., 0, :], nodal[..., 1, :]
        angle = np.sum(self.turn * nodal.reshape(*nodal.shape[:-2], 8), axis=-1, keepdims=True)
        du, dw = ix * x + iy * y + self.w * angle, ix * y - iy * x - self.u * angle
        return np.concatenate(((self.kernel.axial @ du[..., None])[..., 0], (self.kernel.bending @ dw[..., None])[..., 0]), axis=-1)

    def _maps(self) -> tuple[Array, Array]:
        """du/de and dw/de [..., n, 4, 8]."""
        eye = np.eye(4)
        ix, iy = self.i[..., 0, None, None], self.i[..., 1, None, None]
        along, across = np.concatenate((ix * eye, iy * eye), axis=-1), np.concatenate((-iy * eye, ix * eye), axis=-1)
        turn = self.turn[..., None, :]
        return along + self.w[..., None] * turn, across - self.u[..., None] * turn

    @cached_property
    def gradient(self) -> Array:
        """B [..., n, 5, 8]."""
        du, dw = self._maps()
        return np.concatenate((self.kernel.axial @ du, self.kernel.bending @ dw), axis=-2)

    def _curve(self, stress: Array) -> Array:
        """sigma . d2(strain)/de2 [..., n, 8, 8]."""
        on_u, on_w = self._nodal(stress)
        side = self._across(on_u) - self._along(on_w)
        moment = np.sum(on_u * self.w - on_w * self.u, axis=-1)[..., None, None]
        inward = np.sum(on_u * self.u + on_w * self.w, axis=-1)[..., None, None]
        turn = self.turn
        by_i, by_j = self._along(END), self._across(END)
        bend = -(by_i[..., :, None] * by_j[..., None, :] + by_j[..., :, None] * by_i[..., None, :]) / self.length[..., None, None] ** 2
        mixed = side[..., :, None] * turn[..., None, :]
        return mixed + np.swapaxes(mixed, -1, -2) - inward * turn[..., :, None] * turn[..., None, :] + moment * bend

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        """B' diag(modulus) B + sigma . d2(strain) [..., n, 8, 8]."""
        b = self.gradient
        return np.swapaxes(b, -1, -2) @ (modulus[..., :, None] * b) + self._curve(stress)

    def swirl(self, v: Array) -> Array:
        """d(B v)/dq [..., n, 5, 8]."""
        rate = v[..., self.kernel.dofs]
        rows = []
        for c in range(5):
            unit = np.zeros((*self.u.shape[:-1], 5))
            unit[..., c] = 1.0
            rows.append((self._curve(unit) @ rate[..., None])[..., 0])
        return np.stack(rows, axis=-2)

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., n, 5]."""
        return (self.swirl(v) @ change[..., self.kernel.dofs][..., None])[..., 0]

    def energy(self) -> Array:
        """[...]: of all elements together."""
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))
