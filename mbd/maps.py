"""Affine maps of many items in one array: x_n = constant_n + matrix_n q[dofs_n], padded to the longest with zero weights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .affine import Affine, Array


class Maps:
    """Maps [n] with dofs [n, k], matrix [n, d, k], constant [n, d]."""

    def __init__(self, maps: Sequence[Affine]):
        k = max([m.rows.size * m.dimension for m in maps], default=0)
        d = maps[0].dimension
        self.dofs = np.zeros((len(maps), k), dtype=np.intp)
        self.matrix = np.zeros((len(maps), d, k))
        self.constant = np.array([m.constant for m in maps])
        for i, m in enumerate(maps):
            size = m.rows.size * d
            self.dofs[i, :size], self.matrix[i, :, :size] = m.columns(), m.matrix()

    def value(self, q: Array) -> Array:
        """[..., n, d]."""
        return self.constant + self.push(q)

    def push(self, dq: Array) -> Array:
        """The linear part [..., n, d]."""
        return (self.matrix @ dq.take(self.dofs, axis=-1)[..., None])[..., 0]

    def pull(self, force: Array) -> Array:
        """The transpose: [..., n, k] from [..., n, d]."""
        return (force[..., None, :] @ self.matrix)[..., 0, :]
