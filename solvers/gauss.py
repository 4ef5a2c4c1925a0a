"""Gauss collocation with fixed steps and constraints at Lobatto's points: symplectic and symmetric, order 2 s, for long runs.

Within a step q is a polynomial of degree s. Hamilton's principle holds for it with the action taken by the s points c of Gauss and the
work of the constraints by the s + 1 points d of Lobatto, the ends of the step among them; so the map from step to step is symplectic,
conserves linear and angular momentum exactly, and energy without drift for as long as no step had to be divided:
    V = A^-1 (Q - q0) / h                       at Gauss's points; the same polynomial gives P_0 = q0, P_1, ..., P_s = q1 at Lobatto's
    r2 = M A^-1 (V - v0) / h + B(Q)' S - load(Q, V, t) + T [G(P)' Lambda],      T = A^-1 A~,  b_i A~_ij + b~_j E_ji = b_i b~_j
    r3 = gamma(P_j) - c(t_j), j = 1..s,    r5 = C strain(Q) + eta B V - S                     (unknown: Q, S, Lambda_0..Lambda_(s-1))
    M v1 + h b~_s G(q1)' Lambda_s = M (v0 + b A^-1 (V - v0)) + h (b T - b~) [G(P)' Lambda]_(0..s-1),         G(q1) v1 = c'
as in RATTLE. r3 = 0 fixes the polynomial as equations at the stages would, and T is regular: with derivatives of the middle of the step
Newton's iteration is that of ``stages.py``, for each eigenvalue z of A^-1 / h
    [ z^2 M + z D + K   G' ] [ dQ        ]   [ -r2 - B' r5          ]
    [ G                 0  ] [ T dLambda ] = [ -(E A^-1)^-1 r3      ]      and dS as there
It goes on until its corrections are rounding: their bias would be a drift.

With forces taken at k > s points of Gauss and projected to polynomials of degree s - 1, the work of elastic forces along the step is
the change of their energy but for a quadrature error of order 2 k: energy is conserved to rounding even in motions that a step does
not resolve, and symplecticity is given up. Newton's matrix stays the same: at the stages the projection of K dQ is K dQ. Hairer (2010),
J. Numer. Anal. Ind. Appl. Math. 5 (energy-preserving collocation); Brugnano, Iavernaro and Trigiante (2010), ibid. (HBVM).

Unlike Lobatto's IIIA-IIIB pair it is stable for vibrations
of any frequency; M is used together with G only, and may be semidefinite.

Jay (1996), SIAM J. Numer. Anal. 33, (2007), 45 (Gauss-Lobatto SPARK); Wenger, Ober-Bloebaum and Leyendecker (2017), Adv. Comput. Math. 43
(the same from the variational side); Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, VII.1 and VIII.5, VIII.6.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import NamedTuple

import numpy as np

from .coefficients import GaussLobatto, gauss_lobatto, lagrange
from .formats import Singular
from .linear import Linear
from .protocol import Attempt, State
from .stages import Correction, Linearised, Middle
from .start import Inconsistent, hermite, project_samples, project_velocities, refuse_slips
from .system import Array, System, targets

ROUNDING, NOISE = 2e-16, 1e-13  # Newton's goal, and changes that may be noise of the residuals, as shares of the system's length
SLOW, ITERATIONS, EARLY = 0.3, 30, 0.02  # a slower contraction renews the derivatives; see ``inside``


@dataclass(frozen=True)
class Gauss:
    """Gauss's collocation, symplectic and symmetric, order 2 stages: fixed steps, for long runs of conservative scenes.

    step     [s]; a step that does not converge is divided, which ends conservation there: ``result.stats["failed"]`` counts it
    stages   2, 3, 4 or 5
    samples  points at which forces are taken. None: one for each stage, symplectic; more, up to 20: not symplectic, but energy is conserved
             to the quadrature error of so many points even where steps do not resolve all vibrations
    """

    step: float
    stages: int = field(default=2, kw_only=True)
    samples: int | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if not (isinstance(self.step, Real) and 0.0 < self.step < np.inf):
            raise ValueError(f"Gauss(step={self.step!r}): expected a positive number of seconds")
        if not (isinstance(self.stages, Integral) and 2 <= self.stages <= 5):
            raise ValueError(f"Gauss(stages={self.stages!r}): expected 2, 3, 4 or 5")
        if self.samples is not None and not (isinstance(self.samples, Integral) and self.stages <= self.samples <= 20):
            raise ValueError(f"Gauss(samples={self.samples!r}): expected None, or a number from that of the stages, {self.stages}, to 20")

    def integrator(self, rtol: float) -> GaussCollocation:
        """The method; its steps are the user's, whatever the tolerance."""
        return GaussCollocation(int(self.stages), int(self.samples or self.stages), float(self.step))


