"""One step of Dormand and Prince's method for a system: the room it takes, and the states, accelerations and multipliers in it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .dop853 import NODES
from .index_one import Form
from .leap import parts
from .linear import Linear
from .nystrom import END, STAGES, combinations
from .places import NearlySingular
from .system import Array, System


class Memory(NamedTuple):
    """The state in the form prepared for the system, with its accelerations and multipliers.

    home       positions where the method began, and ``extent`` the farthest that anything has been seen from there [m]
    share      least share of an equation's slope, squared, that others leave it there (``places.least_share``)
    stiffness  the last step times the fastest rate seen in it, of elastic systems: near 6 stability limits steps, not accuracy
    """

    w: Array
    acceleration: Array
    multipliers: Array
    home: Array
    extent: float
    share: float
    stiffness: float = 0.0


BETWEEN, AT_END, ALL = slice(1, END), slice(END, END + 1), slice(1, END + 1)
"""Places of a step: stages but the start, its end, and both."""


class Workspace:
    """A form of a system, and room for one step: its states at stages and end [stages + 1, 2, ...], and rows of position and velocity at its
    start and the accelerations of all states [3 + stages, ...], of which states are sums."""

    def __init__(self, linear: Linear, form: Form):
        self.linear, self.form = linear, form
        self.rows, self.states = np.zeros((3 + STAGES, form.width)), np.zeros((STAGES + 1, 2, form.width))
        self.places = form.places(self.states, self.rows[2:])
        self._table = self.rows[: 2 + STAGES]
        self._sums = np.empty((STAGES + 3, 2, 2 + STAGES))
        self._ends = self._sums[END:].reshape(-1, 2 + STAGES)
        self._plan = [(self._sums[i, :, : i + 2], self.rows[: i + 2], self.states[i], i, float(NODES[i])) for i in range(1, STAGES)]

    def step(self, system: System, memory: Memory, t: float, h: float) -> Array:
        """[3, 2, ...]: the state at the end, not yet moved to the joints, and two estimates of its error, velocities times h. Raises
        NearlySingular where a state is singular; others near it show in a check."""
        combinations(h, self._sums)
        self.states[0] = self.rows[:2] = memory.w
        self.rows[2], self.places.multipliers[0] = memory.acceleration, memory.multipliers
        rates = self.places.rates
        for weights, rows, state, place, node in self._plan:
            np.dot(weights, rows, state)
            rates(system, place, t + node * h)
        return self._ends.dot(self._table).reshape(3, 2, -1)

    def remembered(self, system: System, t: float, w: Array, least: float) -> Memory:
        """Of a state to start from. Raises NearlySingular."""
        self.states[END] = w
        self.places.rates(system, END, t)
        return self._end(w[0].copy(), 0.0, self.check(AT_END, least))

    def landed(self, system: System, before: Memory, t: float, w: Array, least: float) -> Memory:
        """The end of the last step, moved to the joints. Raises Inconsistent where there are none near, and NearlySingular."""
        self.states[END] = w
        self.places.land(system, END, t)
        return self._end(before.home, before.extent, self.check(ALL, least))

    def check(self, places: slice, least: float) -> Array:
        """The shares that states leave their equations. Raises NearlySingular, at the worst of them, unless all are above ``least``."""
        shares = self.places.shares(places)
        worst = int(shares.argmin())
        if not shares[worst] > least:
            raise NearlySingular(places.start + worst)
        return shares

    def reached(self, system: System, memory: Memory, t: float, h: float, least: float) -> Memory:
        """The end of a step, or of two where one comes near a singular position. Raises Inconsistent and NearlySingular."""

        def whole(memory: Memory, t: float, h: float) -> Memory:
            return self.landed(system, memory, t + h, self.step(system, memory, t, h)[0], least)

        try:
            return whole(memory, t, h)
        except NearlySingular as near:
            first, second = parts(near, h)
        return whole(whole(memory, t, first), t + first, second)

    def _end(self, home: Array, extent: float, shares: Array) -> Memory:
        w = self.states[END].copy()
        farthest = max(extent, float(self.form.lengths((w[0] - home)[None])[0]))
        return Memory(w, self.rows[-1].copy(), self.places.multipliers[END].copy(), home, farthest, float(shares[-1]))
