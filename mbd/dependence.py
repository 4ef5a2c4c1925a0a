"""What the gradient G of a system's equations spans: equations that follow from others, motions that no equation forbids, and the
smallest sets of items that either of them needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .system import System

Rows = NDArray[np.intp]

ZERO = 1e-7
"""Entries of unit vectors in a null space below this are rounding: equations count as dependent from 1e-9 on, and G is nonlinear."""


@dataclass(frozen=True, eq=False)
class Spaces:
    """The null spaces of G at one configuration, its rows and columns scaled.

    rank; left [m, m - rank], multipliers that move nothing; right [n, n - rank], motions that keep all equations; both orthonormal.
    ``units`` [n]: a motion times these is in the user's units.
    """

    rank: int
    left: Array
    right: Array
    units: Array


def scaled_gradient(system: System, units: Array, q: Array) -> tuple[Array, Array]:
    """G [m, n] at q, coordinates in these units [n], each equation of size 1; and the sizes [m] that they had."""
    from .solvers.start import dense_gradient

    gradient = dense_gradient(system, q) * units
    sizes = np.linalg.norm(gradient, axis=1)
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    return gradient / sizes[:, None], sizes


def rank_of(matrix: Array) -> int:
    """The rank by singular values; the same threshold as at the start of a run."""
    from .solvers.start import REDUNDANT

    sizes = np.linalg.svd(matrix, compute_uv=False) if matrix.size else np.zeros(0)
    return int(np.sum(sizes > REDUNDANT * max(float(sizes.max(initial=0.0)), 1e-300)))


def spaces(gradient: Array, units: Array) -> Spaces:
    """The null spaces of a scaled gradient [m, n]."""
    from .solvers.start import REDUNDANT

    left, sizes, right = np.linalg.svd(gradient)
    rank = int(np.sum(sizes > REDUNDANT * max(float(sizes.max(initial=0.0)), 1e-300)))
    return Spaces(rank, left[:, rank:], right[rank:].T, units)


def minimal_sets(basis: Array, groups: Sequence[Rows]) -> list[tuple[list[int], Array]]:
    """Sets of groups of rows, none of which can do without one of its groups, that carry vectors of a space and together span it.

    basis [rows, k], orthonormal columns. Each set comes with the vectors [rows, j] of the space that vanish on all other groups. The last
    groups are given up first: sets do not depend on a pivot of the elimination.
    """
    k = basis.shape[1]
    known: Array = np.zeros((k, 0))
    found = []
    while known.shape[1] < k:
        inside: Array = np.eye(k)
        for group in reversed(groups):
            fewer = inside @ _kernel(basis[group] @ inside)
            if np.linalg.norm(fewer - known @ (known.T @ fewer)) > 1e-3:  # still something that no set before had
                inside = fewer
        vectors = basis @ inside
        found.append(([i for i, group in enumerate(groups) if np.max(np.abs(vectors[group]), initial=0.0) > ZERO], vectors))
        known = _column_space(np.hstack((known, inside)))
    return found


def _kernel(matrix: Array) -> Array:
    """[k, j]: orthonormal, with matrix [r, k] @ it = 0."""
    if np.max(np.abs(matrix), initial=0.0) <= ZERO:
        return np.eye(matrix.shape[1])
    _, sizes, right = np.linalg.svd(matrix)
    return right[int(np.sum(sizes > ZERO)) :].T


def _column_space(matrix: Array) -> Array:
    left, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
    return left[:, sizes > ZERO]


def independent_rows(matrix: Array, order: Sequence[int]) -> list[int]:
    """Rows of a matrix, the first of an order that are independent."""
    chosen: list[int] = []
    rest = np.array(matrix, dtype=float)
    for row in order:
        size = float(np.linalg.norm(rest[row]))
        if size > 1e-3 * float(np.linalg.norm(matrix[row])) and size > ZERO:
            direction = rest[row] / size
            rest = rest - np.outer(rest @ direction, direction)
            chosen.append(row)
    return chosen
