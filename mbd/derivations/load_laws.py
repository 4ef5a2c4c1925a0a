"""The forces of all kernels of loads, by class, from their virtual work: ``LOADS[kernel](key, numbers, item)`` is the term of one item.

A force F does the work F . dp; a torque T the work T . d(theta), where an axis e that it turns tells the rotation as e x de / |e|^2, three
orthonormal ones as 1/2 sum e_a x de_a. ``numbers`` are what the item handed to its kernel (``Model.load``); inputs are the user's functions of time.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from mbd.affine import Array
from mbd.elements.control import Pursuit
from mbd.elements.force import DeadForces, FollowerForces
from mbd.elements.force_law import Laws, RateLaws
from mbd.elements.friction import Frictions
from mbd.elements.stop import StopSprings
from mbd.elements.torque import DeadTorques, FollowerTorques, PlanarTorques, RigidTorques
from mbd.joints.drives import Couples

from .law import LoadLaw, Term, rates_of, stacked
from .laws import limits, penetration
from .numbers import number
from .rows import called


def _vectors(names: list[str], d: int) -> list[sp.Matrix]:
    return [sp.Matrix(sp.symbols(f"{name}_x:{'xyz'[d - 1]}")) for name in names]


def _unit(e: sp.Matrix) -> sp.Matrix:
    return e / sp.sqrt(e.dot(e))


def _quarter(e: sp.Matrix) -> sp.Matrix:
    """Turned counter-clockwise by a right angle."""
    return sp.Matrix([-e[1], e[0]])


def _work(variables: list[sp.Matrix], work: Callable[[list[sp.Matrix]], sp.Expr]) -> sp.Matrix:
    """The force that does a work linear in the virtual displacements of all variables."""
    virtual = _vectors([rf"\delta_{k}" for k in range(len(variables))], len(variables[0]))
    flat = [x for v in virtual for x in v]
    expression = work(virtual)
    return sp.Matrix([sp.diff(expression, x) for x in flat])


@cache
def dead_force(d: int) -> LoadLaw:
    p, force = _vectors(["p", "F"], d)
    return LoadLaw(p, force, _work([p], lambda change: force.dot(change[0])))


@cache
def follower_force(d: int, count: int) -> LoadLaw:
    """F = sum F_k u_k along the directions of the axes; in the plane the second is a right angle ahead of the first."""
    axes, (p,) = _vectors([f"e{k + 1}" for k in range(1 if d == 2 else count)], d), _vectors(["p"], d)
    inputs = sp.symbols(f"F_1:{count + 1}")
    units = [_unit(e) for e in axes]
    if d == 2:
        units.append(_quarter(units[0]))
    total = sum((f * u for f, u in zip(inputs, units)), sp.zeros(d, 1))
    w = [*axes, p]
    return LoadLaw([x for v in w for x in v], inputs, _work(w, lambda change: total.dot(change[-1])))


@cache
def planar_torque(rigid: bool) -> LoadLaw:
    """T . d(theta); of a rigid body |e| = 1 holds by its internal equation."""
    (e,), torque = _vectors(["e"], 2), sp.Symbol("T")
    size = sp.Integer(1) if rigid else e.dot(e)
    return LoadLaw(e, [torque], _work([e], lambda change: torque * _quarter(e).dot(change[0]) / size))


@cache
def spatial_torque(count: int, follower: bool) -> LoadLaw:
    axes = _vectors([f"e{k + 1}" for k in range(count)], 3)
    inputs = sp.Matrix(sp.symbols("T_1:4" if follower else "T_x:z"))
    torque = sum((t * _unit(e) for t, e in zip(inputs, axes)), sp.zeros(3, 1)) if follower else inputs
    share = sp.Integer(1) if count == 1 else sp.Rational(1, 2)

    def work(change: list[sp.Matrix]) -> sp.Expr:
        return sum(share * torque.dot(e.cross(de)) / e.dot(e) for e, de in zip(axes, change))

    return LoadLaw([x for e in axes for x in e], inputs, _work(axes, work))


@cache
def couple() -> LoadLaw:
    phi, torque = sp.symbols("phi T")
    return LoadLaw([phi], [torque], [torque])


def _dead_force(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    point = numbers["points"][n]
    return Term(dead_force(point.dimension), *stacked([point]), ())


def _follower_force(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    """In the plane the second axis is i times the first: not a variable of its own."""
    point, axes = numbers["points"][n], numbers["axes"][n]
    d = point.dimension
    return Term(follower_force(d, len(axes)), *stacked([*axes[: 1 if d == 2 else None], point]), ())


def _torque(law: LoadLaw) -> Callable[[tuple, dict[str, Any], int], Term]:
    return lambda key, numbers, n: Term(law, *stacked([numbers["axes"][n]]), ())


def _spatial(follower: bool) -> Callable[[tuple, dict[str, Any], int], Term]:
    return lambda key, numbers, n: Term(spatial_torque(key[0], follower), *stacked(numbers["axes"][n]), ())


def _couple(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    return Term(couple(), np.array([numbers["turns"][n]]), sp.eye(1), sp.zeros(1, 1), ())


def _pursuit(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    """What a controller pulls with: its input is proportional c + derivative c'."""
    return Term(couple(), np.array([numbers["at"][n]]), sp.eye(1), sp.zeros(1, 1), ())


