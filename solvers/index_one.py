"""Accelerations where the mass matrix is diagonal: the multipliers' own equations, half the size of the KKT matrix.

    S lambda = G M^-1 f + v' d2g/dq2 v - c'',    S = G M^-1 G',    a = M^-1 (f - G' lambda)

S is symmetric and positive definite; its entries are sums over pairs of entries of G in one column, listed once. Rigid bodies about
their principal axes and particles have diagonal M; other systems, redundant joints and massless coordinates take the KKT matrix.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lapack

from .formats import Singular
from .linear import Linear
from .ordering import half_bandwidth, reverse_cuthill_mckee
from .start import accelerations, mass_factor
from .system import Array, Index, System, targets

NEARLY_SINGULAR = 1e-9
"""Squared ratio of the smallest to the largest pivot of the scaled S below which the multipliers are no longer trusted."""

DENSE_UP_TO = 40


def index_one(system: System, linear: Linear) -> NormalEquations | KktEquations:
    """The cheaper way to the accelerations of a system."""
    diagonal = np.array_equal(system.mass_rows, system.mass_cols) and np.all(np.bincount(system.mass_rows, minlength=system.n) == 1)
    regular = diagonal and not linear.softened and bool((system.mass_values > 0.0).all()) and system.m > 0
    return NormalEquations(system) if regular else KktEquations(system, linear)


class KktEquations:
    """Through the KKT matrix of the mass: any system."""

    def __init__(self, system: System, linear: Linear):
        self.system, self.linear = system, linear

    def solve(self, q: Array, v: Array, inputs: Any) -> tuple[Array, Array]:
        """a [n], multipliers [m]; raises Singular."""
        return accelerations(self.system, mass_factor(self.system, self.linear, q), q, v, inputs)


class NormalEquations:
    """Through S = G M^-1 G', by Cholesky factors, dense or band."""

    def __init__(self, system: System):
        self.system, joints = system, system.joints
        self.inverse = np.empty(system.n)
        self.inverse[system.mass_rows] = 1.0 / system.mass_values
        self.root = np.sqrt(self.inverse)[joints.cols]
        left, right = _pairs(joints.cols, joints.rows)
        rows, cols = joints.rows[left], joints.rows[right]
        order = reverse_cuthill_mckee(rows, cols, system.m)
        self.place = np.argsort(order)
        self.half = half_bandwidth(rows, cols, order)
        self.band = system.m > DENSE_UP_TO and 3 * self.half < system.m
        i, j = self.place[rows], self.place[cols]
        lower = i >= j
        self.left, self.right = left[lower], right[lower]
        self.height = self.half + 1 if self.band else system.m
        self.slots = (j * self.height + (i - j if self.band else i))[lower]
        self.size = system.m * self.height
        self.order = order

    def solve(self, q: Array, v: Array, inputs: Any) -> tuple[Array, Array]:
        """a [n], multipliers [m]; raises Singular where S nearly is."""
        system = self.system
        force = system.load(q, v, inputs)
        if system.n_stresses:
            strains = system.strains(q)
            force = force - strains.pull(system.stress(strains, v))
        joints = system.joints.at(q)
        free = self.inverse * force
        right = joints.push(free) + joints.bias(v) - targets(inputs).acceleration
        multipliers = self._solve(joints.gradient * self.root, right)
        return free - self.inverse * joints.pull(multipliers), multipliers

    def _solve(self, scaled: Array, right: Array) -> Array:
        buffer = np.bincount(self.slots, scaled[self.left] * scaled[self.right], minlength=self.size).reshape(-1, self.height).T
        if self.band:
            factor, info = lapack.dpbtrf(buffer, lower=1, overwrite_ab=1)
            pivots = factor[0]
        else:
            factor, info = lapack.dpotrf(buffer, lower=1, clean=0, overwrite_a=1)
            pivots = factor.diagonal()
        if info or not (pivots.min() / pivots.max()) ** 2 > NEARLY_SINGULAR:
            raise Singular("joints in a nearly singular position")
        solve = lapack.dpbtrs if self.band else lapack.dpotrs
        return solve(factor, right[self.order], lower=1)[0][self.place]


def _pairs(columns: Index, rows: Index) -> tuple[Index, Index]:
    """All ordered pairs of entries that share a column."""
    order = np.argsort(columns, kind="stable")
    sizes = np.bincount(columns)
    starts = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    size, start = sizes[columns[order]], starts[columns[order]]
    left = np.repeat(order, size)
    offset = np.arange(left.size) - np.repeat(np.cumsum(size) - size, size)
    return left, order[np.repeat(start, size) + offset]
