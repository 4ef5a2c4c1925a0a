"""What a scene in steady rotation is linearised about: q(t) = R(t) p + c t, R the rotation of every row of the table about an axis through
the origin, c the rates of the scalar coordinates (a motor's turn).

With x' for rates in the rotating frame and S the generator, R' = R S, the equations of ``System`` become

    M p'' + 2 M S p' + M S S p + B' sigma + G' lambda = f,     linearised:   M x'' + (D + 2 M S) x' + (K + D S + M S S) x + G' l = 0,  G x = 0

because M is constant and the same in all directions (Meirovitch 1980, Computational Methods in Structural Dynamics, sec. 2.9). Loads and
joints must turn with the scene: all of this is evaluated at later times, turned back, and compared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .about import RIGID, strain_quotients
from .affine import Array
from .assembly import consistent, prepare
from .balance import Equilibrium
from .errors import SceneError
from .spin import generator_of, turn_by
from .state import State

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.minimal import Minimal

LARGEST = 600
"""Coordinates up to which modes about a rotation are found: by dense matrices, whose time grows with the cube."""

LATER = (1.0, 2.6)
"""Angles [rad] that the scene is turned by: 2.6 is no multiple of 1, nor is either a fraction of a turn."""

STEADY = 1e-6
"""Share of forces, of a row of K or D, and of velocities, by which they may differ after a turn."""

NOISE = 1e-12
"""The same as a share of the largest entry of the scaled K: rounding of stresses."""


class Turned(NamedTuple):
    """Linear equations in the rotating frame: K, D [n, n] without inertia, G [m, n]; multipliers [m]; and what is out of balance [n]."""

    stiffness: Array
    damping: Array
    gradient: Array
    multipliers: Array
    left: Array


class Rotating:
    """The linearisation of a scene that rotates steadily.

    q [n] the configuration at t [s]; rates [n] of scalar coordinates; generator [n, n] S; basis [n, r] of motions that the joints allow
    """

    def __init__(self, scene: Scene, about: State | Equilibrium | None, spin: Array):
        from .solvers.minimal import null_basis
        from .solvers.steady import CLOSE, SteadyProblem, steady_state

        self.scene, self.system = scene, scene.build()
        system = self.system
        self._refuse()
        start = about.state if isinstance(about, Equilibrium) else about or State(system.q0, np.zeros(system.n))
        start.check(system)
        self.t, self.speed = start.t, float(np.linalg.norm(spin))
        self.inputs = system.inputs(self.t)
        q = consistent(system, State(start.q, np.zeros(system.n), start.t)).state.q
        self.linear = prepare(system, q)[0]
        self.generator = generator_of(system, spin)
        self.mass = system.mass(np.eye(system.n))
        self.rates = self._rates(q)
        self.q, left = steady_state(SteadyProblem(system, self.linear, self.inputs, self.generator, self.mass, self.rates), q)
        if left > CLOSE:
            self.q = q
            self._give_up()
        self.linear.origin = self.q
        self.basis = null_basis(system, self.linear, self.q)
        self.now = self._compared()

    @property
    def _said(self) -> str:
        return f"{self.speed:.6g} rad/s about the origin"

    def _refuse(self) -> None:
        system = self.system
        found = []
        if system.n > LARGEST:
            found.append(f"spin: expected at most {LARGEST} coordinates, found {system.n}; use fewer elements")
        if system.joints.slips.size:
            names = ", ".join(dict.fromkeys(repr(system.label(int(row))) for row in system.joints.slips))
            found.append(f"spin: expected joints that hold positions, found nonholonomic {names}; leave them out")
        if found:
            raise SceneError(found)

    def _rates(self, q: Array) -> Array:
        """[n]: of the scalar coordinates, so that joints and drives hold while everything turns."""
        system, rates = self.system, np.zeros(self.system.n)
        from .solvers.start import dense_gradient

        gradient = dense_gradient(system, q)
        slip = np.broadcast_to(self.inputs.targets.rate, system.m) - gradient @ self.generator @ q
        scalars = gradient[:, system.n_table :]
        if scalars.size:
            rates[system.n_table :] = np.linalg.lstsq(scalars, slip, rcond=None)[0]
            slip = slip - scalars @ rates[system.n_table :]
        self._hold(slip, self.speed, "would have to give way by {:.3g} m/s")
        return rates

    def _hold(self, gap: Array, scale: float, what: str) -> None:
        """Raises SceneError where equations do not hold, by the worst one's name."""
        gap = np.abs(gap) * self.linear.reach
        if np.max(gap, initial=0.0) > STEADY * scale * self.system.length:
            k = int(np.argmax(gap))
            found = f"{self.system.label(k)!r}, which {what.format(gap[k])}"
            raise SceneError([f"spin: expected joints and drives that turn with {self._said}, found {found}; hold the scene on the axis"])

    def _at(self, angle: float) -> Turned:
        """The equations after a turn, in the rotating frame."""
        from .solvers.formats import dense
        from .solvers.start import accelerations, dense_gradient, mass_factor

        system, later = self.system, angle / self.speed
        inputs = system.inputs(self.t + later)
        turn = turn_by(self.generator, self.speed, angle)
        q = turn @ self.q + later * self.rates
        v = self.generator @ q + self.rates
        joints, targets = system.joints.at(q), inputs.targets
        self._hold(joints.value - targets.value, 1.0, f"is open by {{:.3g}} m after a turn of {angle:.2g} rad")
        self._hold(joints.push(v) - targets.rate, self.speed, f"would give way by {{:.3g}} m/s after a turn of {angle:.2g} rad")
        a, multipliers = accelerations(system, mass_factor(system, self.linear, q), q, v, inputs)
        left = turn.T @ system.mass(a - self.generator @ (self.generator @ q))
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        shape = (system.n, system.n)
        values = system.stiffness(q, v, inputs, stress, multipliers)
        stiffness = turn.T @ dense(system.stiffness_rows, system.stiffness_cols, values, shape) @ turn
        damping = np.zeros(shape)
        if system.damped:
            damping = turn.T @ dense(system.damping_rows, system.damping_cols, system.damping(q, v, inputs), shape) @ turn
        return Turned(stiffness + damping @ self.generator, damping, dense_gradient(system, q) @ turn, multipliers, left)

    def _compared(self) -> Turned:
        """The equations at the start, once they have proved the same after turns."""
        scale = self.linear.scale[: self.system.n]
        now = self._at(0.0)
        both = scale[:, None] * scale
        noise = NOISE * float(np.max(np.abs(now.stiffness) * both, initial=0.0))
        far = float(np.max(np.abs(self.q) / scale, initial=0.0))
        inertia = float(np.max(np.abs(self.mass @ self.generator @ self.generator @ self.q) * scale, initial=0.0))
        forces = float(np.max(np.abs(now.gradient.T @ now.multipliers) * scale, initial=0.0))
        allowed = STEADY * max(inertia, forces) + noise * 1e-3 * far
        if np.max(np.abs(now.left) * scale, initial=0.0) > allowed:
            self._give_up()
        for angle in LATER:
            then = self._at(angle)
            if np.max(np.abs(then.left) * scale, initial=0.0) > allowed:
                self._unsteady(then.left, "is not in balance", angle)
            self._hold(np.max(np.abs(then.gradient @ self.basis / scale.max()), axis=1, initial=0.0), 1.0, "holds a direction that does not turn")
            for name, before, after in (("stiffness", now.stiffness, then.stiffness), ("damping", now.damping, then.damping)):
                size, change = (np.max(np.abs(x) * both, axis=1, initial=0.0) for x in (before, after - before))
                excess = np.where(change > STEADY * size + noise * (1.0 if name == "stiffness" else 1.0 / self.speed), change, 0.0)
                if excess.any():
                    self._unsteady(excess / scale, f"feels another {name}", angle)
        return now

    def _give_up(self) -> None:
        """Raises SceneError for a scene without a relative equilibrium: by what does not turn, else by what is set in motion most."""
        now, levers = self._force(0.0), self.system.levers
        size = np.max(np.abs((now, self.mass @ self.generator @ self.generator @ self.q)) * levers)
        for angle in LATER:
            force = self._force(angle)
            if np.max(np.abs(force - now) * levers) > STEADY * size:
                self._unsteady(force - now, "feels another force", angle)
        item = self.system.owners[self._worst(self._at(0.0).left)][0]
        found = f"none near this position, where {item!r} is set in motion"
        raise SceneError([f"spin: expected a steady rotation with {self._said}, found {found}; start nearer to it by about=, or correct spin"])

    def _force(self, angle: float) -> Array:
        """Of loads and stresses after a turn, in the rotating frame [n]."""
        later, turn = angle / self.speed, turn_by(self.generator, self.speed, angle)
        q = turn @ self.q + later * self.rates
        return turn.T @ self.system.force(q, self.generator @ q + self.rates, self.system.inputs(self.t + later))

    def _worst(self, force: Array) -> int:
        return int(np.argmax(np.abs(force) * self.linear.scale[: self.system.n]))

    def _unsteady(self, force: Array, what: str, angle: float) -> None:
        where = f"{self.system.owners[self._worst(force)][0]!r} {what} after a turn of {angle:.2g} rad"
        advice = "gravity or a load across the axis, a support that does not turn, or a function of time does that; leave it out"
        raise SceneError([f"spin: expected a steady rotation with {self._said}, found that {where}; {advice}"])

    @property
    def rounding(self) -> float:
        """What counts as zero as omega^2."""
        scale = self.linear.scale[: self.system.n]
        return RIGID * (float(np.max(np.abs(self.now.stiffness) * scale[:, None] * scale, initial=0.0)) or 1.0)

    def minimal(self) -> Minimal:
        """M, D and K in minimal coordinates, gyroscopic and centrifugal terms included."""
        from .solvers.minimal import Minimal

        z, s = self.basis, self.generator
        mass = z.T @ self.mass @ z
        damping = self.now.damping + 2.0 * self.mass @ s
        stiffness = self.now.stiffness + self.mass @ s @ s
        return Minimal(z, 0.5 * (mass + mass.T), z.T @ damping @ z, z.T @ stiffness @ z)

    def quotients(self, shapes: Array) -> Array:
        """x' (K + D S + M S S) x [k] of shapes [k, n], the elastic part as energies of strains (decision "Frequencies are quotients of strains")."""
        system = self.system
        centrifugal = -np.sum((shapes @ self.generator.T) * system.mass(shapes @ self.generator.T), axis=-1)
        v = self.generator @ self.q + self.rates
        stress = system.stress(system.strains(self.q), v) if system.n_stresses else np.zeros(0)
        strained = strain_quotients(system, self.q, v, self.inputs, stress, self.now.multipliers, shapes)
        damped = np.sum((shapes @ self.now.damping) * (shapes @ self.generator.T), axis=-1)
        return strained + damped + centrifugal
