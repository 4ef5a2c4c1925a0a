"""What a scene is linearised about: a state of balance at rest, with its stresses, multipliers, and the linearised matrices."""

from __future__ import annotations

import warnings
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .assembly import consistent, prepare
from .balance import Equilibrium
from .errors import SceneError, SceneWarning
from .failures import undetermined
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.linear import Linear

RIGID = 1e-15
"""Share of the largest entry of the scaled K below which energies of strains are zero: they are exact enough for that."""

BALANCED = 1e-5
"""Forces left over below this share of the largest load or elastic force count as none; in scaled coordinates."""


class About:
    """The linearisation of a scene at rest.

    q [n], stress [n_stresses], multipliers [m], t [s];  linear: the linear algebra there, made unless given
    stiffness, damping   values of K and D on the system's patterns; D is None where nothing damps
    """

    def __init__(self, scene: Scene, about: State | Equilibrium | None, linear: Linear | None = None):
        self.scene, self.system = scene, scene.build()
        system = self.system
        if isinstance(about, Equilibrium) and about.system is not system:
            raise SceneError(["about: expected an equilibrium of this scene as it is, found one of another; solve it anew"])
        state = about.state if isinstance(about, Equilibrium) else about or State(system.q0, np.zeros(system.n))
        state.check(system)
        self._refuse_motion(state)
        self.t = state.t
        self.q = state.q if isinstance(about, Equilibrium) else consistent(system, State(state.q, np.zeros(system.n), state.t)).state.q
        self.linear = linear or prepare(system, self.q)[0]
        self.inputs = about.inputs if isinstance(about, Equilibrium) else system.inputs(self.t)
        self.stress = system.modulus * system.strains(self.q).value if system.n_stresses else np.zeros(0)
        self.multipliers = about.multipliers if isinstance(about, Equilibrium) else self._released()
        still = np.zeros(system.n)
        self.stiffness = system.stiffness(self.q, still, self.inputs, self.stress, self.multipliers)
        self.damping: Array | None = system.damping(self.q, still, self.inputs) if system.damped else None

    def _refuse_motion(self, state: State) -> None:
        speed = np.abs(state.v) * self.system.levers
        if speed.any():
            k = int(np.argmax(speed))
            found = f"{speed[k]:.6g} m/s at {self.system.owners[k][0]!r}"
            raise SceneError([f"about: expected a state at rest, found {found}; stop it, or give modes the spin= of a steady rotation"])

    def _released(self) -> Array:
        """The multipliers at the release from rest; warns unless nothing is set in motion."""
        from .solvers.formats import Singular
        from .solvers.start import mass_factor

        system = self.system
        try:
            factor = mass_factor(system, self.linear, self.q)
        except Singular as trouble:
            raise undetermined(system, self.linear, self.q, self.t, trouble) from trouble
        load = np.broadcast_to(system.load(self.q, np.zeros(system.n), self.inputs), system.n)
        elastic = -system.strains(self.q).pull(self.stress) if system.n_stresses else np.zeros(system.n)
        a, multipliers = factor.solve(np.stack((load, elastic)), np.zeros((2, system.m)))
        scale = self.linear.scale[: system.n]
        left, forces = system.mass(a.sum(axis=0)) * scale, np.stack((load, elastic)) * scale
        if np.max(np.abs(left)) > BALANCED * np.max(np.abs(forces)):
            k = int(np.argmax(np.abs(left)))
            found = f"a force of {left[k] / scale[k]:.3g} is left on {' '.join(system.owners[k])!r}"
            warnings.warn(f"about: not an equilibrium, {found}; linearise about mbd.equilibrium(scene)", SceneWarning, stacklevel=5)
        return multipliers.sum(axis=0)

    @property
    def tangent(self) -> Any:
        """K, D and G in the buffers of ``linear``."""
        return self.linear.tangent(self.system.joints.at(self.q).gradient, self.stiffness, self.damping)

    @cached_property
    def rounding(self) -> float:
        """What counts as zero among ``quotients`` of shapes with x' M x = 1, and as omega^2."""
        return RIGID * (float(np.max(np.abs(self.tangent.stiffness), initial=0.0)) or 1.0)

    @cached_property
    def conservative(self) -> bool:
        """Whether K is symmetric: follower forces make it otherwise."""
        system = self.system
        skew = np.concatenate((self.stiffness, -self.stiffness))
        rows, cols = system.stiffness_rows, system.stiffness_cols
        keys, slot = np.unique(np.concatenate((rows * system.n + cols, cols * system.n + rows)), return_inverse=True)
        scale = self.linear.scale[keys // max(system.n, 1)] * self.linear.scale[keys % max(system.n, 1)]
        largest = np.max(np.abs(np.bincount(slot, np.abs(skew)) * scale), initial=0.0)
        return bool(np.max(np.abs(np.bincount(slot, skew) * scale), initial=0.0) <= 1e-12 * largest)

    def quotients(self, shapes: Array) -> Array:
        """x' K x [k] of shapes [k, n], as energies of strains: what does not strain anything is zero to rounding squared."""
        return strain_quotients(self.system, self.q, np.zeros(self.system.n), self.inputs, self.stress, self.multipliers, shapes)


def strain_quotients(system: System, q: Array, v: Array, inputs: Any, stress: Array, multipliers: Array, shapes: Array) -> Array:
    """x' K x [k] of shapes [k, n] at a state, the elastic part as energies of strains."""
    view: System = copy(system)
    view.modulus = np.zeros_like(view.modulus)
    values = view.stiffness(q, v, inputs, stress, multipliers)
    geometric = np.sum(values * shapes[:, view.stiffness_rows] * shapes[:, view.stiffness_cols], axis=-1)
    if not view.n_stresses:
        return geometric
    return geometric + np.sum(system.modulus * system.strains(q).push(shapes) ** 2, axis=-1)
