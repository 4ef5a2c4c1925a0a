"""Reference values by sympy and mpmath, from the published formulas; nothing here imports the library.

An elastic item is a sum of terms. A term is a list of strains eps(w) with a constant matrix C, W = 1/2 eps' C eps, over local
variables w = A q + c; C may contain parameters. Damping (Kelvin-Voigt, relaxation time tau) is R = tau/2 eps_t' C eps_t with
eps_t = (d eps/dw) w_t. Then

    force     F = dW/dw + dR/dw_t,      stiffness K = dF/dw,      damping D = dF/dw_t,

all differentiated by sympy and evaluated with 30 digits, so that a difference to the library is the library's.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp
from sympy.integrals.quadrature import gauss_legendre

DIGITS = 30


class Law(NamedTuple):
    """Strains of local variables w, their matrix C, and the parameters in both; ``tau`` is always the first parameter."""

    w: tuple[sp.Symbol, ...]
    strains: tuple[sp.Expr, ...]
    moduli: Any
    parameters: tuple[sp.Symbol, ...]


class Term(NamedTuple):
    """A law at w = matrix q + constant with numbers for its parameters (tau first)."""

    law: Any
    matrix: Any
    constant: Any
    numbers: tuple


@cache
def compiled(make_law: Any) -> Any:
    """(w, w_t, parameters) -> W, F, K, D by sympy, from the function that makes a law."""
    law = make_law()
    tau = sp.Symbol("tau")
    rates = sp.symbols(f"rate:{len(law.w)}")
    eps, c = sp.Matrix(law.strains), sp.Matrix(law.moduli)
    eps_t = eps.jacobian(law.w) * sp.Matrix(rates)
    energy = (eps.T * c * eps)[0] / 2
    loss = tau * (eps_t.T * c * eps_t)[0] / 2
    force = sp.Matrix([sp.diff(energy, x) + sp.diff(loss, y) for x, y in zip(law.w, rates)])
    stiffness, damping = force.jacobian(law.w), force.jacobian(rates)
    return sp.lambdify([*law.w, *rates, tau, *law.parameters], [energy, force, stiffness, damping], modules="mpmath", cse=True)


def evaluate(terms: list[Term], q: np.ndarray, v: np.ndarray) -> tuple[Any, Any, Any, Any]:
    """W, F [n], K [n, n], D [n, n] of a sum of terms at q, v, rounded from 30 digits."""
    with mpmath.workdps(DIGITS):
        n = len(q)
        total = [mpmath.mpf(0), mpmath.matrix(n, 1), mpmath.matrix(n, n), mpmath.matrix(n, n)]
        qs, vs = mpmath.matrix(q.tolist()), mpmath.matrix(v.tolist())
        for term in terms:
            a = mpmath.matrix(term.matrix)
            w, rates = a * qs + mpmath.matrix(term.constant), a * vs
            energy, force, stiffness, damping = compiled(term.law)(*w, *rates, *term.numbers)
            parts = energy, a.T * force, a.T * stiffness * a, a.T * damping * a
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


def planar_cable() -> Law:
    """U = 1/2 int EA (|r'|/|r0'| - 1)^2 + EI (kappa - kappa0)^2 ds at a Gauss point, kappa = (r' x r'')/(|r'|^2 |r0'|); ``ds`` with its weight."""
    x1, x2, y1, y2 = w = sp.symbols("x1 x2 y1 y2")
    ea, ei, ds, rest, kappa0 = parameters = sp.symbols("EA EI ds rest kappa0")
    square = x1**2 + x2**2
    strains = (sp.sqrt(square) / rest - 1, (x1 * y2 - x2 * y1) / (square * rest) - kappa0)
    return Law(w, strains, sp.diag(ea * ds, ei * ds), parameters)


def spatial_cable() -> Law:
    """The same in space: three components of curvature, straight at rest."""
    w = sp.symbols("x1:4 y1:4")
    ea, ei, ds = parameters = sp.symbols("EA EI ds")
    x, y = sp.Matrix(w[:3]), sp.Matrix(w[3:])
    strains = (sp.sqrt(x.dot(x)) - 1, *(x.cross(y) / x.dot(x)))
    return Law(w, strains, sp.diag(ea, ei, ei, ei) * ds, parameters)


def local_frame() -> Law:
    """Eq. 18 of Escalona et al. (1998): U = 1/2 int EA u_l'^2 + EI u_t''^2 dx, integrated exactly; w = (chord d, slopes s0, s1).

    Seen from the chord, r - r_O = N2 s0 + N3 d + N4 s1, so u_l' = N2' (i.s0 - 1) + N3' (|d| - l) + N4' (i.s1 - 1), because
    N2' + l N3' + N4' = 1, and u_t'' = N2'' j.s0 + N4'' j.s1.
    """
    w = sp.symbols("d1 d2 s1:3 t1:3")
    ea, ei, length, x = sp.symbols("EA EI l x", positive=True)
    d, s0, s1 = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4))
    size = sp.sqrt(d.dot(d))
    i, j = d / size, sp.Matrix([-d[1], d[0]]) / size
    _, n2, n3, n4 = _hermite(x, length)
    along, across = sp.Matrix([n3, n2, n4]), sp.Matrix([n2, n4])
    stretch = (along.diff(x) * along.diff(x).T).applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, length)))
    bend = (across.diff(x, 2) * across.diff(x, 2).T).applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, length)))
    strains = (size - length, i.dot(s0) - 1, i.dot(s1) - 1, j.dot(s0), j.dot(s1))
    return Law(w, strains, sp.diag(ea * stretch, ei * bend), (ea, ei, length))


