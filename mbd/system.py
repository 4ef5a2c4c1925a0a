"""A scene as equations: gather -> kernels -> scatter.

    M dv/dt = f(q, v, t) - B(q)' sigma - G(q)' lambda          balance
    sigma   = C strain(q) + eta d(strain)/dt                   elastic measures, B = d(strain)/dq
    0       = g(q, t) = gamma(q) - c(t)                        joints and drives, G = dg/dq

M is constant, a matrix over the rows of the table times the identity of d; it may be semidefinite. C and eta are diagonal.
Arrays have any leading axes (stages, time samples) before the coordinates: q, v [..., n], lambda [..., m], sigma [..., n_stresses].
Tangents: K = d(M a - f + B' sigma + G' lambda)/dq, D = B' eta B - df/dv, as values on constant patterns of rows and columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .constraint_set import Joints, JointsAt
from .model import Model, build
from .scatter import Scatter
from .strains import Strains
from .target import Targets

DENSE_MASS = 256
"""Coordinates up to which M x is one product with zeros and all: of 124 coordinates and 5 stages 4 us, where sums over entries take 10."""


def _of_scene(scene: Any) -> System:
    system: System = scene.build()
    return system


class Inputs:
    """Functions of time at times [...]: sampled once for a step, whatever the iterations, and only if asked for."""

    def __init__(self, system: System, times: Array):
        self._system, self._times = system, times

    @cached_property
    def loads(self) -> list[Array]:
        """The values that each kernel of loads takes."""
        return self._system.steady_loads if self._system.steady else [kernel.inputs(self._times) for kernel in self._system.loads]

    def __iter__(self) -> Iterator[Array]:
        return iter(self.loads)

    def scaled(self, factors: Iterable[Array]) -> Inputs:
        """The same with the values of each kernel's items [n] times factors [n]."""
        view = Inputs(self._system, self._times)
        view.loads = [values * factor.reshape(-1, *[1] * (values.ndim - 1)) for values, factor in zip(self.loads, factors)]
        return view

    @cached_property
    def dead(self) -> Array:
        """Weight and all forces that depend on time alone [..., n]; [n] where they are constant."""
        return self._system.dead_load(self.loads)

    @cached_property
    def targets(self) -> Targets:
        """What drives follow."""
        return self._system.joints.targets(self._times)


def _side_by_side(parts: list[Array], batch: tuple[int, ...]) -> Array:
    """Values [*batch, ...] of several patterns in one array; parts that do not depend on the configuration are [...]."""
    if batch:
        parts = [np.broadcast_to(part, (*batch, part.shape[-1])) for part in parts]
    return np.concatenate(parts, axis=-1)


