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
from .index_one import Form, index_one
from .linear import Linear
from .protocol import Attempt, State
from .start import Inconsistent
from .system import Array, System

ERRORS = np.array([ERROR_5, ERROR_3])

STRICT = 0.1
"""The local error aimed at, as a share of the tolerance: what steps of this size leave adds up over the long spans they cover."""


@dataclass(frozen=True)
class DormandPrince:
    """Explicit, order 8, with projection to the joints and error control; for scenes without stiff elements."""

    def integrator(self, rtol: float) -> ProjectedExplicit:
        """The method for a tolerance."""
        return ProjectedExplicit()


class Memory(NamedTuple):
    """The system in the form prepared for it, with the state, its derivative and its multipliers there.

    ``stiffness`` is the last step times the fastest rate seen in it, of elastic systems: near 6 stability limits steps, not accuracy.
    """

    form: Form
    w: Array
    rate: Array
    multipliers: Array
    stiffness: float = 0.0


class ProjectedExplicit:
    """The method."""

    name = "projected Dormand-Prince (order 8, explicit)"
    fixed: float | None = None

    def __init__(self) -> None:
        self._prepared: tuple[Linear, Form] | None = None  # the form of the last system asked for, whose making costs as much as a step

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
            states, rates, multipliers = self._stages(system, memory, state.t, h)
            error = self._error(memory.form, rates, h) / (STRICT * min(tolerance, linear.coarsest))
            if not error <= 1.0:
                return Attempt(state, error if np.isfinite(error) else 1e8, 8.0, 0.0, 0)
            after = self._landed(system, memory, state.t + h, _end(memory, rates, h))
            if system.n_stresses or system.damped:
                stiffness = h * _fastest(memory.form, after.memory.w - states[-1], after.memory.rate - rates[-1])
                after = after._replace(memory=after.memory._replace(stiffness=stiffness))
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 0.0, 0, f"singular equations ({trouble})")
        nodes = (state.t + NODES * h, *memory.form.leave(states), WEIGHTS * h)
        return Attempt(after, error, 8.0, 0.0, 12, nodes=nodes, multipliers=memory.form.all_rows(multipliers))

    def _remembered(self, system: System, linear: Linear, state: State) -> Memory:
        if isinstance(state.memory, Memory):
            return state.memory
        if self._prepared is None or self._prepared[0] is not linear:
            self._prepared = (linear, index_one(system, linear))
        form = self._prepared[1]
        w, rate = form.enter(state.q, state.v), np.zeros(form.shape)
        return Memory(form, w, rate, form.rates(system, w, state.t, rate))

    def _stages(self, system: System, memory: Memory, t: float, h: float) -> tuple[Array, Array, Array]:
        """States and their derivatives [12, 2, ...], and multipliers [12, ...], at the stages."""
        form = memory.form
        states, rates = np.empty((2, 12, *form.shape))
        multipliers = np.empty((12, memory.multipliers.size))
        states[0], rates[0], multipliers[0] = memory.w, memory.rate, memory.multipliers
        flat, start, matrix, times = rates.reshape(12, -1), memory.w.ravel(), h * MATRIX, t + NODES * h
        for i in range(1, 12):
            states[i] = (start + matrix[i, :i] @ flat[:i]).reshape(form.shape)
            multipliers[i] = form.rates(system, states[i], times[i], rates[i])
        return states, rates, multipliers

    def _error(self, form: Form, rates: Array, h: float) -> float:
        """The estimate of Hairer, Norsett and Wanner, II.10: the embedded orders 5 and 3 together, in positions and velocities times h."""
        lengths = form.lengths((ERRORS @ rates.reshape(12, -1)).reshape(2, *form.shape))
        fifth, third = (h * max(position, h * velocity) for position, velocity in lengths.tolist())
        return fifth**2 / np.sqrt(fifth**2 + 0.01 * third**2) if fifth > 0.0 else 0.0

    def _landed(self, system: System, memory: Memory, t: float, w: Array) -> State:
        """The state at the end of a step, on the joints."""
        form, rate = memory.form, np.zeros(memory.form.shape)
        multipliers = form.land(system, w, t, rate)
        q, v = form.leave(w)
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        return State(t, q, v, form.all_rows(multipliers), stress, memory._replace(w=w, rate=rate, multipliers=multipliers))

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the ends of steps of their own from its start, as accurate as the step itself."""
        q, v = np.empty((times.size, system.n)), np.empty((times.size, system.n))
        start = before._replace(memory=self._remembered(system, linear, before))
        try:
            for k, t in enumerate(times):
                h = float(t - before.t)
                rates = self._stages(system, start.memory, before.t, h)[1]
                q[k], v[k] = self._landed(system, start.memory, float(t), _end(start.memory, rates, h))[1:3]
        except (Singular, Inconsistent) as trouble:
            raise ArithmeticError(f"no interpolation at {t:.9g} s: the joints are in a nearly singular position ({trouble})") from None
        return q, v


def _end(memory: Memory, rates: Array, h: float) -> Array:
    """The end of a step, before it is moved to the joints."""
    return memory.w + (h * WEIGHTS @ rates.reshape(12, -1)).reshape(memory.w.shape)


def _fastest(form: Form, change: Array, of_rate: Array) -> float:
    """The rate [1/s] of what oscillates or decays fastest, from two neighbouring states: the change of acceleration over those of position
    (oscillations) and velocity (dampers). Hairer and Wanner (1996), IV.2."""
    (position, velocity), (_, acceleration) = form.lengths(change).tolist(), form.lengths(of_rate).tolist()
    return max(np.sqrt(acceleration / position) if position > 0.0 else 0.0, acceleration / velocity if velocity > 0.0 else 0.0)
