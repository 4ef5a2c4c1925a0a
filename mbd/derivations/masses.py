"""Masses and weights by kind of description: ``MASSES[kind](item)`` are the blocks of one item in terms of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from mbd.elements import AncfCable, CorotationalBeam, FloatingFrameBeam, GeometricallyExactBeam, Particle, RigidBody

from .beam_laws import lagrange
from .laws import shape_derivative, shapes
from .numbers import number


class Mass(NamedTuple):
    """A block [k, k] on rows [k] of the table, what gravity pulls with [k], and the values of the symbols in both."""

    rows: NDArray[np.intp]
    block: sp.Matrix
    weight: sp.Matrix
    values: dict[sp.Symbol, sp.Expr]


def consistent_mass() -> tuple[sp.Symbol, sp.Matrix, sp.Matrix]:
    """l, int N N' dx and int N dx over one element: eqs. 8 and 27 for rho A = 1."""
    x, length, n = shape_derivative(0)
    column = sp.Matrix(n)
    mass = (column * column.T).applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, length)))
    return length, mass, column.applyfunc(lambda f: sp.integrate(f, (x, 0, length)))


def symbol(item: Any, name: str) -> sp.Symbol:
    return sp.Symbol(f"{name}_{item.name}".replace(" ", "_"), real=True)


def _cable(item: Any) -> Iterator[Mass]:
    length, _, weight = consistent_mass()
    if item.description.gravity == "lumped":
        x, _, n = shape_derivative(0)
        weight = length * sp.Matrix([f.subs(x, length / 2) for f in n])
    yield from _cubic(item, weight)


def _corotational(item: Any) -> Iterator[Mass]:
    """The cubic element's, with unit directors for slopes."""
    *_, weight = consistent_mass()
    yield from _cubic(item, weight)


def _cubic(item: Any, weight: sp.Matrix) -> Iterator[Mass]:
    c, rho_a = item.description, symbol(item, "rhoA")
    length, mass, _ = consistent_mass()
    for e, here in enumerate(lengths(item.name, item.lengths)):
        rows = np.concatenate((item.rows[e], item.rows[e + 1]))
        values = {rho_a: number(c.rho * c.A), here: number(item.lengths[e])}
        yield Mass(rows, rho_a * mass.subs(length, here), rho_a * weight.subs(length, here), values)


def _geometrically_exact(item: Any) -> Iterator[Mass]:
    """int rho A |r_t|^2 + rho I |d_t|^2 dx: positions by their shape functions, rotary inertia at the nodes by the integrals of these."""
    b, x = item.description, sp.Symbol("x")
    line, turning = symbol(item, "rhoA"), symbol(item, "rhoI")
    column = sp.Matrix(lagrange(x))
    mass, share = ((m.applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, 1)))) for m in (column * column.T, column))
    for e, here in enumerate(lengths(item.name, item.lengths)):
        rows, length = item.rows[2 * e : 2 * e + 3], number(item.lengths[e])
        yield Mass(rows[:, 0], line * here * mass, line * here * share, {line: number(b.rho * b.A), here: length})
        rotary = b.rho * b.I if b.rotary_inertia is None else b.rotary_inertia
        yield Mass(rows[:, 1], turning * here * sp.diag(*share), sp.zeros(3, 1), {turning: number(rotary), here: length})


def _floating_frame(item: Any) -> Iterator[Mass]:
    """int rho A f f' dx of f = (1, x, modes, shortenings), over all of the beam; the modes' nodal values are known in numbers only."""
    b, s, count = item.description, sp.Symbol("s"), len(item.lengths)
    m, length = symbol(item, "m"), sp.Symbol(f"l_{item.name}".replace(" ", "_"), positive=True)
    modes, size = item.modes.nodal, 2 + len(item.modal) + len(item.short)
    block, weight = sp.zeros(size, size), sp.zeros(size, 1)
    for e in range(count):
        x, nodal = (e + s) / count, modes[2 * e : 2 * e + 4].T
        functions = shapes(s / count, sp.Rational(1, count))
        bent = [sum(number(c) * f for c, f in zip(row, functions)) for row in nodal]
        shorter = [-f for f in shortenings(x)][: len(item.short)]
        parts = [sp.Poly(f, s) for f in (sp.Integer(1), x, *bent, *shorter)]
        for i, f in enumerate(parts):
            weight[i] += _over_one(f) / count
            for j, g in enumerate(parts[: i + 1]):
                block[i, j] += _over_one(f * g) / count
    block = sp.Matrix(size, size, lambda i, j: block[max(i, j), min(i, j)])
    scale = sp.diag(1, length, *[1] * (size - 2))
    values = {m: number(b.rho * b.A * item.length), length: number(item.length)}
    yield Mass(np.concatenate((item.frame, item.modal, item.short)), m * scale * block * scale, m * scale * weight, values)


def _over_one(f: sp.Poly) -> sp.Expr:
    """The integral from 0 to 1."""
    return f.integrate().eval(1)


def shortenings(xi: Any) -> list[sp.Expr]:
    """The sums u of xi^3, xi^4, xi^5 of which one of int u, 2 int xi u, u(1) is 1 and the others are 0."""
    x, factors = sp.Symbol("x"), sp.symbols("c:3")
    u = sum(c * x**power for c, power in zip(factors, (3, 4, 5)))
    told = (sp.integrate(u, (x, 0, 1)), sp.integrate(sp.expand(2 * x * u), (x, 0, 1)), u.subs(x, 1))
    found = [sp.solve([t - int(j == k) for j, t in enumerate(told)], factors) for k in range(3)]
    return [u.subs(solution).subs(x, xi) for solution in found]


def lengths(name: str, values: Any) -> list[sp.Symbol]:
    """Symbols of the lengths of a cable's elements: one for equal elements."""
    word = name.replace(" ", "_")
    same = np.ptp(values) <= 1e-14 * np.max(values)
    return [sp.Symbol(f"l_{word}" if same else f"l{e}_{word}", positive=True) for e in range(len(values))]


def _particle(item: Any) -> Iterator[Mass]:
    m = symbol(item, "m")
    yield Mass(np.array([item.row]), sp.Matrix([[m]]), sp.Matrix([m]), {m: number(item.description.mass)})


def _body(item: Any) -> Iterator[Mass]:
    """Mass on the centre; on directors J in the plane, E = tr J / 2 - J in space."""
    m, b = symbol(item, "m"), item.description
    values = {m: number(b.mass)}
    if b.position.size == 2:
        j = symbol(item, "J")
        values[j], directors = number(b.inertia), sp.Matrix([[j]])
    else:
        matrix = np.diag(b.inertia) if b.inertia.ndim == 1 else b.inertia
        j = sp.Matrix(3, 3, lambda r, c: symbol(item, f"J{'xyz'[min(r, c)]}{'xyz'[max(r, c)]}") if matrix[r, c] else 0)
        values |= {j[r, c]: number(matrix[r, c]) for r in range(3) for c in range(r, 3) if matrix[r, c]}
        directors = sp.trace(j) / 2 * sp.eye(3) - j
    yield Mass(item.rows, sp.diag(m, directors), sp.Matrix([m, *[0] * directors.rows]), values)


MASSES: dict[type, Callable[[Any], Iterator[Mass]]] = {
    AncfCable: _cable,
    CorotationalBeam: _corotational,
    FloatingFrameBeam: _floating_frame,
    GeometricallyExactBeam: _geometrically_exact,
    Particle: _particle,
    RigidBody: _body,
}
