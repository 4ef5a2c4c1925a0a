"""From the shape functions of the 1998 element to its mass matrix and gravity vectors: eqs. 1-11, 27 and 28."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

import mbd
from mbd.elements.shapes import hermite, hermite_bend, hermite_slope

from .laws import shape_derivative, shapes
from .masses import consistent_mass
from .numbers import evaluated
from .step import PAPER, Pairs, Step

X, LENGTH = sp.symbols("x l", positive=True)
MASS, GRAVITY = sp.symbols("m g", positive=True)
RX, RY, THETA = Q = sp.symbols("R_x R_y theta", real=True)
RATES = sp.symbols(r"\dot{R}_x \dot{R}_y \dot{theta}", real=True)


def shape_matrix() -> sp.Matrix:
    """S [2, 8]: r = S e."""
    return sp.kronecker_product(sp.Matrix([shapes(X, LENGTH)]), sp.eye(2))


@cache
def rigid() -> sp.Matrix:
    """e of a straight, unstretched element at R, theta: eq. 3."""
    c, s = sp.cos(THETA), sp.sin(THETA)
    return sp.Matrix([RX, RY, c, s, RX + LENGTH * c, RY + LENGTH * s, c, s])


@cache
def mass() -> sp.Matrix:
    """M [8, 8] in terms of m = rho A l."""
    _, block, _ = consistent_mass()
    return sp.kronecker_product(block * MASS / LENGTH, sp.eye(2)).applyfunc(sp.expand)


class Element:
    """One element at a random place, in numbers: R, theta and their rates, l, m."""

    def __init__(self, rng: np.random.Generator, **words: Any):
        self.values = dict(zip((*Q, *RATES), rng.standard_normal(6).tolist()))
        length, rho, area = rng.uniform(0.5, 2.0, 3).tolist()
        self.values |= {LENGTH: length, MASS: rho * area * length, GRAVITY: 9.81}
        start, angle = np.array([self.values[RX], self.values[RY]]), self.values[THETA]
        end = start + length * np.array([np.cos(angle), np.sin(angle)])
        self.scene = mbd.Scene(gravity=(0.0, -9.81))
        self.item = self.scene.add(mbd.AncfCable(start, end, n_elements=1, E=1.0, A=area, I=1.0, rho=rho, **words))
        self.system = self.scene.build()

    def of(self, expression: Any) -> Any:
        return evaluated(expression, self.values)


def _shapes(rng: np.random.Generator) -> Pairs:
    length, xi = rng.uniform(0.5, 2.0), rng.uniform()
    scale = np.array([1.0, length, 1.0, length])
    for order, (name, function) in enumerate((("N", hermite), ("dN/dx", hermite_slope), ("d2N/dx2", hermite_bend))):
        x, symbol, formula = shape_derivative(order)
        yield name, evaluated(sp.Matrix(formula), {x: xi * length, symbol: length})[:, 0], function(xi) * scale / length**order


def _placed(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    yield "e", element.of(rigid())[:, 0], element.system.q0


def _complete(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    s = rng.uniform()
    found = element.item.at(s).point.value(element.system.q0)
    yield "r", evaluated(_along(), element.values | {X: s * element.values[LENGTH]})[:, 0], found


@cache
def _along() -> sp.Matrix:
    return (shape_matrix() * rigid()).applyfunc(sp.simplify)


def _velocity(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    s = rng.uniform()
    v = element.of(velocity_map() * sp.Matrix(RATES))[:, 0]
    exact = _along().jacobian(Q) * sp.Matrix(RATES)
    yield "dr/dt", evaluated(exact, element.values | {X: s * element.values[LENGTH]})[:, 0], element.item.at(s).point.rate(v)


@cache
def velocity_map() -> sp.Matrix:
    """B [8, 3]: de/dt = B d(R, theta)/dt."""
    return rigid().jacobian(Q)


def _mass(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    yield "M", element.of(mass()), element.system.mass(np.eye(8))


def _reduced(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    b = element.of(velocity_map())
    yield "B' M B", element.of(reduced_mass()), b.T @ element.system.mass(b.T).T


@cache
def reduced_mass() -> sp.Matrix:
    b = velocity_map()
    return (b.T * mass() * b).applyfunc(sp.simplify)


def _quadratic(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    b, swirl = element.of(velocity_map()), element.of(_swirl())[:, 0]
    yield "B' M dB/dt dq/dt", element.of(quadratic_term())[:, 0], b.T @ element.system.mass(swirl)


@cache
def _swirl() -> sp.Matrix:
    """dB/dt dq/dt [8]."""
    rate = sum((sp.diff(velocity_map(), x) * v for x, v in zip(Q, RATES)), sp.zeros(8, 3))
    return rate * sp.Matrix(RATES)


@cache
def quadratic_term() -> sp.Matrix:
    return (velocity_map().T * mass() * _swirl()).applyfunc(sp.simplify)


@cache
def inertia() -> sp.Expr:
    e = rigid()
    return sp.simplify((e.T * mass() * e)[0])


def _inertia(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    q = element.system.q0
    yield "e' M e", element.of(sp.Matrix([inertia()]))[0, 0], q @ element.system.mass(q)


def weight(gravity: str) -> sp.Matrix:
    """The generalised force of gravity [8] along -y."""
    s = shape_matrix()[1, :].T * -MASS * GRAVITY
    return s.subs(X, LENGTH / 2) if gravity == "lumped" else (s / LENGTH).applyfunc(lambda f: sp.integrate(sp.expand(f), (X, 0, LENGTH)))


def _weight(gravity: str) -> Any:
    def compare(rng: np.random.Generator) -> Pairs:
        element = Element(rng, gravity=gravity)
        yield f"{gravity} weight", element.of(weight(gravity))[:, 0], element.system.weight

    return compare


def steps() -> list[Step]:
    cable = "mbd.elements.ancf_cable.AncfCable"
    return [
        Step("Shape functions, cubic in xi = x/l", "N(x)", sp.Matrix(shapes(X, LENGTH)), f"{PAPER}, eq. 1", "mbd.elements.shapes", _shapes),
        Step("Coordinates of a rigid element", "e", rigid(), f"{PAPER}, eq. 3", f"{cable}.place", _placed),
        Step("They describe every rigid position exactly", r"S(x)\, e", _along(), f"{PAPER}, eq. 4", "mbd.elements.ancf_cable.Cable.at", _complete),
        Step(r"Velocities of a rigid element", r"B = \partial e / \partial (R, \theta)", velocity_map(), f"{PAPER}, eqs. 5, 9, 10",
             "mbd.affine.Affine.rate", _velocity),
        Step("Mass matrix, constant", r"M = \int \rho A\, S^T S\, dx", mass(), f"{PAPER}, eq. 8", "mbd.elements.shapes.MASS", _mass),
        Step("It reduces to that of a rigid rod", "B^T M B", reduced_mass(), f"{PAPER}, eq. 11", "mbd.system.System.mass", _reduced),
        Step("and the quadratic velocity term of the rod comes out with it", r"B^T M \dot{B} \dot{q}", quadratic_term(), f"{PAPER}, after eq. 11",
             "mbd.system.System.mass", _quadratic),
        Step("Inertia about the origin", "J = e^T M e", inertia(), f"{PAPER}, Table 1", "mbd.system.System.mass", _inertia),
        Step("Gravity, distributed", "Q", weight("consistent"), f"{PAPER}, eq. 27", "mbd.elements.shapes.WEIGHT", _weight("consistent")),
        Step("Gravity, concentrated at midspan", "Q", weight("lumped"), f"{PAPER}, eq. 28", "mbd.elements.shapes.WEIGHT_LUMPED", _weight("lumped")),
    ]  # fmt: skip
