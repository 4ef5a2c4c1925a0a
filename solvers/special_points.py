"""Points of a path of equilibrium where it turns or branches, or where a function passes through zero, between two stations.

Where ds/d(arc) changes sign is a limit point; where the number of unstable motions changes otherwise, a bifurcation (Seydel 2010, Practical
Bifurcation and Stability Analysis, ch. 5). Both are located: by the zero of ds/d(arc), and between counts by that of the softest motion's
stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from .arc import Arc, Station
from .formats import Singular
from .softest import softest
from .statics import Point
from .system import Array

SHARE, HALVINGS = 0.45, 6
"""No halves: between round numbers they would come upon a singular point again and again."""

BRACKETS, NARROW = 2, 0.01
"""How often a bracket about a bifurcation is narrowed, and to which share to either side."""

EXACT = 1e-10
"""A function counts as zero below this share of its larger value at both ends: beyond, singular matrices only add noise."""

Function = tuple[Callable[[Point], float], int, bool]
"""A function of the point, its direction (+1: only rising through zero, -1: falling, 0: both), and whether the path ends there."""


class Found(NamedTuple):
    """A special point: "limit", "bifurcation" or the number of a function; with the motion [n] that is free there, if any."""

    kind: str
    station: Station
    motion: Array | None
    function: int = -1


def special_points(arc: Arc, here: Station, there: Station, length: float, functions: list[Function]) -> list[tuple[float, Found]]:
    """What lies between two stations, by its distance from the first."""
    found: list[tuple[float, Found]] = []
    limit = here.tangent[1] * there.tangent[1] < 0.0
    spans = [(0.0, here, length, there)]
    if limit:
        place, station = _zero(arc, here, lambda at: at.tangent[1], 0.0, here.tangent[1], length, there.tangent[1])
        found.append((place, Found("limit", station, station.tangent[0])))
        beside = [max(place - 1e-3 * length, 0.0), min(place + 1e-3 * length, length)]
        middle = [arc.reach(here, x)[0] for x in beside]
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


def _zero(arc: Arc, here: Station, function: Callable[[Station], float], a: float, fa: float, b: float, fb: float) -> tuple[float, Station]:
    """Where a function of the station is zero between a and b: the Illinois method (Dowell and Jarratt 1971)."""
    station, side, x, largest = here, 0, b, max(abs(fa), abs(fb))
    for _ in range(60):
        x = b - fb * (b - a) / (fb - fa)
        station, _ = arc.reach(here, x)
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
        x = a + SHARE * (b - a)
        middle, _ = arc.reach(here, x)
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
                middle, _ = arc.reach(here, place)
                a, left, b, right = (place, middle, b, right) if middle.negatives == left.negatives else (a, left, place, middle)
    fa, fb = _softness(arc, left), _softness(arc, right)
    share = fa / (fa - fb) if fa * fb < 0.0 else 0.5
    pairs: Any = zip(left.x, right.x)
    between = Point(*(p + share * (q - p) for p, q in pairs))
    return a + share * (b - a), Found("bifurcation", left._replace(x=between), softest(arc.problem, left.x)[1])


def _softness(arc: Arc, station: Station) -> float:
    return softest(arc.problem, station.x)[0]
