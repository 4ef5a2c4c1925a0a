"""``linearize``: small motions about a state of rest, as matrices in minimal coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .about import About
from .affine import Array
from .balance import Equilibrium
from .errors import SceneError
from .loading import alone
from .marker import Marker
from .state import State

if TYPE_CHECKING:
    from .scene import Scene

FIELDS = {"force": "vector", "torque": "value", "motor": "torque"}


@dataclass(frozen=True, eq=False)
class Linearization:
    """M x'' + D x' + K x = F u, y = C x, with dq = basis x: all that the joints allow, to first order.

    q [n] the state of rest;  basis [n, r];  mass, damping, stiffness [r, r];  inputs F [r, p];  outputs C [k, r]
    input_names [p], output_names [k]
    """

    q: Array
    basis: Array
    mass: Array
    damping: Array
    stiffness: Array
    inputs: Array
    outputs: Array
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<linear system: {len(self.mass)} degrees of freedom, {len(self.input_names)} inputs, {len(self.output_names)} outputs>"

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """A, B, C, D of the state (x, x'): for python-control, ``control.ss(*linear.matrices)``."""
        from .solvers.state_space import first_order

        return first_order(self.mass, self.damping, self.stiffness, self.inputs, self.outputs)

    @cached_property
    def state_space(self) -> Any:
        """The scipy.signal.StateSpace."""
        from .solvers.state_space import scipy_system

        return scipy_system(*self.matrices)


def linearize(scene: Scene, inputs: Sequence[Any] = (), outputs: Sequence[Any] = (), about: State | Equilibrium | None = None) -> Linearization:
    """The linearised equations of a scene about a state of rest.

    inputs   forces, torques and torque motors of the scene (items or names), a column for each component: u is what is added to their
             values; or arrays [n] of generalised forces
    outputs  markers, a row for each component of their position; or arrays [n] that multiply dq
    about    ``mbd.equilibrium(scene)``, a state at rest, or None: positions as described; drives stand still

    Raises SceneError for a state in motion and for other inputs and outputs, all together; warns where the state is no equilibrium.
    """
    from .solvers.minimal import minimal_form

    at = About(scene, about)
    found: list[str] = []
    columns = [column for one in inputs for column in _columns(at, one, found)]
    rows = [row for one in outputs for row in _rows(at, one, found)]
    if found:
        raise SceneError(found)
    small = minimal_form(at.system, at.linear, at.q, at.stiffness, at.damping)
    n = at.system.n
    forces = np.array([force for _, force in columns]).reshape(-1, n)
    readings = np.array([reading for _, reading in rows]).reshape(-1, n)
    names = tuple(name for name, _ in columns), tuple(name for name, _ in rows)
    return Linearization(at.q, small.basis, small.mass, small.damping, small.stiffness, (forces @ small.basis).T, readings @ small.basis, *names)


def _columns(at: About, one: Any, found: list[str]) -> list[tuple[str, Array]]:
    """(name, generalised force [n] per unit) of each component of an input."""
    if isinstance(one, np.ndarray) and one.shape == (at.system.n,):
        return [("force", one)]
    item = at.scene[one] if isinstance(one, str) and one in at.scene._names else one
    field = FIELDS.get(getattr(getattr(item, "description", None), "kind", ""))
    if field is None or item not in at.scene.items or getattr(item.description, field) is None:
        found.append(f"inputs: expected forces, torques and motors with a torque of this scene, or arrays [{at.system.n}], found {one!r}; correct it")
        return []
    size = at.scene.dimension if field == "vector" else 1 if at.scene.dimension == 2 else 3
    units = np.eye(size) if size > 1 else np.ones(1)
    labels = [f"{item.name} {axis}" for axis in "xyz"[:size]] if size > 1 else [item.name]
    return [(label, _unit_force(at, item, field, unit)) for label, unit in zip(labels, units)]


def _unit_force(at: About, item: Any, field: str, unit: Any) -> Array:
    one = copy(item)
    one.description = replace(item.description, **{field: unit})
    return alone(at.system, at.scene, one, at.q)


def _rows(at: About, one: Any, found: list[str]) -> list[tuple[str, Array]]:
    """(name, row [n]) of each component of an output."""
    n = at.system.n
    if isinstance(one, np.ndarray) and one.shape == (n,):
        return [("output", one)]
    if not isinstance(one, Marker) or one.scene is not at.scene:
        found.append(f"outputs: expected markers of this scene such as rod.end, or arrays [{n}], found {one!r}; correct it")
        return []
    rows = np.zeros((one.dimension, n))
    rows[:, one.point.columns()] = one.point.matrix()
    return [(f"{one.item} {axis}", row) for axis, row in zip("xyz", rows)]
