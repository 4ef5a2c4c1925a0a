"""Follows a path of equilibrium, station by station."""

from __future__ import annotations

import numpy as np

from .arc import Arc, Station
from .formats import Singular
from .special_points import Found, Function, special_points

EASY = 4
"""Iterations with which the length of a step stays."""

SHORTER = 0.45
"""No half: see special_points.py."""

SHORTEST = 1e-7


def trace(arc: Arc, start: Station, step: float, longest: float, most: int, functions: list[Function]) -> tuple[list[Station], list[Found], str]:
    """Stations from the start on, the special points among them, and why the path ended early, or ""."""
    stations, length = [start], step
    found: list[Found] = []
    while len(stations) <= most:
        here = stations[-1]
        try:
            there, iterations = arc.reach(here, length)
            inside = sorted(special_points(arc, here, there, length, functions), key=lambda place: place[0])
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
