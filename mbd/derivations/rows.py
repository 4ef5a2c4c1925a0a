"""Equations of joints as expressions: quadratic rows, turning angles, points on cables, and what users' functions relate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from mbd.affine import Affine, Array, Scalar
from mbd.model import Model
from mbd.relation import Relation
from mbd.rows import Row
from mbd.track import Track
from mbd.turn import Turning

from .laws import shapes_at
from .numbers import DIGITS, floats, number, precise
from .step import Pairs

Coordinates = Sequence[sp.Symbol]


def scalar(form: Scalar, q: Coordinates) -> sp.Expr:
    return sp.Add(number(form.constant), *(number(c) * q[k] for k, c in zip(form.columns, form.coefficients)))


def vector(form: Affine, q: Coordinates) -> sp.Matrix:
    return sp.Matrix([scalar(x, q) for x in form.components()])


def quadratic(row: Row, q: Coordinates) -> sp.Expr:
    return sp.Add(scalar(row.linear, q), *(scalar(x, q) * scalar(y, q) for x, y in row.products))


def turn(angle: Turning, q: Coordinates) -> sp.Expr:
    """|p| |c| sin(phi - angle of p between c, ahead, and s, across)."""
    moving, ahead, across = (vector(axis, q) for axis in angle[:3])
    return sp.sin(q[angle.phi]) * moving.dot(ahead) - sp.cos(q[angle.phi]) * moving.dot(across)


def on_track(track: Track, q: Coordinates) -> sp.Matrix:
    """P - r(s), r the cubic Hermite curve of the element where s is."""
    d, s = track.point.dimension, q[track.place]
    ends, pieces = np.concatenate(([0.0], np.cumsum(track.lengths))), []
    for e, length in enumerate(track.lengths):
        functions = shapes_at(0, (s - number(ends[e])) / number(length), number(length))
        nodes = [sp.Matrix(q[d * row : d * row + d]) for row in track.rows[e : e + 2].ravel().tolist()]
        pieces.append(sum((f * node for f, node in zip(functions, nodes)), sp.zeros(d, 1)))
    limits = [s < number(end) for end in ends[1:-1]] + [True]
    curve = [sp.Piecewise(*((piece[i], limit) for piece, limit in zip(pieces, limits))) for i in range(d)]
    return vector(track.point, q) - sp.Matrix(curve)


def relation(item: str, related: Relation, q: Coordinates) -> sp.Expr:
    """s - f(s_1 ... s_k)."""
    return q[related.output] - called(item, related.formula.function, [q[k] for k in related.inputs])[0]


def called(item: str, function: Any, arguments: Sequence[sp.Expr]) -> list[sp.Expr]:
    """A user's function of symbols; it must be made of operations that symbols understand."""
    try:
        return [sp.sympify(x) for x in np.ravel(np.array(function(*arguments), dtype=object))]
    except (TypeError, AttributeError, sp.SympifyError) as error:
        expected = "expected one of operators and sympy's functions, to write its equations"
        raise TypeError(f"{item!r}: the function given for it: {expected}, found one that fails with symbols ({error}); rewrite it") from error


def equations(model: Model, q: Coordinates) -> list[sp.Expr]:
    """gamma(q) [m] in the order of the system's equations, without what drives ask for."""
    found = [quadratic(row, q) for *_, row in model.equations] + [turn(angle, q) for _, angle in model.turns]
    found += [row for _, track in model.tracks for row in on_track(track, q)]
    return found + [relation(item, related, q) for item, related in model.relations]


class Differentiated:
    """Equations [m] and their first two derivatives at numbers, from 30 digits."""

    def __init__(self, g: Sequence[sp.Expr], q: Coordinates):
        self.n, self.m = len(q), len(g)
        index = {symbol: k for k, symbol in enumerate(q)}
        own = [sorted(expression.free_symbols, key=index.__getitem__) for expression in g]
        gradients = [[sp.diff(f, x) for x in names] for f, names in zip(g, own)]
        hessians = [[[sp.diff(f, x) for x in names] for f in gradient] for gradient, names in zip(gradients, own)]
        self.columns = [np.array([index[x] for x in names], dtype=np.intp) for names in own]
        self.function = sp.lambdify(list(q), [list(g), gradients, hessians], "mpmath", cse=True)

    def at(self, q: Array) -> tuple[Array, Array, Array]:
        """g [m], dg/dq [m, n], d2g/dq2 [m, n, n]."""
        value, gradient, hessian = np.zeros(self.m), np.zeros((self.m, self.n)), np.zeros((self.m, self.n, self.n))
        with mpmath.workdps(DIGITS):
            values, gradients, hessians = self.function(*(precise(x) for x in q))
            for r, (own, g, dg, ddg) in enumerate(zip(self.columns, values, gradients, hessians)):
                value[r], gradient[r, own], hessian[r, own[:, None], own] = float(g), floats(dg), floats(ddg)
        return value, gradient, hessian


def evaluate(exact: Differentiated, kernel: Any, q: Array, v: Array, rng: np.random.Generator) -> Pairs:
    """A kernel of equations beside the derivatives of its expressions, with random multipliers."""
    value, gradient, hessian = exact.at(q)
    multipliers, swirl = rng.standard_normal(exact.m), hessian @ v
    z = kernel.prepare(q)

    def full(values: Array) -> Array:
        out = np.zeros((exact.m, exact.n))
        np.add.at(out, (kernel.rows, kernel.cols), values)
        return out

    curvature = np.zeros((exact.n, exact.n))
    np.add.at(curvature, (kernel.curvature_rows, kernel.curvature_cols), kernel.curvature(z, multipliers))
    yield "value", value, kernel.value(z)
    yield "gradient", gradient, full(kernel.gradient(z))
    yield "swirl", swirl, full(kernel.swirl(z, v))
    yield "bias", swirl @ v, kernel.bias(z, v)
    yield "curvature", np.einsum("r,rij->ij", multipliers, hessian), curvature
