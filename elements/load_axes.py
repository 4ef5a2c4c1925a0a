"""What forces and torques that depend on axes share: the axes of all items in one array, and derivatives of their directions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbd.affine import Affine, Array


class Axes:
    """Axes e_a of items [n] with a axes each, on the joint coordinates of an item: values, and gradients [n, d, k]."""

    def __init__(self, axes: Sequence[Sequence[Affine]], points: Sequence[Affine] = ()):
        groups = [[*group, *points[i : i + 1]] for i, group in enumerate(axes)]
        k = max(sum(m.rows.size * m.dimension for m in group) for group in groups)
        d, a = groups[0][0].dimension, len(groups[0])
        self.dofs = np.zeros((len(groups), k), dtype=np.intp)
        self.matrix, self.constant = np.zeros((len(groups), a, d, k)), np.zeros((len(groups), a, d))
        for i, group in enumerate(groups):
            first = 0
            for j, m in enumerate(group):
                last = first + m.rows.size * d
                self.dofs[i, first:last], self.matrix[i, j, :, first:last], self.constant[i, j] = m.columns(), m.matrix(), m.constant
                first = last

    def value(self, q: Array) -> Array:
        """[..., n, a, d]."""
        return self.constant + np.einsum("nadk,...nk->...nad", self.matrix, q[..., self.dofs])


def unit_gradient(e: Array) -> Array:
    """d(e/|e|)/de [..., d, d]."""
    size = np.linalg.norm(e, axis=-1)[..., None, None]
    u = e / size[..., 0]
    return (np.eye(e.shape[-1]) - u[..., :, None] * u[..., None, :]) / size


def inverse_gradient(e: Array) -> Array:
    """d(e/|e|^2)/de [..., d, d]."""
    square = np.sum(e**2, axis=-1)[..., None, None]
    return (np.eye(e.shape[-1]) - 2.0 * e[..., :, None] * e[..., None, :] / square) / square
