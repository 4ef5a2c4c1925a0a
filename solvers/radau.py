"""Radau IIA with error control: predicts the stages, iterates them, estimates the error, projects the end.

The stage equations are in ``stages.py``, the coefficients in ``coefficients.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from .coefficients import tableau
from .formats import Singular
from .linear import Linear
from .protocol import Attempt, State
from .stages import Linearised, Middle, StageEquations, Stages
from .start import Inconsistent, hermite, project_positions, project_samples, project_velocities
from .system import Array, System, targets

NEWTON = 0.01
"""Newton stops where its error is below this share of the tolerance."""

STAGNANT = 10.0
"""An iteration that gets no further is accepted below this multiple of its goal: rounding near a singular position, say."""

SLOW = 0.4
"""A contraction slower than this renews the derivatives in the middle of the iteration."""


@dataclass(frozen=True)
class Radau:
    """Radau IIA of order 2 stages - 1 on the stabilised index-2 equations; the default.

    stages   3, 5 or 7; None: by the tolerance
    step     a fixed step [s]; None: steps by error control
    """

    stages: int | None = None
    step: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if self.stages not in (None, 3, 5, 7):
            raise ValueError(f"Radau(stages={self.stages!r}): expected 3, 5, 7 or None")
        if self.step is not None and not (isinstance(self.step, Real) and 0.0 < self.step < np.inf):
            raise ValueError(f"Radau(step={self.step!r}): expected a positive number of seconds or None")

    def integrator(self, rtol: float) -> RadauIIA:
        """The method for a tolerance."""
        stages = self.stages or (3 if rtol > 5e-3 else 5 if rtol > 3e-6 else 7)
        return RadauIIA(stages, self.step, rtol)


class Memory(NamedTuple):
    """What the last step leaves to predict the next: its length, start, and stages."""

    h: float
    q0: Array
    v0: Array
    stress0: Array
    stages: Stages
    n_stages: int


class RadauIIA:
    """The s-stage method. ``fixed`` is its step, or None; ``rtol`` serves values inside of steps."""

    def __init__(self, stages: int, fixed: float | None = None, rtol: float = 1e-6):
        self.table, self.fixed, self.rtol = tableau(stages), fixed, rtol
        self.name = f"Radau IIA, {stages} stages (order {self.table.order})"
        self.iterations = 8 + stages

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h; ``tolerance`` is a length: the local error allowed in positions."""
        table = self.table
        guess, middle = self._predict(system, state, h)
        inputs = system.inputs(state.t + table.c * h)
        equations = StageEquations(system, table, h, state.q, state.v, inputs)
        try:
            found = self._iterate(equations, linear, guess, middle, tolerance, system.inputs(state.t + 0.5 * h))
            if isinstance(found, Attempt):
                return found
            x, at, rate, solves = found
            error = self._error(equations, linear, state, x, at, tolerance)
            q, v = state.q + x.dq[-1], x.v[-1]
            if at.mass_factor is not None:
                goal = targets(inputs)
                q = project_positions(system, linear, q, goal.value[-1], factor=at.mass_factor, sweeps=8, allowed=NEWTON * tolerance)
                v = project_velocities(system, at.mass_factor, q, v, goal.rate[-1])
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 1.0, 0, f"singular equations ({trouble})")
        memory = Memory(h, state.q, state.v, state.stress, x, table.stages)
        nodes = (state.t + table.c * h, state.q + x.dq, x.v, table.b * h)
        after = State(state.t + h, q, v, x.multipliers[-1], x.stress[-1], memory)
        return Attempt(after, error, table.stages + 1.0, rate, solves, nodes=nodes, multipliers=x.multipliers)

    def _predict(self, system: System, state: State, h: float) -> tuple[Stages, Middle]:
        """Stages and middle by the polynomials of the last step; from a start, by constant velocity and stress."""
        c = self.table.c
        s, m = c.size, system.m
        if state.memory is None:
            dq = np.outer(c, h * state.v)
            stages = Stages(dq, np.tile(state.v, (s, 1)), np.tile(state.multipliers, (s, 1)), np.zeros((s, m)), np.tile(state.stress, (s, 1)))
            return stages, Middle(state.q + 0.5 * h * state.v, state.v, state.multipliers, state.stress)
        memory: Memory = state.memory
        last = tableau(memory.n_stages)
        points = 1.0 + np.concatenate((c, [0.5])) * (h / memory.h)
        wide, narrow = last.forecast(points, with_start=True), last.forecast(points, with_start=False)
        dq = wide[:, 1:] @ memory.stages.dq + (memory.q0 - state.q)
        v = wide[:, :1] * memory.v0 + wide[:, 1:] @ memory.stages.v
        multipliers = narrow @ memory.stages.multipliers
        stress = wide[:, :1] * memory.stress0 + wide[:, 1:] @ memory.stages.stress
        stages = Stages(dq[:-1], v[:-1], multipliers[:-1], np.zeros((s, m)), stress[:-1])
        return stages, Middle(state.q + dq[-1], v[-1], multipliers[-1], stress[-1])

    def _iterate(
        self, equations: StageEquations, linear: Linear, x: Stages, middle: Middle, tolerance: float, inputs: Any
    ) -> Attempt | tuple[Stages, Linearised, float, int]:
        """Simplified Newton; renews its derivatives once where it contracts slowly."""
        system = equations.system
        at = Linearised(system, linear, self.table, equations.h, middle, inputs)
        goal = max(NEWTON * tolerance, 1e-15 * system.length)
        worst_rate, fresh = 0.0, True
        last: float | None = None
        for k in range(1, self.iterations + 1):
            x, size, g = equations.correct(x, at)
            if not np.isfinite(size):
                return self._failed("Newton's iteration overflowed", k, system, linear, g)
            if size <= 1e-2 * goal:
                return x, at, worst_rate, k
            if last is not None:
                rate = size / last
                worst_rate = max(worst_rate, rate)
                if rate < 1.0 and rate / (1.0 - rate) * size <= goal:
                    return x, at, worst_rate, k
                hopeless = rate >= 1.0 or rate ** (self.iterations - k) / (1.0 - rate) * size > goal
                if k > 2 and fresh and rate > SLOW:
                    at, fresh, last = Linearised(system, linear, self.table, equations.h, self._middle(equations, x), inputs), False, None
                    continue
                if k > 2 and hopeless and size <= STAGNANT * goal:
                    return x, at, worst_rate, k
                if k > 2 and hopeless:
                    return self._failed(f"Newton's iteration does not contract (rate {rate:.2g})", k, system, linear, g)
            last = size
        return self._failed(f"Newton's iteration needs more than {self.iterations} steps", self.iterations, system, linear, g)

    def _middle(self, equations: StageEquations, x: Stages) -> Middle:
        wide, narrow = self.table.middle[1:], self.table.middle_stages
        v = equations.v0 * (1.0 - wide.sum()) + wide @ x.v
        return Middle(equations.q0 + wide @ x.dq, v, narrow @ x.multipliers, narrow @ x.stress)

    def _failed(self, what: str, solves: int, system: System, linear: Linear, g: Array) -> Attempt:
        residual = np.max(np.abs(g), axis=0, initial=0.0) * linear.reach
        worst = int(np.argmax(residual)) if residual.size and np.isfinite(residual).all() else -1
        return Attempt(None, np.inf, 1.0, 1.0, solves, what, worst)

    def _error(self, equations: StageEquations, linear: Linear, state: State, x: Stages, at: Linearised, tolerance: float) -> float:
        system, table = equations.system, self.table
        force = system.load(state.q, state.v, system.inputs(state.t))
        if system.n_stresses:
            force = force - system.strains(state.q).pull(state.stress)
        if system.m:
            force = force - system.joints.at(state.q).pull(table.back_to_start @ x.multipliers)
        in_q, in_v = equations.start_defect(x, force, at)
        size = max(float(np.max(np.abs(in_q) * system.levers)), equations.h * float(np.max(np.abs(in_v) * system.levers)))
        return size / tolerance

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are found by solving it again."""

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the step is solved once more, with so many stages that its polynomial is as accurate inside
        as this method is at the end (collocation has order s + 1 inside, 2 s - 1 at the end)."""
        h = after.t - before.t
        fine = RadauIIA(min(2 * self.table.stages - 1, 11), rtol=self.rtol)
        found = fine._resolve(system, linear, before, after)
        if found is None:
            return self._halves(system, linear, before, after, times)
        wide = fine.table.extend((times - before.t) / h, with_start=True)
        q, v = before.q + wide[:, 1:] @ found.dq, wide[:, :1] * before.v + wide[:, 1:] @ found.v
        return (q, v) if system.joints.linear else project_samples(system, linear, q, v, targets(system.inputs(times)))

    def _resolve(self, system: System, linear: Linear, before: State, after: State) -> Stages | None:
        """The stages of the step from before to after, starting from the cubic between them; None where they do not converge."""
        h, c = after.t - before.t, self.table.c
        q, v = hermite(before, after, c)
        between = c[:, None]
        guess = Stages(
            q - before.q,
            v,
            (1.0 - between) * before.multipliers + between * after.multipliers,
            np.zeros((c.size, system.m)),
            (1.0 - between) * before.stress + between * after.stress,
        )
        equations = StageEquations(system, self.table, h, before.q, before.v, system.inputs(before.t + c * h))
        try:
            middle = self._middle(equations, guess)
            found = self._iterate(equations, linear, guess, middle, self.rtol * system.length, system.inputs(before.t + 0.5 * h))
        except Singular:
            return None
        return None if isinstance(found, Attempt) else found[0]

    def _halves(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """The same in two shorter steps, where the long one does not converge with more stages."""
        h = after.t - before.t
        half = self.step(system, linear, before, 0.5 * h, self.rtol * system.length).state
        if half is None or h < 1e-9 * max(abs(after.t), h):
            raise ArithmeticError(f"no interpolation between {before.t:.9g} and {after.t:.9g} s: the step does not converge a second time")
        early = times <= half.t
        q, v = np.empty((times.size, system.n)), np.empty((times.size, system.n))
        for part, (a, b) in ((early, (before, half)), (~early, (half, after))):
            if part.any():
                q[part], v[part] = self.inside(system, linear, a, b, times[part])
        return q, v

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        """A step over which accelerations move things by a modest part of the length."""
        speed = float(np.max(np.abs(state.v) * system.levers, initial=0.0))
        pull = float(np.max(np.abs(acceleration) * system.levers, initial=0.0))
        reach = system.length * (tolerance / system.length) ** (1.0 / (self.table.stages + 1.0))
        steps = [span, *([reach / speed] if speed > 0.0 else []), *([np.sqrt(2.0 * reach / pull)] if pull > 0.0 else [])]
        return 0.1 * min(steps)
