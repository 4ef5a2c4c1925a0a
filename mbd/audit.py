"""What a run did to the quantities that should stay: drift of the joints, balance of energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .system import System
from .trajectory import Trajectory


@dataclass(frozen=True)
class Audit:
    """What a run did to the quantities that should stay: largest values over all accepted steps.

    position_drift   |g| (of drives: from what is asked) as a length, relative to the scene's length
    velocity_drift   |G v|, relative to the largest speed
    energy_error     |energy - energy at the start - work of loads, drives and dampers| [J]
    energy_scale     the largest energy exchanged [J]
    energy_level     the largest energy of any kind [J]
    work             of loads, drives and dampers over the run [J]
    """

    position_drift: float
    velocity_drift: float
    energy_error: float
    energy_scale: float
    energy_level: float
    work: float

    @property
    def balanced(self) -> bool:
        """Whether the energy adds up at all: an imbalance of a fifth, above rounding, means an unstable or far too coarse run."""
        return self.energy_error <= max(0.2 * self.energy_scale, 1e-9 * self.energy_level)

    def __str__(self) -> str:
        relative = f" ({self.energy_error / self.energy_scale:.1e} of {self.energy_scale:.4g} J exchanged)" if self.energy_scale > 0.0 else ""
        work = f"; loads, drives and dampers did {self.work:.6g} J of work" if self.work else ""
        return (
            f"joints: positions within {self.position_drift:.1e} of the length, velocities within {self.velocity_drift:.1e} of the speed\n"
            f"energy: balanced within {self.energy_error:.1e} J{relative}{work}"
        )


def audit(system: System, trajectory: Trajectory) -> Audit:
    """The audit of a trajectory."""
    q, v = trajectory.q, trajectory.v
    joints, reach, goal = system.joints.at(q), trajectory.linear.reach, system.inputs(trajectory.t).targets
    speed = max(float(np.max(np.abs(v) * system.levers, initial=0.0)), 1e-300)
    kinetic, elastic, potential = system.kinetic(v), system.elastic(q), system.potential(q)
    balance = kinetic + elastic + potential - trajectory.work
    exchanged = max(float(np.ptp(part)) for part in (kinetic, elastic, potential))
    return Audit(
        float(np.max(np.abs(joints.value - goal.value) * reach, initial=0.0)) / system.length,
        float(np.max(np.abs(joints.push(v) - goal.rate) * reach, initial=0.0)) / speed,
        float(np.max(np.abs(balance - balance[0]))),
        exchanged,
        max(float(np.max(np.abs(part))) for part in (kinetic, elastic, potential)),
        float(trajectory.work[-1]),
    )
