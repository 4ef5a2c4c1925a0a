"""The forms in which explicit methods know a system, with index-1 accelerations, and the cheapest of them.

Small systems move in the coordinates that their linear equations leave (``reduced.py``). Rigid bodies about their principal axes and
particles have a diagonal mass matrix, which serves larger systems (``normal.py``); others, redundant joints and massless coordinates take
the KKT matrix (``whole.py``).
"""

from __future__ import annotations

from typing import Protocol

from .linear import Linear
from .normal import Normal
from .reduced import reduced
from .system import Array, System
from .whole import Kkt

DENSEST = 300
"""Equations up to which S is factorised dense where it has no band (a star)."""


class Places(Protocol):
    """Room for several states w [k, 2, width] with accelerations [k, width] and ``multipliers`` [k, m].

    rates  finds the accelerations and multipliers of one state; raises NearlySingular
    land   moves it to the joints before; raises Inconsistent where it finds none near
    shares tells of states the least share of an equation's slope, squared, that others leave; near singular positions it is small
    """

    multipliers: Array

    def rates(self, system: System, place: int, t: float) -> None: ...
    def land(self, system: System, place: int, t: float) -> None: ...
    def shares(self, places: slice) -> Array: ...


class Form(Protocol):
    """A system for an explicit method: states w [2, width], positions and velocities in the form's own coordinates; see ``Reduced``.
    ``m``: how many multipliers it finds."""

    width: int
    m: int

    def enter(self, q: Array, v: Array) -> Array: ...
    def leave(self, w: Array) -> tuple[Array, Array]: ...
    def lengths(self, rows: Array) -> Array: ...
    def all_rows(self, multipliers: Array) -> Array: ...
    def places(self, w: Array, accelerations: Array) -> Places: ...


def index_one(system: System, linear: Linear) -> Form:
    """The cheapest form of a system."""
    small = reduced(system, linear)
    if small:
        return small
    if not Normal.serves(system) or linear.softened:
        return Kkt(system, linear)
    normal = Normal(system, linear)
    return normal if normal.band or system.m <= DENSEST else Kkt(system, linear)
