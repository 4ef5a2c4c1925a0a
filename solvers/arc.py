"""Steps along paths of equilibrium by pseudo arc length.

A point x = (q, s) moves along its tangent, and is corrected at right angles to it (Keller 1977; Riks 1979, Int. J. Solids Struct. 15):
the factor s is one more unknown, so that loads may fall, by two solutions with one factor,

    x = predicted + correction + ds along,     <tangent, x - predicted> = 0.

Lengths are <a, b> = mean of (lever a_q / length)(lever b_q / length) + a_s b_s over the coordinates that have a lever.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .formats import Singular
from .kkt import Kkt
from .statics import CONVERGED, ROUNDING, Linearised, Point, Problem
from .system import Array

ITERATIONS = 12

STRAIGHT = 0.95
"""Least cosine between the tangents at both ends of a step."""

ASIDE = 0.3
"""The longest correction, as a share of a step: further lies another path."""


class Station(NamedTuple):
    """A point of a path: its unit tangent (q, s), the rate of the multipliers along it, and how many motions are unstable."""

    x: Point
    tangent: tuple[Array, float]
    rate: Array
    negatives: int


class Arc:
    """Steps along the paths of one problem."""

    def __init__(self, problem: Problem):
        self.problem = problem._replace(kkt=Kkt(problem.system, problem.linear, 0.0))  # limit points are singular: that is what is looked for
        levers = problem.system.levers / problem.system.length
        self._weight = levers**2 / max(int(np.sum(levers > 0.0)), 1)

    def dot(self, a: tuple[Array, float], b: tuple[Array, float]) -> float:
        return float(np.sum(self._weight * a[0] * b[0]) + a[1] * b[1])

    def apart(self, a: Station, b: Station) -> float:
        """The distance between two stations."""
        way = (b.x.q - a.x.q, b.x.s - a.x.s)
        return float(np.sqrt(self.dot(way, way)))

    def unit(self, a: tuple[Array, float], like: tuple[Array, float]) -> tuple[Array, float]:
        """The direction of length 1, turned to that of another."""
        size = np.copysign(np.sqrt(self.dot(a, a)), self.dot(a, like))
        return a[0] / size, a[1] / size

    def station(self, x: Point, like: tuple[Array, float]) -> Station:
        """A point in balance with its tangent."""
        at = Linearised(self.problem, x)
        along = at.changes()[1]
        tangent = self.unit((along.q, 1.0), like)
        return Station(x, tangent, tangent[1] * along.multipliers, self.problem.kkt.negatives(at.tangent))

    def step(self, start: Station, length: float) -> tuple[Station, int] | None:
        """The point so far along, and the iterations; None where it is not found. Raises Singular."""
        problem, x, (tq, ts) = self.problem, start.x, start.tangent
        bend = problem.system.strains(x.q).push(tq) * problem.system.modulus if problem.system.n_stresses else x.stress
        x = Point(x.s + length * ts, x.q + length * tq, x.stress + length * bend, x.multipliers + length * start.rate)
        predicted, before = x, np.inf
        for k in range(1, ITERATIONS + 1):
            correction, along = Linearised(problem, x).changes()
            gap = self.dot(start.tangent, (x.q - start.x.q, x.s - start.x.s)) - length + self.dot(start.tangent, (correction.q, 0.0))
            ds = -gap / self.dot(start.tangent, (along.q, 1.0))
            x = Point(x.s + ds, *(a + b + ds * c for a, b, c in zip(x[1:], correction, along)))
            size = max(problem.size(correction.q + ds * along.q), abs(ds))
            if not np.isfinite(size) or size > 1e3:
                return None
            if size < CONVERGED or (size < ROUNDING and size > 0.25 * before):
                aside = (x.q - predicted.q, x.s - predicted.s)
                return None if self.dot(aside, aside) > (ASIDE * length) ** 2 else (self.station(problem.settled(x), start.tangent), k)
            before = size
        return None

    def aside(self, x: Point, motion: Array, length: float) -> Station | None:
        """The first station of the other path through a bifurcation, leaving in the direction of a motion [n]."""
        start = Station(x, self.unit((motion, 0.0), (motion, 0.0)), np.zeros(self.problem.system.m), 0)
        for halvings in range(12):
            attempt = self.step(start, 0.5**halvings * length)
            if attempt is not None:
                return attempt[0]
        return None

    def reach(self, start: Station, length: float) -> tuple[Station, int]:
        """As ``step``; raises Singular where none is found, or where the path bends too far, perhaps into another one."""
        attempt = self.step(start, length)
        if attempt is None or self.dot(start.tangent, attempt[0].tangent) < STRAIGHT:
            raise Singular("the path bends too far within a step")
        return attempt
