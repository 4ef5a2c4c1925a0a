"""Reference values by sympy and mpmath: the laws of ``mbd.derivations`` over maps that the tests make from descriptions themselves.

An elastic item is a sum of terms, a law at local variables w = A q + c with numbers for its parameters, evaluated with 30 digits.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp
from sympy.integrals.quadrature import gauss_legendre

DIGITS = 30


class Term(NamedTuple):
    """A law at w = matrix q + constant with numbers for its parameters."""

    law: Any
    matrix: Any
    constant: Any
    numbers: tuple


def evaluate(terms: list[Term], q: np.ndarray, v: np.ndarray) -> tuple[Any, Any, Any, Any]:
    """W, F [n], K [n, n], D [n, n] of a sum of terms at q, v, rounded from 30 digits."""
    with mpmath.workdps(DIGITS):
        n = len(q)
        total = [mpmath.mpf(0), mpmath.matrix(n, 1), mpmath.matrix(n, n), mpmath.matrix(n, n)]
        qs, vs = mpmath.matrix(q.tolist()), mpmath.matrix(v.tolist())
        for term in terms:
            a = mpmath.matrix(term.matrix)
            w, rates = a * qs + mpmath.matrix(term.constant), a * vs
            energy, vectors, matrices = term.law.at(w, rates, [mpmath.mpf(x) for x in term.numbers])
            parts = energy, a.T * vectors["force"], a.T * matrices["stiffness"] * a, a.T * matrices["damping"] * a
            total = [x + y for x, y in zip(total, parts)]
        return float(total[0]), _floats(total[1])[:, 0], _floats(total[2]), _floats(total[3])


def _floats(matrix: Any) -> np.ndarray:
    return np.array(matrix.tolist(), dtype=float).reshape(matrix.rows, matrix.cols)


def gauss(points: int) -> list[tuple[Any, Any]]:
    """(xi, weight) on [0, 1] with 30 digits."""
    with mpmath.workdps(DIGITS):
        return [((mpmath.mpf(x) + 1) / 2, mpmath.mpf(w) / 2) for x, w in zip(*gauss_legendre(points, DIGITS))]


def _hermite(x: Any, length: Any) -> tuple[sp.Expr, ...]:
    """N(x) for nodal vectors (r, dr/dx, r, dr/dx); Escalona et al. (1998), eq. 1."""
    xi = x / length
    return 1 - 3 * xi**2 + 2 * xi**3, length * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, length * (xi**3 - xi**2)


@cache
def _shapes(derivative: int) -> Any:
    x, length = sp.symbols("x l")
    return sp.lambdify((x, length), [sp.diff(n, x, derivative) for n in _hermite(x, length)], "mpmath")


def hermite(derivative: int, x: Any, length: Any) -> list[Any]:
    """d^k N/dx^k [4]."""
    return [mpmath.mpf(value) for value in _shapes(derivative)(mpmath.mpf(x), mpmath.mpf(length))]
