"""Membrane locking of cubic elements, seen in the result: stretching and bending cannot both be right in a thin beam on a coarse mesh.

An element that bends as a cubic cannot keep its length everywhere; its axial strain fluctuates about what loads ask of it, which is linear
along an element. The energy of this fluctuation against all elastic energy measures the error: a half circle of slenderness 1e2 to 1e5 on
8 to 128 elements is off by 3 to 10 times this share of its radius, wherever locking is most of the error.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .shapes import hermite_bend, hermite_slope

Array = NDArray[np.float64]

LOCKED = 2e-3
"""The share of the elastic energy from which on there is a doubt: about 1 % of error."""

TIMES = 32
"""States of a run that are looked at, at most."""

GAUSS, WEIGHTS = (0.5 * (x + i) for x, i in zip(np.polynomial.legendre.leggauss(5), (1.0, 0.0)))
LINEAR = np.stack((np.ones(5), np.sqrt(3.0) * (2.0 * GAUSS - 1.0)))
"""1 and x, orthonormal on an element."""

SLOPES, SECOND = hermite_slope(GAUSS), hermite_bend(GAUSS)
"""[4, 5] first and second derivatives of the shape functions."""


def locked(cable: Any, q: Array) -> float:
    """The share of fluctuating axial strain in the elastic energy, both at their largest in states q [n_t, n]."""
    c, d = cable.description, cable.rest.shape[-1]
    rows = np.concatenate((cable.rows[:-1], cable.rows[1:]), axis=1)
    chosen = q[np.unique(np.linspace(0, len(q) - 1, TIMES).astype(int))]
    axial, bending = _strains(chosen[:, d * rows[..., None] + np.arange(d)], cable.lengths)
    axial_0, bending_0 = _strains(np.concatenate((cable.rest[:-1], cable.rest[1:]), axis=1)[None], cable.lengths)
    axial, bending = axial - axial_0, bending - bending_0
    fluctuation = axial - np.einsum("tng,pg,g,ph->tnh", axial, LINEAR, WEIGHTS, LINEAR)

    def energy(strain: Array, modulus: float) -> Array:
        return 0.5 * modulus * np.einsum("tng,g,n->t", strain**2, WEIGHTS, cable.lengths)

    stiff, soft = float(c.E * c.A), float(c.E * c.I)
    whole = float(np.max(energy(axial, stiff) + energy(bending, soft)))
    return float(np.max(energy(fluctuation, stiff))) / whole if whole > 0.0 else 0.0


def _strains(nodes: Array, lengths: Array) -> tuple[Array, Array]:
    """Axial strain and curvature [n_t, n, 5] of elements with nodes [n_t, n, 4, d]."""
    scaled = nodes * np.stack((np.ones_like(lengths), lengths, np.ones_like(lengths), lengths), axis=1)[..., None]
    slope = np.einsum("tnkd,kg->tngd", scaled, SLOPES) / lengths[:, None, None]
    second = np.einsum("tnkd,kg->tngd", scaled, SECOND) / lengths[:, None, None] ** 2
    square = np.sum(slope**2, axis=-1)
    if nodes.shape[-1] == 2:
        across = slope[..., 0] * second[..., 1] - slope[..., 1] * second[..., 0]
    else:
        across = np.linalg.norm(np.cross(slope, second), axis=-1)
    return 0.5 * (square - 1.0), across / np.maximum(square, 1e-300)
