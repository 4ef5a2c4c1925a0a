"""Nonholonomic rows A(q) v = 0: sums of one-sided products x(q) dy/dt of affine scalars.

    A_rc = sum x_k dy_k/dq_c        in place of G, though it is the gradient of nothing: gamma is zero at all q
    d(A v)/dq = sum dy_k/dt dx_k/dq,    bias v' dA/dq v = sum dx_k/dt dy_k/dt,    d(A' lambda)/dq = sum lambda dy_k/dq dx_k/dq

Solvers keep these rows at the level of velocities only (``Joints.slips``).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .affine import Array, Scalar
from .scatter import Scatter

SlipRow = list[tuple[Scalar, Scalar]]


class _Forms:
    """Affine scalars [k]: values, rates, and their entries as (scalar, column, coefficient)."""

    def __init__(self, scalars: Sequence[Scalar], n: int):
        self.owner = np.repeat(np.arange(len(scalars)), [s.columns.size for s in scalars])
        self.columns = np.concatenate([s.columns for s in scalars]).astype(np.intp) % n
        self.coefficients = np.concatenate([s.coefficients for s in scalars])
        self.constant = np.array([s.constant for s in scalars])
        self._sum = Scatter(self.owner, len(scalars))

    def value(self, q: Array) -> Array:
        return self.constant + self.rate(q)

    def rate(self, v: Array) -> Array:
        return self._sum(self.coefficients * v[..., self.columns])


class Slip:
    """The nonholonomic rows [m] of a scene, as a kernel beside the quadratic rows."""

    linear = False

    def __init__(self, rows: Sequence[SlipRow], n: int):
        self.m = len(rows)
        row = np.repeat(np.arange(self.m), [len(pairs) for pairs in rows])
        self.x, self.y = (_Forms([pair[side] for pairs in rows for pair in pairs], n) for side in (0, 1))
        keys = [row[forms.owner] * n + forms.columns for forms in (self.y, self.x)]
        pattern, slot = np.unique(np.concatenate(keys), return_inverse=True)
        self.rows, self.cols = pattern // n, pattern % n
        self._of_y, self._of_x = (Scatter(part, pattern.size) for part in np.split(slot, [keys[0].size]))
        self._of_rows, self._row = Scatter(row, self.m), row
        self._compile_curvature()

    def _compile_curvature(self) -> None:
        i, j = np.nonzero(self.y.owner[:, None] == self.x.owner)
        self.curvature_rows: NDArray[np.intp] = self.y.columns[i]
        self.curvature_cols: NDArray[np.intp] = self.x.columns[j]
        self._curvature, self._curvature_owner = self.y.coefficients[i] * self.x.coefficients[j], self._row[self.y.owner[i]]

    def prepare(self, q: Array) -> Array:
        """x [..., pairs]."""
        return self.x.value(q)

    def value(self, z: Array) -> Array:
        return np.zeros((*z.shape[:-1], self.m))

    def gradient(self, z: Array) -> Array:
        """A on the pattern."""
        return self._of_y(self.y.coefficients * z[..., self.y.owner])

    def swirl(self, z: Array, v: Array) -> Array:
        return self._of_x(self.x.coefficients * self.y.rate(v)[..., self.x.owner])

    def bias(self, z: Array, v: Array) -> Array:
        return self._of_rows(self.x.rate(v) * self.y.rate(v))

    def curvature(self, z: Array, multipliers: Array) -> Array:
        return self._curvature * multipliers[..., self._curvature_owner]