def _angle(a: Any) -> sp.Expr:
    """From the x axis: of vectors that are not near the negative one."""
    return sp.atan2(a[1], a[0])


def corotational() -> Law:
    """U = EA/2l (|c| - l)^2 + EI/2l (4 t1^2 + 4 t1 t2 + 4 t2^2), t_a the angle from the chord c to the director d_a."""
    w = sp.symbols("c1 c2 a1 a2 b1 b2")
    ea, ei, length = sp.symbols("EA EI l")
    chord, first, second = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4))
    strains = (sp.sqrt(chord.dot(chord)) - length, _angle(first) - _angle(chord), _angle(second) - _angle(chord))
    return Law(w, strains, sp.diag(ea, ei * sp.Matrix([[4, 2], [2, 4]])) / length, (ea, ei, length))


def geometrically_exact() -> Law:
    """U = 1/2 (EA e^2 + GA g^2 + EI k^2) dx at a Gauss point with N_a(x): (1 + e, g) = R(theta)' r', theta = N_a theta_a, k = theta'."""
    w = sp.symbols("r1 r2 a1 a2 b1 b2 c1 c2")
    numbers = sp.symbols("EA GA EI dx n1:4 m1:4")
    slope, *directors = (sp.Matrix(w[k : k + 2]) for k in (0, 2, 4, 6))
    angles = [_angle(d) for d in directors]
    theta = sum(n * t for n, t in zip(numbers[4:7], angles))
    along, across = sp.Matrix([sp.cos(theta), sp.sin(theta)]), sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    strains = (along.dot(slope) - 1, across.dot(slope), sum(m * t for m, t in zip(numbers[7:], angles)))
    return Law(w, strains, sp.diag(*numbers[:3]) * numbers[3], numbers)


def deflection() -> Law:
    """1/2 k q^2 of a modal coordinate q = (i d) . p."""
    w = sp.symbols("d1 d2 p1 p2")
    k = sp.Symbol("k")
    return Law(w, (w[0] * w[3] - w[1] * w[2],), sp.Matrix([[k]]), (k,))


def _spring(d: int) -> Law:
    p = sp.symbols(f"p1:{d + 1}")
    k, length = sp.symbols("k length")
    return Law(p, (sp.sqrt(sum(x**2 for x in p)) - length,), sp.Matrix([[k]]), (k, length))


def planar_spring() -> Law:
    """1/2 k (|p| - length)^2."""
    return _spring(2)


def spatial_spring() -> Law:
    return _spring(3)


def linear() -> Law:
    """1/2 k (w - rest)^2 of one number: a component of a spring of zero length, a turn."""
    w, k, rest = sp.symbols("w k rest")
    return Law((w,), (w - rest,), sp.Matrix([[k]]), (k, rest))
