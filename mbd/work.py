"""The work of loads, drives and dampers over the steps of a run, by the steps' own quadrature."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .affine import Array
from .signal import from_inside
from .system import System

if TYPE_CHECKING:
    from .solvers.protocol import Attempt

BATCH = 2**14
"""Coordinates at nodes that wait to be evaluated together: of small systems a step costs calls, not numbers."""


class Work:
    """Told of each step; nothing is evaluated where nothing does any work. ``jumps`` [k] are the times at which functions of time jump."""

    def __init__(self, system: System, jumps: Array):
        self._system, self._jumps = system, jumps
        self._steps: list[Array] = []
        self._count, self._size = 0, 0
        self._waiting: list[Attempt] = []

    def __call__(self, attempt: Attempt) -> None:
        self._count += 1
        if not self._system.exchanges:
            return
        assert attempt.nodes is not None
        if not self._system.steady or self._system.driven:  # users' functions are called as time goes on, and from inside of the step
            self._evaluate([attempt], from_inside(self._system, self._jumps, attempt.nodes[0][0], attempt.nodes[0][-1]))
            return
        self._waiting.append(attempt._replace(state=None))
        self._size += attempt.nodes[1].size
        if self._size > BATCH:
            self._flush()

    def done(self) -> Array:
        """[steps + 1]: the work since the start [J]."""
        self._flush()
        return np.concatenate(([0.0], np.cumsum(np.concatenate(self._steps)) if self._steps else np.zeros(self._count)))

    def _flush(self) -> None:
        if self._waiting:
            self._evaluate(self._waiting, self._system)
        self._waiting, self._size = [], 0

    def _evaluate(self, steps: list[Attempt], system: System) -> None:
        t, q, v, weights = (np.concatenate(parts) for parts in zip(*(step.nodes for step in steps if step.nodes)))
        multipliers = None if steps[0].multipliers is None else np.concatenate([step.multipliers for step in steps])  # type: ignore[misc]
        power = weights * system.power(q, v, system.inputs(t), multipliers)
        ends = np.cumsum([step.nodes[0].size for step in steps if step.nodes])
        self._steps.append(np.add.reduceat(power, np.concatenate(([0], ends[:-1]))))
