"""The elastic forces of the 1998 element: strains seen from the frame of its chord, eqs. 14-18, 24 and 25, and their tangent."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

import mbd

from .laws import shape_derivative
from .numbers import evaluated, gauss
from .step import PAPER, Pairs, Step

EA, EI, LENGTH, X = sp.symbols("EA EI l x", positive=True)
E = sp.symbols("e_1:9", real=True)
NODAL = sp.Matrix(E[0::2]), sp.Matrix(E[1::2])  # X, Y
CHORD = sp.Matrix([E[4] - E[0], E[5] - E[1]])
SIZE = sp.sqrt(CHORD.dot(CHORD))
I = CHORD / SIZE  # noqa: E741
J = sp.Matrix([-I[1], I[0]])
KERNEL = "mbd.elements.local_frame.LocalFrameAt"


def shape_row(order: int) -> sp.Matrix:
    """d^k N/dx^k [1, 4]."""
    return sp.Matrix([shape_derivative(order)[2]])


@cache
def integrals() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """K_A = EA int N'^T N' dx, K_B = EI int N''^T N'' dx, a = EA int N'^T dx: the blocks of A_ij, B_ij, A_i."""
    slope, bend = shape_row(1), shape_row(2)
    over = (X, 0, LENGTH)
    products = (EA * slope.T * slope, EI * bend.T * bend, EA * slope.T)
    a, b, c = (m.applyfunc(lambda f: sp.integrate(sp.expand(f), over)) for m in products)
    return a, b, c


class Seen(NamedTuple):
    """From the chord: u = i . e, w = j . e (nodal 4-vectors), forces on them, energy."""

    u: sp.Matrix
    w: sp.Matrix
    on_u: sp.Matrix
    on_w: sp.Matrix
    energy: sp.Expr


@cache
def seen() -> Seen:
    stretch, bend, linear = integrals()
    u, w = (unit[0] * NODAL[0] + unit[1] * NODAL[1] for unit in (I, J))
    energy = ((u.T * stretch * u + w.T * bend * w)[0] - 2 * linear.dot(u) + EA * LENGTH) / 2
    return Seen(u, w, stretch * u - linear, bend * w, energy)


@cache
def turn() -> sp.Matrix:
    """d theta/de [1, 8]: the frame's derivative, di/de = j t, dj/de = -i t."""
    return sp.Matrix([sp.atan2(CHORD[1], CHORD[0])]).jacobian(E).applyfunc(sp.simplify)


@cache
def literal_force() -> sp.Matrix:
    """Eq. 25 term by term, with A_pq, B_pq [8, 8] and A_p [8]."""
    stretch, bend, linear = integrals()
    rows = sp.Matrix([[1, 0]]), sp.Matrix([[0, 1]])
    e = sp.Matrix(E)
    a = [[sp.kronecker_product(stretch, p.T * q) for q in rows] for p in rows]
    b = [[sp.kronecker_product(bend, p.T * q) for q in rows] for p in rows]
    one = [sp.kronecker_product(linear, p.T) for p in rows]
    total = sp.zeros(8, 1)
    for matrices, unit, loads in ((a, I, one), (b, J, [sp.zeros(8, 1)] * 2)):
        mixed = matrices[0][1] + matrices[1][0]
        total += (matrices[0][0] * unit[0] ** 2 + matrices[1][1] * unit[1] ** 2 + mixed * unit[0] * unit[1]) * e
        total -= loads[0] * unit[0] + loads[1] * unit[1]
        for p in (0, 1):
            factor = (e.T * matrices[p][p] * e)[0] * unit[p] + (e.T * mixed * e)[0] * unit[1 - p] / 2 - loads[p].dot(e)
            total += factor * sp.Matrix([[unit[p]]]).jacobian(E).T
    return total


@cache
def _gradient() -> sp.Matrix:
    return sp.Matrix([seen().energy]).jacobian(E).T


class Element:
    """One deformed element in numbers."""

    def __init__(self, rng: np.random.Generator):
        length, ea, ei = rng.uniform(0.5, 2.0, 3).tolist()
        scene = mbd.Scene(gravity=(0, 0))
        scene.add(mbd.AncfCable((0, 0), (length, 0), n_elements=1, E=ea, A=1.0, I=ei / ea, rho=1.0, elasticity="local_frame"))
        system = scene.build()
        self.q = system.q0 + 0.15 * rng.standard_normal(8)
        self.kernel = system.measures[0]
        self.at = self.kernel.at(self.q)
        self.stress = self.kernel.modulus * self.at.value
        self.values = dict(zip(E, self.q.tolist())) | {LENGTH: length, EA: ea, EI: ea * (ei / ea)}

    def of(self, expression: Any) -> Any:
        return evaluated(sp.Matrix(expression), self.values)

    @staticmethod
    def ordered(found: Any) -> Any:
        """From (X, Y) to e."""
        return np.swapaxes(np.reshape(found, (2, 4)), 0, 1).ravel()


