"""From a scene's description to a consistent state: what the joints had to move is reported, what they cannot join is refused."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .affine import Array
from .errors import SceneError, SceneWarning
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.linear import Linear

REPORTED = 1e-9
"""Corrections below this share of the scene's length and speed are rounding, not worth a word."""


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

    Positions, then velocities, are projected to the joints with the least motion in the sense of the mass matrix.
    Raises SceneError, by name, for joints that cannot be satisfied together and for parts without inertia.
    """
    system = scene.build()
    state = start or State(system.q0, system.v0)
    state.check(system)
    return consistent(system, state)


def consistent(system: System, state: State) -> Assembly:
    from .solvers.formats import Singular
    from .solvers.linear import Linear
    from .solvers.start import Inconsistent, mass_factor, project_positions, project_velocities, redundancy

    linear = Linear(system, state.q)
    redundant = _redundant(system, linear, redundancy(system, linear, state.q))
    try:
        q = project_positions(system, linear, state.q)
        v = project_velocities(system, mass_factor(system, linear, q), q, state.v)
    except Inconsistent as trouble:
        raise SceneError([_conflict(system, trouble.defect.rows, trouble.defect.what)]) from None
    except Singular:
        rows = [int(np.argmax(np.abs(system.joints.at(state.q).value) * linear.reach))]
        raise SceneError([_conflict(system, rows, "the joints lock on the way to a position that satisfies them")]) from None
    unmet = system.joints.at(q).push(v) * linear.reach
    scale = float(np.max(np.abs(v) * system.levers, initial=0.0))
    if np.max(np.abs(unmet), initial=0.0) > 1e-6 * scale:
        raise SceneError([_conflict(system, [int(np.argmax(np.abs(unmet)))], "velocities cannot satisfy them together")])
    corrections = _corrections(system, linear, state, q, v)
    return Assembly(State(q, v, state.t), tuple(corrections), tuple(redundant), linear)


def _redundant(system: System, linear: Linear, defect: object) -> list[str]:
    from .solvers.start import Defect

    if defect is None:
        return []
    assert isinstance(defect, Defect)
    if defect.coordinates:
        where = _names([system.owners[k][0] for k in defect.coordinates])
        raise SceneError([f"{where}: expected inertia or joints for every coordinate, found {defect.what}; give it mass or hold it by a joint"])
    linear.soften()
    names = list(dict.fromkeys(system.label(row) for row in defect.rows))
    return [name for name in names if name not in system.internal] or names


def _conflict(system: System, rows: list[int], what: str) -> str:
    labels = [system.label(row) for row in rows]
    names = _names([label for label in labels if label not in system.internal] or labels)
    return f"joints {names}: expected equations that can hold together, found {what}; correct positions or lengths"


def _names(names: list[str]) -> str:
    return ", ".join(repr(name) for name in dict.fromkeys(names))


def _corrections(system: System, linear: Linear, before: State, q: Array, v: Array) -> list[Correction]:
    """What was violated at which joint, and which item moved how far, above rounding."""
    found: list[Correction] = []
    speed = max(float(np.max(np.abs(before.v) * system.levers, initial=0.0)), 1e-300)
    joints = system.joints.at(before.q)
    for name, unit, residual, moved, scale in (
        ("position", "(length)", joints.value, q - before.q, system.length),
        ("velocity", "(length/time)", joints.push(before.v), v - before.v, speed),
    ):
        gaps = np.abs(residual) * linear.reach
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
            f"redundant joints {_names(list(assembly.redundant))}: some of their equations follow from the others; "
            "the scene runs, its multipliers are those of least norm",
            SceneWarning,
            stacklevel=3,
        )
    if assembly.corrections:
        warnings.warn("the start was not consistent and has been corrected: " + "; ".join(map(str, assembly.corrections)), SceneWarning, stacklevel=3)
