"""Explicit Runge-Kutta of order 8 on the accelerations, projected to the joints after each step: for systems where nothing is stiff.

Dormand and Prince's method (``dop853.py``) for q' = v, v' = a(q, v, t) with index-1 accelerations (``index_one.py``); positions, then
velocities, are projected at the end of each step. Hairer, Norsett and Wanner (1993), II.10; Eich (1993), SIAM J. Numer. Anal. 30.
A step that comes near a singular position of the joints fails and says so: it is for an implicit method to go on (``automatic.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .dop853 import ERROR_3, ERROR_5, MATRIX, NODES, WEIGHTS
from .formats import Singular
from .index_one import KktEquations, NormalEquations, index_one
from .linear import Linear
from .protocol import Attempt, State
from .start import Inconsistent, mass_factor, project_positions, project_velocities
from .system import Array, System, targets

STRICT = 0.1
"""The local error aimed at, as a share of the tolerance: what steps of this size leave adds up over the long spans they cover."""


@dataclass(frozen=True)
class DormandPrince:
    """Explicit, order 8, with projection to the joints and error control; for scenes without stiff elements."""

    def integrator(self, rtol: float) -> ProjectedExplicit:
        """The method for a tolerance."""
        return ProjectedExplicit()


class Memory(NamedTuple):
    """The prepared index-1 equations, and the acceleration at the state."""

    equations: NormalEquations | KktEquations
    acceleration: Array


class ProjectedExplicit:
    """The method."""

    name = "projected Dormand-Prince (order 8, explicit)"
    fixed: float | None = None

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        """A step over which velocities and accelerations move things by a modest part of the length."""
        speed = float(np.max(np.abs(state.v) * system.levers, initial=0.0))
        pull = float(np.max(np.abs(acceleration) * system.levers, initial=0.0))
        reach = system.length * (tolerance / system.length) ** (1.0 / 8.0)
        steps = [span, *([reach / speed] if speed > 0.0 else []), *([np.sqrt(2.0 * reach / pull)] if pull > 0.0 else [])]
        return 0.1 * min(steps)

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are the ends of shorter ones."""

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h; ``tolerance`` is a length: the local error allowed in positions."""
        try:
            memory = self._remembered(system, linear, state)
            positions, velocities, accelerations, multipliers = self._stages(system, memory, state, h)
            q, v = state.q + h * (WEIGHTS @ velocities), state.v + h * (WEIGHTS @ accelerations)
            error = self._error(system, velocities, accelerations, h) / (STRICT * tolerance)
            if not error <= 1.0:
                return Attempt(state, error if np.isfinite(error) else 1e8, 8.0, 0.0, 0)
            after = self._landed(system, linear, memory, state.t + h, q, v)
            nodes = (state.t + NODES * h, positions, velocities, WEIGHTS * h)
            return Attempt(after, error, 8.0, 0.0, 12, nodes=nodes, multipliers=multipliers)
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 0.0, 0, f"singular equations ({trouble})")

    def _remembered(self, system: System, linear: Linear, state: State) -> Memory:
        if isinstance(state.memory, Memory):
            return state.memory
        equations = index_one(system, linear)
        return Memory(equations, equations.solve(state.q, state.v, system.inputs(state.t))[0])

    def _stages(self, system: System, memory: Memory, state: State, h: float) -> tuple[Array, Array, Array, Array]:
        """Positions, velocities and accelerations [12, n], and multipliers [12, m], at the stages."""
        positions, velocities, accelerations = np.empty((3, 12, system.n))
        multipliers = np.empty((12, system.m))
        positions[0], velocities[0], accelerations[0], multipliers[0] = state.q, state.v, memory.acceleration, state.multipliers
        for i in range(1, 12):
            row = h * MATRIX[i, :i]
            velocities[i] = v = state.v + row @ accelerations[:i]
            positions[i] = q = state.q + row @ velocities[:i]
            accelerations[i], multipliers[i] = memory.equations.solve(q, v, system.inputs(state.t + NODES[i] * h))
        return positions, velocities, accelerations, multipliers

    def _error(self, system: System, velocities: Array, accelerations: Array, h: float) -> float:
        """The estimate of Hairer, Norsett and Wanner, II.10: the embedded orders 5 and 3 together, in positions and velocities times h."""
        levers = h * system.levers

        def size(weights: Array) -> float:
            return max(float(np.max(np.abs(weights @ velocities) * levers)), h * float(np.max(np.abs(weights @ accelerations) * levers)))

        fifth, third = size(ERROR_5), size(ERROR_3)
        return fifth**2 / np.sqrt(fifth**2 + 0.01 * third**2) if fifth > 0.0 else 0.0

    def _landed(self, system: System, linear: Linear, memory: Memory, t: float, q: Array, v: Array) -> State:
        """The state at the end of a step, on the joints."""
        inputs = system.inputs(t)
        if system.m:
            goal = targets(inputs)
            factor = mass_factor(system, linear, q)
            q = project_positions(system, linear, q, goal.value, factor=factor, sweeps=8)
            v = project_velocities(system, factor, q, v, goal.rate)
        acceleration, multipliers = memory.equations.solve(q, v, inputs)
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        return State(t, q, v, multipliers, stress, memory._replace(acceleration=acceleration))

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the ends of steps of their own from its start, as accurate as the step itself."""
        q, v = np.empty((times.size, system.n)), np.empty((times.size, system.n))
        start = before._replace(memory=self._remembered(system, linear, before))
        for k, t in enumerate(times):
            landed = self.step(system, linear, start, float(t - before.t), np.inf).state
            if landed is None:
                raise ArithmeticError(f"no interpolation at {t:.9g} s: the joints are in a nearly singular position")
            q[k], v[k] = landed.q, landed.v
        return q, v
