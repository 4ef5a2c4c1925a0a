"""What the stages of the last step tell of the next one: its stages, and the middle where its derivatives are taken.

Velocities go on as a polynomial of least squares through the last step's stages, exact at its end. Of each degree this adds a term to the
forecast, and as with an asymptotic series the terms shrink first and grow then: over a long step because the motion is no polynomial, over a
short one because high degrees magnify what Newton's iteration left in the stages. The sum ends before its smallest term. Positions are the
integral of these velocities; multipliers and stresses, which follow accelerations, take a degree less.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial

from .coefficients import tableau
from .protocol import State
from .stages import Middle, Stages
from .system import Array, System


class Memory(NamedTuple):
    """What the last step leaves to predict the next: its length, velocities and stresses at its start, stages, and how slowly iterations
    contracted of late."""

    h: float
    v0: Array
    stress0: Array
    stages: Stages
    n_stages: int
    rate: float


FAST = 0.5
"""A last term below this share of the one before is no sign that the next would grow."""

POWERS = np.arange(1, 13)
"""Exponents of a point's powers: more than any method's stages need."""


class Fits:
    """Polynomials of least squares through values at nodes [nodes] of a step, of which the last, its end, is x = 0: there they are exact.

    weights [degrees, powers, nodes]: degree d = 1, 2, ... is sum_k x^k weights[d - 1, k - 1] @ (values), added to the last value; integrated
    [degrees, powers, nodes]: the same of its integral from the end, by x^(k + 1). Points are given as their powers x, x^2, ...
    """

    def __init__(self, nodes: Array):
        degrees = len(nodes) - 1
        self.weights = np.zeros((degrees, degrees, len(nodes)))
        for degree in range(1, degrees + 1):
            inverse = np.linalg.pinv(polynomial.polyvander(nodes[:-1] - 1.0, degree)[:, 1:])
            self.weights[degree - 1, :degree] = np.concatenate((inverse, -inverse.sum(axis=1, keepdims=True)), axis=1)
        self.integrated = self.weights / np.arange(2, degrees + 2)[:, None]
        self.terms = np.diff(self.weights, axis=0, prepend=0.0).transpose(1, 0, 2).reshape(degrees, -1)

    def changes(self, powers: Array, degree: int) -> Array:
        """[points, nodes]: values less the one at the end."""
        return powers[:, :degree].dot(self.weights[degree - 1, :degree])

    def integrals(self, powers: Array, degree: int) -> Array:
        """[points, nodes]: integrals of these changes from the end."""
        return powers[:, 1 : degree + 1].dot(self.integrated[degree - 1, :degree])

    def best(self, powers: Array, values: Array) -> int:
        """The degree for values [nodes, ...] up to a point: below that of the smallest term there, or the highest where terms shrink fast to the
        last."""
        degrees = len(self.weights)
        terms = powers[:degrees].dot(self.terms).reshape(degrees, -1).dot(values)
        squares = np.einsum("ij,ij->i", terms, terms)
        if squares[-1] < FAST**2 * squares[-2]:
            return degrees
        return max(int(squares.argmin()), 1)


@cache
def _fits(stages: int) -> tuple[Fits, Fits]:
    """Through start and stages, and through the stages alone."""
    c = tableau(stages).c
    return Fits(np.concatenate((np.zeros(1), c))), Fits(c)


def forecast(system: System, state: State, c: Array, h: float) -> tuple[Stages, Middle]:
    """Stages at fractions c of a step of length h from a state, and its middle; where no step went before, by constant velocity and stress."""
    memory, x = state.memory, np.append(c, 0.5)
    if memory is None:
        rows = len(x)
        still = np.tile(state.v, (rows, 1)), np.tile(state.multipliers, (rows, 1)), np.tile(state.stress, (rows, 1))
        return _split(system, state, np.outer(x, h * state.v), *still)
    wide, narrow = _fits(memory.n_stages)
    last, ahead = memory.stages, (x * (h / memory.h))[:, None] ** POWERS[: memory.n_stages + 1]
    v = np.concatenate((memory.v0[None], last.v))
    degree = wide.best(ahead[-2], v * system.levers)
    less = max(degree - 1, 1)
    dq = wide.integrals(ahead, degree).dot(v) * memory.h + np.outer(x, h * state.v)
    stress = wide.changes(ahead, less).dot(np.concatenate((memory.stress0[None], last.stress))) + last.stress[-1]
    multipliers = narrow.changes(ahead, less).dot(last.multipliers) + last.multipliers[-1]
    return _split(system, state, dq, wide.changes(ahead, degree).dot(v) + state.v, multipliers, stress)


def _split(system: System, state: State, dq: Array, v: Array, multipliers: Array, stress: Array) -> tuple[Stages, Middle]:
    """Stages and, from the last row, the middle."""
    stages = Stages(dq[:-1], v[:-1], multipliers[:-1], np.zeros((len(dq) - 1, system.m)), stress[:-1])
    return stages, Middle(state.q + dq[-1], v[-1], multipliers[-1], stress[-1])
