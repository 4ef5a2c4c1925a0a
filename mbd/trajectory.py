"""The accepted steps of a run, and the values between them: of one part of a scene, and of several as one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .failures import unknown_between
from .parts import Index, Part
from .state import State


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The accepted steps of one part, and the method that can fill in between them.

    t [k], q, v [k, n], work [k] of loads and dampers since the start [J], states as the solver left them; the solver as the user chose
    it, and the method it became for the tolerance.
    """

    part: Part
    t: Array
    q: Array
    v: Array
    work: Array
    states: Sequence[Any]
    solver: Any
    method: Any
    linear: Any

    @classmethod
    def of(cls, part: Part, states: Sequence[Any], work: Array, solver: Any, method: Any, linear: Any) -> Trajectory:
        t, q, v = (np.array([getattr(state, name) for state in states]) for name in "tqv")
        return cls(part, t, q, v, work, states, solver, method, linear)

    @property
    def end(self) -> State:
        """The last state."""
        return State(self.q[-1], self.v[-1], float(self.t[-1]))

    def pieces(self, columns: Index = slice(None)) -> Sequence[Trajectory]:
        """The trajectories of the parts that these coordinates belong to."""
        return (self,)

    def values(self, columns: Index = slice(None)) -> tuple[Array, Array]:
        """q, v [k, n] at the accepted steps."""
        return self.q, self.v

    def at(self, times: Array, columns: Index = slice(None)) -> tuple[Array, Array]:
        """q, v [..., n] at times within the run: by the method's own interpolation, projected to the joints."""
        flat = _inside(times, self.t[0], self.t[-1])
        q, v = np.empty((flat.size, self.q.shape[1])), np.empty((flat.size, self.q.shape[1]))
        step = np.clip(np.searchsorted(self.t, flat, side="left"), 1, max(len(self.t) - 1, 1)) - 1
        for k in np.unique(step):
            here = np.flatnonzero(step == k)
            q[here], v[here] = self._within(int(k), flat[here])
        return q.reshape(*times.shape, q.shape[1]), v.reshape(*times.shape, v.shape[1])

    def _within(self, k: int, times: Array) -> tuple[Array, Array]:
        """At times within a step."""
        if len(self.t) == 1:
            return np.repeat(self.q, times.size, axis=0), np.repeat(self.v, times.size, axis=0)
        q, v = np.empty((times.size, self.q.shape[1])), np.empty((times.size, self.q.shape[1]))
        between = (times != self.t[k]) & (times != self.t[k + 1])
        if between.any():
            before, after = self.states[k], self.states[k + 1]
            try:
                q[between], v[between] = self.method.inside(self.part.system, self.linear, before, after, times[between])
            except ArithmeticError as trouble:
                raise unknown_between(self.part.system, self.linear, before, after, trouble) from trouble
        for end in (k, k + 1):
            exact = times == self.t[end]
            q[exact], v[exact] = self.q[end], self.v[end]
        return q, v

    def until(self, t: float) -> Trajectory:
        """The steps up to the first that ends at t or after it."""
        k = int(np.searchsorted(self.t, t)) + 1
        return replace(self, t=self.t[:k], q=self.q[:k], v=self.v[:k], work=self.work[:k], states=self.states[:k])


@dataclass(frozen=True, eq=False)
class Joined:
    """The trajectories of all parts of a scene of n coordinates, up to the last time that every one of them reached.

    ``t`` are the steps of the part that took most of them: the union of all would have the sum of their lengths for rows and the sum of
    their coordinates for columns, and most of it would be interpolated. A part's values between its own steps are found when they are
    asked for; where only some ``columns`` of q are wanted, the coordinates of other parts are left NaN.
    """

    trajectories: tuple[Trajectory, ...]
    n: int
    _known: dict[Trajectory, tuple[Array, Array]] = field(default_factory=dict)

    @cached_property
    def t(self) -> Array:
        """[k]."""
        end = min(each.t[-1] for each in self.trajectories)
        finest = max(self.trajectories, key=lambda each: int(np.searchsorted(each.t, end, side="right")))
        t = finest.t[finest.t <= end]
        return t if t[-1] == end else np.append(t, end)

    @cached_property
    def q(self) -> Array:
        """[k, n]."""
        return self.values()[0]

    @cached_property
    def v(self) -> Array:
        """[k, n]."""
        return self.values()[1]

    @cached_property
    def end(self) -> State:
        """The last state."""
        q, v = self.at(self.t[-1:])
        return State(q[0], v[0], float(self.t[-1]))

    @cached_property
    def _owner(self) -> NDArray[np.intp]:
        owner = np.empty(self.n, dtype=np.intp)
        for k, each in enumerate(self.trajectories):
            owner[each.part.columns] = k
        return owner

    def pieces(self, columns: Index = slice(None)) -> Sequence[Trajectory]:
        """The trajectories of the parts that these coordinates belong to."""
        return [self.trajectories[k] for k in np.unique(self._owner[columns])]

    def values(self, columns: Index = slice(None)) -> tuple[Array, Array]:
        """q, v [k, n] at ``t``."""
        pieces = self.pieces(columns)
        for each in pieces:
            if each not in self._known:
                self._known[each] = each.at(self.t)
        return self._filled(self.t.shape, pieces, [self._known[each] for each in pieces])

    def at(self, times: Array, columns: Index = slice(None)) -> tuple[Array, Array]:
        """q, v [..., n] at times within the run, each part's by its own method."""
        _inside(times, self.t[0], self.t[-1])
        pieces = self.pieces(columns)
        return self._filled(times.shape, pieces, [each.at(times) for each in pieces])

    def _filled(self, shape: tuple[int, ...], pieces: Sequence[Trajectory], motions: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
        q, v = np.full((*shape, self.n), np.nan), np.full((*shape, self.n), np.nan)
        for each, motion in zip(pieces, motions):
            q[..., each.part.columns], v[..., each.part.columns] = motion
        return q, v


def joined(trajectories: Sequence[Trajectory], n: int) -> Trajectory | Joined:
    """The trajectory of a scene of n coordinates from those of its parts."""
    if len(trajectories) == 1:
        return trajectories[0]
    end = float(min(each.t[-1] for each in trajectories))
    return Joined(tuple(each.until(end) for each in trajectories), n)


def _inside(times: Array, start: float, end: float) -> Array:
    """Times as one row. Raises ValueError where one is outside of the run."""
    flat = times.ravel()
    if not np.all((flat >= start) & (flat <= end)):
        raise ValueError(f"t: expected times between {start:g} and {end:g} s, found {flat.min():g} to {flat.max():g}")
    return flat
