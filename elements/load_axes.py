"""What forces and torques that depend on axes share: the axes of all items in one array, vectors given along them, and derivatives of their
directions. Sums are matrix products and cross products are matrices: of few items a call costs, not its numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbd.affine import Affine, Array

QUARTERS = np.array([
    [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
    [[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
])  # fmt: skip
"""y @ QUARTERS[k] = unit vector k x y."""


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
        self._flat = self.matrix.reshape(len(groups), a * d, k)

    def value(self, q: Array) -> Array:
        """[..., n, a, d]."""
        return self.constant + (self._flat @ q.take(self.dofs, axis=-1)[..., None]).reshape(*q.shape[:-1], *self.constant.shape)

    def pull(self, on_axes: Array) -> Array:
        """The transpose: [..., n, k] from [..., n, a, d]."""
        return (on_axes.reshape(*on_axes.shape[:-2], 1, -1) @ self._flat)[..., 0, :]


def crossing(x: Array) -> Array:
    """X [..., 3, 3] with y @ X = x cross y, for x, y [..., 3]."""
    return (x @ QUARTERS.reshape(3, 9)).reshape(*x.shape, 3)


def squares(e: Array) -> Array:
    """|e|^2 [...]."""
    return (e * e).sum(axis=-1)


def along(e: Array, components: Array) -> Array:
    """sum_k components_k e_k/|e_k| [..., d] from e [..., a, d] and components [..., a]."""
    return ((components / np.sqrt(squares(e)))[..., None, :] @ e)[..., 0, :]


def unit_gradient(e: Array) -> Array:
    """d(e/|e|)/de [..., d, d]."""
    size = np.sqrt(squares(e))[..., None, None]
    u = e / size[..., 0]
    return (np.eye(e.shape[-1]) - u[..., :, None] * u[..., None, :]) / size


def inverse_gradient(e: Array) -> Array:
    """d(e/|e|^2)/de [..., d, d]."""
    square = squares(e)[..., None, None]
    return (np.eye(e.shape[-1]) - 2.0 * e[..., :, None] * e[..., None, :] / square) / square
