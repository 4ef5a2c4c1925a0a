"""The linearised equations in minimal coordinates: dq = Z x with G Z = 0.

    Z' M Z x'' + Z' D Z x' + Z' K Z x = Z' f       Z: an orthonormal basis of the null space of G in scaled unknowns (``linear.py``)

K holds the curvature of the joints under their multipliers, so that this is exact to first order (Haug 1989, sec. 8).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .linear import Linear
from .start import REDUNDANT
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
        out = np.zeros((basis.shape[1], basis.shape[1]))
        if rows.size:
            full = np.zeros((system.n, system.n))
            np.add.at(full, (rows, cols), values)
            out = basis.T @ full @ basis
        return out

    none = np.zeros(0)
    mass = project(system.mass_rows, system.mass_cols, system.mass_values)
    rate = none if damping is None else damping
    rows, cols = (none.astype(np.intp),) * 2 if damping is None else (system.damping_rows, system.damping_cols)
    return Minimal(basis, 0.5 * (mass + mass.T), project(rows, cols, rate), project(system.stiffness_rows, system.stiffness_cols, stiffness))


def null_basis(system: System, linear: Linear, q: Array) -> Array:
    """Z [n, r]."""
    scale = linear.scale[: system.n]
    if not system.m:
        return np.diag(scale)
    scaled = np.zeros((system.m, system.n))
    np.add.at(scaled, (system.joints.rows, system.joints.cols), system.joints.at(q).gradient)
    scaled *= linear.scale[system.n :, None] * scale
    _, sizes, right = np.linalg.svd(scaled)
    rank = int(np.sum(sizes > REDUNDANT * sizes[0]))
    return scale[:, None] * right[rank:].T
