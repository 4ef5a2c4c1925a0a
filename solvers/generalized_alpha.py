"""Generalized-alpha with fixed steps on the constrained equations; a step that Newton's iteration cannot take is divided.

An algorithmic acceleration a, which belongs to the time t + (alpha_m - alpha_f) h, carries the step beside the true one:
    q1 = q0 + h v0 + h^2 (1/2 - beta) a0 + h^2 beta a1,        v1 = v0 + h (1 - gamma) a0 + h gamma a1
    (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) dv1/dt + alpha_f dv0/dt
    M dv1/dt + B1' sigma1 + G1' lambda1 = load(q1, t1),        sigma1 = C strain(q1) + eta d(strain)/dt
index 3: g(q1) = 0;   index 2 (stabilised after Gear, Gupta and Leimkuhler): also G1 v1 = 0, and the first equation, times M, with G1' mu.
Written in terms of q1 and v1, with u(q1) the velocity that the first line gives for mu = 0,
    r1 = M (u - v1) - G1' mu         u     = v_free + z (q1 - q_free),     z = gamma / (beta h)
    r2 = M dv1/dt + ...              dv1/dt = w_free + y (v1 - v_free),    y = (1 - alpha_m) / ((1 - alpha_f) gamma h)
is what ``stages.py`` solves for one stage, with y z in place of z^2, and it is solved in the same way: stresses iterate beside the
coordinates, velocity-dependent forces are taken at u so that z D is exact under heavy damping, multipliers are scaled by y z.

Second order; high frequencies are damped to rho_inf in each step. Chung and Hulbert (1993), J. Appl. Mech. 60; Arnold and Bruels (2007),
Multibody Syst. Dyn. 18; Arnold, Bruels and Cardona (2015), Numer. Math. 129 (the stabilised form; the start of a).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .formats import Singular
from .linear import Linear
from .protocol import Attempt, State
from .start import Inconsistent, accelerations, mass_factor, project_positions, project_velocities
from .system import Array, System

NEWTON = 1e-10
"""Newton stops where its error is below this share of the system's length: far below what steps of second order can resolve."""

SLOW, ITERATIONS, HALVINGS = 0.3, 15, 8
"""A contraction slower than SLOW renews the derivatives; a step is divided into at most 2^HALVINGS parts."""


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Generalized-alpha, second order, with fixed steps.

    step     [s]; a step that does not converge is taken in 2, 4, ... parts
    rho_inf  what a step leaves of infinitely high frequencies: 1 keeps them (and their noise), 0 removes them at once
    index    2: positions and velocities satisfy the joints; 3: only positions do, at half the cost in linear algebra
    """

    step: float
    rho_inf: float = field(default=0.8, kw_only=True)
    index: int = field(default=2, kw_only=True)

    def __post_init__(self) -> None:
        if not (_is_number(self.step) and self.step > 0.0):
            raise ValueError(f"GeneralizedAlpha(step={self.step!r}): expected a positive number of seconds")
        if not (_is_number(self.rho_inf) and 0.0 <= self.rho_inf <= 1.0):
            raise ValueError(f"GeneralizedAlpha(rho_inf={self.rho_inf!r}): expected a number from 0 to 1")
        if self.index not in (2, 3):
            raise ValueError(f"GeneralizedAlpha(index={self.index!r}): expected 2 or 3")

    def integrator(self, rtol: float) -> ChungHulbert:
        """The method; its steps are the user's, whatever the tolerance."""
        return ChungHulbert(float(self.step), float(self.rho_inf), self.index)


def _is_number(x: Any) -> bool:
    return isinstance(x, (int, float, np.number)) and not isinstance(x, bool) and bool(np.isfinite(x))


class Memory(NamedTuple):
    """What a step of length h leaves: its algorithmic and true accelerations [n]; ``inner``: the states within, where it was divided."""

    h: float
    algorithmic: Array
    acceleration: Array
    inner: tuple[State, ...] = ()


class Unknowns(NamedTuple):
    """The end of a step: dq = q1 - q0, v [n]; multipliers, drift (the mu) [m]; stress [n_stresses]."""

    dq: Array
    v: Array
    multipliers: Array
    drift: Array
    stress: Array


