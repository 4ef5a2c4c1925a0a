"""The motion of a system in all its coordinates: states w = (q, v) [2, n]."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .formats import Singular
from .linear import Linear
from .places import NearlySingular
from .start import accelerations, mass_factor, project_positions, project_velocities
from .system import Array, System, targets


class Rates(NamedTuple):
    """Accelerations [n], multipliers [m], and the least share of an equation's slope, squared, that others leave (``places.least_share``);
    1 where it is not asked for."""

    acceleration: Array
    multipliers: Array
    share: float = 1.0


class Whole:
    """What its forms share."""

    def __init__(self, system: System, linear: Linear):
        self.linear, self.levers, self.width, self.m = linear, system.levers, system.n, system.m

    def enter(self, q: Array, v: Array) -> Array:
        return np.stack((q, v))

    def leave(self, w: Array) -> tuple[Array, Array]:
        return w[..., 0, :].copy(), w[..., 1, :].copy()

    def lengths(self, rows: Array) -> Array:
        """[...]: the largest change of position [m] that each of the rows [..., n] stands for."""
        return np.max(np.abs(rows) * self.levers, axis=-1, initial=0.0)

    def all_rows(self, multipliers: Array) -> Array:
        return multipliers

    def places(self, w: Array, accelerations: Array) -> Each:
        return Each(self, w, accelerations)

    def rates(self, system: System, w: Array, t: float) -> Rates:
        """What follows from a state. Raises Singular where equations depend on each other."""
        raise NotImplementedError

    def land(self, system: System, w: Array, t: float) -> Rates:
        """Moves w to the joints, in place, and goes on as ``rates``; raises Inconsistent where it finds none near."""
        raise NotImplementedError


class Each:
    """Places that share nothing."""

    def __init__(self, form: Whole, w: Array, accelerations: Array):
        self._form, self._w, self._accelerations = form, w, accelerations
        self.multipliers, self._shares = np.empty((len(w), form.m)), np.ones(len(w))

    def rates(self, system: System, place: int, t: float) -> None:
        self._set(place, self._form.rates, system, t)

    def land(self, system: System, place: int, t: float) -> None:
        self._set(place, self._form.land, system, t)

    def _set(self, place: int, find: Callable[[System, Array, float], Rates], system: System, t: float) -> None:
        try:
            self._accelerations[place], self.multipliers[place], self._shares[place] = find(system, self._w[place], t)
        except Singular as trouble:
            raise NearlySingular(place, trouble) from None

    def shares(self, places: slice) -> Array:
        return self._shares[places]


class Kkt(Whole):
    """Through the KKT matrix of the mass: any system."""

    def rates(self, system: System, w: Array, t: float) -> Rates:
        """What follows from a state. Raises Singular where equations depend on each other."""
        return Rates(*accelerations(system, mass_factor(system, self.linear, w[0]), w[0], w[1], system.inputs(t)))

    def land(self, system: System, w: Array, t: float) -> Rates:
        """Moves w to the joints, in place, and goes on as ``rates``; raises Inconsistent where it finds none near."""
        if system.m:
            goal = targets(system.inputs(t))
            factor = mass_factor(system, self.linear, w[0])
            w[0] = project_positions(system, self.linear, w[0], goal.value, factor=factor, sweeps=8)
            w[1] = project_velocities(system, factor, w[0], w[1], goal.rate)
        return self.rates(system, w, t)
