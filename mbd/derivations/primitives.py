"""What joints are made of: vector equations between points and axes, each beside the rows that evaluate it.

Points and axes a, b are affine in the coordinates; the derivatives of every equation follow: gradient G, bias v' g_qq v, d(G v)/dq and
d(G' lambda)/dq.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from mbd import rows
from mbd.affine import Affine
from mbd.constraint import Quadratic
from mbd.turn import Turn, Turning

from .kernels import symbols
from .rows import Differentiated, evaluate, holonomic
from .step import Pairs, Step

Vector = Any
VALUE, FACTOR, LENGTH = sp.symbols("c k L", real=True)
NUMBERS = {VALUE: 0.3, FACTOR: 0.7, LENGTH: 1.3}


def _random(rng: np.random.Generator, d: int, n_rows: int) -> Affine:
    """An affine map of all rows of a table, in the plane with turns."""
    weights = rng.standard_normal(n_rows) + (1j * rng.standard_normal(n_rows) if d == 2 else 0.0)
    return Affine(np.arange(n_rows), weights, rng.standard_normal(d))


def _explicit(x: Affine, q: list[sp.Symbol]) -> Vector:
    """constant + sum of weights times rows, a planar weight as a rotation and stretch."""
    d, total = x.dimension, sp.Matrix([sp.Float(c, 30) for c in x.constant])
    for row, weight in zip(x.rows, x.weights):
        re, im = sp.Float(float(weight.real), 30), sp.Float(float(np.imag(weight)), 30)
        turned = sp.Matrix([[re, -im], [im, re]]) if d == 2 else re * sp.eye(d)
        total += turned * sp.Matrix(q[d * row : d * row + d])
    return total


Formula = Callable[[Vector, Vector, Any], list[Any]]
Kernel = Callable[[Affine, Affine, int, int], Any]
Rows = Callable[..., list[rows.Row]]


def _compare(d: int, formula: Formula, kernel: Kernel) -> Callable[[np.random.Generator], Pairs]:
    """One equation between two random maps of two rows; the last coordinate is a scalar of its own."""

    def compare(rng: np.random.Generator) -> Pairs:
        a, b, n = _random(rng, d, 2), _random(rng, d, 2), 2 * d + 1
        names, (q, v) = symbols("q", n), rng.standard_normal((2, n))
        numbers = {symbol: sp.Float(x, 30) for symbol, x in NUMBERS.items()}
        g = [f.subs(numbers) for f in formula(_explicit(a, names), _explicit(b, names), names[-1])]
        yield from evaluate(Differentiated([holonomic(x, names) for x in g], names), kernel(a, b, n - 1, n), q, v, rng)

    return compare


def _quadratic(make: Rows) -> Kernel:
    value, factor, length = NUMBERS.values()
    return lambda a, b, last, n: Quadratic(make(a, b, last, value, factor, length), n)


def _across(a: Vector, b: Vector) -> Any:
    return a[0] * b[1] - a[1] * b[0]


class Primitive(NamedTuple):
    """An equation between a and b, and what evaluates it; s is a coordinate."""

    title: str
    formula: Formula
    home: str
    kernel: Kernel
    dimensions: tuple[int, ...] = (2, 3)

    def steps(self) -> Iterator[Step]:
        for d in self.dimensions:
            a, b = (sp.Matrix(sp.symbols(f"{letter}_x:{'xyz'[d - 1]}")) for letter in "ab")
            where = f", {'planar' if d == 2 else 'spatial'}" if len(self.dimensions) > 1 else ""
            shown = sp.Matrix(self.formula(a, b, sp.Symbol("s")))
            yield Step(f"{self.title}{where}", "g", shown, "here", self.home, _compare(d, self.formula, self.kernel))


PRIMITIVES = [
    Primitive("Points coincide", lambda a, b, s: list(a - b), "mbd.rows.coincide", _quadratic(lambda a, b, s, *_: rows.coincide(a, b))),
    Primitive("The product of two axes is c", lambda a, b, s: [FACTOR * (a.dot(b) - VALUE)], "mbd.rows.dot",
              _quadratic(lambda a, b, s, c, k, length: [rows.dot(a, b, c, k)])),
    Primitive("Axes are parallel, in the plane", lambda a, b, s: [_across(a, b)], "mbd.rows.cross",
              _quadratic(lambda a, b, s, *_: [rows.cross(a, b)]), (2,)),
    Primitive("Points keep their distance L; the multiplier is the force", lambda a, b, s: [((a - b).dot(a - b) - LENGTH**2) / (2 * LENGTH)],
              "mbd.rows.distance", _quadratic(lambda a, b, s, c, k, length: [rows.distance(a, b, length)])),
    Primitive("Axes are parallel, whatever their lengths: s is a coordinate", lambda a, b, s: list(a - s * b), "mbd.rows.parallel",
              _quadratic(lambda a, b, s, *_: rows.parallel(a, b, s))),
    Primitive("A coordinate s is the angle from axis b to axis a: |a| |b| sin(s - angle)",
              lambda a, b, s: [sp.sin(s) * a.dot(b) + sp.cos(s) * _across(a, b)], "mbd.turn.Turn",
              lambda a, b, last, n: Turn([Turning(a, b, b.scaled(1j), last)], n), (2,)),
]  # fmt: skip


def steps() -> list[Step]:
    return [step for primitive in PRIMITIVES for step in primitive.steps()]
