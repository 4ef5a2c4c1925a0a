"""Generalized-alpha with fixed steps on the constrained equations; a step that Newton's iteration cannot take is divided.

An algorithmic acceleration a, which belongs to the time t + (alpha_m - alpha_f) h, carries the step beside the true one:
    q1 = q0 + h v0 + h^2 (1/2 - beta) a0 + h^2 beta a1,        v1 = v0 + h (1 - gamma) a0 + h gamma a1
    (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) dv1/dt + alpha_f dv0/dt
    M dv1/dt + B1' sigma1 + G1' lambda1 = load(q1, t1),        sigma1 = C strain(q1) + eta d(strain)/dt,        gamma(q1) = c(t1)
That is index 3. Index 2, stabilised after Gear, Gupta and Leimkuhler: also G1 v1 = c'(t1), with G1' mu in the first equation, times M.
In the unknowns q1 and v1, with u(q1) for the velocity that the first line gives where mu = 0,
    r1 = M (u - v1) - G1' mu         u      = v_free + z (q1 - q_free),     z = gamma / (beta h)
    r2 = M dv1/dt + ... - load       dv1/dt = w_free + y (v1 - v_free),     y = (1 - alpha_m) / ((1 - alpha_f) gamma h)
is what ``stages.py`` solves, for one stage and with y z in place of z^2, and it is solved alike: stresses iterate beside the
coordinates, velocity-dependent forces are taken at u (z D is then exact under heavy damping), multipliers are scaled by y z.

Chung and Hulbert (1993), J. Appl. Mech. 60; Arnold and Bruels (2007), Multibody Syst. Dyn. 18; stabilised: with Cardona (2015), Numer. Math. 129.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from .formats import Singular
from .linear import Linear
from .protocol import Attempt, State
from .stages import Correction, Stages
from .start import Inconsistent, accelerations, hermite, mass_factor, project_positions, project_samples, project_velocities, refuse_slips
from .system import Array, System, targets

NEWTON = 1e-11  # Newton's error as a share of the system's length: far below what steps of second order can resolve
SLOW, ITERATIONS, HALVINGS = 0.1, 15, 8  # a slower contraction renews the derivatives; a step has at most 2^HALVINGS parts


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Generalized-alpha, second order, with fixed steps.

    step     [s]; a step that does not converge is taken in 2, 4, ... parts
    rho_inf  what a step leaves of infinitely fast vibrations: 0 removes them at once, 1 keeps them, and may let large steps blow up
    index    2: positions and velocities satisfy the joints;  3: only positions do, for one matrix less in each step
    """

    step: float
    rho_inf: float = field(default=0.8, kw_only=True)
    index: int = field(default=2, kw_only=True)

    def __post_init__(self) -> None:
        if not (isinstance(self.step, Real) and 0.0 < self.step < np.inf):
            raise ValueError(f"GeneralizedAlpha(step={self.step!r}): expected a positive number of seconds")
        if not (isinstance(self.rho_inf, Real) and 0.0 <= self.rho_inf <= 1.0):
            raise ValueError(f"GeneralizedAlpha(rho_inf={self.rho_inf!r}): expected a number from 0 to 1")
        if self.index not in (2, 3):
            raise ValueError(f"GeneralizedAlpha(index={self.index!r}): expected 2 or 3")

    def integrator(self, rtol: float) -> ChungHulbert:
        """The method; its steps are the user's, whatever the tolerance."""
        return ChungHulbert(float(self.step), float(self.rho_inf), int(self.index))


class Memory(NamedTuple):
    """What a step of length h leaves: algorithmic and true acceleration [n] at its end, and the states inside if it was divided."""

    h: float
    algorithmic: Array
    acceleration: Array
    inner: tuple[State, ...] = ()