def _chord(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    yield "|d|", element.of([SIZE])[0, 0], element.at.length[0]
    yield "i", element.of(I)[:, 0], element.at.i[0]


def _turn(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    yield "t", element.of(turn())[0], element.ordered(element.at.turn[0])


@cache
def strains() -> sp.Matrix:
    """u_l' = i . r' - 1 and u_t'' = j . r''."""
    slope, bend = ([row.dot(nodal) for nodal in NODAL] for row in (shape_row(1), shape_row(2)))
    return sp.Matrix([I.dot(sp.Matrix(slope)) - 1, J.dot(sp.Matrix(bend))])


def _strains(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    for which, (name, points) in enumerate((("u_l'", 3), ("u_t''", 2))):
        places = [float(xi) * element.values[LENGTH] for xi, _ in gauss(points)]
        exact = [evaluated(sp.Matrix([strains()[which]]), element.values | {X: x})[0, 0] for x in places]
        found = element.at.value[0]
        yield name, np.sort(exact), np.sort(found[:3] if which == 0 else found[3:])


def _integrals(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    k = element.kernel
    axial, bending = k.axial[0], k.bending[0]
    stretch, bend = (m.T @ (c[:, None] * m) for m, c in ((axial, k.modulus[0, :3]), (bending, k.modulus[0, 3:])))
    exact = [element.of(m) for m in integrals()]
    yield "A_11", exact[0], stretch
    yield "B_11", exact[1], bend
    yield "A_1", exact[2][:, 0], axial.T @ k.modulus[0, :3]


def _energy(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    yield "U", element.of([seen().energy])[0, 0], element.at.energy()


def _force(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    found = element.ordered(element.at.pull(element.stress)[0])
    yield "eq. 25", element.of(literal_force())[:, 0], found
    yield "dU/de", element.of(_gradient())[:, 0], found


def _tangent(rng: np.random.Generator) -> Pairs:
    element = Element(rng)
    found = element.at.stiffness(element.stress, element.kernel.modulus)[0].reshape(2, 4, 2, 4).transpose(1, 0, 3, 2).reshape(8, 8)
    yield "dQ/de", element.of(compact_tangent()), found


@cache
def compact_tangent() -> sp.Matrix:
    """U_u' K_A U_u + W_w' K_B W_w + s t' + t s' - (g_u . u + g_w . w) t t' + tau T."""
    stretch, bend, _ = integrals()
    u, w, on_u, on_w, _ = seen()
    t = turn().T
    by_u, by_w = (sp.kronecker_product(sp.eye(4), unit.T) for unit in (I, J))
    whole_u, whole_w = by_u + w * t.T, by_w - u * t.T
    side = by_w.T * on_u - by_u.T * on_w
    tau, inward = on_u.dot(w) - on_w.dot(u), on_u.dot(u) + on_w.dot(w)
    bent = whole_u.T * stretch * whole_u + whole_w.T * bend * whole_w
    return bent + side * t.T + t * side.T - inward * t * t.T + tau * t.jacobian(E)


def _vectors(names: str) -> list[Any]:
    return [sp.MatrixSymbol(name, 4, 1) for name in names.split()]


def steps() -> list[Step]:
    u, w, a, on_u, on_w = _vectors("u w a g_u g_w")
    stretch, bend = sp.MatrixSymbol("K_A", 4, 4), sp.MatrixSymbol("K_B", 4, 4)
    ix, iy = sp.symbols("i_x i_y")
    half = sp.Rational(1, 2)
    t, s = sp.MatrixSymbol("t", 8, 1), sp.MatrixSymbol("s", 8, 1)
    whole_u, whole_w, bent = sp.MatrixSymbol("U", 4, 8), sp.MatrixSymbol("W", 4, 8), sp.MatrixSymbol("T", 8, 8)
    tau, inward = sp.symbols("tau n")
    energy = half * u.T * stretch * u - a.T * u + half * w.T * bend * w + sp.Matrix([EA * LENGTH / 2])
    tangent = whole_u.T * stretch * whole_u + whole_w.T * bend * whole_w + s * t.T + t * s.T - inward * t * t.T + tau * bent
    force = sp.BlockMatrix([[ix * on_u - iy * on_w], [iy * on_u + ix * on_w]])
    here, whole = f"{PAPER}, eq.", "mbd.elements.local_frame.LocalFrame"
    return [
        Step("Frame of the chord d = r_A - r_O, with j = k x i", "i", I, f"{here} 14-17", KERNEL, _chord),
        Step("It turns with the nodes: di/de = j t', dj/de = -i t'", r"t^T = \partial\theta/\partial e", turn(), f"{here} 25",
             f"{KERNEL}.turn", _turn),
        Step("Strains seen from it: u_l' = i . r' - 1, u_t'' = j . r''", "(u_l', u_t'')", strains(), f"{here} 16-18", f"{KERNEL}.value", _strains),
        Step("Shape integrals, EA int N'^T N' dx: the blocks of A_11, A_12, A_22", "K_A", integrals()[0], f"{here} 24", whole, _integrals),
        Step("EI int N''^T N'' dx: the blocks of B_11, B_12, B_22", "K_B", integrals()[1], f"{here} 24", whole, _integrals),
        Step("EA int N'^T dx: the blocks of A_1, A_2", "a", integrals()[2], f"{here} 24", whole, _integrals),
        Step("Energy, with u = i_x X + i_y Y and w = j_x X + j_y Y (X, Y: the nodal components)", "U", energy, f"{here} 18, 19",
             f"{KERNEL}.energy", _energy),
        Step("Force, with g_u = K_A u - a, g_w = K_B w; to (Q_X, Q_Y) the frame adds tau t, tau = g_u . w - g_w . u", r"(Q_X, Q_Y) - \tau t", force,
             f"{here} 25", f"{KERNEL}.pull", _force),
        Step("Tangent, with U = du/de, W = dw/de, s = j g_u - i g_w, n = g_u . u + g_w . w, T = dt/de", r"\partial Q / \partial e", tangent,
             "here, from eq. 25", f"{KERNEL}.stiffness", _tangent),
    ]  # fmt: skip
