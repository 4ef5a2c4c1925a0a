"""Bending modes of a uniform thin beam clamped at xi = 0 and free at xi = 1: of a mesh of cubic elements.

    K V = M V diag(b^4) / 4,   V' M V = I / 4        M, K: int w w, int w'' w'' over [0, 1]; the frequency is b^2 sqrt(EI / rho A) / length^2

With int w^2 = 1/4 the free end deflects by about 1 (of the continuous beam by exactly 1), upwards by choice of sign.
"""

from __future__ import annotations

import numpy as np

from mbd.affine import Array

from .shapes import gauss, hermite, hermite_bend, hermite_slope

POINTS = 6
"""Gauss points of an element: exact for the products of shapes and weights below, up to degree 11."""


class BendingModes:
    """The lowest modes [m] of a mesh of m elements (half of all; the others are the mesh's own): ``stiffness`` int w''^2, shapes, integrals."""

    def __init__(self, elements: int):
        self.elements = elements
        xi, weight = gauss(POINTS)
        self.points = ((np.arange(elements)[:, None] + xi) / elements).ravel(), np.tile(weight / elements, elements)
        self.nodal = np.eye(2 * elements + 2)[:, 2:]  # all shapes that are zero at the clamp, deflection and slope of each node
        mass, stiffness = (self._products(self.shape(self.points[0], k), np.ones_like(self.points[0])) for k in (0, 2))
        lower = np.linalg.cholesky(mass)
        inverse = np.linalg.inv(lower)
        values, vectors = np.linalg.eigh(inverse @ stiffness @ inverse.T)
        shapes = 0.5 * self.nodal @ inverse.T @ vectors[:, :elements]
        self.nodal, self.stiffness = shapes * np.sign(shapes[-2]), 0.25 * values[:elements]

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
