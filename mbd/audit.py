"""What a run did to the quantities that should stay: drift of the joints, balance of energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .affine import Array
from .displayed import Displayed
from .system import System
from .trajectory import Joined, Trajectory

ENERGIES = ("error", "exchanged", "level", "moving", "work")
"""What is summed over parts."""
KNOWN = 1e-3
"""Kinetic energy that a run may lose or gain where little is exchanged: velocities off by half of this."""


@dataclass(frozen=True)
class Audit(Displayed):
    """What a run did to the quantities that should stay: largest values over all accepted steps.

    position_drift   |g| (of drives: from what is asked) as a length, relative to the scene's length
    velocity_drift   |G v|, relative to the largest speed
    energy_error     |energy - energy at the start - work of loads, drives and dampers| [J]
    energy_scale     the largest energy exchanged [J]
    energy_level     the largest energy of any kind [J]; of gravity, before what is above and below the origin cancels
    moving_energy    the largest kinetic energy [J]
    still            nothing moved farther than rounding: energies, and their balance, are rounding too
    work             of loads, drives and dampers over the run [J]
    parts            of a scene of several independent parts the audits of each, whose energies are summed above; else empty
    """

    position_drift: float
    velocity_drift: float
    energy_error: float
    energy_scale: float
    energy_level: float
    moving_energy: float
    still: bool
    work: float
    parts: tuple[Audit, ...] = field(default=(), repr=False)

    @property
    def balanced(self) -> bool:
        """Whether the energy adds up at all: an imbalance of a fifth, above rounding and what velocities are known to, means an unstable or
        far too coarse run. Where next to nothing is exchanged, as in a uniform rotation, errors within the tolerance are all that changes."""
        if self.parts:
            return all(part.balanced for part in self.parts)
        return self.still or self.energy_error <= max(0.2 * self.energy_scale, KNOWN * self.moving_energy, 1e-9 * self.energy_level)

    def __str__(self) -> str:
        relative = f" ({self.energy_error / self.energy_scale:.1e} of {self.energy_scale:.4g} J exchanged)" if self.energy_scale > 0.0 else ""
        work = f"; loads, drives and dampers did {self.work:.6g} J of work" if self.work else ""
        return (
            f"joints: positions within {self.position_drift:.1e} of the length, velocities within {self.velocity_drift:.1e} of the speed\n"
            f"energy: balanced within {self.energy_error:.1e} J{relative}{work}"
        )


class History(NamedTuple):
    """Of one part, at its accepted steps t [k] [s]: what ``Audit`` tells the largest of; imbalance [J]."""

    t: Array
    position: Array
    velocity: Array
    imbalance: Array


class _Found(NamedTuple):
    """What was found in one part: gaps and slips of joints, levers times velocities, and energies."""

    gap: float
    slip: float
    speed: float
    error: float
    exchanged: float
    level: float
    moving: float
    still: bool
    work: float


def audit(system: System, trajectory: Trajectory | Joined) -> Audit:
    """The audit of a trajectory, each part at its own steps."""
    found = [_found(each) for each in trajectory.pieces()]
    parts = tuple(_summed([one], system.length) for one in found) if len(found) > 1 else ()
    return _summed(found, system.length, parts)


def _summed(found: Sequence[_Found], length: float, parts: tuple[Audit, ...] = ()) -> Audit:
    gap, slip, speed = (max(getattr(one, name) for one in found) for name in ("gap", "slip", "speed"))
    error, exchanged, level, moving, work = (sum(getattr(one, name) for one in found) for name in ENERGIES)
    still = all(one.still for one in found)
    return Audit(gap / length, slip / max(speed, 1e-300), error, exchanged, level, moving, still, work, parts)


def histories(system: System, trajectory: Trajectory | Joined) -> list[History]:
    """The drift and the balance of each part over its steps, in the units of the audit."""
    pieces = trajectory.pieces()
    speed = max(_speed(each) for each in pieces) or 1e-300
    told = []
    for each in pieces:
        gap, slip = _open(each)
        told.append(History(each.t, gap / system.length, slip / speed, np.abs(_imbalance(each, _energies(each)))))
    return told


def _open(trajectory: Trajectory) -> tuple[Array, Array]:
    """[k]: the largest gap of a joint [m], and how fast one opens [m/s]."""
    system, reach = trajectory.part.system, trajectory.linear.reach
    joints, goal = system.joints.at(trajectory.q), system.inputs(trajectory.t).targets
    gaps, slips = joints.value - goal.value, joints.push(trajectory.v) - goal.rate
    gap, slip = (np.max(np.abs(each) * reach, axis=-1, initial=0.0) for each in (gaps, slips))
    return gap, slip


def _speed(trajectory: Trajectory) -> float:
    return float(np.max(np.abs(trajectory.v) * trajectory.part.system.levers, initial=0.0))


def _energies(trajectory: Trajectory) -> tuple[Array, Array, Array]:
    system = trajectory.part.system
    return system.kinetic(trajectory.v), system.elastic(trajectory.q), system.potential(trajectory.q)


def _imbalance(trajectory: Trajectory, energies: tuple[Array, Array, Array]) -> Array:
    balance = energies[0] + energies[1] + energies[2] - trajectory.work
    return balance - balance[0]


def _still(trajectory: Trajectory) -> bool:
    system, q = trajectory.part.system, trajectory.q
    rounding = 1e-11 * system.length + 1e-14 * float(np.max(np.abs(q) * system.levers))
    return bool(np.max(np.abs(q - q[0]) * system.levers) <= rounding)


def _found(trajectory: Trajectory) -> _Found:
    system, (gap, slip), energies = trajectory.part.system, _open(trajectory), _energies(trajectory)
    return _Found(
        gap=float(gap.max()),
        slip=float(slip.max()),
        speed=_speed(trajectory),
        error=float(np.max(np.abs(_imbalance(trajectory, energies)))),
        exchanged=max(float(np.ptp(part)) for part in energies),
        level=max(float(np.max(energies[0])), float(np.max(energies[1])), _weights(system, trajectory.q)),
        moving=float(np.max(energies[0])),
        still=_still(trajectory),
        work=float(trajectory.work[-1]),
    )


def _weights(system: System, q: Array) -> float:
    """The potential energy before anything cancels in it [J], moved by the length at least: what its rounding is a share of."""
    reach = np.maximum(np.max(np.abs(q), axis=0), system.length * system.levers)
    return float(np.abs(system.weight) @ reach)
