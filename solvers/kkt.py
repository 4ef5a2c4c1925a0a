"""The KKT matrix of statics, and its inertia.

    [ K + shift M   size G' ]
    [ size G        0       ]    in the scaled unknowns of ``linear.py``; size is the largest entry of K, so that both parts weigh alike

It has m negative eigenvalues more than K + shift M on the null space of G (Gould 1985, Math. Programming 32, 90-99): counting them tells
stable equilibria from others. They are those of the blocks of L D L' (Bunch and Kaufman, LAPACK sytrf) or, of large systems, the negative
pivots of SuperLU on the diagonal of a matrix whose corner is slightly negative.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lapack

from .formats import Singular
from .linear import SOFTENING, Factor, Linear, Tangent
from .system import Array, Index, System

DENSE_UP_TO = 800
SINGULAR = 1e-16
"""Reciprocal condition below which a stiffness counts as singular."""

NEUTRAL = 1e-14
"""Eigenvalues of K within this share of the largest entry, in scaled unknowns, are rounding: they count as zero."""

CORNER = 1e-9
"""Share of ``size`` in the negative corner where pivots are taken from the diagonal only."""


class Kkt:
    """The static KKT matrices of one system; patterns are prepared once. ``least``: the reciprocal condition below which one is refused."""

    def __init__(self, system: System, linear: Linear, least: float = SINGULAR):
        self.system, self.linear, self.least = system, linear, least
        corner = linear.place[linear.n :]
        self._corner = linear.format.slot(corner, corner)

    def buffer(self, tangent: Tangent, shift: float) -> tuple[Array, float]:
        """The matrix in the slots of the format, and its size."""
        linear = self.linear
        assert tangent.stiffness is not None
        stiffness = tangent.stiffness + shift * linear.mass
        size = float(np.max(np.abs(stiffness), initial=0.0)) or 1.0
        buffer = stiffness + size * tangent.gradient
        if linear.softened:
            buffer[self._corner] -= SOFTENING * size
        return buffer, size

    def factor(self, tangent: Tangent, shift: float = 0.0) -> Factor:
        """Raises Singular."""
        return self.linear.factorised(lambda: self.buffer(tangent, shift), self.least)

    def entries(self, buffer: Array) -> tuple[Index, Index, Array]:
        """Rows, columns (in the order of the format) and values of a filled buffer."""
        rows, cols, slots = self.linear.pattern
        return rows, cols, buffer[slots]

    def negatives(self, tangent: Tangent, shift: float = 0.0) -> int:
        """How many eigenvalues K + shift M, its symmetric part, has below zero on the null space of G."""
        buffer, size = self.buffer(tangent, shift)
        count = _dense_negatives if self.linear.size <= DENSE_UP_TO else _sparse_negatives
        if count is _sparse_negatives and not self.linear.softened:
            buffer[self._corner] -= CORNER * size
        return count(*self.entries(buffer), self.linear.size) - self.system.m

    def signs(self, tangent: Tangent) -> tuple[int, int]:
        """(negative, zero): how many eigenvalues of K on the null space of G are below zero, and how many are zero to rounding."""
        noise = NEUTRAL * self.buffer(tangent, 0.0)[1]
        below, upto = self.negatives(tangent, noise), self.negatives(tangent, -noise)
        return below, max(upto - below, 0)


def _dense_negatives(rows: Index, cols: Index, values: Array, size: int) -> int:
    matrix = np.zeros((size, size), order="F")
    matrix[rows, cols] = 0.5 * values
    # By blocks: column by column OpenBLAS starts threads for each, which took 280 ms instead of 0.1 ms at size 137 on a busy machine.
    factor, pivots, _ = lapack.dsytrf(matrix + matrix.T, lower=1, lwork=32 * size, overwrite_a=1)
    single = pivots > 0
    below = int(np.sum(factor.diagonal()[single] < 0.0))
    return below + int(np.sum(~single)) // 2  # a block of two has one eigenvalue of each sign


def _sparse_negatives(rows: Index, cols: Index, values: Array, size: int) -> int:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    half: Any = coo_array((0.5 * values, (rows, cols)), shape=(size, size)).tocsc()
    try:
        lu = splu(half + half.T, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise Singular(str(error)) from None
    if not np.array_equal(lu.perm_r, lu.perm_c):
        raise Singular("pivots had to leave the diagonal")
    return int(np.sum(lu.U.diagonal() < 0.0))
