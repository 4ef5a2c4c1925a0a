"""Loads and targets of drives that depend on a factor s, for statics: what a solver calls a path.

load(q, s)  = sum over items (base + s share) load_i(q)  +  constant + s growing
target(s)   = (1 - s) gamma(q0) + s c(t), or c(t)
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .model import Model, build
from .scatter import Scatter
from .system import Inputs, System


class Shares(NamedTuple):
    """How much of each item's load acts, base + s share: for each kernel one number for each item."""

    base: list[Array]
    share: list[Array]

    def at(self, inputs: Inputs, s: float) -> Inputs:
        return inputs.scaled(base + s * share for base, share in zip(self.base, self.share))


def _chosen(system: System, names: Iterable[str]) -> list[Array]:
    """For each kernel of loads: 1 for the items of these names, 0 for others."""
    wanted = set(names)
    return [np.array([float(item in wanted) for item in _items(kernel)]) for kernel in system.loads]


def _items(kernel: Any) -> list[str]:
    """The names of those that inputs scale: one for each signal, unless the kernel says otherwise."""
    return getattr(kernel, "items", [signal.item for signal in kernel.signals])


class Loading:
    """The path of a system at time t; see the module. Its drives go to where they are at t from where they are at ``start``, if given."""

    def __init__(self, system: System, t: float, shares: Shares, constant: Array, growing: Array, start: Array | None = None):
        self.system, self.t, self._shares, self._constant, self._growing = system, t, shares, constant, growing
        self._inputs = system.inputs(t)
        goal = self._inputs.targets.value
        self._goal = goal if start is None else system.joints.at(start).value
        self.target_rate: Array = goal - self._goal
        self.longest = np.inf
        self._still = np.zeros(system.n)

    @classmethod
    def whole(cls, system: System, t: float, q: Array, stress: Array, without: Iterable[str] = (), dead: Array | float = 0.0) -> Loading:
        """All loads grow together, but for some items, whose constant parts are ``dead`` in sum.

        s = 0 is a balance at q [n], whatever the stresses [n_stresses] and gaps of joints there: a force holds it that fades as the loads
        grow. Where the start is free of stress, that is nothing.
        """
        held = system.strains(q).pull(stress) if system.n_stresses else np.zeros(system.n)
        shares = Shares([np.zeros(len(_items(kernel))) for kernel in system.loads], [1.0 - chosen for chosen in _chosen(system, without)])
        return cls(system, t, shares, held, system.constant_force - dead - held, q)

    @classmethod
    def of(cls, system: System, t: float, names: Iterable[str], dead: Array) -> Loading:
        """The loads of some items grow, their constant parts being ``dead`` [n] in sum; the others act in full."""
        chosen = _chosen(system, names)
        return cls(system, t, Shares([1.0 - part for part in chosen], chosen), system.constant_force - dead, dead)

    def inputs(self, s: float) -> Inputs:
        """What kernels of loads are given."""
        return self._shares.at(self._inputs, s)

    def load(self, q: Array, s: float) -> Array:
        """[n]."""
        return self.system.load(q, self._still, self.inputs(s)) - self.system.constant_force + self._constant + s * self._growing

    def rate(self, q: Array) -> Array:
        """d load/ds [n]."""
        only = Shares([0.0 * share for share in self._shares.share], self._shares.share)
        return self.system.load(q, self._still, only.at(self._inputs, 1.0)) - self.system.constant_force + self._growing

    def target(self, s: float) -> Array:
        """c [m], or what broadcasts to it."""
        return self._goal + s * self.target_rate

    def stiffness(self, q: Array, s: float, stress: Array, multipliers: Array) -> Array:
        """Values of K on the system's pattern."""
        return self.system.stiffness(q, self._still, self.inputs(s), stress, multipliers)


def dead_part(system: System, scene: Any, items: Iterable[Any]) -> Array:
    """The constant forces [n] of some items."""
    model = Model(scene.layout, np.asarray(scene.gravity), system.length)
    for item in items:
        item.assemble(model)
    return model.dead_forces


def alone(system: System, scene: Any, item: Any, q: Array) -> Array:
    """The force [n] of one item of loads at q and t = 0, constant or not."""
    model = Model(scene.layout, np.asarray(scene.gravity), system.length)
    item.assemble(model)
    total, now = model.dead_forces.copy(), np.zeros(())
    for kernel in build(model.loads):
        total += Scatter(kernel.dofs, system.n)(kernel.force(q, kernel.inputs(now)).ravel())
    return total
