"""From a scene's description to a consistent state: what the joints had to move is reported, what they cannot join is refused."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .affine import Array
from .closing import closed, conflict, distances, driven_rows, quoted
from .errors import SceneError, SceneWarning
from .state import State
from .system import System
from .target import Targets

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.linear import Linear

REPORTED = 1e-9
"""Corrections below this share of the scene's length and speed are rounding, not worth a word."""

STANDSTILL = 1e-12
"""Lengths of the scene per unit of time that the differences of a drive at rest may leave."""


@dataclass(frozen=True)
class Correction:
    """One thing that the start projection changed: which quantity, at which item or joint, by how much."""

    quantity: str
    item: str
    amount: float
    unit: str

    def __str__(self) -> str:
        return f"{self.quantity} of {self.item!r}: {self.amount:.6g} {self.unit}"


@dataclass(frozen=True)
class Assembly:
    """A consistent state, the corrections that led to it, and the joints that are redundant there."""

    state: State
    corrections: tuple[Correction, ...]
    redundant: tuple[str, ...]
    linear: Linear

    def __str__(self) -> str:
        lines = [str(c) for c in self.corrections] or ["nothing had to be moved"]
        if self.redundant:
            lines.append(f"redundant joints: {', '.join(self.redundant)}")
        return "\n".join(lines)


def assemble(scene: Scene, start: State | None = None) -> Assembly:
    """Consistent positions and velocities of a scene, with a report of what was moved.

    Positions, then velocities, are projected to the joints with the least motion in the sense of the mass matrix; from rough positions,
    which that cannot close in one go, gaps are closed bit by bit. Parts that nothing connects are assembled separately.
    Raises SceneError, by name, for joints that cannot be satisfied together and for parts without inertia.
    """
    from .starts import starts, together

    system, parts = scene.build(), scene.parts()
    state = start or State(system.q0, system.v0)
    state.check(system)
    return together(starts(parts, state), parts, system.n)


def consistent(system: System, state: State) -> Assembly:
    from .solvers.formats import Singular
    from .solvers.start import Inconsistent, mass_factor, project_velocities

    linear, redundant = prepare(system, state.q)
    goal = system.inputs(state.t).targets
    try:
        q = closed(system, linear, state.q, goal.value)
        if redundant or _singular(system, linear, q):  # what holds twice in a rough position may not where the joints close, or the reverse
            redundant = _redundant(system, linear, q)
        v = project_velocities(system, mass_factor(system, linear, q), q, state.v, goal.rate)
    except Inconsistent as trouble:
        raise SceneError([conflict(system, trouble.defect.rows, trouble.defect.what)]) from None
    except Singular:
        rows = [int(np.argmax(np.abs(system.joints.at(state.q).value - goal.value) * linear.reach))]
        raise SceneError([conflict(system, rows, "the joints lock on the way to a position that satisfies them")]) from None
    linear.origin = q
    unmet = (system.joints.at(q).push(v) - goal.rate) * linear.reach
    scale = float(np.max(np.abs((v, state.v)) * system.levers, initial=0.0))  # joints may leave rounding of the velocities described
    if np.max(np.abs(unmet), initial=0.0) > max(1e-6 * scale, STANDSTILL * system.length):
        what = "velocities cannot satisfy them together" + (" (with the drives: a dead centre)" if redundant and system.driven else "")
        raise SceneError([conflict(system, [int(np.argmax(np.abs(unmet)))], what)])
    corrections = _corrections(system, linear, state, q, v, goal)
    return Assembly(State(q, v, state.t), tuple(corrections), redundant, linear)


def prepare(system: System, q: Array) -> tuple[Linear, tuple[str, ...]]:
    """The linear algebra of a system near q, ready for redundant joints, and their names."""
    from .solvers.linear import Linear

    linear = Linear(system, q)
    return linear, _redundant(system, linear, q)


def prepared(system: System, q: Array, softened: bool, origin: Array) -> Linear:
    """The linear algebra that a run had which was assembled near q, at ``origin``, with or without redundant joints."""
    from .solvers.linear import Linear

    linear = Linear(system, q)
    if softened:
        linear.soften()
    linear.origin = origin
    return linear


def _singular(system: System, linear: Linear, q: Array) -> bool:
    from .solvers.formats import Singular
    from .solvers.start import mass_factor

    try:
        mass_factor(system, linear, q)
        return False
    except Singular:
        return True


def _redundant(system: System, linear: Linear, q: Array) -> tuple[str, ...]:
    """The joints that are redundant at q, which the matrix then allows. Raises SceneError for coordinates that nothing determines."""
    from .solvers.start import redundancy

    defect = redundancy(system, linear, q)
    if defect is None:
        return ()
    if defect.coordinates:
        where = quoted([system.owners[k][0] for k in defect.coordinates])
        raise SceneError([f"{where}: expected inertia or joints for every coordinate, found {defect.what}; give it mass or hold it by a joint"])
    linear.soften()
    names = list(dict.fromkeys(system.label(row) for row in defect.rows))
    return tuple(name for name in names if name not in system.internal) or tuple(names)


def _corrections(system: System, linear: Linear, before: State, q: Array, v: Array, goal: Targets) -> list[Correction]:
    """What was violated at which joint, and which item moved how far, above rounding. A mechanism at rest whose drive sets it in motion
    was described well: what only driven equations ask of velocities is no correction."""
    found: list[Correction] = []
    speed = max(float(np.max(np.abs(before.v) * system.levers, initial=0.0)), 1e-300)
    joints, lengths = system.joints.at(before.q), distances(system, linear, before.q)
    for name, unit, residual, moved, scale in (
        ("position", "(length)", joints.value - goal.value, q - before.q, system.length),
        ("velocity", "(length/time)", np.where(driven_rows(system), 0.0, joints.push(before.v)), v - before.v, speed),
    ):
        gaps = np.abs(residual) * lengths
        if name == "velocity" and np.max(gaps, initial=0.0) <= REPORTED * scale:
            continue
        by_joint: dict[str, float] = {}
        for row in np.flatnonzero(gaps > REPORTED * scale):
            by_joint[system.label(int(row))] = max(by_joint.get(system.label(int(row)), 0.0), float(gaps[row]))
        change = np.abs(moved) * system.levers
        by_item: dict[str, float] = {}
        for k in np.flatnonzero(change > REPORTED * scale):
            by_item[system.owners[k][0]] = max(by_item.get(system.owners[k][0], 0.0), float(change[k]))
        found += [Correction(f"{name} error closed", joint, gap, unit) for joint, gap in by_joint.items()]
        found += [Correction(f"{name} changed", item, amount, unit) for item, amount in by_item.items()]
    return found


def announce(assembly: Assembly) -> None:
    """A SceneWarning for redundant joints and for a start that had to be corrected."""
    if assembly.redundant:
        warnings.warn(
            f"redundant joints {quoted(list(assembly.redundant))}: some of their equations follow from the others; "
            "the scene runs, its multipliers are those of least norm",
            SceneWarning,
            stacklevel=3,
        )
    if assembly.corrections:
        warnings.warn("the start was not consistent and has been corrected: " + "; ".join(map(str, assembly.corrections)), SceneWarning, stacklevel=3)
