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

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Array, Scalar
from .rows import Row
from .sums import Index, Map, affine, sums_of_runs

NO_FORMS = np.zeros(0)


class Terms(NamedTuple):
    """Weights times coordinates q[columns], and what these are terms of."""

    of: Index
    columns: Index
    weights: Array

    @classmethod
    def gathered(cls, scalars: Sequence[Scalar], of: Iterable[int], n: int) -> Terms:
        sizes = [scalar.columns.size for scalar in scalars]
        columns = np.concatenate([np.zeros(0, np.intp), *(scalar.columns for scalar in scalars)]) % n
        return cls(np.repeat(np.fromiter(of, np.intp), sizes), columns, np.concatenate([np.zeros(0), *(scalar.coefficients for scalar in scalars)]))


class At(NamedTuple):
    """Coordinates q [..., n], and the forms z [..., forms] there, none where G is constant."""

    q: Array
    z: Array


class Quadratic:
    """The rows [m] of all joints: values, gradients and curvatures for q [..., n].

    ``linear``: G is constant. The forms are all left sides of products, then all right ones.
    """

    def __init__(self, rows: Sequence[Row], n: int):
        self.m = len(rows)
        products, linear, constants = _split(rows)
        forms = [x for _, x, _ in products] + [y for *_, y in products]
        self.owner, self.products, self.linear = np.array([r for r, *_ in products], dtype=np.intp), len(products), not products
        of_rows = Terms.gathered([scalar for _, scalar in linear], [r for r, _ in linear], n)
        of_forms = Terms.gathered(forms, range(len(forms)), n)
        self.linear_part = affine(np.array(constants), *of_rows, n)
        self.forms = affine(np.array([form.constant for form in forms]), *of_forms, n)
        self.by_row = sums_of_runs(self.owner, self.m)
        self._compile_gradient(of_rows, of_forms, n)
        self._compile_curvature(of_forms)

    def _compile_gradient(self, linear: Terms, forms: Terms, n: int) -> None:
        """Entries that vary come last, so that they are one slice."""
        form, columns, weights = forms
        varying = np.tile(self.owner, 2)[form] * n + columns
        keys, slot = np.unique(np.concatenate((varying, linear.of * n + linear.columns)), return_inverse=True)
        last = np.bincount(slot[: varying.size], minlength=keys.size) > 0
        order = np.argsort(last, kind="stable")
        keys, slot = keys[order], np.argsort(order)[slot]
        self.rows, self.cols = keys // n, keys % n
        self.fixed: Array = np.bincount(slot[varying.size :], linear.weights, minlength=keys.size).astype(float)
        self.varying_rows = self.rows[keys.size - int(last.sum()) :]
        other = np.roll(np.arange(2 * self.products), self.products)[form]
        self.slopes = affine(self.fixed, slot[: varying.size], other, weights, 2 * self.products)

    def _compile_curvature(self, forms: Terms) -> None:
        """Pairs of a term of the left side and one of the right side of each product."""
        half = int(np.searchsorted(forms.of, self.products))
        size = np.bincount(forms.of[half:] - self.products, minlength=self.products)  # of the right sides
        product, first = forms.of[:half], half + np.cumsum(size) - size
        times = size[product]
        i = np.repeat(np.arange(half), times)
        j = first[product[i]] + np.arange(i.size) - np.repeat(np.cumsum(times) - times, times)
        a, b, c = forms.columns[i], forms.columns[j], forms.weights[i] * forms.weights[j]
        self.curvature_rows, self.curvature_cols = np.concatenate((a, b)), np.concatenate((b, a))
        self.curvature_weights, self.curvature_owner = np.tile(c, 2), np.tile(self.owner[product[i]], 2)

    @cached_property
    def _fixed_times(self) -> Map:
        """From weights of rows to a constant G with each row times its weight."""
        nnz = self.fixed.size
        return affine(np.zeros(nnz), np.arange(nnz), self.rows, self.fixed, self.m)

    @property
    def constant_rows(self) -> NDArray[np.bool_]:
        """[m]: whether the row's part of G is constant."""
        constant = np.ones(self.m, dtype=bool)
        constant[self.varying_rows] = False
        return constant

    def prepare(self, q: Array) -> At:
        """What the other methods take."""
        return At(q, NO_FORMS if self.linear else self.forms(q))

    def _products(self, z: Array) -> Array:
        """Their sums [..., m]."""
        return self.by_row(z[..., : self.products] * z[..., self.products :])

    def value(self, at: At) -> Array:
        """g [..., m]."""
        g = self.linear_part(at.q)
        return g if self.linear else g + self._products(at.z)

    def gradient(self, at: At) -> Array:
        """Values of G [..., nnz] on the pattern (rows, cols); [nnz] where they are constant."""
        return self.fixed if self.linear else self._varying(at.z)

    def weighted(self, at: At, weights: Array) -> Array:
        """Values of G, each row times its weight [..., m]."""
        return self._fixed_times(weights) if self.linear else weights.take(self.rows, axis=-1) * self.gradient(at)

    def _varying(self, z: Array) -> Array:
        """What z changes is added to what is fixed."""
        return self.slopes(z)

    def swirl(self, at: At, v: Array) -> Array:
        """Values of d(G v)/dq [..., nnz] on the pattern of G."""
        return np.zeros((*v.shape[:-1], self.fixed.size)) if self.linear else self.slopes.slope(self.forms.slope(v))

    def bias(self, at: At, v: Array) -> Array:
        """v' d2g/dq2 v [..., m]."""
        return np.zeros((*v.shape[:-1], self.m)) if self.linear else 2.0 * self._products(self.forms.slope(v))

    def curvature(self, at: At, multipliers: Array) -> Array:
        """Values of d(G' lambda)/dq on the pattern (curvature_rows, curvature_cols)."""
        return self.curvature_weights * multipliers.take(self.curvature_owner, axis=-1)


def _split(rows: Sequence[Row]) -> tuple[list[tuple[int, Scalar, Scalar]], list[tuple[int, Scalar]], list[float]]:
    """Products of which both sides vary, as (row, x, y); all else is linear, (row, x), and its constants are added to those of the rows."""
    products, linear, constants = [], [(r, row.linear) for r, row in enumerate(rows)], [row.linear.constant for row in rows]
    for r, row in enumerate(rows):
        for x, y in row.products:
            if x.columns.size and y.columns.size:
                products.append((r, x, y))
            else:
                varying, fixed = (x, y) if x.columns.size else (y, x)
                linear.append((r, varying.scaled(fixed.constant)))
                constants[r] += varying.constant * fixed.constant
    return products, linear, constants
