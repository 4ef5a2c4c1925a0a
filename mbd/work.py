"""The work of loads, drives and dampers over the steps of a run, by the steps' own quadrature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .affine import Array
from .signal import from_inside
from .system import System

if TYPE_CHECKING:
    from .solvers.protocol import Attempt

BATCH = 2**14
"""Coordinates at nodes that wait to be evaluated together: of small systems a step costs calls, not numbers."""


class Nodes(NamedTuple):
    """The quadrature of a step: times [s], q, v [s, n], weights [s], and multipliers [s, m], if any."""

    t: Array
    q: Array
    v: Array
    weights: Array
    multipliers: Array | None


class Pending(NamedTuple):
    """Steps that wait to be evaluated, after so many that were: what is evaluated together matters to the last bit."""

    done: int = 0
    waiting: tuple[Nodes, ...] = ()


class Work:
    """Told of each step; nothing is evaluated where nothing does any work. ``jumps`` [k] are the times at which functions of time jump;
    ``before`` is the work [k + 1] of steps done before, without those that wait."""

    def __init__(self, system: System, jumps: Array, before: Array | None = None, waiting: tuple[Nodes, ...] = ()):
        self._system, self.jumps, self._idle = system, jumps, not system.exchanges
        self._before = np.zeros(1) if before is None else before
        self._new: list[Array] = []
        self._done, self._waiting = len(self._before) - 1, waiting
        self._size = sum(nodes.q.size for nodes in waiting)

    def __call__(self, attempt: Attempt) -> None:
        if self._idle:
            self._keep(1, np.zeros(1))
            return
        assert attempt.nodes is not None
        nodes = Nodes(*attempt.nodes, attempt.multipliers)
        if not self._system.steady or self._system.driven:  # users' functions are called as time goes on, and from inside of the step
            self._keep(1, self._at_once(nodes, attempt.inputs))
        else:
            self._waiting, self._size = (*self._waiting, nodes), self._size + nodes.q.size
            if self._size > BATCH:
                self._keep(len(self._waiting), self._evaluated(self._waiting))
                self._waiting, self._size = (), 0

    @property
    def pending(self) -> Pending:
        return Pending(self._done, self._waiting)

    def rewind(self, pending: Pending) -> None:
        """Back to where this was pending, whatever was begun since."""
        evaluated = pending.done - len(self._before) + 1
        self._new = [np.concatenate((np.zeros(0), *self._new))[:evaluated]]
        self._done, self._waiting = pending
        self._size = sum(nodes.q.size for nodes in self._waiting)

    def so_far(self) -> Array:
        """[steps + 1]: the work since the start [J]."""
        rest = [self._evaluated(self._waiting)] if self._waiting else []
        return np.concatenate((self._before[:-1], np.cumsum(np.concatenate((self._before[-1:], *self._new, *rest)))))

    def _keep(self, count: int, values: Array) -> None:
        self._new.append(values)
        self._done += count

    def _at_once(self, nodes: Nodes, inputs: Any) -> Array:
        """Of one step, from what its loads and drives were given, where the method has that at hand."""
        inputs = inputs or from_inside(self._system, self.jumps, nodes.t[0], nodes.t[-1]).inputs(nodes.t)
        return nodes.weights.dot(self._system.power(nodes.q, nodes.v, inputs, nodes.multipliers)).reshape(1)

    def _evaluated(self, steps: tuple[Nodes, ...]) -> Array:
        t, q, v, weights = (np.concatenate([getattr(step, name) for step in steps]) for name in ("t", "q", "v", "weights"))
        multipliers = None if steps[0].multipliers is None else np.concatenate([step.multipliers for step in steps])  # type: ignore[misc]
        power = weights * self._system.power(q, v, self._system.inputs(t), multipliers)
        ends = np.cumsum([step.t.size for step in steps])
        return np.add.reduceat(power, np.concatenate(([0], ends[:-1])))
