"""The iteration that solves the stage equations: simplified Newton by the derivatives of the step's middle, renewed once where it contracts
slowly; where it fails, as across a singular position of the joints, Newton's with the slopes of each stage (``coupled.py``).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .coupled import Coupled
from .formats import Singular
from .linear import Linear
from .stages import Correction, Derivatives, Linearised, Middle, StageEquations, Stages
from .system import Array

STAGNANT = 0.1
"""An iteration that gets no further is accepted below this share of the tolerance: rounding near a singular position, say."""

ROUNDING, NEAR = 1e-15, 10.0
"""What iterations can reach, as a share of the system's length; and so many times that much is next to it."""

SLOW = 0.4
"""A contraction slower than this renews the derivatives in the middle of the iteration."""

STEADY = 0.1
"""The contraction that Newton's iteration with each stage's slopes is trusted to go on with: it starts faster."""

FEW = 4.0
"""What is left adds up over steps, whose number grows as (length / tolerance)^(1 / order): the goal falls with it from so much on."""

FED = 3.0
"""The energy that what is left may add to a step, in units of the goal (``StageEquations.fed``): where motions are smooth, each step adds as much."""

COUPLED_UP_TO = 50_000
"""Unknowns of all stages together up to which Newton's method with each stage's slopes costs less than the shorter steps it saves."""


class Outcome(NamedTuple):
    """How an iteration ended: its stages (where it failed: the best), the derivatives, the worst contraction and the last one seen, its
    iterations, the residual of g [s, m], and what went wrong, or ""."""

    x: Stages
    at: Derivatives
    rate: float
    trend: float
    solves: int
    residual: Array
    failure: str = ""


class Goal(NamedTuple):
    """Lengths: where an iteration has converged, where it may stop if it gets no further, and what its residual may feed in
    (``StageEquations.fed``); and the iterations it has."""

    converged: float
    enough: float
    fed: float
    iterations: int


def iterate(
    equations: StageEquations, linear: Linear, x: Stages, middle: Middle, tolerance: float, inputs: Any, iterations: int, slowest: float = 0.0
) -> Outcome:
    """The stages, from the guess x; ``inputs`` are those of the middle. Raises Singular.

    What is left at the goal does not show in the error estimate, nor in many steps together. ``slowest`` is a contraction seen before, which
    this iteration is not trusted to beat: the first correction mends most of what was guessed, those after it less."""
    system, goal = equations.system, _goal(equations, tolerance, iterations)
    spent, coupled = 0, not system.joints.linear and equations.table.stages * linear.size <= COUPLED_UP_TO
    try:
        found = _simplified(equations, linear, x, middle, inputs, Watch(equations, goal, slowest))
        if not found.failure or not coupled:
            return found
        x, middle, spent = found.x, middle_of(equations, found.x), found.solves
    except Singular:
        if not coupled:
            raise
    found = _full(equations, x, Coupled(equations, linear, x, middle, inputs), goal)
    return found._replace(solves=spent + found.solves)


def _goal(equations: StageEquations, tolerance: float, iterations: int) -> Goal:
    """What a tolerance asks for; next to rounding neither many steps nor energies ask for more."""
    length, once = equations.system.length, tolerance / equations.table.noise
    many = max((length / tolerance) ** (1.0 / (equations.table.stages + 1)) / FEW, 1.0)
    floor, near = ROUNDING * length, NEAR * ROUNDING * length
    converged = max(once / many, min(once, near), floor)
    return Goal(converged, max(STAGNANT * tolerance, NEAR * floor), FED * converged if converged > near else np.inf, iterations)


def middle_of(equations: StageEquations, x: Stages) -> Middle:
    """The middle of the step by the stage polynomials."""
    wide, narrow = equations.table.middle[1:], equations.table.middle_stages
    v = equations.v0 * (1.0 - wide.sum()) + wide @ x.v
    return Middle(equations.q0 + wide @ x.dq, v, narrow @ x.multipliers, narrow @ x.stress)


