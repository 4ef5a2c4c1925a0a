"""The motion of a system in all its coordinates where the mass matrix is diagonal: by the multipliers' own equations, half the size of the
KKT matrix:

    S lambda = G M^-1 f + v' d2g/dq2 v - c'',    S = G M^-1 G',    a = M^-1 (f - G' lambda)

S is symmetric and positive definite; its entries are sums over pairs of entries of G in one column, listed once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lapack

from .formats import Singular
from .linear import Linear
from .ordering import half_bandwidth, reverse_cuthill_mckee
from .places import least_share
from .start import floor_of, settle
from .system import Array, Index, JointsAt, System, targets
from .whole import Rates, Whole

DENSE_UP_TO = 40
"""Equations up to which S is factorised dense whatever its pattern."""


class Normal(Whole):
    """Through S = G M^-1 G', by Cholesky factors, dense or band."""

    @staticmethod
    def serves(system: System) -> bool:
        """Whether there are joints, and M is diagonal and positive."""
        lone = np.array_equal(system.mass_rows, system.mass_cols) and np.all(np.bincount(system.mass_rows, minlength=system.n) == 1)
        return bool(system.m > 0 and lone and (system.mass_values > 0.0).all())

    def __init__(self, system: System, linear: Linear):
        super().__init__(system, linear)
        joints = system.joints
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
        self.height = self.half + 1 if self.band else system.m
        self.size = system.m * self.height
        self.order = order
        slots = j * self.height + (i - j if self.band else i)
        self._compile(joints, linear.origin, left[lower], right[lower], slots[lower])

    def _compile(self, joints: Any, q: Array, left: Index, right: Index, slots: Index) -> None:
        """The pairs of entries of G that vary, and the sums of the others: all, and without those of a position's equation and a nonholonomic one."""
        slips, constant_rows = np.isin(joints.rows, joints.slips), joints.constant_rows[joints.rows]
        alike = (slips[left] == slips[right]).astype(float)
        constant = constant_rows[left] & constant_rows[right]
        self.left, self.right, self.slots, self.alike = left[~constant], right[~constant], slots[~constant], alike[~constant]
        scaled = joints.at(q).gradient * self.root
        pairs = (scaled[left] * scaled[right])[constant]
        self.fixed = [np.bincount(slots[constant], pairs * weights, minlength=self.size) for weights in (1.0, alike[constant])]

    def rates(self, system: System, w: Array, t: float) -> Rates:
        """What follows from a state. Raises Singular where S is."""
        joints = system.joints.at(w[0])
        return self._finish(system, w, t, joints, *self._factor(joints))

    def land(self, system: System, w: Array, t: float) -> Rates:
        """Moves w to the joints, in place, and goes on as ``rates``; raises Inconsistent where it finds none near."""
        goal, start = targets(system.inputs(t)), system.joints.at(w[0])
        near, _ = self._factor(start, apart=bool(system.joints.slips.size))

        def correction(gap: Array) -> Array:
            return self.inverse * start.pull(self._solve(near, gap))

        w[0] = settle(w[0], lambda q: system.joints.at(q).value - goal.value, correction, self.linear.reach, floor_of(system, w[0]))
        joints = system.joints.at(w[0])
        factor, share = self._factor(joints)
        w[1] -= self.inverse * joints.pull(self._solve(factor, joints.push(w[1]) - goal.rate))
        return self._finish(system, w, t, joints, factor, share)

    def _finish(self, system: System, w: Array, t: float, joints: JointsAt, factor: Array, share: float) -> Rates:
        inputs = system.inputs(t)
        free = self.inverse * system.force(w[0], w[1], inputs)
        multipliers = self._solve(factor, joints.push(free) + joints.bias(w[1]) - targets(inputs).acceleration)
        return Rates(free - self.inverse * joints.pull(multipliers), multipliers, share)

    def _factor(self, joints: JointsAt, apart: bool = False) -> tuple[Array, float]:
        """The Cholesky factor of S, and the share it leaves; ``apart``: without what couples positions' equations with nonholonomic ones. Raises
        Singular."""
        scaled = joints.gradient * self.root
        pairs = scaled.take(self.left) * scaled.take(self.right)
        summed: Any = np.bincount(self.slots, pairs * self.alike if apart else pairs, minlength=self.size)  # floats, whatever the stub says
        values = summed + self.fixed[apart]
        buffer = values.reshape(-1, self.height).T
        sizes = (buffer[0] if self.band else buffer.diagonal()).copy()
        if self.band:
            factor, info = lapack.dpbtrf(buffer, lower=1, overwrite_ab=1)
            pivots = factor[0]
        else:
            factor, info = lapack.dpotrf(buffer, lower=1, clean=0, overwrite_a=1)
            pivots = factor.diagonal()
        if info:
            raise Singular("joints in a nearly singular position")
        return factor, float(least_share(pivots, sizes))

    def _solve(self, factor: Array, right: Array) -> Array:
        solve = lapack.dpbtrs if self.band else lapack.dpotrs
        return solve(factor, right.take(self.order), lower=1, overwrite_b=1)[0].take(self.place)


def _pairs(columns: Index, rows: Index) -> tuple[Index, Index]:
    """All ordered pairs of entries that share a column."""
    order = np.argsort(columns, kind="stable")
    sizes = np.bincount(columns)
    starts = np.concatenate(([0], np.cumsum(sizes)[:-1]))
    size, start = sizes[columns[order]], starts[columns[order]]
    left = np.repeat(order, size)
    offset = np.arange(left.size) - np.repeat(np.cumsum(size) - size, size)
    return left, order[np.repeat(start, size) + offset]
