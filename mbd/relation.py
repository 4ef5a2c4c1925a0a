"""A coordinate that a user's function of other coordinates defines: s - f(s_1 ... s_k) = 0."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .formula import Formula


class Relation(NamedTuple):
    """The indices of s_1 ... s_k, that of s, and f."""

    inputs: NDArray[np.intp]
    output: int
    formula: Formula


class _Point:
    """f and its derivatives at configurations [...]; each is evaluated when it is asked for."""

    def __init__(self, formula: Formula, x: Array, s: Array):
        self.formula, self.x, self.s = formula, x, s

    def _each(self, level: str) -> Array:
        call = getattr(self.formula, level)
        values = np.array([call(x)[0] for x in self.x.reshape(-1, self.formula.k)])
        return values.reshape((*self.x.shape[:-1], *values.shape[1:]))

    @cached_property
    def value(self) -> Array:
        return self.s - self._each("value")

    @cached_property
    def gradient(self) -> Array:
        return self._each("gradient")

    @cached_property
    def hessian(self) -> Array:
        return self._each("hessian")


class Relations:
    """The row of one relation, as a kernel beside the quadratic rows."""

    linear, m = False, 1

    def __init__(self, relation: Relation, n: int):
        self.formula = relation.formula
        self.inputs, self.output = relation.inputs % n, relation.output % n
        k = self.inputs.size
        self.rows, self.cols = np.zeros(k + 1, dtype=np.intp), np.append(self.inputs, self.output)
        self.curvature_rows, self.curvature_cols = np.repeat(self.inputs, k), np.tile(self.inputs, k)

    def prepare(self, q: Array) -> _Point:
        return _Point(self.formula, q[..., self.inputs], q[..., self.output])

    def value(self, z: _Point) -> Array:
        return z.value[..., None]

    def gradient(self, z: _Point) -> Array:
        return np.concatenate((-z.gradient, np.ones((*z.s.shape, 1))), axis=-1)

    def _bent(self, z: _Point, v: Array) -> Array:
        """H ds/dt [..., k]."""
        return (z.hessian @ v[..., self.inputs, None])[..., 0]

    def swirl(self, z: _Point, v: Array) -> Array:
        bent = self._bent(z, v)
        return np.concatenate((-bent, np.zeros((*bent.shape[:-1], 1))), axis=-1)

    def bias(self, z: _Point, v: Array) -> Array:
        return -np.sum(self._bent(z, v) * v[..., self.inputs], axis=-1, keepdims=True)

    def curvature(self, z: _Point, multipliers: Array) -> Array:
        return -multipliers * z.hessian.reshape(*z.s.shape, -1)