def _simplified(equations: StageEquations, linear: Linear, x: Stages, middle: Middle, inputs: Any, watch: Watch) -> Outcome:
    def at_middle(middle: Middle) -> Linearised:
        return Linearised(equations.system, linear, equations.table, equations.h, middle, inputs)

    goal, at, fresh = watch.goal, at_middle(middle), True
    for k in range(1, goal.iterations + 1):
        change = equations.correct(x, at)
        x, g = change.x, change.residual
        verdict = watch.judge(k, change, at)
        if k > 2 and fresh and watch.ratio > SLOW and verdict not in (CONVERGED, OVERFLOW):
            del at  # its factors make room for the new ones
            at, fresh = at_middle(middle_of(equations, x)), False
            watch.forget()
        elif verdict:
            return watch.outcome(verdict, x, at, k, g)
    return watch.outcome(f"Newton's iteration needs more than {goal.iterations} steps", x, at, goal.iterations, g)


def _full(equations: StageEquations, x: Stages, at: Coupled, goal: Goal) -> Outcome:
    watch = Watch(equations, goal, STEADY)
    for k in range(1, goal.iterations + 1):
        change = equations.correct(x, at)
        x, g = change.x, change.residual
        verdict = watch.judge(k, change, at)
        if verdict:
            return watch.outcome(verdict, x, at, k, g)
        if k == 1:
            watch.forget()  # the first change mends what the simplified iteration spoilt, and says nothing of the contraction
    return watch.outcome(f"Newton's iteration needs more than {goal.iterations} steps", x, at, goal.iterations, g)


CONVERGED, ENOUGH, OVERFLOW = "converged", "gets no further, but far enough", "Newton's iteration overflowed"


class Watch:
    """The sizes of successive changes, and what they say."""

    def __init__(self, equations: StageEquations, goal: Goal, slowest: float):
        self.equations, self.goal, self.slowest = equations, goal, slowest
        self.rate = self.ratio = self.trend = 0.0
        self._last: float | None = None
        self._best: tuple[float, Stages | None] = (np.inf, None)

    def forget(self) -> None:
        """The next ratio would compare two different iterations."""
        self._last = None

    def judge(self, k: int, change: Correction, at: Derivatives) -> str:
        """CONVERGED, ENOUGH, what is wrong, or "" to go on, after correction number k."""
        verdict = self._by_size(k, change)
        if verdict == CONVERGED and at.unseen(change.strains, change.stress_change) > self.goal.converged:
            return ""
        return verdict

    def _by_size(self, k: int, change: Correction) -> str:
        size = change.size
        if not np.isfinite(size):
            return OVERFLOW
        if size < self._best[0]:
            self._best = size, change.x
        last, self._last, self.ratio = self._last, size, 0.0
        if size <= 1e-2 * self.goal.converged:
            return CONVERGED
        if not last:
            return ""
        self.trend = min(size / last, 1.0)
        self.ratio = rate = max(size / last, self.slowest)
        self.rate = max(self.rate, rate)
        if rate < 1.0 and self._little(rate / (1.0 - rate), change):
            return CONVERGED
        hopeless = rate >= 1.0 or rate ** (self.goal.iterations - k) / (1.0 - rate) * size > self.goal.converged
        if k <= 2 or not hopeless:
            return ""
        return ENOUGH if size <= self.goal.enough else f"Newton's iteration does not contract (rate {rate:.2g})"

    def _little(self, share: float, change: Correction) -> bool:
        """Whether a share of the last change may be left."""
        goal = self.goal
        return share * change.size <= goal.converged and (goal.fed == np.inf or share * self.equations.fed(change) <= goal.fed)

    def outcome(self, verdict: str, x: Stages, at: Derivatives, k: int, g: Array) -> Outcome:
        if verdict in (CONVERGED, ENOUGH):
            return Outcome(x, at, self.rate, self.trend, k, g)
        return Outcome(self._best[1] or x, at, 1.0, 1.0, k, g, verdict)
