"""The linearised equations in minimal coordinates: dq = Z x with G Z = 0.

    Z' M Z x'' + Z' D Z x' + Z' K Z x = Z' f       Z: an orthonormal basis of the null space of G in scaled unknowns (``linear.py``)

K holds the curvature of the joints under their multipliers, so that this is exact to first order (Haug 1989, sec. 8).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .formats import dense
from .linear import Linear
from .start import REDUNDANT, scaled_gradient
from .system import Array, Index, System


class Minimal(NamedTuple):
    """Z [n, r], and M, D, K [r, r]."""

    basis: Array
    mass: Array
    damping: Array
    stiffness: Array


def minimal_form(system: System, linear: Linear, q: Array, stiffness: Array, damping: Array | None) -> Minimal:
    """At a configuration q, with values of K and D on the system's patterns."""
    basis = null_basis(system, linear, q)

    def project(rows: Index, cols: Index, values: Array) -> Array:
        return basis.T @ dense(rows, cols, values, (system.n, system.n)) @ basis

    mass = project(system.mass_rows, system.mass_cols, system.mass_values)
    rate = np.zeros_like(mass) if damping is None else project(system.damping_rows, system.damping_cols, damping)
    return Minimal(basis, 0.5 * (mass + mass.T), rate, project(system.stiffness_rows, system.stiffness_cols, stiffness))


def null_basis(system: System, linear: Linear, q: Array) -> Array:
    """Z [n, r]."""
    scale = linear.scale[: system.n]
    if not system.m:
        return np.diag(scale)
    _, sizes, right = np.linalg.svd(scaled_gradient(system, linear, q))
    rank = int(np.sum(sizes > REDUNDANT * sizes[0]))
    return scale[:, None] * right[rank:].T
