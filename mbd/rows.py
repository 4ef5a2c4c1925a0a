"""Equations of joints as data: every row is a quadratic polynomial g(q) = linear(q) + sum of products x(q) y(q) of affine scalars.

Coinciding points, perpendicular axes, points on lines, fixed distances, orthonormal directors and parallel tangents are all of this
form; a joint is a list of such rows, and one sparse tensor evaluates the rows of all joints of a scene (constraint.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .affine import Affine, Scalar

NOTHING = Scalar(np.zeros(0, dtype=np.intp), np.zeros(0), 0.0)


@dataclass(frozen=True, eq=False)
class Row:
    linear: Scalar = NOTHING
    products: list[tuple[Scalar, Scalar]] = field(default_factory=list)


def shifted(row: Row, constant: float) -> Row:
    """The row plus a constant."""
    linear = row.linear
    return Row(Scalar(linear.columns, linear.coefficients, linear.constant + constant), row.products)


def coincide(a: Affine, b: Affine) -> list[Row]:
    """a - b = 0: one linear row for each component [d]."""
    return [Row(component) for component in (a - b).components()]


def dot(a: Affine, b: Affine, value: float = 0.0, factor: float = 1.0) -> Row:
    """factor (a . b - value) = 0."""
    linear = Scalar(NOTHING.columns, NOTHING.coefficients, -factor * value)
    return Row(linear, [(x.scaled(factor), y) for x, y in zip(a.components(), b.components())])


def cross(a: Affine, b: Affine) -> Row:
    """a x b = 0 in the plane: a . (-i b) = 0."""
    return dot(a, b.scaled(-1j))


def distance(a: Affine, b: Affine, length: float) -> Row:
    """(|a - b|^2 - length^2) / (2 length) = 0, whose multiplier is the force along the line [N]."""
    apart = a - b
    return dot(apart, apart, length**2, 0.5 / length)


def parallel(a: Affine, b: Affine, ratio: int) -> list[Row]:
    """a - s b = 0 with the scalar coordinate s = q[ratio]: a and b stay parallel, whatever their lengths."""
    s = Scalar.coordinate(ratio)
    return [Row(x, [(s.scaled(-1.0), y)]) for x, y in zip(a.components(), b.components())]