class ChungHulbert:
    """The method. ``fixed`` is its step."""

    def __init__(self, step: float, rho_inf: float, index: int):
        self.fixed, self.index = step, index
        self.name = f"generalized-alpha, index {index}, rho_inf {rho_inf:g} (order 2)"
        self.alpha_m, self.alpha_f = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
        self.gamma = 0.5 + self.alpha_f - self.alpha_m
        self.beta = 0.25 * (self.gamma + 0.5) ** 2

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h, in parts where it must be; ``tolerance`` is not used."""
        return self._divided(system, linear, state, h, HALVINGS)

    def _divided(self, system: System, linear: Linear, state: State, h: float, halvings: int) -> Attempt:
        whole = self._whole(system, linear, state, h)
        if whole.state is not None or halvings == 0:
            return whole
        first = self._divided(system, linear, state, 0.5 * h, halvings - 1)
        if first.state is None:
            return first._replace(solves=whole.solves + first.solves)
        second = self._divided(system, linear, first.state, 0.5 * h, halvings - 1)
        solves = whole.solves + first.solves + second.solves
        if second.state is None:
            return second._replace(solves=solves)
        assert first.nodes and second.nodes
        inner = (*first.state.memory.inner, first.state, *second.state.memory.inner)
        after = second.state._replace(t=state.t + h, memory=second.state.memory._replace(inner=inner))
        t, q, v, weights = (np.concatenate(pair) for pair in zip(first.nodes, second.nodes))
        return Attempt(after, 0.0, 2.0, max(first.rate, second.rate), solves, nodes=(t, q, v, weights))

    def _whole(self, system: System, linear: Linear, state: State, h: float) -> Attempt:
        try:
            memory = self._remembered(system, linear, state, h)
            equations = Equations(self, system, linear, state, h, memory)
            found = self._iterate(equations)
            if isinstance(found, Attempt):
                return found
            x, at, rate, solves = found
            q, v = state.q + x.dq, x.v
            if not system.joints.linear:
                q = project_positions(system, linear, q, factor=at.mass_factor or at.factor, sweeps=8)
            if at.mass_factor is not None:
                v = project_velocities(system, at.mass_factor, q, v)
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 1.0, 0, f"singular equations ({trouble})")
        kept = Memory(h, (v - equations.v_free) / (self.gamma * h), equations.acceleration(v))
        after = State(state.t + h, q, v, x.multipliers, x.stress, kept)
        nodes = (np.array([state.t, after.t]), np.stack((state.q, q)), np.stack((state.v, v)), np.full(2, 0.5 * h))
        return Attempt(after, 0.0, 2.0, rate, solves, nodes=nodes)

    def _remembered(self, system: System, linear: Linear, state: State, h: float) -> Memory:
        """Accelerations at the start of a step; a moves with the length of the step, as the time that it belongs to."""
        if state.memory is None:
            factor = mass_factor(system, linear, state.q)
            acceleration, _ = accelerations(system, factor, state.q, state.v, system.inputs(state.t))
            return Memory(h, acceleration, acceleration)
        last: Memory = state.memory
        return Memory(h, last.acceleration + h / last.h * (last.algorithmic - last.acceleration), last.acceleration)

    def _iterate(self, equations: Equations) -> Attempt | tuple[Unknowns, Tangents, float, int]:
        """Simplified Newton; renews its derivatives whenever it contracts slowly."""
        x = equations.guess()
        at = Tangents(equations, x)
        goal = NEWTON * equations.system.length
        last, worst_rate = np.inf, 0.0
        for k in range(1, ITERATIONS + 1):
            x, size, g = equations.correct(x, at)
            if not np.isfinite(size):
                return _failed("Newton's iteration overflowed", k, equations.linear, g)
            rate = size / last
            if size <= 1e-2 * goal or (rate < 1.0 and rate / (1.0 - rate) * size <= goal and k > 1):
                return x, at, worst_rate, k
            worst_rate, last = max(worst_rate, rate), size
            if rate > SLOW:
                at, last = Tangents(equations, x), np.inf
        return _failed(f"Newton's iteration needs more than {ITERATIONS} steps", ITERATIONS, equations.linear, g)

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the cubic through positions and velocities at its ends, projected to the joints."""
        states = [before, *(after.memory.inner if after.memory else ()), after]
        t, ends, speeds = (np.array([getattr(state, name) for state in states]) for name in "tqv")
        k = np.clip(np.searchsorted(t, times, side="left"), 1, t.size - 1)
        h = (t[k] - t[k - 1])[:, None]
        x = (times - t[k - 1])[:, None] / h
        chord = (ends[k] - ends[k - 1]) / h
        first, last = speeds[k - 1] - chord, speeds[k] - chord
        q = ends[k - 1] + h * x * (chord + (1.0 - x) * ((1.0 - x) * first - x * last))
        v = chord + (1.0 - x) * (1.0 - 3.0 * x) * first - x * (2.0 - 3.0 * x) * last
        if system.joints.linear:
            return q, v
        for i in range(times.size):
            q[i] = project_positions(system, linear, q[i])
            v[i] = project_velocities(system, mass_factor(system, linear, q[i]), q[i], v[i])
        return q, v

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        return self.fixed


