"""Paths of equilibrium by pseudo arc length, with the points where they turn or branch.

A point x = (q, s) moves along its tangent, and is corrected at right angles to it (Keller 1977; Riks 1979, Int. J. Solids Struct. 15):
the factor s is one more unknown, so that loads may fall, by two solutions with one factor,

    x = predicted + correction + ds along,     <tangent, x - predicted> = 0.

Lengths are <a, b> = mean of (lever a_q / length)(lever b_q / length) + a_s b_s over the coordinates that have a lever. Where ds/d(arc)
changes sign is a limit point; where the number of unstable motions changes otherwise, a bifurcation. Both are located: by the zero of
ds/d(arc), and between counts by that of the softest motion's stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .formats import Singular
from .kkt import Kkt
from .softest import softest
from .statics import CONVERGED, ROUNDING, Linearised, Point, Problem
from .system import Array

ITERATIONS = 12
EASY = 4
"""Iterations with which the length of a step stays."""

STRAIGHT = 0.95
"""Least cosine between the tangents at both ends of a step."""

ASIDE = 0.3
"""The longest correction, as a share of a step: further lies another path."""

SHORTER = 0.45
"""No half: from round numbers halves would come upon a singular point again and again."""

SHORTEST = 1e-7
HALVINGS = 6

BRACKETS, NARROW = 2, 0.01
"""How often a bracket about a bifurcation is narrowed, and to which share to either side."""

EXACT = 1e-10
"""A function counts as zero below this share of its larger value at both ends: beyond, singular matrices only add noise."""


class Station(NamedTuple):
    """A point of a path: its unit tangent (q, s), the rate of the multipliers along it, and how many motions are unstable."""

    x: Point
    tangent: tuple[Array, float]
    rate: Array
    negatives: int


class Found(NamedTuple):
    """A special point: "limit", "bifurcation" or the number of a function; with the motion [n] that is free there, if any."""

    kind: str
    station: Station
    motion: Array | None
    function: int = -1


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


def trace(
    arc: Arc, start: Station, step: float, longest: float, most: int, functions: list[tuple[Callable[[Point], float], int, bool]]
) -> tuple[list[Station], list[Found], str]:
    """Stations from the start on, the special points among them, and why the path ended early, or "".

    functions: (function, direction, whether the path ends there); found where they pass through zero.
    """
    stations, length = [start], step
    found: list[Found] = []
    while len(stations) <= most:
        here = stations[-1]
        try:
            there, iterations = _reach(arc, here, length)
            inside = sorted(_special(arc, here, there, length, functions), key=lambda place: place[0])
        except Singular:
            length *= SHORTER
            if length < SHORTEST * step:
                return stations, found, "steps became too short"
            continue
        for _, item in inside:
            found.append(item)
            if item.function >= 0 and functions[item.function][2]:
                return [*stations, item.station], found, ""
        stations.append(there)
        length = min(length * float(np.clip(np.sqrt(EASY / iterations), 0.5, 2.0)), longest)
    return stations, found, "so many points were asked for"


def _special(
    arc: Arc, here: Station, there: Station, length: float, functions: list[tuple[Callable[[Point], float], int, bool]]
) -> list[tuple[float, Found]]:
    """What lies between two stations, by its distance from the first."""
    found: list[tuple[float, Found]] = []
    limit = here.tangent[1] * there.tangent[1] < 0.0
    spans = [(0.0, here, length, there)]
    if limit:
        place, station = _zero(arc, here, lambda at: at.tangent[1], 0.0, here.tangent[1], length, there.tangent[1])
        found.append((place, Found("limit", station, station.tangent[0])))
        beside = [max(place - 1e-3 * length, 0.0), min(place + 1e-3 * length, length)]
        middle = [_reach(arc, here, x)[0] for x in beside]
        spans = [(0.0, here, beside[0], middle[0]), (beside[1], middle[1], length, there)]
    for a, left, b, right in spans:
        if left.negatives != right.negatives:
            found.append(_bifurcation(arc, here, a, left, b, right))
    for k, (function, direction, _) in enumerate(functions):
        f, g = function(here.x), function(there.x)
        if (f * g < 0.0 and direction * (g - f) >= 0.0) or (g == 0.0 and f != 0.0):
            place, station = _zero(arc, here, lambda at: function(at.x), 0.0, f, length, g)  # noqa: B023 (called at once)
            found.append((place, Found("function", station, None, k)))
    return found


def _reach(arc: Arc, here: Station, length: float) -> tuple[Station, int]:
    """The station so far along, and the iterations. Raises Singular where none is found, or one on another path."""
    attempt = arc.step(here, length)
    if attempt is None or arc.dot(here.tangent, attempt[0].tangent) < STRAIGHT:
        raise Singular("the path bends too far within a step")
    return attempt


def _zero(arc: Arc, here: Station, function: Callable[[Station], float], a: float, fa: float, b: float, fb: float) -> tuple[float, Station]:
    """Where a function of the station is zero between a and b: the Illinois method (Dowell and Jarratt 1971)."""
    station, side, x, largest = here, 0, b, max(abs(fa), abs(fb))
    for _ in range(60):
        x = b - fb * (b - a) / (fb - fa)
        station, _ = _reach(arc, here, x)
        f = function(station)
        if f * fb > 0.0:
            b, fb, fa, side = x, f, fa * (0.5 if side == -1 else 1.0), -1
        else:
            a, fa, fb, side = x, f, fb * (0.5 if side == 1 else 1.0), 1
        if f == 0.0 or abs(b - a) <= 1e-12 * max(abs(a), abs(b)) or abs(f) <= EXACT * largest:
            break
    return x, station


def _bifurcation(arc: Arc, here: Station, a: float, left: Station, b: float, right: Station) -> tuple[float, Found]:
    """Halving by counting; then narrow brackets about the zero of the softest motion's stiffness, never at it, where K is singular."""
    for _ in range(HALVINGS):
        x = a + SHORTER * (b - a)
        middle, _ = _reach(arc, here, x)
        if middle.negatives == left.negatives:
            a, left = x, middle
        else:
            b, right = x, middle
    if arc.apart(left, right) > 2.0 * (b - a):
        raise Singular("the path jumped to another one")
    for _ in range(BRACKETS):
        fa, fb = _softness(arc, left), _softness(arc, right)
        share = fa / (fa - fb) if fa * fb < 0.0 else 0.5
        x, width = a + share * (b - a), b - a
        for place in (max(x - NARROW * width, a), min(x + NARROW * width, b)):
            if a < place < b:
                middle, _ = _reach(arc, here, place)
                a, left, b, right = (place, middle, b, right) if middle.negatives == left.negatives else (a, left, place, middle)
    fa, fb = _softness(arc, left), _softness(arc, right)
    share = fa / (fa - fb) if fa * fb < 0.0 else 0.5
    pairs: Any = zip(left.x, right.x)
    between = Point(*(p + share * (q - p) for p, q in pairs))
    return a + share * (b - a), Found("bifurcation", left._replace(x=between), softest(arc.problem, left.x)[1])


def _softness(arc: Arc, station: Station) -> float:
    return softest(arc.problem, station.x)[0]
