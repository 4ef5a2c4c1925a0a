"""The equations of one Radau IIA step and their simplified Newton iteration.

GGL-stabilised index 2, with stresses S iterated beside the coordinates; X' = A^-1 (X - x0) / h for stage values X:
    r1 = M (Q' - V) - G' mu                 (where G is constant and nothing driven: mu = 0, V = Q', left out)
    r2 = M V' + B(Q)' S - load(Q, Q', t) + G' Lambda           in r2 + z r1 no V is left but v0
    r3 = gamma(Q) - c(t),   r4 = G V - c'(t)                   with c = 0 but where drives act
                                                               of nonholonomic rows r3 = h A (G Q' - c'), which G dQ changes alike
    r5 = C strain(Q) + eta B Q' - S                            so that one step may turn a stiff beam far
K, D, G, B of the predicted middle of the step serve all stages. The eigenvectors of A^-1 decouple these into one real and
(s - 1)/2 complex systems; for each eigenvalue z of A^-1 / h
    [ z^2 M + z D + K   G' ] [ dQ               ]   [ -r2 - B' r5 - z r1 ]
    [ G                 0  ] [ dLambda - z dMu  ] = [ -r3                ]
then, with the mass matrix,
    [ M   G' ] [ dV  ]   [ M dQ' + r1            ]
    [ G   0  ] [ dMu ] = [ -r4 - d(G v)/dq dQ    ]
and dS = r5 + (C B + d(eta B v)/dq) dQ + eta B dQ'. Velocity-dependent forces are taken at Q', so that z D is exact under heavy damping.
Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8 and VII.4; Gear, Leimkuhler and Gupta (1985).
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from .coefficients import GaussLobatto, Tableau
from .linear import Factor, Linear, Tangent
from .system import Array, System, targets


class Stages(NamedTuple):
    """Unknowns of a step: dq = Q - q0, v [s, n]; multipliers, drift (the GGL mu) [s, m]; stress [s, n_stresses]."""

    dq: Array
    v: Array
    multipliers: Array
    drift: Array
    stress: Array


class Correction(NamedTuple):
    """What one correction leads to: the next iterate, the size of its change as a length, the residual of g [s, m] before it; what
    stresses were computed with, which is kept only where strains set in: strains before it, change of the stresses; and, of Radau, the residual
    of the balance [s, n] before it."""

    x: Any
    size: float
    residual: Array
    strains: Any
    stress_change: Array | None
    force: Array | None = None


class Middle(NamedTuple):
    """The configuration whose derivatives serve the whole step."""

    q: Array
    v: Array
    multipliers: Array
    stress: Array


class Derivatives:
    """Derivatives at the middle of a step; those of the joints are its own where a subclass takes no others."""

    joints: Any
    v: Array
    real_factor: Factor
    mass_factor: Any
    end_factor: Factor | None

    def __init__(self, system: System, middle: Middle, inputs: Any):
        self.system = system
        strains = system.strains(middle.q) if system.n_stresses else None
        self.joints = joints = system.joints.at(middle.q)
        self.stiffness = system.stiffness(middle.q, middle.v, inputs, middle.stress, middle.multipliers, strains=strains, joints=joints)
        self.strains = strains if strains is None or system.viscosity is not None else strains.frozen()
        self.damping = system.damping(middle.q, middle.v, inputs) if system.damped else None

    def solve(self, top: Array, bottom: Array) -> tuple[Array, Array]:
        """The stage system: right sides [s, n] and [s, m]."""
        raise NotImplementedError

    def pull(self, stress: Array) -> Array:
        return self.strains.pull(stress) if self.strains is not None else np.zeros((len(stress), self.system.n))

    def stress_change(self, dq: Array, rate: Array) -> Array:
        """(C B + d(eta B v)/dq) dq + eta B rate."""
        system = self.system
        assert self.strains is not None
        change = system.modulus * self.strains.push(dq)
        if system.viscosity is not None:
            change = change + system.viscosity * (self.strains.push(rate) + self.strains.swirl_times(self.v, dq))
        return change

    def unseen(self, strains: Any, change: Array | None) -> float:
        """What a change of stresses [s, n_stresses] will move by the slopes of each stage, and has not by those of the middle, as a length:
        where a strain sets in within the step, the middle has no slope, and the first correction of positions is zero whatever the stress."""
        if change is None:
            return 0.0
        gap = self.gathered(self.pull(change) - strains.pull(change))
        dq, _ = self.solve(gap, np.zeros((len(gap), self.system.m)))
        return float(np.max(np.abs(dq) * self.system.levers))

    def gathered(self, force: Array) -> Array:
        """Forces [s, n] at the stages from those where stresses are taken: the same points, unless a method says otherwise."""
        return force

    @cached_property
    def _swirl(self) -> Array:
        """Values of d(G v)/dq."""
        return self.joints.swirl(self.v)

    def velocity_swirl(self, dq: Array) -> Array:
        """d(G v)/dq dq [s, m]."""
        joints = self.system.joints
        return joints.to_rows(self._swirl * dq.take(joints.cols, axis=-1))


class Linearised(Derivatives):
    """All derivatives at the middle of a step, factorised for all eigenvalues. Raises Singular."""

    def __init__(self, system: System, linear: Linear, table: Tableau | GaussLobatto, h: float, middle: Middle, inputs: Any):
        super().__init__(system, middle, inputs)
        self.linear, self.table, self.v = linear, table, middle.v
        tangent = linear.tangent(self.joints.gradient, self.stiffness, self.damping)
        z = (table.eigenvalues / h).tolist()
        factors = linear.factors(tangent, [x.real for x in z[: table.real]] + z[table.real :])
        del self.stiffness, self.damping  # the factors hold them
        self._gradient: Tangent = tangent._replace(stiffness=None, damping=None)
        self.real_factor = factors[0]
        self._solves = [factor.raw for factor in factors]
        self._weight = factors[0].weight * linear.into

    def gathered(self, force: Array) -> Array:
        return self.table.gather @ force if isinstance(self.table, GaussLobatto) else force

    @cached_property
    def mass_factor(self) -> Factor | None:
        """The mass KKT matrix; None where G is constant, and then never asked for."""
        return None if self.system.joints.linear else self.linear.factor(self._gradient)

    @property
    def end_factor(self) -> Factor | None:  # type: ignore[override]
        """The mass KKT matrix to project the end of the step with."""
        return self.mass_factor

    def solve(self, top: Array, bottom: Array) -> tuple[Array, Array]:
        """The stage system: right sides [s, n] and [s, m], all eigenvalues."""
        t, linear = self.table, self.linear
        x = t.into_parts.dot(np.concatenate((top, bottom), axis=1)).take(linear.order, axis=1)
        x *= self._weight
        if t.real:
            x[0] = self._solves[0](x[0])
        for k, solve in enumerate(self._solves[t.real :]):
            re = t.real + 2 * k
            pair = solve(x[re] + 1j * x[re + 1])
            x[re], x[re + 1] = pair.real, pair.imag
        x *= self._weight
        x = t.back_parts.dot(x).take(linear.place, axis=1)
        return x[:, : linear.n], x[:, linear.n :]


class StageEquations:
    """The residuals of a step from (q0, v0) with given stage inputs, and one Newton correction."""

    def __init__(self, system: System, table: Tableau, h: float, q0: Array, v0: Array, inputs: Any):
        self.system, self.table, self.h, self.q0, self.v0, self.inputs = system, table, h, q0, v0, inputs
        self.goal = targets(inputs)
        self.rate = table.inverse / h

    def correct(self, x: Stages, at: Derivatives) -> Correction:
        """One step of Newton's iteration."""
        system, strains = self.system, None
        q, q_rate = self.q0 + x.dq, self.rate.dot(x.dq)
        joints = system.joints.at(q)
        r2 = system.mass(self.rate.dot(q_rate - self.v0)) - system.load(q, q_rate, self.inputs)
        if system.n_stresses:
            strains = system.strains(q)
            r5 = system.stress(strains, q_rate) - x.stress
            r2 += strains.pull(x.stress)
            r2 += at.pull(r5)
        if system.m:
            r2 += joints.pull(x.multipliers)
        g = joints.value - self.goal.value
        if (slips := system.joints.slips).size:
            g[:, slips] = np.linalg.solve(self.rate, (joints.push(q_rate) - self.goal.rate)[:, slips])
        if at.mass_factor is None:
            dq, d_multipliers = at.solve(-r2, -g)
            dq_rate, v, drift = self.rate.dot(dq), q_rate, x.drift
            dv = dq_rate
        else:
            turning, v = joints.pull(x.drift), x.v
            dq, y = at.solve(self.rate.dot(turning) - r2, -g)
            dq_rate = self.rate.dot(dq)
            top, slip = system.mass(q_rate + dq_rate - v) - turning, joints.push(v) - self.goal.rate
            dv, d_drift = at.mass_factor.solve(top, -slip - at.velocity_swirl(dq))
            d_multipliers = y + self.rate.dot(d_drift)
            drift = x.drift + d_drift
        stress = x.stress
        if system.n_stresses:
            stress = stress + r5 + at.stress_change(dq, dq_rate)
        after = Stages(x.dq + dq, v + dv, x.multipliers + d_multipliers, drift, stress)
        seen, change = (strains, stress - x.stress) if system.onsets else (None, None)
        return Correction(after, self._size(dq, dv), g, seen, change, r2)

    def _size(self, dq: Array, dv: Array) -> float:
        """The largest change of a stage's position, or of the final velocity times the step: both are lengths."""
        levers = self.system.levers
        return max(float(np.abs(dq * levers).max()), self.h * float(np.abs(dv[-1] * levers).max()))

    def fed(self, change: Correction) -> float:
        """What the residual of the balance before a correction adds to the energy in this step, as a length: h times the final velocity, times its
        share of v M v. Stiff elements and joints hold large forces by changes of position that are not seen."""
        v, force = change.x.v, change.force
        assert force is not None
        energy = self.h * abs(float(self.table.b.dot(np.einsum("ij,ij->i", v, force))))
        moving = float(v[-1].dot(self.system.mass(v[-1:])[0]))
        return self.h * float(np.abs(v[-1] * self.system.levers).max()) * energy / moving if moving > 0.0 else 0.0

    def start_defect(self, x: Stages, force: Array, at: Derivatives) -> tuple[Array, Array]:
        """The embedded estimate of the local error in q and v [n]: the defect of the collocation polynomial at the start of the step,
        filtered by the real system. ``force`` is f - B' sigma - G' lambda at the start. Hairer and Wanner (1996), IV.8, eq. 8.19."""
        gamma = self.table.gamma / self.h
        start = self.table.start / self.h
        gap = self.v0 - start @ x.dq
        if at.end_factor is not None:
            gap, _ = at.end_factor.solve(self.system.mass(gap), np.zeros(self.system.m))
        top = gamma * self.system.mass(gap) + force - self.system.mass(start @ (x.v - self.v0))
        error, _ = at.real_factor.solve(top, np.zeros(self.system.m))
        return error, gamma * error - gap
