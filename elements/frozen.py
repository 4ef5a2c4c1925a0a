"""First derivatives of strains at one configuration as matrices, one for each item: for many products with vectors at all stages."""

from __future__ import annotations

from typing import Any

import numpy as np

from mbd.affine import Array


def times(x: Array, matrix: Array) -> Array:
    """x [..., n, k] times the matrix [n, k, l] of each item: one product for all leading axes."""
    by_item = x.reshape(-1, *x.shape[-2:]).swapaxes(0, 1)
    return (by_item @ matrix).swapaxes(0, 1).reshape(*x.shape[:-1], matrix.shape[-1])


class Frozen:
    """B [n, m, k] of a kernel with ``dofs`` [n, k] and ``modulus`` [n, ...], m numbers for each item."""

    def __init__(self, kernel: Any, matrix: Array):
        self.kernel, self.matrix, self.transpose = kernel, matrix, np.swapaxes(matrix, -1, -2)

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, k] from sigma [..., n, ...]."""
        batch = stress.ndim - self.kernel.modulus.ndim
        return times(stress.reshape(*stress.shape[: batch + 1], -1), self.matrix)

    def push(self, change: Array) -> Array:
        """B dq [..., n, ...] from dq [..., n_coordinates]."""
        found = times(change.take(self.kernel.dofs, axis=-1), self.transpose)
        return found.reshape(*change.shape[:-1], *self.kernel.modulus.shape)