def _stop_spring(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    """-k p(s)."""
    which, parameters = limits(numbers, n)
    s, symbols, p = penetration(*which)
    force = -number(numbers["stiffness"][n]) * p.subs(dict(zip(symbols, map(number, parameters))))
    return Term(LoadLaw([s], [], [force]), np.array([numbers["at"][n]]), sp.eye(1), sp.zeros(1, 1), ())


def _friction(key: tuple, numbers: dict[str, Any], n: int) -> Term:
    """-F tanh(s_t / speed)."""
    s = sp.Symbol("s", real=True)
    (rate,), size, speed = rates_of([s]), number(numbers["size"][n]), number(numbers["speed"][n])
    return Term(LoadLaw([s], [], [-size * sp.tanh(rate / speed)]), np.array([numbers["at"][n]]), sp.eye(1), sp.zeros(1, 1), ())


def _force_law(rates: bool) -> Callable[[tuple, dict[str, Any], int], Term]:
    """The user's function of t and the measures, and perhaps their rates."""

    def term(key: tuple, numbers: dict[str, Any], n: int) -> Term:
        formula, t, w = numbers["formulas"][n], sp.Symbol("t", real=True), sp.symbols(f"s_1:{key[0] + 1}")
        arguments = [t, *w, *(rates_of(w) if rates else ())]
        law = LoadLaw(w, [t], called(formula.item, formula.function, arguments))
        return Term(law, numbers["at"][n], sp.eye(key[0]), sp.zeros(key[0], 1), ())

    return term


LOADS: dict[type, Callable[[tuple, dict[str, Any], int], Term]] = {
    DeadForces: _dead_force,
    FollowerForces: _follower_force,
    RigidTorques: _torque(planar_torque(True)),
    PlanarTorques: _torque(planar_torque(False)),
    DeadTorques: _spatial(False),
    FollowerTorques: _spatial(True),
    Couples: _couple,
    Pursuit: _pursuit,
    StopSprings: _stop_spring,
    Laws: _force_law(False),
    RateLaws: _force_law(True),
    Frictions: _friction,
}

INPUTS: dict[type, Callable[[dict[str, Any], int, Array], list[float]]] = {
    Pursuit: lambda numbers, n, t: [float(np.sum(p * c.value(t) + d * c.rate(t))) for (p, d), c in [(numbers["gains"][n], numbers["targets"][n])]],
    StopSprings: lambda numbers, n, t: [],
    Laws: lambda numbers, n, t: [float(t)],
    RateLaws: lambda numbers, n, t: [float(t)],
    Frictions: lambda numbers, n, t: [],
}
"""Inputs at a time, of kernels whose inputs are not the samples of their signals."""
