"""Loads and targets of drives that depend on a factor s, for statics: what a solver calls a path.

    load(q, s)  = s grown(q) + kept(q) + (1 - s) held           grown: all loads, or those of chosen items
    target(s)   = (1 - s) gamma(q0) + s c(t), or c(t)

``held`` [n] is what would keep the start in balance: B' sigma there. So s = 0 is a balance and s = 1 the wanted state, whether the start is
free of stress (then all loads just grow in proportion), prestressed, or not even closed at its joints.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .model import Model, build
from .scatter import Scatter
from .system import Inputs, System


class _Inputs(NamedTuple):
    """Values that kernels of loads take."""

    loads: list[Array]


def _scaled(inputs: Inputs, shares: list[Array], s: float) -> Any:
    """Inputs with the chosen items' values times s, the others as they are."""
    factors = (1.0 + (s - 1.0) * share for share in shares)
    return _Inputs([values * factor.reshape(-1, *[1] * (values.ndim - 1)) for values, factor in zip(inputs.loads, factors)])


def _shares(system: System, names: Iterable[str] | None) -> list[Array]:
    """For each kernel of loads: 1 for the items that grow, 0 for those that are kept; None: all grow."""
    return [np.array([float(names is None or signal.item in names) for signal in kernel.signals]) for kernel in system.loads]


class Loading:
    """The path of a system at time t; see the module."""

    def __init__(self, system: System, t: float, shares: list[Array], growing: Array, held: Array, start: Array | None):
        self.system, self._shares, self._growing, self._held = system, shares, growing, held
        self._inputs = system.inputs(t)
        self._kept = _scaled(self._inputs, shares, 0.0)
        goal = self._inputs.targets.value
        self._goal = goal if start is None else system.joints.at(start).value
        self.target_rate: Array = goal - self._goal
        self.longest = np.inf
        self._still = np.zeros(system.n)

    @classmethod
    def whole(cls, system: System, t: float, q: Array, stress: Array) -> Loading:
        """All loads and drives, from a start [n] with its stresses."""
        held = system.strains(q).pull(stress) if system.n_stresses else np.zeros(system.n)
        return cls(system, t, _shares(system, None), system.constant_force, held, q)

    @classmethod
    def of(cls, system: System, t: float, names: Iterable[str], growing: Array) -> Loading:
        """The loads of some items grow, their constant parts being ``growing`` [n] in sum; s = 1: as they are described."""
        return cls(system, t, _shares(system, set(names)), growing, np.zeros(system.n), None)

    def load(self, q: Array, s: float) -> Array:
        return self.system.load(q, _scaled(self._inputs, self._shares, s)) + (s - 1.0) * (self._growing - self._held)

    def rate(self, q: Array) -> Array:
        """d load/ds [n]."""
        return self.system.load(q, self._inputs) - self.system.load(q, self._kept) + (self._growing - self._held)

    def target(self, s: float) -> Array:
        return self._goal + s * self.target_rate

    def stiffness(self, q: Array, s: float, stress: Array, multipliers: Array) -> Array:
        return self.system.stiffness(q, self._still, _scaled(self._inputs, self._shares, s), stress, multipliers)


def alone(system: System, scene: Any, item: Any, q: Array) -> Array:
    """The force [n] of one item of loads at q and t = 0, constant or not."""
    model = Model(scene.layout, np.asarray(scene.gravity), system.length)
    item.assemble(model)
    total, now = model.dead_forces.copy(), np.zeros(())
    for kernel in build(model.loads):
        total += Scatter(kernel.dofs, system.n)(kernel.force(q, kernel.inputs(now)).ravel())
    return total
