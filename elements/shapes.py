"""Cubic Hermite functions of a two-node element and Gauss quadrature on [0, 1].

Nodal vectors are ordered (r_0, l r'_0, r_1, l r'_1): slopes scaled by the element's length l, so that the functions depend on
xi = x / l alone. Escalona, Hussien and Shabana (1998), eq. 1.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def hermite(xi: ArrayLike) -> Array:
    """N [4, n_xi]."""
    x = np.asarray(xi, dtype=float)
    return np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])


def hermite_slope(xi: ArrayLike) -> Array:
    """dN/dxi [4, n_xi]."""
    x = np.asarray(xi, dtype=float)
    return np.array([6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])


def hermite_bend(xi: ArrayLike) -> Array:
    """d2N/dxi2 [4, n_xi]."""
    x = np.asarray(xi, dtype=float)
    return np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])


@cache
def gauss(points: int) -> tuple[Array, Array]:
    """Points and weights on [0, 1]: exact for polynomials up to degree 2 points - 1."""
    x, w = np.polynomial.legendre.leggauss(points)
    return 0.5 * (x + 1.0), 0.5 * w


MASS = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0
"""int N N' dxi: the mass matrix of a unit element, eq. 8."""

WEIGHT = np.array([1 / 2, 1 / 12, 1 / 2, -1 / 12])
"""int N dxi: distributed gravity, eq. 27."""

WEIGHT_LUMPED = np.array([1 / 2, 1 / 8, 1 / 2, -1 / 8])
"""N(1/2): the weight concentrated at midspan, eq. 28."""
