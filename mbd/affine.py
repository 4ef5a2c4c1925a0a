"""Affine maps of the table of d-vectors: x(q) = c + sum_r w_r q_r.

Every coordinate is a row of a table of d-vectors (d = 2 planar, d = 3 spatial), so every point and every axis of every body is such a
map. In the plane a weight is a complex number, rotation and stretch in one: a planar body needs one director, its second axis being
i times the first. In space a weight is a real number.

Scalar coordinates that are no vectors (a turning angle, a stretch ratio) fill q from its end: the j-th has the index -1 - j, known
before the table is complete.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scalar:
    """c + sum_k coefficients_k q[columns_k]."""

    columns: NDArray[np.intp]
    coefficients: Array
    constant: float

    @classmethod
    def coordinate(cls, column: int) -> Scalar:
        return cls(np.array([column]), np.ones(1), 0.0)

    def scaled(self, factor: float) -> Scalar:
        return Scalar(self.columns, factor * self.coefficients, factor * self.constant)


@dataclass(frozen=True, eq=False)
class Affine:
    """constant [d] + sum of weights [k] times rows [k] of the table."""

    rows: NDArray[np.intp]
    weights: NDArray
    constant: Array

    @classmethod
    def fixed(cls, vector: ArrayLike) -> Affine:
        constant = np.array(vector, dtype=float)
        return cls(np.zeros(0, dtype=np.intp), np.zeros(0, dtype=complex if constant.size == 2 else float), constant)

    @classmethod
    def of(cls, rows: Sequence[int] | NDArray[np.intp], weights: Sequence[complex] | NDArray, dimension: int) -> Affine:
        kind = complex if dimension == 2 else float
        return cls(np.array(rows, dtype=np.intp), np.array(weights, dtype=kind), np.zeros(dimension))

    @property
    def dimension(self) -> int:
        return self.constant.size

    def __add__(self, other: Affine) -> Affine:
        return Affine(np.concatenate((self.rows, other.rows)), np.concatenate((self.weights, other.weights)), self.constant + other.constant)

    def __sub__(self, other: Affine) -> Affine:
        return self + other.scaled(-1.0)

    def scaled(self, factor: complex) -> Affine:
        """Times a real number, or in the plane a complex one (a rotation and stretch)."""
        if self.dimension == 2:
            turned = factor * complex(*self.constant)
            return Affine(self.rows, factor * self.weights, np.array([turned.real, turned.imag]))
        return Affine(self.rows, np.real(factor) * self.weights, np.real(factor) * self.constant)

    def columns(self) -> NDArray[np.intp]:
        """[k d]: the coordinates behind the rows."""
        d = self.dimension
        return (d * self.rows[:, None] + np.arange(d)).ravel()

    def matrix(self) -> Array:
        """[d, k d]: x = constant + matrix @ q[columns]."""
        d, k = self.dimension, self.rows.size
        blocks = np.zeros((d, k, d))
        if d == 2:
            blocks[0, :, 0] = blocks[1, :, 1] = self.weights.real
            blocks[0, :, 1], blocks[1, :, 0] = -self.weights.imag, self.weights.imag
        else:
            blocks[np.arange(d), :, np.arange(d)] = self.weights
        return blocks.reshape(d, k * d)

    def components(self) -> list[Scalar]:
        columns, matrix = self.columns(), self.matrix()
        used = matrix != 0.0
        return [Scalar(columns[u], row[u], float(c)) for u, row, c in zip(used, matrix, self.constant)]

    def value(self, q: Array) -> Array:
        """[..., d] from q [..., n]."""
        return self.constant + q[..., self.columns()] @ self.matrix().T

    def rate(self, v: Array) -> Array:
        """[..., d], the value's time derivative from v [..., n]."""
        return v[..., self.columns()] @ self.matrix().T
