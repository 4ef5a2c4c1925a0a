"""The energies of all elastic kernels, by class: ``TERMS[kernel](key, numbers, item)`` are the terms of one item.

``numbers`` are what the item handed to its kernel (``Model.strain``); parameters may be replaced by symbols, "stored" are then the numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from mbd.elements.local_frame import LocalFrame
from mbd.elements.planar_continuum import PlanarContinuum
from mbd.elements.spatial_continuum import SpatialContinuum
from mbd.elements.spring_strains import Offset, Stretch, Twist
from mbd.elements.stop import StopDampers

from .beam_laws import BEAMS
from .law import Law, Term, stacked
from .numbers import gauss, number


def shapes(x: Any, length: Any) -> tuple[sp.Expr, ...]:
    """N(x) for the nodal vectors (r, dr/dx, r, dr/dx); Escalona et al. (1998), eq. 1."""
    xi = x / length
    return 1 - 3 * xi**2 + 2 * xi**3, length * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, length * (xi**3 - xi**2)


@cache
def shape_derivative(order: int) -> tuple[sp.Symbol, sp.Symbol, tuple[sp.Expr, ...]]:
    """x, l and d^k N/dx^k."""
    x, length = sp.symbols("x l", positive=True)
    return x, length, tuple(sp.expand(sp.diff(n, x, order)) for n in shapes(x, length))


def shapes_at(order: int, xi: Any, length: Any) -> list[sp.Expr]:
    """d^k N/dx^k [4] at x = xi l."""
    return _shape_function(order)(xi * length, length)


@cache
def _shape_function(order: int) -> Any:
    x, length, functions = shape_derivative(order)
    return sp.lambdify((x, length), list(functions), "sympy")


def cross(x: Any, y: Any) -> sp.Matrix:
    """x cross y: one component in the plane."""
    return sp.Matrix([x[0] * y[1] - x[1] * y[0]]) if len(x) == 2 else sp.Matrix(x).cross(sp.Matrix(y))


@cache
def continuum(d: int) -> Law:
    """Stretch |r'|/|r0'| - 1 and curvature (r' x r'')/(|r'|^2 |r0'|) - kappa0 at a Gauss point, over the arc ds; x = r', y = r''."""
    w = [*sp.symbols(f"r'_x:{'xyz'[d - 1]}"), *sp.symbols(f"r''_x:{'xyz'[d - 1]}")]
    ea, ei, tau, arc, rest = sp.symbols("EA EI tau ds r'_0", positive=True)
    kappa0 = sp.Symbol("kappa_0")
    x, y = sp.Matrix(w[:d]), sp.Matrix(w[d:])
    curvature = cross(x, y) / (x.dot(x) * rest)
    if d == 2:
        curvature = curvature - sp.Matrix([kappa0])
    moduli = sp.diag(ea, *[ei] * len(curvature)) * arc
    return Law(w, [sp.sqrt(x.dot(x)) / rest - 1, *curvature], moduli, tau * moduli, [ea, ei, tau, arc, rest, kappa0])


@cache
def chord_frame() -> Law:
    """Eq. 18 of Escalona et al. (1998): U = 1/2 int EA u_l'^2 + EI u_t''^2 dx, integrated exactly; w = (chord d, slopes s_0, s_1).

    Seen from the chord, r - r_O = N2 s_0 + N3 d + N4 s_1, so u_l' = N2' (i.s_0 - 1) + N3' (|d| - l) + N4' (i.s_1 - 1), because
    N2' + l N3' + N4' = 1, and u_t'' = N2'' j.s_0 + N4'' j.s_1.
    """
    w = sp.symbols("d_x d_y s_0x s_0y s_1x s_1y")
    ea, ei, tau = sp.symbols("EA EI tau", positive=True)
    _, length, _ = shape_derivative(0)
    d, s0, s1 = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4))
    size = sp.sqrt(d.dot(d))
    i, j = d / size, sp.Matrix([-d[1], d[0]]) / size
    strains = (size - length, i.dot(s0) - 1, i.dot(s1) - 1, j.dot(s0), j.dot(s1))
    moduli = sp.diag(ea * _products(1, (2, 1, 3)), ei * _products(2, (1, 3)))
    return Law(w, strains, moduli, tau * moduli, [ea, ei, tau, length])


def _products(order: int, which: tuple[int, ...]) -> sp.Matrix:
    """int N_a^(k) N_b^(k) dx over the element."""
    x, length, functions = shape_derivative(order)
    return sp.Matrix(len(which), len(which), lambda a, b: sp.integrate(sp.expand(functions[which[a]] * functions[which[b]]), (x, 0, length)))


@cache
def stretch(d: int) -> Law:
    """|p| - L."""
    p = sp.symbols(f"p_x:{'xyz'[d - 1]}")
    k, c, length = sp.symbols("k c L", positive=True)
    return Law(p, [sp.sqrt(sum(x**2 for x in p)) - length], [[k]], [[c]], [k, c, length])


@cache
def offset(d: int) -> Law:
    """p itself."""
    p = sp.symbols(f"p_x:{'xyz'[d - 1]}")
    k, c = sp.symbols("k c", positive=True)
    return Law(p, p, k * sp.eye(d), c * sp.eye(d), [k, c])


@cache
def twist() -> Law:
    """phi - phi_0."""
    phi, rest = sp.symbols("phi phi_0")
    k, c = sp.symbols("k c", positive=True)
    return Law([phi], [phi - rest], [[k]], [[c]], [k, c, rest])


@cache
def penetration(lower: bool, upper: bool) -> tuple[sp.Symbol, list[sp.Symbol], sp.Expr]:
    """s, (s_0, s_1, w) and p = g(s - s_1) - g(s_0 - s) of the limits that there are, g(x) = w (u^3 - u^4/2), u = x/w, then x - w/2."""
    s, low, high = sp.symbols("s s_0 s_1", real=True)
    width = sp.Symbol("w", positive=True)

    def onset(x: sp.Expr) -> sp.Expr:
        u = x / width
        return sp.Piecewise((0, x < 0), (width * (u**3 - u**4 / 2), x < width), (x - width / 2, True))

    return s, [low, high, width], (onset(s - high) if upper else sp.Integer(0)) - (onset(low - s) if lower else sp.Integer(0))


@cache
def stop_damper(lower: bool, upper: bool) -> Law:
    """p itself, without stiffness."""
    s, parameters, p = penetration(lower, upper)
    c = sp.Symbol("c", positive=True)
    return Law([s], [p], [[0]], [[c]], [c, *parameters])


def limits(numbers: dict[str, Any], n: int) -> tuple[tuple[bool, bool], tuple[Any, ...]]:
    """Which limits a stop has, and (s_0, s_1, w), 0 for a limit that it has not."""
    given = [bool(np.isfinite(x)) for x in numbers["limits"][n]]
    return (given[0], given[1]), (*(x if has else 0 for x, has in zip(numbers["limits"][n], given)), numbers["width"][n])


def _stop_damper(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    which, parameters = limits(numbers, n)
    return [Term(stop_damper(*which), np.array([numbers["at"][n]]), sp.eye(1), sp.zeros(1, 1), (numbers["damping"][n], *parameters))]


def _places(nodes: Any, functions: list[list[Any]], d: int) -> sp.Matrix:
    """The matrix [len(functions) d, 4 d] that weighs the nodal vectors, for coordinates ordered as ``nodes`` [d, 4]."""
    return sp.Matrix.vstack(*(sp.kronecker_product(sp.eye(d), sp.Matrix([row])) for row in functions))


def _continuum(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    nodes, length = numbers["nodes"][n], number(numbers["length"][n])
    stored = number(numbers.get("stored", numbers)["length"][n])  # the shape at rest is known in numbers only
    d, rest, terms = len(nodes), numbers["rest"][n], []
    for xi, weight in gauss(*key):
        functions, at_rest = ([shapes_at(k, xi, size) for k in (1, 2)] for size in (length, stored))
        x, y = (sp.Matrix([[sum(number(c) * f for c, f in zip(row, fs))] for row in rest]) for fs in at_rest)
        speed = _tidy(sp.sqrt(x.dot(x)))
        kappa0 = _tidy(cross(x, y)[0] / (x.dot(x) * speed)) if d == 2 else sp.Integer(0)
        parameters = (numbers["EA"][n], numbers["EI"][n], numbers["damping"][n], weight * length * speed, speed, kappa0)
        matrix = _places(nodes, functions, d)
        terms.append(Term(continuum(d), nodes.ravel(), matrix, sp.zeros(2 * d, 1), parameters))
    return terms


def _tidy(x: sp.Expr) -> sp.Expr:
    """Exactly 0 or 1 where it is so but for rounding: a straight cable at rest."""
    near = sp.Integer(round(float(x)))
    return near if near in (0, 1) and abs(float(x - near)) < 1e-14 else x


def _chord_frame(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    nodes = numbers["nodes"][n]
    matrix = _places(nodes, [[-1, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], 2)
    parameters = tuple(numbers[name][n] for name in ("EA", "EI", "damping", "length"))
    return [Term(chord_frame(), nodes.ravel(), matrix, sp.zeros(6, 1), parameters)]


def _stretch(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    apart = numbers["apart"][n]
    parameters = tuple(numbers[name][n] for name in ("stiffness", "damping", "length"))
    return [Term(stretch(apart.dimension), *stacked([apart]), parameters)]


def _offset(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    apart = numbers["apart"][n]
    return [Term(offset(apart.dimension), *stacked([apart]), (numbers["stiffness"][n], numbers["damping"][n]))]


def _twist(key: tuple, numbers: dict[str, Any], n: int) -> list[Term]:
    parameters = tuple(numbers[name][n] for name in ("stiffness", "damping", "angle"))
    return [Term(twist(), np.array([numbers["turn"][n]]), sp.eye(1), sp.zeros(1, 1), parameters)]


TERMS: dict[type, Callable[[tuple, dict[str, Any], int], list[Term]]] = {
    PlanarContinuum: _continuum,
    SpatialContinuum: _continuum,
    LocalFrame: _chord_frame,
    Stretch: _stretch,
    Offset: _offset,
    Twist: _twist,
    StopDampers: _stop_damper,
    **BEAMS,
}
