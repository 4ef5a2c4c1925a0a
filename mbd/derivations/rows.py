"""Equations of joints as expressions: quadratic rows, turning angles, points on cables, what users' functions relate, and
nonholonomic rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from mbd.affine import Affine, Array, Scalar
from mbd.model import Model
from mbd.relation import Relation
from mbd.rows import Row
from mbd.slip import SlipRow
from mbd.track import Track
from mbd.turn import Turning

from .laws import shapes_at
from .numbers import DIGITS, floats, number, precise
from .step import Pairs

Coordinates = Sequence[sp.Symbol]


def scalar(form: Scalar, q: Coordinates) -> sp.Expr:
    return number(form.constant) + rate(form, q)


def rate(form: Scalar, v: Coordinates) -> sp.Expr:
    return sp.Add(*(number(c) * v[k] for k, c in zip(form.columns, form.coefficients)))


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


def slip(row: SlipRow, q: Coordinates, v: Coordinates) -> sp.Expr:
    """A(q) v = sum x dy/dt."""
    return sp.Add(*(scalar(x, q) * rate(y, v) for x, y in row))


def called(item: str, function: Any, arguments: Sequence[sp.Expr]) -> list[sp.Expr]:
    """A user's function of symbols; it must be made of operations that symbols understand."""
    try:
        return [sp.sympify(x) for x in np.ravel(np.array(function(*arguments), dtype=object))]
    except (TypeError, AttributeError, sp.SympifyError) as error:
        expected = "expected one of operators and sympy's functions, to write its equations"
        raise TypeError(f"{item!r}: the function given for it: {expected}, found one that fails with symbols ({error}); rewrite it") from error


def equations(model: Model, q: Coordinates) -> list[sp.Expr]:
    """gamma(q) [m] in the order of the system's equations, without what drives ask for; nonholonomic rows are none of them."""
    found = [quadratic(row, q) for *_, row in model.equations] + [turn(angle, q) for _, angle in model.turns]
    found += [row for _, track in model.tracks for row in on_track(track, q)]
    return found + [relation(item, related, q) for item, related in model.relations]


def slips(model: Model, q: Coordinates, v: Coordinates) -> list[sp.Expr]:
    """A(q) v of the nonholonomic rows, which stand behind all others."""
    return [slip(row, q, v) for *_, row in model.slips]


class Closure(NamedTuple):
    """gamma and its row of G by columns; of a nonholonomic row 0 and A."""

    value: sp.Expr
    gradient: dict[int, sp.Expr]


def holonomic(g: sp.Expr, q: Coordinates) -> Closure:
    return Closure(g, {k: sp.diff(g, x) for k, x in enumerate(q) if x in g.free_symbols})


def nonholonomic(slipping: sp.Expr, v: Coordinates) -> Closure:
    """Of A(q) v."""
    return Closure(sp.Integer(0), {k: sp.diff(slipping, x) for k, x in enumerate(v) if x in slipping.free_symbols})


class Differentiated:
    """Rows [m] and the derivatives of their gradients at numbers, from 30 digits."""

    def __init__(self, closures: Sequence[Closure], q: Coordinates):
        self.n, self.m = len(q), len(closures)
        self.columns = [_columns(closure, q) for closure in closures]
        gradients = [[closure.gradient.get(k, sp.Integer(0)) for k in own] for closure, own in zip(closures, self.columns)]
        hessians = [[[sp.diff(f, q[k]) for k in own] for f in gradient] for gradient, own in zip(gradients, self.columns)]
        self.function = sp.lambdify(list(q), [[closure.value for closure in closures], gradients, hessians], "mpmath", cse=True)

    def at(self, q: Array) -> tuple[Array, Array, Array]:
        """gamma [m], G [m, n], dG/dq [m, n, n], which is symmetric for holonomic rows only."""
        value, gradient, hessian = np.zeros(self.m), np.zeros((self.m, self.n)), np.zeros((self.m, self.n, self.n))
        with mpmath.workdps(DIGITS):
            values, gradients, hessians = self.function(*(precise(x) for x in q))
            for r, (own, g, dg, ddg) in enumerate(zip(self.columns, values, gradients, hessians)):
                value[r], gradient[r, own], hessian[r, own[:, None], own] = float(g), floats(dg), floats(ddg)
        return value, gradient, hessian


def _columns(closure: Closure, q: Coordinates) -> NDArray[np.intp]:
    """The coordinates that a row depends on or acts on."""
    occurring = set().union(*(x.free_symbols for x in closure.gradient.values()))
    return np.array([k for k, x in enumerate(q) if k in closure.gradient or x in occurring], dtype=np.intp)


def evaluate(exact: Differentiated, kernel: Any, q: Array, v: Array, rng: np.random.Generator) -> Pairs:
    """A kernel of equations beside the derivatives of its expressions, with random multipliers: swirl is d(G v)/dq."""
    value, gradient, hessian = exact.at(q)
    multipliers, swirl = rng.standard_normal(exact.m), np.einsum("rij,i->rj", hessian, v)
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
