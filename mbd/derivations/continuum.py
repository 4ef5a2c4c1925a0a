"""The continuum that the cable's strains belong to, and what the energy of 1998 becomes on short elements."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import sympy as sp

import mbd

from .laws import chord_frame, continuum, cross, shape_derivative
from .numbers import evaluated, gauss
from .step import PAPER, Pairs, Step

SOURCE = "Gerstmayr and Irschik (2008)"
PLANE, SPACE = "mbd.elements.planar_continuum.PlanarContinuumAt", "mbd.elements.spatial_continuum.SpatialContinuumAt"
SHORT = 1e-16
"""Length of an element of which the limit is taken [m]: what is left of it is below rounding."""


class Element:
    """One deformed element in numbers, and its derivatives r', r'' at the Gauss points."""

    def __init__(self, rng: np.random.Generator, d: int):
        length, self.ea, self.ei = rng.uniform(0.5, 2.0, 3).tolist()
        scene = mbd.Scene(gravity=np.zeros(d))
        scene.add(mbd.AncfCable(np.zeros(d), np.eye(d)[0] * length, n_elements=1, gauss_points=3, E=self.ea, A=1.0, I=self.ei / self.ea, rho=1.0))
        system = scene.build()
        q = system.q0 + 0.15 * rng.standard_normal(system.n)
        self.at, nodal = system.measures[0].at(q), q.reshape(4, d)
        self.points: list[dict[Any, Any]] = []
        self.arcs = [float(weight) * length for _, weight in gauss(3)]
        for xi, _ in gauss(3):
            values = [evaluated(sp.Matrix([shape_derivative(k)[2]]), {_X: float(xi) * length, _LENGTH: length})[0] @ nodal for k in (1, 2)]
            self.points.append(dict(zip(continuum(d).w, np.concatenate(values).tolist())))


_X, _LENGTH, _ = shape_derivative(0)
REST = {sp.Symbol("r'_0", positive=True): 1, sp.Symbol("kappa_0"): 0}


def strains(d: int) -> sp.Matrix:
    """Of a cable that is straight at rest."""
    return continuum(d).strains.subs(REST)


def _strains(d: int) -> Any:
    def compare(rng: np.random.Generator) -> Pairs:
        element = Element(rng, d)
        exact = np.array([evaluated(strains(d), values)[:, 0] for values in element.points])
        yield "strains", exact[np.argsort(exact[:, 0])], (seen := element.at.value[0].T)[np.argsort(seen[:, 0])]

    return compare


def _energy(rng: np.random.Generator) -> Pairs:
    element = Element(rng, 2)
    law = continuum(2)
    ea, ei, _, arc, *_ = law.parameters
    total = 0.0
    for values, ds in zip(element.points, element.arcs):
        total += evaluated(sp.Matrix([law.energy.subs(REST)]), values | {ea: element.ea, ei: element.ei, arc: ds})[0, 0]
    yield "W", total, element.at.energy()


def limit() -> sp.Matrix:
    """(u_l', u_t'') of eq. 18 at x = xi l for l -> 0, on a curve r = r' x + r'' x^2/2 + ...: the frame becomes the tangent's."""
    x, y = (sp.Matrix(sp.symbols(f"{name}_x {name}_y", real=True)) for name in ("r'", "r''"))
    frame = x / sp.sqrt(x.dot(x))
    return sp.Matrix([sp.simplify(frame.dot(x)) - 1, sp.simplify(cross(frame, y)[0])])


def _limit(rng: np.random.Generator) -> Pairs:
    """The law of the chord frame on a very short element of a random curve, with digits to spare."""
    x, y = rng.standard_normal((2, 2))
    names = sp.symbols("r'_x r'_y r''_x r''_y", real=True)
    exact = evaluated(limit(), dict(zip(names, (*x, *y))))[:, 0]
    law = chord_frame()
    strain = sp.lambdify([*law.w, law.parameters[-1]], list(law.strains), "mpmath")
    with mpmath.workdps(80):
        length = mpmath.mpf(SHORT)
        chord = [a * length + b * length**2 / 2 for a, b in zip(x, y)]
        end = [a + b * length for a, b in zip(x, y)]
        stretched, s0, s1, t0, t1 = strain(*chord, *x, *end, length)
        slopes, bends = (mpmath.matrix([_row(k, length)]) for k in (1, 2))
        along = slopes[1] * s0 + slopes[2] * stretched + slopes[3] * s1
        across = bends[1] * t0 + bends[3] * t1
    yield "u_l', u_t''", exact, np.array([float(along), float(across)])


def _row(order: int, length: Any) -> list[Any]:
    """d^k N/dx^k at a third of the element."""
    return list(sp.lambdify((_X, _LENGTH), shape_derivative(order)[2], "mpmath")(length / 3, length))


def steps() -> list[Step]:
    return [
        Step("Strains in the plane: stretch and curvature d theta/ds", r"(\varepsilon, \kappa)", strains(2), SOURCE, f"{PLANE}.value", _strains(2)),
        Step("Strains in space: stretch and three parts of curvature", r"(\varepsilon, \kappa)", strains(3), SOURCE, f"{SPACE}.value", _strains(3)),
        Step("Energy, a sum over Gauss points of weight ds", "dW", continuum(2).energy.subs(REST), SOURCE, f"{PLANE}.energy", _energy),
        Step("Strains of the 1998 element as its length goes to zero: |r'| - 1 and |r'| kappa, not kappa", r"\lim (u_l', u_t'')", limit(),
             f"here, from {PAPER}, eq. 18", "mbd.elements.local_frame", _limit),
    ]  # fmt: skip
