"""Numbers on the way between NumPy, sympy and mpmath, and the difference of two arrays."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from sympy.integrals.quadrature import gauss_legendre

from mbd.affine import Array

DIGITS = 30
"""Exact values carry 30 digits, so that a difference is the kernel's."""

FEW = 6
"""A number of so few decimals is printed as the fraction that its author meant: it differs from the stored one by rounding."""


def number(x: Any) -> sp.Expr:
    """A float as a fraction where it has few decimals, otherwise with all its digits; expressions stay."""
    if isinstance(x, sp.Expr):
        return x
    text = repr(float(x))
    decimals = text.lstrip("-").partition("e")[0].replace(".", "").strip("0")
    return sp.Rational(text) if len(decimals) <= FEW else sp.Float(float(x), DIGITS)


def precise(x: Any) -> Any:
    """An mpmath number of an expression without symbols, or of a float."""
    return mpmath.mpf(float(x)) if not isinstance(x, sp.Basic) else mpmath.mpf(sp.Float(x, DIGITS))


def matrix(entries: Any) -> Any:
    """An mpmath matrix of a sympy one, or of floats."""
    if isinstance(entries, sp.MatrixBase):
        return mpmath.matrix([[precise(x) for x in row] for row in entries.tolist()])
    return mpmath.matrix(entries)


def floats(values: Any) -> Array:
    """An mpmath matrix, or nested lists of mpmath numbers, as an array."""
    return np.array(values.tolist() if hasattr(values, "tolist") else values, dtype=float)


def evaluated(expression: Any, values: dict[sp.Symbol, Any]) -> Array:
    """A matrix of expressions as an array at the values of its symbols, from 30 digits."""
    names = tuple(values)
    with mpmath.workdps(DIGITS):
        return floats(_function(names, sp.ImmutableMatrix(expression))(*(precise(values[name]) for name in names)))


@cache
def _function(names: tuple[sp.Symbol, ...], expression: sp.ImmutableMatrix) -> Any:
    return sp.lambdify(names, expression, modules="mpmath", cse=True)


def gauss(points: int) -> list[tuple[sp.Expr, sp.Expr]]:
    """(xi, weight) on [0, 1] with 30 digits."""
    places, weights = gauss_legendre(points, DIGITS)
    return [((x + 1) / 2, w / 2) for x, w in zip(places, weights)]


def difference(expected: Any, found: Any) -> float:
    """The largest |found - expected| relative to the largest |expected|; infinite for NaN or another shape."""
    exact, seen = np.asarray(expected, dtype=float), np.asarray(found, dtype=float)
    if exact.shape != seen.shape or not np.isfinite(seen).all():
        return float("inf")
    apart, size = float(np.max(np.abs(seen - exact), initial=0.0)), float(np.max(np.abs(exact), initial=0.0))
    if not apart:
        return 0.0
    return apart / size if size else float("inf")
