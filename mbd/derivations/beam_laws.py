"""The energies of the planar beams beside the cable: corotational, geometrically exact, and the modes of a floating frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from mbd.elements.corotational import Corotational
from mbd.elements.floating_frame import Deflection
from mbd.elements.geometrically_exact import GeometricallyExact

from .law import Law, Term
from .numbers import gauss, number

Terms = Callable[[tuple, dict[str, Any], int], list[Term]]


def angle(a: Any, b: Any) -> sp.Expr:
    """From vector a to vector b, within half a turn: whatever their directions, a beam may point anywhere."""
    return sp.atan2(a[0] * b[1] - a[1] * b[0], a.dot(b))


@cache
def corotational() -> Law:
    """U = EA/2l (|c| - l)^2 + EI/2l (4 t_0^2 + 4 t_0 t_1 + 4 t_1^2), t_a the angle from the chord c to the director d_a."""
    w = sp.symbols("c_x c_y d_0x d_0y d_1x d_1y")
    ea, ei, tau, length = sp.symbols("EA EI tau l", positive=True)
    chord, first, second = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4))
    strains = (sp.sqrt(chord.dot(chord)) - length, angle(chord, first), angle(chord, second))
    moduli = sp.diag(ea, ei * sp.Matrix([[4, 2], [2, 4]])) / length
    return Law(w, strains, moduli, tau * moduli, [ea, ei, tau, length])


@cache
def geometrically_exact() -> Law:
    """U = 1/2 (EA e^2 + GA g^2 + EI k^2) dx at a Gauss point with N_a(x): (1 + e, g) = R(theta)' r', theta = N_a theta_a, k = theta'.

    Angles theta_a are counted from that of the middle director, which changes neither theta nor k: the N_a sum to 1, the N_a' to 0.
    """
    w = sp.symbols("r'_x r'_y d_0x d_0y d_1x d_1y d_2x d_2y")
    ea, ga, ei, tau, dx = sp.symbols("EA GA EI tau dx", positive=True)
    n, m = sp.symbols("N_0:3"), sp.symbols("N'_0:3")
    slope, *directors = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4, 6))
    angles = [angle(directors[1], d) for d in directors]
    theta = angle(sp.Matrix([1, 0]), directors[1]) + sum(a * t for a, t in zip(n, angles))
    along, across = sp.Matrix([sp.cos(theta), sp.sin(theta)]), sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    strains = (along.dot(slope) - 1, across.dot(slope), sum(a * t for a, t in zip(m, angles)))
    moduli = sp.diag(ea, ga, ei) * dx
    return Law(w, strains, moduli, tau * moduli, [ea, ga, ei, tau, dx, *n, *m])


@cache
def deflection() -> Law:
    """The modal coordinate (k x d) . p of a mode."""
    w = sp.symbols("d_x d_y p_x p_y")
    k, tau = sp.symbols("k tau", positive=True)
    return Law(w, [w[0] * w[3] - w[1] * w[2]], [[k]], [[k * tau]], [k, tau])


def lagrange(x: Any) -> tuple[Any, ...]:
    """Quadratic shape functions through x = 0, 1/2, 1."""
    nodes = (0, sp.Rational(1, 2), 1)
    return tuple(sp.prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes)


def _weighed(functions: Sequence[Sequence[Any]]) -> sp.Matrix:
    """Vectors [2] that are sums of nodal vectors, for coordinates ordered by node, then component."""
    return sp.kronecker_product(sp.Matrix(functions), sp.eye(2))


def _corotational(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    matrix = _weighed([[-1, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    parameters = tuple(numbers[name][n] for name in ("EA", "EI", "damping", "length"))
    return [Term(corotational(), numbers["nodes"][n].ravel(), matrix, sp.zeros(6, 1), parameters)]


def _geometrically_exact(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    """Two Gauss points; the coordinates are (r_0, d_0, r_1, d_1, r_2, d_2)."""
    length, x, terms = number(numbers["length"][n]), sp.Symbol("x"), []
    own = tuple(numbers[name][n] for name in ("EA", "GA", "EI", "damping"))
    directors = [[int(k == 2 * a + 1) for k in range(6)] for a in range(3)]
    for xi, weight in gauss(2):
        values = [f.subs(x, xi) for f in lagrange(x)]
        slopes = [sp.diff(f, x).subs(x, xi) / length for f in lagrange(x)]
        matrix = _weighed([[f for slope in slopes for f in (slope, 0)], *directors])
        parameters = (*own, weight * length, *values, *slopes)
        terms.append(Term(geometrically_exact(), numbers["nodes"][n].ravel(), matrix, sp.zeros(8, 1), parameters))
    return terms


def _deflection(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    parameters = (numbers["stiffness"][n], numbers["damping"][n])
    return [Term(deflection(), np.ravel(numbers["nodes"][n]), sp.eye(4), sp.zeros(4, 1), parameters)]


BEAMS: dict[type, Terms] = {Corotational: _corotational, GeometricallyExact: _geometrically_exact, Deflection: _deflection}