class ChungHulbert:
    """The method. ``fixed`` is its step."""

    order = 2

    def __init__(self, step: float, rho_inf: float, index: int):
        self.fixed, self.index = step, index
        self.name = f"generalized-alpha, index {index}, rho_inf {rho_inf:g} (order 2)"
        self.alpha_m, self.alpha_f = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
        self.gamma = 0.5 + self.alpha_f - self.alpha_m
        self.beta = 0.25 * (self.gamma + 0.5) ** 2
        self.leading = abs(self.beta + 0.5 * (self.alpha_m - self.alpha_f) - 1.0 / 6.0)  # by h^2 and the change of q'': the error of q

    def kept(self, memory: Memory) -> Memory | None:
        return memory if memory.inner else None

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        refuse_slips(system, self.name)
        return self.fixed

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h, whatever the tolerance; in parts where it must be, so that the next one starts on the user's grid."""
        attempt = self._divided(system, linear, state, h, HALVINGS)
        return attempt._replace(error=attempt.error / tolerance)

    def _divided(self, system: System, linear: Linear, state: State, h: float, halvings: int) -> Attempt:
        whole = self._whole(system, linear, state, h)
        if whole.state is not None or halvings == 0:
            return whole
        first = self._divided(system, linear, state, 0.5 * h, halvings - 1)
        second = first if first.state is None else self._divided(system, linear, first.state, 0.5 * h, halvings - 1)
        solves = whole.solves + first.solves + (second.solves if second is not first else 0)
        if first.state is None or second.state is None:
            return second._replace(solves=solves)
        inner = (*first.state.memory.inner, first.state._replace(memory=None), *second.state.memory.inner)
        after = second.state._replace(t=state.t + h, memory=second.state.memory._replace(inner=inner))
        assert first.nodes and second.nodes and first.multipliers is not None and second.multipliers is not None
        t, q, v, weights = (np.concatenate(pair) for pair in zip(first.nodes, second.nodes))
        multipliers = np.concatenate((first.multipliers, second.multipliers))
        error, rate = first.error + second.error, max(first.rate, second.rate)
        return Attempt(after, error, 2.0, rate, solves, nodes=(t, q, v, weights), multipliers=multipliers)

    def _whole(self, system: System, linear: Linear, state: State, h: float) -> Attempt:
        try:
            equations = Equations(self, system, linear, state, h, *self._accelerations(system, linear, state, h))
            found = self._iterate(equations)
            if isinstance(found, Attempt):
                return found
            x, at, rate, solves = found
            q = project_positions(system, linear, state.q + x.dq, equations.goal.value, factor=at.mass_factor or at.factor, sweeps=8)
            v = x.v if at.mass_factor is None else project_velocities(system, at.mass_factor, q, x.v, equations.goal.rate)
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 1.0, 0, f"singular equations ({trouble})")
        memory = Memory(h, (v - equations.v_free) / (self.gamma * h), equations.acceleration(v))
        after = State(state.t + h, q, v, x.multipliers, x.stress, memory)
        change = float(np.max(np.abs(memory.acceleration - equations.true) * system.levers))
        error = h * h * self.leading * change
        nodes = (np.array([state.t, after.t]), np.stack((state.q, q)), np.stack((state.v, v)), np.full(2, 0.5 * h))
        return Attempt(after, error, 2.0, rate, solves, nodes=nodes, multipliers=np.stack((state.multipliers, x.multipliers)))

    def _accelerations(self, system: System, linear: Linear, state: State, h: float) -> tuple[Array, Array]:
        """Algorithmic and true, at the start of a step of length h: the time that the first one belongs to moves with h."""
        if state.memory is None:
            factor = mass_factor(system, linear, state.q)
            true, _ = accelerations(system, factor, state.q, state.v, system.inputs(state.t))
            return true, true
        last: Memory = state.memory
        return last.acceleration + h / last.h * (last.algorithmic - last.acceleration), last.acceleration

    def _iterate(self, equations: Equations) -> Attempt | tuple[Stages, Tangents, float, int]:
        """Simplified Newton; renews its derivatives whenever it contracts slowly."""
        x = equations.guess
        at, last, slowest = Tangents(equations, x), np.inf, 0.0
        goal = NEWTON * equations.system.length
        for k in range(1, ITERATIONS + 1):
            change = equations.correct(x, at)
            x, size, g = change.x, change.size, change.residual
            if not np.isfinite(size):
                break
            rate, last = size / last if last else np.inf, size
            slowest = max(slowest, rate)
            settled = size <= 1e-2 * goal or (0.0 < rate < 1.0 and rate / (1.0 - rate) * size <= goal)
            if settled and at.unseen(change.strains, change.stress_change) <= goal:
                return x, at, slowest, k
            if rate > SLOW:
                at, last = Tangents(equations, x), np.inf
        worst = int(np.argmax(np.abs(g) * equations.linear.reach)) if g.size and np.isfinite(g).all() else -1
        return Attempt(None, np.inf, 1.0, 1.0, k, f"Newton's iteration does not converge within {k} steps", worst)

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step, from the cubic through positions and velocities at its ends."""
        states = [before, *(after.memory.inner if after.memory else ()), after]
        part = np.clip(np.searchsorted([state.t for state in states], times), 1, len(states) - 1)
        q, v = np.empty((times.size, system.n)), np.empty((times.size, system.n))
        for k in np.unique(part):
            here, first, last = part == k, states[k - 1], states[k]
            q[here], v[here] = hermite(first, last, (times[here] - first.t) / (last.t - first.t))
        return (q, v) if system.joints.linear else project_samples(system, linear, q, v, targets(system.inputs(times)))


class Tangents:
    """Derivatives at an iterate, factorised. Raises Singular."""

    def __init__(self, equations: Equations, x: Stages):
        system, linear = equations.system, equations.linear
        q, self.v = equations.q0 + x.dq, equations.velocity(x.dq)
        self.joints = system.joints.at(q)
        self.strains = system.strains(q) if system.n_stresses else None
        stiffness = system.stiffness(q, self.v, equations.inputs, x.stress, x.multipliers)
        damping = system.damping(q, self.v, equations.inputs) if system.damped else None
        tangent = linear.tangent(self.joints.gradient, stiffness, damping)
        self.factor = linear.factor(tangent, equations.y * equations.z, equations.z, 1.0)
        self.mass_factor = linear.factor(tangent) if equations.stabilised else None
        self._system = system

    def unseen(self, strains: Any, change: Array | None) -> float:
        """As of ``stages.Derivatives``, for one state: what a change of stresses will move by slopes that this correction did not have."""
        system = self._system
        if change is None:
            return 0.0
        assert self.strains is not None
        dq, _ = self.factor.solve(self.strains.pull(change) - strains.pull(change), np.zeros(system.m))
        return float(np.max(np.abs(dq) * system.levers))


class Equations:
    """The residuals of a step and one Newton correction, as in the module's header; ``a`` and ``true`` are the accelerations at its start."""

    def __init__(self, method: ChungHulbert, system: System, linear: Linear, state: State, h: float, a: Array, true: Array):
        alpha_m, alpha_f, gamma, beta = method.alpha_m, method.alpha_f, method.gamma, method.beta
        self.system, self.linear, self.h, self.q0, self.inputs = system, linear, h, state.q, system.inputs(state.t + h)
        self.goal = targets(self.inputs)
        self.stabilised = method.index == 2 and not system.joints.linear
        self.z, self.y = gamma / (beta * h), (1.0 - alpha_m) / ((1.0 - alpha_f) * gamma * h)
        self.dq_free = h * state.v + (0.5 - beta) * h * h * a
        self.v_free = state.v + (1.0 - gamma) * h * a
        self.true = true
        self.w_free = (alpha_m * a - alpha_f * true) / (1.0 - alpha_f)
        dq = h * (state.v + 0.5 * h * a)
        self.guess = Stages(dq, self.velocity(dq), state.multipliers, np.zeros(system.m), state.stress)

    def velocity(self, dq: Array) -> Array:
        return self.v_free + self.z * (dq - self.dq_free)

    def acceleration(self, v: Array) -> Array:
        return self.w_free + self.y * (v - self.v_free)

    def correct(self, x: Stages, at: Tangents) -> Correction:
        """One step of Newton's iteration."""
        strains, system, q, u = None, self.system, self.q0 + x.dq, self.velocity(x.dq)
        v = x.v if at.mass_factor else u
        joints, stress, drift = system.joints.at(q), x.stress, x.drift
        r2 = system.mass(self.acceleration(v)) - system.load(q, u, self.inputs) + (joints.pull(x.multipliers) if system.m else 0.0)
        g = joints.value - self.goal.value
        if at.strains is not None:
            strains = system.strains(q)
            r5 = system.stress(strains, u) - stress
            r2 = r2 + strains.pull(stress) + at.strains.pull(r5)
        if at.mass_factor is None:
            dq, d_multipliers = at.factor.solve(-r2, -g)
            dv = self.z * dq
        else:
            r1 = system.mass(u - v) - joints.pull(drift)
            dq, d_multipliers = at.factor.solve(-r2 - self.y * r1, -g)
            turning = system.joints.to_rows(at.joints.swirl(at.v) * dq[system.joints.cols])
            dv, d_drift = at.mass_factor.solve(self.z * system.mass(dq) + r1, self.goal.rate - joints.push(v) - turning)
            d_multipliers, drift = d_multipliers + self.y * d_drift, drift + d_drift
        if at.strains is not None:
            stress = stress + r5 + system.modulus * at.strains.push(dq)
            if system.viscosity is not None:
                stress = stress + system.viscosity * (self.z * at.strains.push(dq) + at.strains.swirl_times(at.v, dq))
        size = float(np.max(np.maximum(np.abs(dq), self.h * np.abs(dv)) * system.levers))
        after = Stages(x.dq + dq, v + dv, x.multipliers + d_multipliers, drift, stress)
        seen = (strains, stress - x.stress) if system.onsets else (None, None)
        return Correction(after, size, g, *seen)