class System:
    """The numeric system of a scene; ``n`` coordinates, ``m`` equations, ``n_stresses`` independent stresses. ``arm`` is the smallest lever [m] of
    a slope or axis, a radius of gyration of rigid bodies.

    ``affine``: loads are constant in time and linear in q alone. ``driven``: some equations follow functions of time. ``damped``: D is not 0:
    something is viscous, or loads depend on velocities. ``onsets``: some strains set in, with slopes that are zero before (their kernels
    declare ``sets_in``).
    """

    def __init__(self, model: Model):
        self.dimension, self.n, self.length = model.dimension, model.n, model.length
        self.q0, self.v0, self.owners = model.q0, model.v0, model.owners
        self.levers, self.lengths, self.arm = model.levers, model.lengths, model.arm
        self.weight = np.zeros(self.n)
        self.weight[: model.weights.size] = model.weights.ravel()
        self.dead = model.dead_forces
        self.constant_force = self.weight + self.dead
        self._compile_mass(model)
        self.joints = Joints(model)
        self.internal = model.internal
        self.m = self.joints.m
        self.measures = build(model.strains)
        sizes = [kernel.modulus.size for kernel in self.measures]
        self.ends = np.concatenate(([0], np.cumsum(sizes, dtype=int)))
        self.n_stresses = int(self.ends[-1])
        self.stress_places = [(slice(a, b), kernel.modulus.shape) for a, b, kernel in zip(self.ends, self.ends[1:], self.measures)]
        self.modulus = np.concatenate([kernel.modulus.ravel() for kernel in self.measures] or [np.zeros(0)])
        viscosity = np.concatenate([kernel.viscosity.ravel() for kernel in self.measures] or [np.zeros(0)])
        self.viscosity: Array | None = viscosity if viscosity.any() else None
        self.onsets = any(getattr(kernel, "sets_in", False) for kernel in self.measures)
        local = [kernel.dofs.ravel() for kernel in self.measures] or [np.zeros(0, np.intp)]
        self.scatter = Scatter(np.concatenate(local), self.n)
        self.loads = build(model.loads)
        self._load_scatters = [Scatter(kernel.dofs, self.n) for kernel in self.loads]
        self.steady = all(signal.function is None for kernel in self.loads for signal in kernel.signals)
        self._rated = [getattr(kernel, "depends_on_rate", False) for kernel in self.loads]  # then methods take (q, v, inputs)
        self.affine = self.steady and not any(self._rated) and all(kernel.linear_in_q for kernel in self.loads)
        self._dead_loads = [i for i, kernel in enumerate(self.loads) if kernel.constant_in_q and not self._rated[i]]
        self._live_loads = [i for i in range(len(self.loads)) if i not in self._dead_loads]
        self._loaded = bool(self.loads) or bool(self.dead.any())
        self.damped = self.viscosity is not None or any(self._rated)
        self.driven = bool(model.drives)
        self._compile_tangent()
        self.scene: Any = None  # which it is the system of, and is copied with

    def __copy__(self) -> System:
        view = object.__new__(System)
        vars(view).update(vars(self))
        return view

    def __reduce__(self) -> tuple[Any, ...]:
        """As its scene, of which it is built anew: arrays that were copied may lie otherwise in memory, and give other last bits."""
        if self.scene is None or self.scene.build() is not self:
            raise TypeError("expected the system of a scene as it is, found items added since; copy a result before adding to its scene")
        return _of_scene, (self.scene,), {"length": self.length}

    def _compile_mass(self, model: Model) -> None:
        k = model.n_rows
        keys = [(rows[:, :, None] * k + rows[:, None, :]).ravel() for rows, _ in model.masses]
        blocks = [blocks.ravel() for _, blocks in model.masses]
        keys_all = np.concatenate(keys or [np.zeros(0, np.intp)])
        distinct, slot = np.unique(keys_all, return_inverse=True)
        values = np.bincount(slot, np.concatenate(blocks or [np.zeros(0)]), minlength=distinct.size)
        rows, cols = distinct[values != 0.0] // max(k, 1), distinct[values != 0.0] % max(k, 1)
        values = values[values != 0.0]
        d, axes = self.dimension, np.arange(self.dimension)
        self.mass_rows = (d * rows[:, None] + axes).ravel()
        self.mass_cols = (d * cols[:, None] + axes).ravel()
        self.mass_values = np.repeat(values, d)
        self.n_table = d * k
        self.vectors = np.where(np.arange(self.n) < self.n_table, np.arange(self.n) // d, np.arange(self.n))
        self._dense_mass: Array | None = None
        if self.n <= DENSE_MASS:
            self._dense_mass = np.zeros((self.n, self.n))
            self._dense_mass[self.mass_rows, self.mass_cols] = self.mass_values
        self._mass_scatter = Scatter(self.mass_rows, self.n)

    def mass(self, x: Array) -> Array:
        """M x [..., n]."""
        if self._dense_mass is None:
            return self._mass_scatter(self.mass_values * x.take(self.mass_cols, axis=-1))
        return x.dot(self._dense_mass)  # symmetric

    def _compile_tangent(self) -> None:
        def pairs(dofs: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
            k = dofs.shape[1]
            return np.repeat(dofs, k, axis=1).ravel() % self.n, np.tile(dofs, (1, k)).ravel() % self.n

        self._moving_loads = [i for i, kernel in enumerate(self.loads) if not kernel.constant_in_q]
        strains = [pairs(kernel.dofs) for kernel in self.measures]
        loads = [pairs(self.loads[i].dofs) for i in self._moving_loads]
        curves = [(self.joints.curvature_rows, self.joints.curvature_cols)]
        empty = [(np.zeros(0, np.intp), np.zeros(0, np.intp))]
        damped = [*(strains if self.viscosity is not None else []), *(pairs(kernel.dofs) for kernel, rated in zip(self.loads, self._rated) if rated)]
        self.damping_rows, self.damping_cols = (np.concatenate(part) for part in zip(*(damped or empty)))
        self.stiffness_rows, self.stiffness_cols = (np.concatenate(part) for part in zip(*(strains + curves + loads)))

    def strains(self, q: Array) -> Strains:
        return Strains(self, q)

    @cached_property
    def whole_gradient(self) -> Scatter:
        """From the gradients of all items' strains to B' [n n_stresses]."""
        numbers = np.arange(self.n_stresses)
        spans = [numbers[span].reshape(len(kernel.dofs), -1, 1) for (span, _), kernel in zip(self.stress_places, self.measures)]
        targets = [kernel.dofs[:, None, :] % self.n * self.n_stresses + span for span, kernel in zip(spans, self.measures)]
        return Scatter(np.concatenate([target.ravel() for target in targets]), self.n * self.n_stresses)

    @cached_property
    def steady_loads(self) -> list[Array]:
        """What kernels of loads that no function of time changes are given."""
        return [kernel.inputs(np.zeros(())) for kernel in self.loads]

    def inputs(self, t: Array | float) -> Inputs:
        """What loads and drives are given as functions of time, at times t [...]."""
        return Inputs(self, np.asarray(t, dtype=float))

    def load(self, q: Array, v: Array, inputs: Inputs) -> Array:
        """Weight, forces and torques [..., n]; [n] where they are constant."""
        total = inputs.dead
        for i in self._live_loads:
            kernel, values = self.loads[i], inputs.loads[i]
            total = total + self._scattered(i, kernel.force(q, v, values) if self._rated[i] else kernel.force(q, values))
        return total

    def dead_load(self, values: list[Array]) -> Array:
        """The part of the load that depends on neither q nor v, from what all kernels of loads are given."""
        total = self.constant_force
        for i in self._dead_loads:
            total = total + self._scattered(i, self.loads[i].force(self.q0, values[i]))
        return total

    def _scattered(self, i: int, local: Array) -> Array:
        return self._load_scatters[i](local.reshape(*local.shape[:-2], -1))

    def stress(self, strains: Strains, v: Array) -> Array:
        """C strain + eta d(strain)/dt [..., n_stresses]."""
        stress = self.modulus * strains.value
        return stress if self.viscosity is None else stress + self.viscosity * strains.push(v)

    def force(self, q: Array, v: Array, inputs: Inputs) -> Array:
        """f - B' sigma [..., n]: everything but the joints."""
        total = self.load(q, v, inputs)
        if self.measures:
            at = self.strains(q)
            total = total - at.pull(self.stress(at, v))
        return total

    def stiffness(
        self, q: Array, v: Array, inputs: Inputs, stress: Array, multipliers: Array, *, strains: Strains | None = None, joints: JointsAt | None = None
    ) -> Array:
        """Values of K on (stiffness_rows, stiffness_cols) at one configuration q [n]; ``strains`` and ``joints`` are those at q, where they are
        at hand."""
        parts = []
        if self.measures:
            parts.append((strains or self.strains(q)).stiffness(stress, self.modulus, None if self.viscosity is None else v))
        parts.append((joints or self.joints.at(q)).curvature(multipliers))
        for i in self._moving_loads:
            kernel, values = self.loads[i], inputs.loads[i]
            local = kernel.gradient(q, v, values) if self._rated[i] else kernel.gradient(q, values)
            parts.append(-local.reshape(*local.shape[:-3], -1))
        return _side_by_side(parts, q.shape[:-1])

    def damping(self, q: Array, v: Array, inputs: Inputs) -> Array:
        """Values of D on (damping_rows, damping_cols) at one state; only asked of scenes that are ``damped``."""
        parts = []
        if self.viscosity is not None:
            parts.append(self.strains(q).stiffness(np.zeros(self.n_stresses), self.viscosity, None))
        for kernel, rated, values in zip(self.loads, self._rated, inputs.loads):
            if rated:
                parts.append(-kernel.rate_gradient(q, v, values).ravel())
        return np.concatenate(parts)

    def kinetic(self, v: Array) -> Array:
        return 0.5 * np.sum(v * self.mass(v), axis=-1)

    def elastic(self, q: Array) -> Array:
        return sum((kernel.at(q).energy() for kernel in self.measures), np.zeros(q.shape[:-1]))

    def potential(self, q: Array) -> Array:
        """Of gravity, zero at the origin."""
        return -(q @ self.weight)

    @property
    def exchanges(self) -> bool:
        """Whether loads, drives or dampers do work that no potential knows."""
        return self._loaded or bool(self.joints.drives) or self.viscosity is not None

    def power(self, q: Array, v: Array, inputs: Inputs, multipliers: Array | None = None) -> Array:
        """[...] of loads, dampers and, given the multipliers [..., m], drives [W]; gravity and elastic forces are in the energy."""
        total = ((self.load(q, v, inputs) - self.weight) * v).sum(axis=-1) if self._loaded else np.zeros(v.shape[:-1])
        if self.viscosity is not None:
            total = total - np.sum(self.viscosity * self.strains(q).push(v) ** 2, axis=-1)
        if self.joints.drives and multipliers is not None:
            total = total - (multipliers * inputs.targets.rate).sum(axis=-1)  # the force -G' lambda on what moves with G v = c'
        return total

    def label(self, row: int) -> str:
        """The item behind an equation."""
        return self.joints.labels[row][0]

    def coordinate(self, index: int) -> str:
        """The item and coordinate behind an entry of q."""
        return " ".join(self.owners[index])
