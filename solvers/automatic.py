"""The default: explicit where nothing is stiff, implicit where something is, and from one to the other where the scene asks for it.

Beams take Radau IIA. Other systems take the projected explicit method, which hands over to Radau where their joints come near a singular
position (bars in line), step by step; and for good where springs or dampers make them stiff.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .formats import Singular
from .linear import Linear
from .projected import ProjectedExplicit
from .protocol import Attempt, State
from .radau import Radau, RadauIIA
from .start import accelerations, mass_factor
from .system import Array, Index, System

IMPLICIT, EXPLICIT = 0, 1

STABLE, ALARMS = 6.1, 15
"""Step times fastest rate at the border of stability, and the surplus of steps beyond it that proves a system stiff (Hairer and Wanner)."""


FAR = 100.0
"""First step times fastest rate from which on a system is taken for stiff at once; steps tell what is not as clear."""

CROSSING, REACHED = 0.1, 1e-10
"""The tolerance of a step across a singular position, as a share of the given one: what Newton's iteration leaves in the equations there is a far
larger error in position. But not below that share of the length, as rounding grows in the same way."""


@dataclass(frozen=True)
class Automatic:
    """Dormand and Prince's explicit method, with Radau IIA near singular positions, and for good where springs prove stiff."""

    def integrator(self, rtol: float) -> Switching:
        """The method for a tolerance."""
        return Switching(Radau().integrator(rtol))


def default(system: System) -> tuple[Automatic | Radau, str]:
    """The solver for a system whose user named none, and why."""
    if not system.n_stresses:
        return Automatic(), "nothing is elastic: explicit, implicit only near singular positions"
    if np.array_equal(system.mass_rows, system.mass_cols):
        return Automatic(), "springs between rigid bodies: explicit, implicit near singular positions and where they prove stiff"
    return Radau(), "elastic continua are stiff"


class Memory(NamedTuple):
    """Who took the last step, what it remembers, whether the system is stiff, and how often stability limited the explicit method."""

    explicit: bool
    inner: Any
    stiff: bool = False
    alarms: int = 0


class Switching:
    """Dormand and Prince's method and Radau IIA in turn."""

    fixed: float | None = None

    def __init__(self, implicit: RadauIIA):
        self.explicit, self.implicit = ProjectedExplicit(), implicit
        self.name = f"{self.explicit.name}, otherwise {implicit.name}"

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        return self.explicit.first_step(system, state, acceleration, span, tolerance)

    def kept(self, memory: Memory | None) -> None:
        """Nothing: the state says whose step it was, and values inside are found by the same method."""

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step by the method at work; where the explicit one cannot go on, by the implicit one."""
        memory = state.memory or self._opening(system, linear, state, h)
        if not memory.stiff:
            inner = memory.inner if memory.explicit else None
            attempt = self.explicit.step(system, linear, state._replace(memory=inner), h, tolerance)
            if attempt.state is not None:
                return self._after_explicit(system, linear, attempt, attempt.state, memory.alarms)
            if memory.explicit:
                state, memory = _complete(system, linear, state), Memory(False, None)
            tolerance = min(tolerance, max(CROSSING * tolerance, REACHED * system.length))
        attempt = self.implicit.step(system, linear, state._replace(memory=memory.inner), h, tolerance)
        if attempt.state is None:
            return attempt
        then = Memory(False, attempt.state.memory, memory.stiff)
        return attempt._replace(state=attempt.state._replace(memory=then, method=IMPLICIT))

    def _opening(self, system: System, linear: Linear, state: State, h: float) -> Memory:
        """Who starts: the implicit method, for good, where stability would shorten the first step to less than 1 / FAR. Before that were seen from
        steps, velocities would be as wrong as errors of tiny steps may be, and dampers would dissipate what nobody put in."""
        if (system.n_stresses or system.damped) and h * _fastest_bound(system, linear, state) > FAR:
            return Memory(False, None, stiff=True)
        return Memory(True, None)

    def _after_explicit(self, system: System, linear: Linear, attempt: Attempt, after: State, alarms: int) -> Attempt:
        """The explicit method goes on, unless its steps were too often as long as stability allows."""
        if attempt.error > 1.0:  # nothing is kept of it
            return attempt
        alarms = alarms + 1 if after.memory.stiffness > STABLE else max(alarms - 1, 0)
        if alarms < ALARMS:
            return attempt._replace(state=after._replace(memory=Memory(True, after.memory, False, alarms), method=EXPLICIT))
        done = _complete(system, linear, after)
        return attempt._replace(state=done._replace(memory=Memory(False, None, stiff=True), method=EXPLICIT))

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step, as the method that took it finds them."""
        if after.method == EXPLICIT:
            return self.explicit.inside(system, linear, before._replace(memory=None), after, times)
        return self.implicit.inside(system, linear, _complete(system, linear, before), after, times)


def _fastest_bound(system: System, linear: Linear, state: State) -> float:
    """A rate [1/s] that no vibration or decay about a state exceeds: row sums of K and D in units in which masses are 1."""

    def size(rows: Index, cols: Index, values: Array) -> float:
        scaled = np.abs(values) * linear.scale[rows] * linear.scale[cols]
        return float(np.max(np.bincount(rows, scaled, minlength=1)))

    inputs = system.inputs(state.t)
    stiffness = system.stiffness(state.q, state.v, inputs, state.stress, state.multipliers)
    rate = np.sqrt(size(system.stiffness_rows, system.stiffness_cols, stiffness))
    if system.damped:
        rate = max(rate, size(system.damping_rows, system.damping_cols, system.damping(state.q, state.v, inputs)))
    return float(rate)


def _complete(system: System, linear: Linear, state: State) -> State:
    """The state with the multipliers of all equations: the explicit method may leave some out."""
    try:
        factor = mass_factor(system, linear, state.q)
    except Singular:
        return state
    return state._replace(multipliers=accelerations(system, factor, state.q, state.v, system.inputs(state.t))[1])
