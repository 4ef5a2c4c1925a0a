"""B, the first derivatives of strains at one configuration, for many products with vectors at all stages: as one matrix of a scene, or as one for
each item."""

from __future__ import annotations

from typing import Any

import numpy as np

from .affine import Array


class Slopes:
    """B of all measures, given as its transpose [n, n_stresses]."""

    def __init__(self, transpose: Array):
        self.matrix, self.transpose = transpose.T, transpose

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n]."""
        return stress.dot(self.matrix)

    def push(self, change: Array) -> Array:
        """B dq [..., n_stresses]."""
        return change.dot(self.transpose)


def _times(x: Array, matrix: Array) -> Array:
    """x [..., n, k] times the matrix [n, k, l] of each item: one product for all leading axes."""
    by_item = x.reshape(-1, *x.shape[-2:]).swapaxes(0, 1)
    return (by_item @ matrix).swapaxes(0, 1).reshape(*x.shape[:-1], matrix.shape[-1])


class Frozen:
    """B [n, m, k] of the items of a kernel with ``dofs`` [n, k] and ``modulus`` [n, ...], m numbers for each item."""

    def __init__(self, kernel: Any, matrix: Array):
        self.kernel, self.matrix, self.transpose = kernel, matrix, np.swapaxes(matrix, -1, -2)

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n, k] from sigma [..., n, ...]."""
        batch = stress.ndim - self.kernel.modulus.ndim
        return _times(stress.reshape(*stress.shape[: batch + 1], -1), self.matrix)

    def push(self, change: Array) -> Array:
        """B dq [..., n, ...] from dq [..., n_coordinates]."""
        found = _times(change.take(self.kernel.dofs, axis=-1), self.transpose)
        return found.reshape(*change.shape[:-1], *self.kernel.modulus.shape)
