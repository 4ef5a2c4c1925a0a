"""Masses and weights by kind of description: ``MASSES[kind](item)`` are the blocks of one item in terms of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from mbd.elements import AncfCable, Particle, RigidBody

from .laws import shape_derivative
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
    c = item.description
    rho_a = symbol(item, "rhoA")
    length, mass, weight = consistent_mass()
    x, _, n = shape_derivative(0)
    if c.gravity == "lumped":
        weight = length * sp.Matrix([f.subs(x, length / 2) for f in n])
    own = lengths(item.name, item.lengths)
    for e in range(len(item.lengths)):
        rows = np.concatenate((item.rows[e], item.rows[e + 1]))
        here = own[e]
        values = {rho_a: number(c.rho * c.A), here: number(item.lengths[e])}
        yield Mass(rows, rho_a * mass.subs(length, here), rho_a * weight.subs(length, here), values)


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


MASSES: dict[type, Callable[[Any], Iterator[Mass]]] = {AncfCable: _cable, Particle: _particle, RigidBody: _body}