class Unknowns(NamedTuple):
    """dq = Q - q0 [s, n]; multipliers [s + 1, m] at Lobatto's points, the last of them zero within a step; stress [k, n_stresses]
    at the samples."""

    dq: Array
    multipliers: Array
    stress: Array


class Memory(NamedTuple):
    """What a step of length h leaves to predict the next: velocities at 0, c, 1 of the step, multipliers at d and their change since
    the same points of the step before, stresses at the samples."""

    h: float
    v: Array
    multipliers: Array
    trend: Array
    stress: Array


class GaussCollocation:
    """The s-stage method. ``fixed`` is its step."""

    def __init__(self, stages: int, samples: int, step: float):
        self.fixed, self.table = step, gauss_lobatto(stages, samples)
        self.order = self.table.order
        kept = "symplectic" if samples == stages else f"energy-preserving, {samples} samples"
        self.name = f"Gauss collocation, {stages} stages ({kept}, order {2 * stages})"
        c = self.table.c
        self._at_stages = lagrange(self.table.d, self.table.c)
        nodes, self._powers = np.concatenate(([0.0], c, [1.0])), np.arange(stages + 2)
        self._v_fit = np.linalg.inv((nodes[:, None] - 1.0) ** self._powers)
        self._stress_fit = np.linalg.pinv((self.table.samples[:, None] - 1.0) ** self._powers[:stages])

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are the ends of shorter ones."""

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        refuse_slips(system, self.name)
        return self.fixed

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h, converged to rounding whatever the tolerance."""
        table, equations = self.table, Equations(system, linear, self.table, h, state)
        try:
            found = _iterate(equations, *self._predict(system, state, h))
            if isinstance(found, Attempt):
                return found
            x, rate, solves = found
            q, v, last = equations.end(x)
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 1.0, 0, f"singular equations ({trouble})")
        inner = equations.velocity(x.dq)
        multipliers = np.concatenate((x.multipliers[:-1], last[None]))
        trend = multipliers - state.memory.multipliers if state.memory else np.zeros_like(multipliers)
        memory = Memory(h, np.concatenate((state.v[None], inner, v[None])), multipliers, trend, x.stress)
        after = State(state.t + h, q, v, table.weights @ multipliers, self._stress_fit[0] @ x.stress, memory)
        nodes = (state.t + table.c * h, state.q + x.dq, inner, table.b * h)
        return Attempt(after, 0.0, table.order, rate, solves, nodes=nodes, multipliers=self._at_stages @ multipliers)

    def _predict(self, system: System, state: State, h: float) -> tuple[Unknowns, Middle]:
        """By the polynomial through the velocities of the last step; from a start, by constant velocity."""
        c, s, memory = self.table.c, self.table.stages, state.memory
        if memory is None:
            stress, multipliers = np.tile(state.stress, (self.table.samples.size, 1)), np.tile(state.multipliers, (s + 1, 1))
            dq = np.outer(np.append(c, 0.5), h * state.v)
        else:
            x = np.append(c, 0.5)[:, None] * (h / memory.h)
            dq = memory.h * (x ** (self._powers + 1) / (self._powers + 1) @ self._v_fit @ memory.v)
            ahead = self.table.samples[:, None] * (h / memory.h)
            stress = ahead ** self._powers[:s] @ self._stress_fit @ memory.stress
            multipliers = memory.multipliers + h / memory.h * memory.trend
        multipliers[-1] = 0.0
        middle = Middle(state.q + dq[-1], state.v, state.multipliers, self.table.sample_weights @ stress)
        return Unknowns(dq[:-1], multipliers, stress), middle

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the ends of steps of their own from its start, on the joints and as accurate as the step.
        Rounding in velocities grows as such steps shrink: very early values are those of a cubic over the first 2 % instead."""
        h = np.maximum(times - before.t, EARLY * (after.t - before.t))
        q, v = np.empty((2, times.size, system.n))
        for k in range(times.size):
            end = self.step(system, linear, before, float(h[k]), 0.0).state
            if end is None:
                raise ArithmeticError(f"no interpolation at {times[k]:.9g} s: the step does not converge a second time")
            q[k], v[k] = end.q, end.v
            if times[k] < end.t:
                cubic = hermite(before, end, (times[k : k + 1] - before.t) / h[k])
                q[k], v[k] = np.concatenate(project_samples(system, linear, *cubic, targets(system.inputs(times[k : k + 1]))))
        return q, v


def _iterate(equations: Equations, x: Unknowns, middle: Middle) -> Attempt | tuple[Unknowns, float, int]:
    """Simplified Newton down to rounding; renews its derivatives whenever it contracts slowly."""
    at = equations.derivatives(middle)
    last, slowest = np.inf, 0.0
    length = equations.system.length + float(np.max(np.abs(equations.q0) * equations.system.levers))
    for k in range(1, ITERATIONS + 1):
        change = equations.correct(x, at)
        x, size, g = change.x, change.size, change.residual
        if not np.isfinite(size):
            break
        rate, last = size / last if last else np.inf, size
        slowest = max(slowest, rate if size > NOISE * length else 0.0)
        settled = 0.0 < rate < 1.0 and rate / (1.0 - rate) * size <= ROUNDING * length
        settled = settled or size <= ROUNDING * length or (k > 2 and rate > SLOW and size <= NOISE * length)
        if settled and at.unseen(change.strains, change.stress_change) <= NOISE * length:
            return x, slowest, k
        if k > 2 and rate > SLOW:
            at, last = equations.derivatives(equations.middle(x)), np.inf
    worst = int(np.argmax(np.max(np.abs(g), axis=0) * equations.linear.reach)) if g.size and np.isfinite(g).all() else -1
    return Attempt(None, np.inf, 1.0, 1.0, k, f"Newton's iteration does not converge within {k} steps", worst)


class Equations:
    """The residuals of a step from a state, one Newton correction, and the step's end, as in the module's header."""

    def __init__(self, system: System, linear: Linear, table: GaussLobatto, h: float, state: State):
        self.system, self.linear, self.table, self.h, self.q0, self.v0 = system, linear, table, h, state.q, state.v
        self.inputs, self.middle_inputs = system.inputs(state.t + table.samples * h), system.inputs(state.t + 0.5 * h)
        self.goal = targets(system.inputs(state.t + table.d[1:] * h))

    def derivatives(self, middle: Middle) -> Linearised:
        return Linearised(self.system, self.linear, self.table, self.h, middle, self.middle_inputs)

    def velocity(self, dq: Array) -> Array:
        return self.table.inverse @ dq / self.h

    def points(self, dq: Array) -> Array:
        """P [s + 1, n]."""
        return np.concatenate((self.q0[None], self.q0 + self.table.ends @ dq))

    def middle(self, x: Unknowns) -> Middle:
        b = self.table.b
        return Middle(self.q0 + b @ x.dq, b @ self.velocity(x.dq), b @ self.table.pull @ x.multipliers, self.table.sample_weights @ x.stress)

    def correct(self, x: Unknowns, at: Linearised) -> Correction:
        """One step of Newton's iteration."""
        strains, system, table, v = None, self.system, self.table, self.velocity(x.dq)
        q, rate = self.q0 + table.spread @ x.dq, table.slope @ v
        joints, stress = system.joints.at(self.points(x.dq)), x.stress
        r2 = system.mass(self.velocity(v - self.v0)) - table.gather @ np.broadcast_to(system.load(q, rate, self.inputs), q.shape)
        if system.n_stresses:
            strains = system.strains(q)
            r5 = system.stress(strains, rate) - stress
            r2 = r2 + table.gather @ (strains.pull(stress) + at.pull(r5))
        if system.m:
            r2 = r2 + table.pull @ joints.pull(x.multipliers)
        g = joints.value[1:] - self.goal.value
        dq, y = at.solve(-r2, -table.ends_inverse @ g)
        multipliers = x.multipliers.copy()
        multipliers[:-1] += table.pull_inverse @ y
        if system.n_stresses:
            stress = stress + r5 + at.stress_change(table.spread @ dq, table.slope @ self.velocity(dq))
        size = float(np.max(np.abs(dq) * system.levers))
        seen = (strains, stress - x.stress) if system.onsets else (None, None)
        return Correction(Unknowns(x.dq + dq, multipliers, stress), size, g, *seen)

    def end(self, x: Unknowns) -> tuple[Array, Array, Array]:
        """q1, v1 [n] and the last multipliers [m]."""
        system, table, h = self.system, self.table, self.h
        points = self.points(x.dq)
        v = self.v0 + table.last @ (self.velocity(x.dq) - self.v0)
        if system.joints.linear:  # what the constraints lack is made up by the last multipliers alone
            return points[-1], v, table.kick[:-1] @ x.multipliers[:-1] / table.weights[-1]
        joints, goal = system.joints.at(points), self.goal.rate[-1]
        factor = self.linear.factor(self.linear.tangent(joints.gradient[-1]))
        slip = joints.push(np.broadcast_to(v, points.shape))[-1]
        dv, y = factor.solve(h * (table.kick @ joints.pull(x.multipliers)), goal - slip)
        return points[-1], project_velocities(system, factor, points[-1], v + dv, goal), y / (h * table.weights[-1])
