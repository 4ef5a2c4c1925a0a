"""What a run did to the quantities that should stay: drift of the joints, balance of energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .affine import Array
from .system import System
from .trajectory import Joined, Trajectory

KNOWN = 1e-3
"""Kinetic energy that a run may lose or gain where little is exchanged: velocities off by half of this."""


@dataclass(frozen=True)
class Audit:
    """What a run did to the quantities that should stay: largest values over all accepted steps.

    position_drift   |g| (of drives: from what is asked) as a length, relative to the scene's length
    velocity_drift   |G v|, relative to the largest speed
    energy_error     |energy - energy at the start - work of loads, drives and dampers| [J]
    energy_scale     the largest energy exchanged [J]
    energy_level     the largest energy of any kind [J]; of gravity, before what is above and below the origin cancels
    moving_energy    the largest kinetic energy [J]
    work             of loads, drives and dampers over the run [J]
    parts            of a scene of several independent parts the audits of each, whose energies are summed above; else empty
    """

    position_drift: float
    velocity_drift: float
    energy_error: float
    energy_scale: float
    energy_level: float
    moving_energy: float
    work: float
    parts: tuple[Audit, ...] = field(default=(), repr=False)

    @property
    def balanced(self) -> bool:
        """Whether the energy adds up at all: an imbalance of a fifth, above rounding and what velocities are known to, means an unstable or
        far too coarse run. Where next to nothing is exchanged, as in a uniform rotation, errors within the tolerance are all that changes."""
        if self.parts:
            return all(part.balanced for part in self.parts)
        return self.energy_error <= max(0.2 * self.energy_scale, KNOWN * self.moving_energy, 1e-9 * self.energy_level)

    def __str__(self) -> str:
        relative = f" ({self.energy_error / self.energy_scale:.1e} of {self.energy_scale:.4g} J exchanged)" if self.energy_scale > 0.0 else ""
        work = f"; loads, drives and dampers did {self.work:.6g} J of work" if self.work else ""
        return (
            f"joints: positions within {self.position_drift:.1e} of the length, velocities within {self.velocity_drift:.1e} of the speed\n"
            f"energy: balanced within {self.energy_error:.1e} J{relative}{work}"
        )


class _Found(NamedTuple):
    """What was found in one part: gaps and slips of joints, levers times velocities, and energies."""

    gap: float
    slip: float
    speed: float
    error: float
    exchanged: float
    level: float
    moving: float
    work: float


def audit(system: System, trajectory: Trajectory | Joined) -> Audit:
    """The audit of a trajectory, each part at its own steps."""
    found = [_found(each) for each in trajectory.pieces()]
    parts = tuple(_summed([one], system.length) for one in found) if len(found) > 1 else ()
    return _summed(found, system.length, parts)


def _summed(found: Sequence[_Found], length: float, parts: tuple[Audit, ...] = ()) -> Audit:
    gap, slip, speed = (max(getattr(one, name) for one in found) for name in ("gap", "slip", "speed"))
    error, exchanged, level, moving, work = (sum(getattr(one, name) for one in found) for name in ("error", "exchanged", "level", "moving", "work"))
    return Audit(gap / length, slip / max(speed, 1e-300), error, exchanged, level, moving, work, parts)


def _found(trajectory: Trajectory) -> _Found:
    system, q, v = trajectory.part.system, trajectory.q, trajectory.v
    joints, reach, goal = system.joints.at(q), trajectory.linear.reach, system.inputs(trajectory.t).targets
    kinetic, elastic, potential = system.kinetic(v), system.elastic(q), system.potential(q)
    balance = kinetic + elastic + potential - trajectory.work
    return _Found(
        gap=float(np.max(np.abs(joints.value - goal.value) * reach, initial=0.0)),
        slip=float(np.max(np.abs(joints.push(v) - goal.rate) * reach, initial=0.0)),
        speed=float(np.max(np.abs(v) * system.levers, initial=0.0)),
        error=float(np.max(np.abs(balance - balance[0]))),
        exchanged=max(float(np.ptp(part)) for part in (kinetic, elastic, potential)),
        level=max(float(np.max(kinetic)), float(np.max(elastic)), _weights(system, q)),
        moving=float(np.max(kinetic)),
        work=float(trajectory.work[-1]),
    )


def _weights(system: System, q: Array) -> float:
    """The potential energy before anything cancels in it [J], moved by the length at least: what its rounding is a share of."""
    reach = np.maximum(np.max(np.abs(q), axis=0), system.length * system.levers)
    return float(np.abs(system.weight) @ reach)
