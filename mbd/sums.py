"""Affine maps y_r = c_r + sum of w_k x_c over entries (r, c, w)_k, prepared once for many x [..., n]: by one matrix where it is small."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .scatter import Scatter

SMALL = 2**11
"""Entries of a matrix, zeros included, up to which one product with it takes less time than its entries by themselves."""

Index = NDArray[np.intp]


class Map(Protocol):
    """An affine map of x [..., n] to y [..., size]."""

    def __call__(self, x: Array) -> Array: ...
    def slope(self, x: Array) -> Array:
        """Without the constant: of rates or changes."""


def affine(constant: Array, rows: Index, columns: Index, weights: Array, n: int) -> Map:
    """The map with a constant [size] and entries in any order, some of them there several times."""
    if constant.size * n > SMALL:
        return Entries(constant, rows, columns, weights)
    product = Product(constant.size, rows, columns, weights, n)
    return Shifted(product, constant) if constant.any() else product


def sums(rows: Index, size: int) -> Callable[[Array], Array]:
    """The map that adds x_k to y_r, r = rows[k]."""
    return _ones(rows, size) if rows.size * size <= SMALL else Scatter(rows, size)


def sums_of_runs(rows: Index, size: int) -> Callable[[Array], Array]:
    """The same for sorted rows."""
    return _ones(rows, size) if rows.size * size <= SMALL else Runs(rows, size)


def _ones(rows: Index, size: int) -> Callable[[Array], Array]:
    return Product(size, rows, np.arange(rows.size), np.ones(rows.size), rows.size)


class Product:
    """One matrix, without a constant."""

    def __init__(self, size: int, rows: Index, columns: Index, weights: Array, n: int):
        self.transpose = np.zeros((n, size))
        np.add.at(self.transpose, (columns, rows), weights)

    def __call__(self, x: Array) -> Array:
        return x.dot(self.transpose)

    slope = __call__


class Shifted:
    """A product and a constant: adding one to all of a batch takes twice as long as the product."""

    def __init__(self, product: Product, constant: Array):
        self.slope, self.constant = product, constant

    def __call__(self, x: Array) -> Array:
        return self.slope(x) + self.constant


class Runs:
    """Sums of consecutive entries with the same of the sorted rows. ``place`` is where rows with entries stand: a slice where no others lie
    between them, which is several times as fast as an index."""

    def __init__(self, rows: Index, size: int):
        self.size = size
        found, self.starts = np.unique(rows, return_index=True)
        self.single, self.everywhere = found.size == rows.size, found.size == size
        first = int(found[0]) if found.size else 0
        self.place: Any = slice(first, first + found.size) if np.array_equal(found, first + np.arange(found.size)) else found

    def compact(self, x: Array) -> Array:
        """Of the rows with entries alone."""
        return x if self.single else np.add.reduceat(x, self.starts, axis=-1)

    def __call__(self, x: Array) -> Array:
        found = self.compact(x)
        if self.everywhere:
            return found
        y = np.zeros((*x.shape[:-1], self.size))
        y[..., self.place] = found
        return y


class Entries:
    """By entries."""

    def __init__(self, constant: Array, rows: Index, columns: Index, weights: Array):
        order = np.argsort(rows, kind="stable")
        self.constant, self.columns, self.weights, self._runs = constant, columns[order], weights[order], Runs(rows[order], constant.size)

    def _terms(self, x: Array) -> Array:
        return self.weights * x.take(self.columns, axis=-1)

    def __call__(self, x: Array) -> Array:
        found, runs = self._runs.compact(self._terms(x)), self._runs
        if runs.everywhere:
            found += self.constant
            return found
        y = np.empty((*x.shape[:-1], runs.size))
        y[...] = self.constant
        y[..., runs.place] += found
        return y

    def slope(self, x: Array) -> Array:
        return self._runs(self._terms(x))