def _failed(what: str, solves: int, linear: Linear, g: Array) -> Attempt:
    residual = np.abs(g) * linear.reach
    worst = int(np.argmax(residual)) if residual.size and np.isfinite(residual).all() else -1
    return Attempt(None, np.inf, 1.0, 1.0, solves, what, worst)


class Tangents:
    """Derivatives at an end of the step, factorised. Raises Singular."""

    def __init__(self, equations: Equations, x: Unknowns):
        system, linear = equations.system, equations.linear
        q, v = equations.q0 + x.dq, equations.velocity(x.dq)
        self.v, self.joints = v, system.joints.at(q)
        self.strains = system.strains(q) if system.n_stresses else None
        stiffness = system.stiffness(q, v, equations.inputs, x.stress, x.multipliers)
        damping = None if system.viscosity is None else system.damping(q)
        tangent = linear.tangent(self.joints.gradient, stiffness, damping)
        self.factor = linear.factor(tangent, equations.y * equations.z, equations.z, 1.0)
        self.mass_factor = linear.factor(tangent) if equations.stabilised else None


class Equations:
    """The residuals of a step and one Newton correction; see the module's equations."""

    def __init__(self, method: ChungHulbert, system: System, linear: Linear, state: State, h: float, memory: Memory):
        alpha_m, alpha_f, gamma, beta = method.alpha_m, method.alpha_f, method.gamma, method.beta
        self.system, self.linear, self.state, self.h = system, linear, state, h
        self.q0, self.inputs = state.q, system.inputs(state.t + h)
        self.stabilised = method.index == 2 and system.m > 0 and not system.joints.linear
        self.start = memory.algorithmic
        self.z, self.y = gamma / (beta * h), (1.0 - alpha_m) / ((1.0 - alpha_f) * gamma * h)
        self.dq_free = h * state.v + (0.5 - beta) * h * h * memory.algorithmic
        self.v_free = state.v + (1.0 - gamma) * h * memory.algorithmic
        self.w_free = (alpha_m * memory.algorithmic - alpha_f * memory.acceleration) / (1.0 - alpha_f)

    def velocity(self, dq: Array) -> Array:
        """u [n]."""
        return self.v_free + self.z * (dq - self.dq_free)

    def acceleration(self, v: Array) -> Array:
        """dv1/dt [n]."""
        return self.w_free + self.y * (v - self.v_free)

    def guess(self) -> Unknowns:
        """The end of the step if accelerations, stresses and multipliers stayed."""
        state, h = self.state, self.h
        dq = h * (state.v + 0.5 * h * self.start)
        return Unknowns(dq, self.velocity(dq), state.multipliers, np.zeros(self.system.m), state.stress)

    def correct(self, x: Unknowns, at: Tangents) -> tuple[Unknowns, float, Array]:
        """The next iterate, the size of its change as a length, and the residual of g [m]."""
        system = self.system
        q, u = self.q0 + x.dq, self.velocity(x.dq)
        joints = system.joints.at(q)
        v = x.v if at.mass_factor else u
        r2 = system.mass(self.acceleration(v)) - system.load(q, self.inputs) + joints.pull(x.multipliers)
        if system.n_stresses:
            strains = system.strains(q)
            r5 = system.stress(strains, u) - x.stress
            r2 = r2 + strains.pull(x.stress) + at.strains.pull(r5)
        g = joints.value
        if at.mass_factor is None:
            dq, d_multipliers = at.factor.solve(-r2, -g)
            dv, drift = self.z * dq, x.drift
        else:
            r1 = system.mass(u - v) - joints.pull(x.drift)
            dq, mixed = at.factor.solve(-r2 - self.y * r1, -g)
            turning = system.joints.to_rows(at.joints.swirl(at.v) * dq[system.joints.cols])
            dv, d_drift = at.mass_factor.solve(self.z * system.mass(dq) + r1, -joints.push(v) - turning)
            d_multipliers, drift = mixed + self.y * d_drift, x.drift + d_drift
        stress = x.stress + r5 + self._stress_change(dq, at) if system.n_stresses else x.stress
        levers = system.levers
        size = max(float(np.max(np.abs(dq) * levers)), self.h * float(np.max(np.abs(dv) * levers)))
        return Unknowns(x.dq + dq, v + dv, x.multipliers + d_multipliers, drift, stress), size, g

    def _stress_change(self, dq: Array, at: Tangents) -> Array:
        """(C B + d(eta B u)/dq) dq + z eta B dq."""
        system, stretch = self.system, at.strains.push(dq)
        change = system.modulus * stretch
        if system.viscosity is None:
            return change
        return change + system.viscosity * (self.z * stretch + at.strains.swirl_times(at.v, dq))
