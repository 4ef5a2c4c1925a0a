"""All quadratic rows of a scene in one sparse tensor.

    z = forms(q)                       affine scalars, one for each factor of a product
    g_r = c_r + sum z_i z_j            value
    G_rc = sum (z_j dz_i/dq_c + z_i dz_j/dq_c)      affine in z, with a constant sparsity pattern
    d(G v)/dq                          the same expression with dz/dt in place of z
    v' d2g/dq2 v = sum 2 dz_i dz_j     bias of the acceleration equation

Products are taken of differences of coordinates, never expanded, so that an offset of the origin costs no more digits than it must.
Form 0 is the constant one: a linear row is the product of its form with it, and its part of G is never evaluated again.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .affine import Array, Scalar
from .rows import Row

ONE = 0


class Segments:
    """Sums of consecutive entries along the last axis, prepared once. Keys must be sorted; ``keys`` lists the distinct ones."""

    def __init__(self, keys: NDArray[np.intp]):
        self.keys, self.starts = np.unique(keys, return_index=True)
        self.trivial = self.keys.size == keys.size

    def sum(self, values: Array) -> Array:
        return values if self.trivial else np.add.reduceat(values, self.starts, axis=-1)


class Quadratic:
    """The rows [m] of all joints: values, gradients and curvatures for q [..., n]."""

    def __init__(self, rows: Sequence[Row], n: int):
        self.m = len(rows)
        self.constant = np.array([row.linear.constant for row in rows])
        forms: list[Scalar] = []
        owners: list[tuple[int, int, int]] = []
        for r, row in enumerate(rows):
            self._collect(r, row, forms, owners)
        self._compile_forms(forms, n)
        self.owner, self.left, self.right = np.array(owners, dtype=np.intp).reshape(-1, 3).T
        self.by_row = Segments(self.owner)
        self._compile_gradient(n)
        self._compile_curvature()

    def _collect(self, r: int, row: Row, forms: list[Scalar], owners: list[tuple[int, int, int]]) -> None:
        linear_parts, before = [row.linear] if row.linear.columns.size else [], len(owners)
        for x, y in row.products:
            if x.columns.size and y.columns.size:
                forms.extend((x, y))
                owners.append((r, len(forms) - 1, len(forms)))
            elif x.columns.size or y.columns.size:
                varying, fixed = (x, y) if x.columns.size else (y, x)
                linear_parts.append(varying.scaled(fixed.constant))
                self.constant[r] += varying.constant * fixed.constant
            else:
                self.constant[r] += x.constant * y.constant
        if linear_parts:
            columns = np.concatenate([part.columns for part in linear_parts])
            forms.append(Scalar(columns, np.concatenate([part.coefficients for part in linear_parts]), 0.0))
            owners.append((r, len(forms), ONE))
        if len(owners) == before:  # every row has a product, so that their sums are those of all rows
            owners.append((r, ONE, ONE))
            self.constant[r] -= 1.0

    def _compile_forms(self, forms: list[Scalar], n: int) -> None:
        sizes = np.array([form.columns.size for form in forms], dtype=np.intp)
        self.form_of = np.repeat(np.arange(1, len(forms) + 1), sizes)
        self.columns = np.concatenate([form.columns for form in forms] or [np.zeros(0, np.intp)]) % n
        self.coefficients = np.concatenate([form.coefficients for form in forms] or [np.zeros(0)])
        self.offsets = np.array([form.constant for form in forms])
        self.by_form = Segments(self.form_of)
        self.first = np.concatenate(([0, 0], np.cumsum(sizes)))

    def _entries(self, form: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """All (position in ``form``, coefficient index) pairs of the given forms."""
        start, size = self.first[form], self.first[form + 1] - self.first[form]
        position = np.repeat(np.arange(form.size), size)
        return position, np.arange(position.size) - np.repeat(np.cumsum(size) - size, size) + start[position]

    def _compile_gradient(self, n: int) -> None:
        sides = [(self.left, self.right), (self.right, self.left)]
        parts = []
        for varied, kept in sides:
            product, entry = self._entries(varied)
            parts.append((self.owner[product], self.columns[entry], kept[product], self.coefficients[entry]))
        row, column, factor, coefficient = (np.concatenate(part) for part in zip(*parts))
        constant = factor == ONE
        keys, slot = np.unique(row * n + column, return_inverse=True)
        last = np.bincount(slot, ~constant, minlength=keys.size) > 0.0  # entries that vary come last: they are one slice
        order = np.argsort(last, kind="stable")
        keys, slot = keys[order], np.argsort(order)[slot]
        self.rows, self.cols, self._fixed = keys // n, keys % n, int(np.sum(~last))
        self.fixed: Array = np.bincount(slot[constant], coefficient[constant], minlength=keys.size).astype(float)
        order = np.argsort(slot[~constant], kind="stable")
        self.gradient_factor = factor[~constant][order]
        self.gradient_coefficient = coefficient[~constant][order]
        self.by_slot = Segments(slot[~constant][order])

    def _compile_curvature(self) -> None:
        both = (self.left != ONE) & (self.right != ONE)
        row, left, right = self.owner[both], self.left[both], self.right[both]
        pair, i = self._entries(left)
        again, j = self._entries(right[pair])
        i, pair = i[again], pair[again]
        a, b, c = self.columns[i], self.columns[j], self.coefficients[i] * self.coefficients[j]
        self.curvature_rows, self.curvature_cols = np.concatenate((a, b)), np.concatenate((b, a))
        self.curvature_coefficient = np.concatenate((c, c))
        self.curvature_owner = np.concatenate((row[pair], row[pair]))

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

    def prepare(self, q: Array) -> Array:
        """z [..., 1 + forms], which the other methods take."""
        z = np.empty((*q.shape[:-1], 1 + self.offsets.size))
        z[..., 0] = 1.0
        np.add(self.by_form.sum(self.coefficients * q.take(self.columns, axis=-1)), self.offsets, out=z[..., 1:])
        return z

    def _rates(self, v: Array) -> Array:
        """dz/dt [..., 1 + forms]."""
        z = np.zeros((*v.shape[:-1], 1 + self.offsets.size))
        z[..., 1:] = self.by_form.sum(self.coefficients * v.take(self.columns, axis=-1))
        return z

    def value(self, z: Array) -> Array:
        """g [..., m]."""
        return self.by_row.sum(z.take(self.left, axis=-1) * z.take(self.right, axis=-1)) + self.constant

    def gradient(self, z: Array) -> Array:
        """Values of G [..., nnz] on the pattern (rows, cols); [nnz] where they are constant."""
        if self.linear:
            return self.fixed
        values = np.empty((*z.shape[:-1], self.fixed.size))
        values[...] = self.fixed
        values[..., self._fixed :] += self._varying(z)
        return values

    def _varying(self, z: Array) -> Array:
        return self.by_slot.sum(self.gradient_coefficient * z.take(self.gradient_factor, axis=-1))

    def swirl(self, z: Array, v: Array) -> Array:
        """Values of d(G v)/dq [..., nnz] on the pattern of G."""
        values = np.zeros((*v.shape[:-1], self.fixed.size))
        if not self.linear:
            values[..., self._fixed :] = self._varying(self._rates(v))
        return values

    def bias(self, z: Array, v: Array) -> Array:
        """v' d2g/dq2 v [..., m]."""
        out = np.zeros((*v.shape[:-1], self.m))
        if not self.linear:
            rates = self._rates(v)
            out += 2.0 * self.by_row.sum(rates.take(self.left, axis=-1) * rates.take(self.right, axis=-1))
        return out

    def curvature(self, z: Array, multipliers: Array) -> Array:
        """Values of d(G' lambda)/dq on the pattern (curvature_rows, curvature_cols)."""
        return self.curvature_coefficient * multipliers.take(self.curvature_owner, axis=-1)
