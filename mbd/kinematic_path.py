"""The motion of a mechanism whose drives determine all of it, followed from one time to the next without integration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .assembly import Assembly
from .dependence import scaled_gradient
from .errors import SimulationError
from .parts import Part
from .system import System

if TYPE_CHECKING:
    from .trajectory import Trajectory

FORESEEN = 0.05
"""Positions farther than this share of the length (less near dead centres) from where velocities and accelerations lead are looked for
in shorter steps."""

SINGULAR = 1e-6
"""The smallest singular value of the scaled G, relative to the largest, at a dead centre."""

SHORTEST = 1e-7
"""The share of the way between two times at which looking for positions gives up."""


@dataclass(frozen=True, eq=False)
class KinematicPath:
    """The motion of one part, solved for at any time from one nearby; in trajectories it stands where integrators do."""

    part: Part
    assembly: Assembly

    name = "kinematics"

    def first(self) -> Any:
        """The start, its velocities and accelerations those of the drives."""
        state = self.assembly.state
        return self._at(state.t, state.q, state.v)

    def reach(self, before: Any, t: float) -> Any:
        """The state at t, following the motion from an earlier or later one."""
        state, step = before, t - before.t
        gradient = self._gradient(state.q)
        while state.t != t:
            step = step if abs(step) < abs(t - state.t) else t - state.t
            found = self._tried(state, gradient, t if step == t - state.t else state.t + step)
            if found is None:
                step *= 0.5
                if abs(step) <= SHORTEST * abs(t - before.t):
                    raise self._lost(state)
            else:
                (state, gradient), step = found, 2.0 * step
        return state

    def _tried(self, state: Any, gradient: Array, t: float) -> tuple[Any, Array] | None:
        """The state at t and its G, if this is where the motion of a state leads without doubt.

        Solutions are apart by at least about the smallest singular value of G over its rate of change (Kantorovich), so a Newton iteration
        that stays well within cannot have found another. The sign of det(G' G) changes where a dead centre lies between."""
        from .solvers.formats import Singular
        from .solvers.start import Inconsistent, project_positions

        step = t - state.t
        expected = state.q + step * state.v + 0.5 * step**2 * state.memory
        try:
            q = project_positions(self.system, self.linear, expected, self.system.inputs(t).targets.value)
            after = self._gradient(q)
            sizes = np.linalg.svd(after, compute_uv=False)
            allowed = FORESEEN * self.system.length * sizes[self.system.n - 1]
            moved = float(np.max(np.abs(q - expected) * self.system.levers))
            if sizes[self.system.n - 1] < SINGULAR * sizes[0] or moved > allowed or np.linalg.slogdet(gradient.T @ after)[0] <= 0.0:
                return None
            return self._at(t, q, state.v), after
        except (Inconsistent, Singular):
            return None

    def _gradient(self, q: Array) -> Array:
        """G [m, n], coordinates in lengths (turning angles in radians), equations of size 1."""
        levers = self.system.levers
        return scaled_gradient(self.system, 1.0 / np.where(levers > 0.0, levers, 1.0), q)[0]

    @property
    def system(self) -> System:
        return self.part.system

    @property
    def linear(self) -> Any:
        return self.assembly.linear

    def _at(self, t: float, q: Array, v: Array) -> Any:
        """The state with these positions; its memory are the accelerations. Raises Singular."""
        from .solvers.protocol import State as SolverState
        from .solvers.start import accelerations, mass_factor, project_velocities

        system, inputs = self.system, self.system.inputs(t)
        factor = mass_factor(system, self.linear, q)
        v = project_velocities(system, factor, q, v, inputs.targets.rate)
        a, multipliers = accelerations(system, factor, q, v, inputs)
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        return SolverState(t, q, v, multipliers, stress, a)

    def inside(self, system: System, linear: Any, before: Any, after: Any, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times between two states."""
        found = [self.reach(before if t - before.t < after.t - t else after, float(t)) for t in times]
        return np.array([state.q for state in found]), np.array([state.v for state in found])

    def _lost(self, state: Any) -> SimulationError:
        """Where positions come to a dead centre, as far as it was followed; told by the equations most in need of one another there."""
        weights = np.abs(np.linalg.svd(self._gradient(state.q))[0][:, self.system.n - 1])
        names = dict.fromkeys(self.system.label(int(row)) for row in np.flatnonzero(weights > 0.1 * weights.max()))
        joints = [name for name in names if name not in self.system.internal] or list(names)
        what = f"the drives lead to a dead centre, or to where the joints cannot close ({', '.join(map(repr, joints))})"
        advice = (
            "drive another joint there, or keep the drive's range short of that position",
            "change lengths so that the joints close all the way: result.plot() shows where they are stretched",
            "use mbd.simulate, which passes dead centres by inertia",
        )
        return SimulationError(what, time=state.t, item=joints[0], advice=advice)


def work(piece: Trajectory) -> Array:
    """[n_t]: of loads, dampers and drives since the first time [J]."""
    x, weights = np.polynomial.legendre.leggauss(10)
    system, path, done = piece.part.system, piece.method, [0.0]
    for before, after in zip(piece.states[:-1], piece.states[1:]):
        half, added, state = 0.5 * (after.t - before.t), 0.0, before
        for node, weight in zip(x, weights):
            state = path.reach(state, before.t + half * (1.0 + node))
            added += half * weight * float(system.power(state.q, state.v, system.inputs(state.t), state.multipliers))
        done.append(done[-1] + added)
    return np.array(done)
