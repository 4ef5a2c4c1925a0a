"""Radau IIA with error control: predicts the stages, iterates them, estimates the error, projects the end.

The stage equations are in ``stages.py``, their iteration in ``newton.py``, the coefficients in ``coefficients.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Real

import numpy as np

from .coefficients import tableau
from .forecast import Memory, forecast
from .formats import Singular
from .linear import Linear
from .newton import Outcome, iterate, middle_of
from .protocol import Attempt, State
from .stages import Derivatives, StageEquations, Stages
from .start import Inconsistent, hermite, mass_factor, project_positions, project_samples, project_velocities
from .system import Array, System, Targets, targets

SHORTEST = 1e-10
"""The first step is not below this share of the run."""

FORGET = 0.8
"""With each step what iterations contracted by counts this much less."""

AT_SINGULAR = 1e-9
"""Below this reciprocal condition of the mass KKT matrix, which is about the square of that of G, the end of a step is not projected."""


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
        stages = self.stages or (3 if rtol > 5e-3 else 5 if rtol > 5e-7 else 7)
        return RadauIIA(stages, self.step, rtol)


class RadauIIA:
    """The s-stage method. ``fixed`` is its step, or None; ``rtol`` serves values inside of steps."""

    def __init__(self, stages: int, fixed: float | None = None, rtol: float = 1e-6):
        self.table, self.fixed, self.rtol = tableau(stages), fixed, rtol
        self.order = self.table.order
        self.name = f"Radau IIA, {stages} stages (order {self.order})"
        self.iterations = 8 + stages

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h; ``tolerance`` is a length: the local error allowed in positions."""
        table, tolerance = self.table, min(tolerance, linear.coarsest)
        guess, middle = forecast(system, state, table.c, h)
        slowest = state.memory.rate if state.memory is not None else 0.0
        inputs = system.inputs(state.t + table.c * h)
        equations = StageEquations(system, table, h, state.q, state.v, inputs)
        try:
            found = iterate(equations, linear, guess, middle, tolerance, system.inputs(state.t + 0.5 * h), self.iterations, slowest)
            if found.failure:
                return self._refused(found, linear)
            x, at = found.x, found.at
            error = self._error(equations, linear, state, x, at, tolerance)
            q, v = state.q + x.dq[-1], x.v[-1].copy()  # not a view: states are kept, and all stages would be with them
            if not system.joints.linear:
                q, v = self._landed(system, linear, q, v, targets(inputs))
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 1.0, 0, f"singular equations ({trouble})")
        memory = Memory(h, state.v, state.stress, x, table.stages, max(found.trend, FORGET * slowest))
        nodes = (state.t + table.c * h, state.q + x.dq, x.v, table.b * h)
        after = State(state.t + h, q, v, x.multipliers[-1].copy(), x.stress[-1].copy(), memory)
        return Attempt(after, error, table.stages + 1.0, found.rate, found.solves, nodes=nodes, multipliers=x.multipliers, inputs=inputs)

    def _landed(self, system: System, linear: Linear, q: Array, v: Array, goal: Targets) -> tuple[Array, Array]:
        """The end of a step projected to the joints to rounding, with their slopes there: near a singular position a small residual is a
        large error. At that position rounding would be what is projected; the last stage meets the equations as far as Newton went."""
        try:
            factor = mass_factor(system, linear, q)
        except Singular:
            return q, v
        if factor.rcond < AT_SINGULAR:
            return q, v
        q = project_positions(system, linear, q, goal.value[-1], factor=factor, sweeps=8)
        return q, project_velocities(system, factor, q, v, goal.rate[-1])

    def _refused(self, found: Outcome, linear: Linear) -> Attempt:
        residual = np.max(np.abs(found.residual), axis=0, initial=0.0) * linear.reach
        worst = int(np.argmax(residual)) if residual.size and np.isfinite(residual).all() else -1
        return Attempt(None, np.inf, 1.0, 1.0, found.solves, found.failure, worst)

    def _error(self, equations: StageEquations, linear: Linear, state: State, x: Stages, at: Derivatives, tolerance: float) -> float:
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
            at_middle, middle = system.inputs(before.t + 0.5 * h), middle_of(equations, guess)
            found = iterate(equations, linear, guess, middle, self.rtol * system.length, at_middle, self.iterations)
        except Singular:
            return None
        return None if found.failure else found.x

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
        """A step over which accelerations move things by a modest part of the length; next to a singular position they may be anything."""
        speed = float(np.max(np.abs(state.v) * system.levers, initial=0.0))
        pull = float(np.max(np.abs(acceleration) * system.levers, initial=0.0))
        reach = system.length * (tolerance / system.length) ** (1.0 / (self.table.stages + 1.0))
        steps = [span, *([reach / speed] if speed > 0.0 else []), *([np.sqrt(2.0 * reach / pull)] if pull > 0.0 else [])]
        return max(0.1 * min(steps), SHORTEST * span)
