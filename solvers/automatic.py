"""The default: explicit where nothing is stiff, implicit where something is, and from one to the other where the scene asks for it.

Systems with elastic elements take Radau IIA. Others take the projected explicit method, which hands over to Radau where their joints come
near a singular position (bars in line) and takes over again some steps after it was passed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from .linear import Linear
from .projected import ProjectedExplicit
from .protocol import Attempt, State
from .radau import Radau, RadauIIA
from .system import Array, System

IMPLICIT_STEPS = 5
"""Steps that the implicit method takes before the explicit one is tried again."""


@dataclass(frozen=True)
class Automatic:
    """Dormand and Prince's explicit method, with Radau IIA where joints come near a singular position; for scenes without stiff elements."""

    def integrator(self, rtol: float) -> Switching:
        """The method for a tolerance."""
        return Switching(Radau().integrator(rtol))


def default(system: System) -> tuple[Automatic | Radau, str]:
    """The solver for a system whose user named none, and why."""
    if system.n_stresses:
        return Radau(), "elastic elements may be stiff"
    return Automatic(), "nothing is elastic: explicit, implicit only near singular positions"


class Memory(NamedTuple):
    """Who is at work, what it remembers, and for how many steps the implicit method goes on."""

    explicit: bool
    inner: Any
    left: int


class Switching:
    """Dormand and Prince's method and Radau IIA in turn."""

    fixed: float | None = None

    def __init__(self, implicit: RadauIIA):
        self.explicit, self.implicit = ProjectedExplicit(), implicit
        self.name = f"{self.explicit.name}, near singular positions {implicit.name}"

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        return self.explicit.first_step(system, state, acceleration, span, tolerance)

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are found by solving it once more, implicitly."""

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step by the method at work; where the explicit one cannot go on, by the implicit one."""
        memory = state.memory or Memory(True, None, 0)
        if memory.explicit or memory.left == 0:
            inner = memory.inner if memory.explicit else None
            attempt = self.explicit.step(system, linear, state._replace(memory=inner), h, tolerance)
            if attempt.state is not None:
                return _remembering(attempt, True, 0)
            memory = Memory(False, None, IMPLICIT_STEPS)
        attempt = self.implicit.step(system, linear, state._replace(memory=memory.inner), h, tolerance)
        return _remembering(attempt, False, max(memory.left - 1, 0))

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step, as the implicit method finds them."""
        return self.implicit.inside(system, linear, before, after, times)


def _remembering(attempt: Attempt, explicit: bool, left: int) -> Attempt:
    if attempt.state is None:
        return attempt
    return attempt._replace(state=attempt.state._replace(memory=Memory(explicit, attempt.state.memory, left)))
