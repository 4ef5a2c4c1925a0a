"""The accepted steps of a run, and the values between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .affine import Array
from .system import System


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The accepted steps of a run, and the method that can fill in between them.

    t [k], q, v [k, n], work [k] of loads and dampers since the start [J], states as the solver left them; the solver as the user chose
    it, and the method it became for the tolerance.
    """

    t: Array
    q: Array
    v: Array
    work: Array
    states: Sequence[Any]
    solver: Any
    method: Any
    linear: Any

    @classmethod
    def of(cls, record: Any, solver: Any, method: Any, linear: Any) -> Trajectory:
        states = record.states
        t, q, v = (np.array([getattr(state, name) for state in states]) for name in "tqv")
        return cls(t, q, v, np.array(record.work), states, solver, method, linear)

    def at(self, system: System, times: Array) -> tuple[Array, Array]:
        """q, v [..., n] at times within the run: by the method's own interpolation, projected to the joints."""
        flat = times.ravel()
        if not np.all((flat >= self.t[0]) & (flat <= self.t[-1])):
            raise ValueError(f"t: expected times between {self.t[0]:g} and {self.t[-1]:g} s, found {flat.min():g} to {flat.max():g}")
        q, v = np.empty((flat.size, self.q.shape[1])), np.empty((flat.size, self.q.shape[1]))
        step = np.clip(np.searchsorted(self.t, flat, side="left"), 1, max(len(self.t) - 1, 1)) - 1
        for k in np.unique(step):
            here = np.flatnonzero(step == k)
            q[here], v[here] = self._inside(system, int(k), flat[here])
        return q.reshape(*times.shape, -1), v.reshape(*times.shape, -1)

    def _inside(self, system: System, k: int, times: Array) -> tuple[Array, Array]:
        if len(self.t) == 1:
            return np.repeat(self.q, times.size, axis=0), np.repeat(self.v, times.size, axis=0)
        q, v = np.empty((times.size, self.q.shape[1])), np.empty((times.size, self.q.shape[1]))
        between = (times != self.t[k]) & (times != self.t[k + 1])
        if between.any():
            q[between], v[between] = self.method.inside(system, self.linear, self.states[k], self.states[k + 1], times[between])
        for end in (k, k + 1):
            exact = times == self.t[end]
            q[exact], v[exact] = self.q[end], self.v[end]
        return q, v
