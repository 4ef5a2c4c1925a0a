"""All quadratic rows of a scene in one sparse tensor.

    z = forms(q)                       affine scalars, one for each factor of a product
    g_r = c_r + l_r q + sum z_i z_j    value
    G_rc = l_rc + sum (z_j dz_i/dq_c + z_i dz_j/dq_c)      affine in z, with a constant sparsity pattern
    d(G v)/dq                          the same sum with dz/dt in place of z
    v' d2g/dq2 v = sum 2 dz_i dz_j     bias of the acceleration equation

Products are taken of differences of coordinates, never expanded, so that an offset of the origin costs no more digits than it must.
The linear part of G is never evaluated again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Array, Scalar
from .rows import Row


class Segments:
    """Sums of consecutive entries along the last axis, prepared once. Keys must be sorted; ``keys`` lists the distinct ones, and ``place``
    is where they stand: a slice where nothing lies between them, which is several times as fast as an index."""

    def __init__(self, keys: NDArray[np.intp]):
        self.keys, self.starts = np.unique(keys, return_index=True)
        self.trivial = self.keys.size == keys.size
        first, size = int(self.keys[0]) if self.keys.size else 0, self.keys.size
        self.place: Any = slice(first, first + size) if np.array_equal(self.keys, first + np.arange(size)) else self.keys

    def sum(self, values: Array) -> Array:
        return values if self.trivial else np.add.reduceat(values, self.starts, axis=-1)


class Sums:
    """Weighted sums of coordinates: of all with the same of the sorted keys, which ``keys`` lists."""

    def __init__(self, scalars: Sequence[Scalar], keys: Sequence[int], n: int):
        sizes = np.array([scalar.columns.size for scalar in scalars], dtype=np.intp)
        self.columns = np.concatenate([scalar.columns for scalar in scalars] or [np.zeros(0, np.intp)]) % n
        self.coefficients = np.concatenate([scalar.coefficients for scalar in scalars] or [np.zeros(0)])
        self.of = np.repeat(np.array(keys, dtype=np.intp), sizes)
        self.by_key = Segments(self.of)

    def __call__(self, q: Array) -> Array:
        """[..., keys]."""
        return self.by_key.sum(self.coefficients * q.take(self.columns, axis=-1))


class At(NamedTuple):
    """Coordinates q [..., n], and the forms z [..., forms] there."""

    q: Array
    z: Array


class Quadratic:
    """The rows [m] of all joints: values, gradients and curvatures for q [..., n]."""

    def __init__(self, rows: Sequence[Row], n: int):
        self.m = len(rows)
        self.constant = np.array([row.linear.constant for row in rows])
        forms: list[Scalar] = []
        owner: list[int] = []
        linear: list[tuple[int, Scalar]] = []
        for r, row in enumerate(rows):
            self._collect(r, row, forms, owner, linear)
        self.linear_part = Sums([scalar for _, scalar in linear], [r for r, _ in linear], n)
        self.forms, self.offsets = Sums(forms, range(len(forms)), n), np.array([form.constant for form in forms])
        self.first = np.concatenate(([0], np.cumsum([form.columns.size for form in forms], dtype=np.intp)))
        self.owner, self.left, self.right = np.array(owner, dtype=np.intp), np.arange(0, len(forms), 2), np.arange(1, len(forms), 2)
        self.by_row = Segments(self.owner)
        self._compile_gradient(n)
        self._compile_curvature()

    def _collect(self, r: int, row: Row, forms: list[Scalar], owner: list[int], linear: list[tuple[int, Scalar]]) -> None:
        """Products of which both sides vary; all else is linear, and its constant is added to that of the row."""
        linear.append((r, row.linear))
        for x, y in row.products:
            if x.columns.size and y.columns.size:
                forms.extend((x, y))
                owner.append(r)
            else:
                varying, fixed = (x, y) if x.columns.size else (y, x)
                linear.append((r, varying.scaled(fixed.constant)))
                self.constant[r] += varying.constant * fixed.constant

    def _entries(self, form: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """All (position in ``form``, coefficient index) pairs of the given forms."""
        start, size = self.first[form], self.first[form + 1] - self.first[form]
        position = np.repeat(np.arange(form.size), size)
        return position, np.arange(position.size) - np.repeat(np.cumsum(size) - size, size) + start[position]

    def _compile_gradient(self, n: int) -> None:
        parts = []
        for varied, kept in ((self.left, self.right), (self.right, self.left)):
            product, entry = self._entries(varied)
            parts.append((self.owner[product] * n + self.forms.columns[entry], kept[product], self.forms.coefficients[entry]))
        varying, factor, coefficient = (np.concatenate(part) for part in zip(*parts))
        constant = self.linear_part.of * n + self.linear_part.columns
        keys, slot = np.unique(np.concatenate((varying, constant)), return_inverse=True)
        last = np.bincount(slot[: varying.size], minlength=keys.size) > 0  # entries that vary come last: they are one slice
        order = np.argsort(last, kind="stable")
        keys, slot = keys[order], np.argsort(order)[slot]
        self.rows, self.cols = keys // n, keys % n
        self.fixed: Array = np.bincount(slot[varying.size :], self.linear_part.coefficients, minlength=keys.size).astype(float)
        order = np.argsort(slot[: varying.size], kind="stable")
        self.gradient_factor, self.gradient_coefficient = factor[order], coefficient[order]
        self.by_slot = Segments(slot[: varying.size][order])
        self._offset = self.fixed[self.by_slot.place]

    def _compile_curvature(self) -> None:
        pair, i = self._entries(self.left)
        again, j = self._entries(self.right[pair])
        i, pair = i[again], pair[again]
        a, b, c = self.forms.columns[i], self.forms.columns[j], self.forms.coefficients[i] * self.forms.coefficients[j]
        self.curvature_rows, self.curvature_cols = np.concatenate((a, b)), np.concatenate((b, a))
        self.curvature_coefficient = np.concatenate((c, c))
        self.curvature_owner = np.concatenate((self.owner[pair], self.owner[pair]))

    @property
    def linear(self) -> bool:
        """Whether G is constant."""
        return self.gradient_factor.size == 0

    @property
    def constant_rows(self) -> NDArray[np.bool_]:
        """[m]: whether the row's part of G is constant."""
        constant = np.ones(self.m, dtype=bool)
        constant[self.rows[self.by_slot.keys]] = False
        return constant

    def prepare(self, q: Array) -> At:
        """What the other methods take."""
        return At(q, self.forms(q) + self.offsets)

    def value(self, at: At) -> Array:
        """g [..., m]."""
        g = np.empty((*at.q.shape[:-1], self.m))
        g[...] = self.constant
        g[..., self.linear_part.by_key.place] += self.linear_part(at.q)
        g[..., self.by_row.place] += self.by_row.sum(at.z[..., ::2] * at.z[..., 1::2])
        return g

    def gradient(self, at: At) -> Array:
        """Values of G [..., nnz] on the pattern (rows, cols); [nnz] where they are constant."""
        if self.linear:
            return self.fixed
        values = np.empty((*at.q.shape[:-1], self.fixed.size))
        values[...] = self.fixed
        values[..., self.by_slot.place] = self._varying(at.z) + self._offset
        return values

    def _varying(self, z: Array) -> Array:
        return self.by_slot.sum(self.gradient_coefficient * z.take(self.gradient_factor, axis=-1))

    def swirl(self, at: At, v: Array) -> Array:
        """Values of d(G v)/dq [..., nnz] on the pattern of G."""
        values = np.zeros((*v.shape[:-1], self.fixed.size))
        if not self.linear:
            values[..., self.by_slot.place] = self._varying(self.forms(v))
        return values

    def bias(self, at: At, v: Array) -> Array:
        """v' d2g/dq2 v [..., m]."""
        out = np.zeros((*v.shape[:-1], self.m))
        if not self.linear:
            rates = self.forms(v)
            out[..., self.by_row.place] = 2.0 * self.by_row.sum(rates[..., ::2] * rates[..., 1::2])
        return out

    def curvature(self, at: At, multipliers: Array) -> Array:
        """Values of d(G' lambda)/dq on the pattern (curvature_rows, curvature_cols)."""
        return self.curvature_coefficient * multipliers.take(self.curvature_owner, axis=-1)
