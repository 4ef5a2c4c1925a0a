"""Bending shapes of a uniform thin beam clamped at xi = 0, by a mesh of cubic elements: vibration modes, or those of Craig and Bampton.

    K V = M V diag(k) / m,   V' M V = I / 4 = m I        M, K: int w w, int w'' w'' over [0, 1]; the frequency is 2 sqrt(k EI / rho A) / length^2

"cantilever": the modes with a free end, whose bending moment is zero there. "craig_bampton" (1968, AIAA J. 6): the static shapes
of a displaced and of a turned end, xi^2 and xi^3, and modes with that end clamped too, for an end that carries moments; Ritz's method in their
space makes them orthogonal. With int w^2 = 1/4 the free end of a mode deflects by about 1, upwards by choice of sign.
"""

from __future__ import annotations

import numpy as np

from mbd.affine import Array

from .shapes import gauss, hermite, hermite_bend, hermite_slope

POINTS = 6
"""Gauss points of an element: exact for the products of shapes and weights below, up to degree 11."""


class BendingModes:
    """Shapes [m] of a mesh of m elements (half of what it has; the others are the mesh's own): ``stiffness`` int w''^2 and integrals."""

    def __init__(self, elements: int, kind: str):
        self.elements = elements
        xi, weight = gauss(POINTS)
        self.points = ((np.arange(elements)[:, None] + xi) / elements).ravel(), np.tile(weight / elements, elements)
        self.nodal = np.eye(2 * elements + 2)[:, 2:]  # all shapes that are zero at the clamp, deflection and slope of each node
        if kind == "craig_bampton":
            self.nodal = self._ritz(self.nodal[:, :-2], max(elements - 2, 0))[0] if elements > 1 else self.nodal[:, :0]
            x = np.arange(elements + 1) / elements
            self.nodal = np.column_stack((*(np.column_stack((x**p, p * x ** (p - 1))).ravel() for p in (2, 3)), self.nodal))
        self.nodal, self.stiffness = self._ritz(self.nodal, max(elements, 2 * (kind == "craig_bampton")))

    def _ritz(self, shapes: Array, count: int) -> tuple[Array, Array]:
        """The lowest modes in the space of nodal shapes [2 n + 2, k]: theirs [2 n + 2, count], and int w''^2 [count]."""
        self.nodal = shapes
        mass, stiffness = (self._products(self.shape(self.points[0], k), np.ones_like(self.points[0])) for k in (0, 2))
        inverse = np.linalg.inv(np.linalg.cholesky(mass))
        values, vectors = np.linalg.eigh(inverse @ stiffness @ inverse.T)
        found = 0.5 * shapes @ inverse.T @ vectors[:, :count]
        return found * np.where(found[-2] < 0.0, -1.0, 1.0), 0.25 * values[:count]

    def shape(self, xi: Array | float, derivative: int = 0) -> Array:
        """d^k w / dxi^k [m, n_xi]."""
        x = np.atleast_1d(np.asarray(xi, dtype=float)) * self.elements
        element = np.minimum(x.astype(int), self.elements - 1)
        functions = (hermite, hermite_slope, hermite_bend)[derivative](x - element)
        scale = np.array([1.0, 1.0, 1.0, 1.0]) * float(self.elements) ** derivative
        scale[1::2] /= self.elements
        values = self.nodal[2 * element[:, None] + np.arange(4)]
        return np.einsum("xam,ax->mx", values, functions * scale[:, None])

    def _products(self, shapes: Array, share: Array) -> Array:
        product = (shapes * (self.points[1] * share)) @ shapes.T
        return 0.5 * (product + product.T)

    def shortening(self, kind: str) -> Array:
        """[m, m]: q' K q / 2 of the deflection q_k w_k is, for u(xi) = 1/2 int_0^xi w'^2: its mean, twice its first moment, or its end value."""
        x = self.points[0]
        share = {"mean": 1.0 - x, "moment": 1.0 - x**2, "end": np.ones_like(x)}[kind]
        return self._products(self.shape(x, 1), share)
