"""Equilibrium by Newton's method, with stresses iterated beside the coordinates, and loads that grow with the iteration.

    r2 = B(q)' sigma + G' lambda - load(q, s),   r5 = C strain(q) - sigma,   r3 = gamma(q) - c(s)
    [ K  G' ] [ dq      ]   [ -r2 - B' r5 ]        [ load'(s) ]
    [ G  0  ] [ dlambda ] = [ -r3         ]  +  ds [ c'(s)    ],    dsigma = r5 + C B dq

K is taken at the iterated stress, so that a steel beam may turn far in one iteration (Magisano, Leonetti and Garcea 2017, Int. J. Numer.
Methods Eng. 109). Both right sides are solved at once and ds is as large as the linearised motion stays short. A path is thus followed at
a distance of one iteration, and no iteration is spent on states that nobody asked for. Where it diverges it starts again from the last
state that was nearly in balance, with shorter motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from .formats import Singular
from .kkt import Kkt
from .linear import Linear, Tangent
from .system import Array, System

FARTHEST = 0.45
"""The longest motion in one iteration, as a share of the system's length."""

SHORTEST = 1e-4
NEAR = 0.05
"""A correction below this share of the longest motion: nearly in balance."""

PATIENCE = 12
"""Iterations without coming nearer before shorter motions are tried."""

CONVERGED = 1e-9
ROUNDING = 1e-6
"""A last correction, as a share of the length, that will do; and one that will where it no longer shrinks."""


class Path(Protocol):
    """Loads and targets that depend on a factor s; ``rate`` and ``target_rate`` are derivatives by s."""

    target_rate: Array
    longest: float  # of one change of s

    def load(self, q: Array, s: float) -> Array: ...
    def rate(self, q: Array) -> Array: ...
    def target(self, s: float) -> Array: ...
    def stiffness(self, q: Array, s: float, stress: Array, multipliers: Array) -> Array: ...


class Point(NamedTuple):
    """A state on a path, or on the way to it: factor, q [n], stresses [n_stresses], multipliers [m]."""

    s: float
    q: Array
    stress: Array
    multipliers: Array


class Change(NamedTuple):
    """Directions for a point: dq, dstress, dmultipliers, and the length of dq."""

    q: Array
    stress: Array
    multipliers: Array


class Problem(NamedTuple):
    """What the methods of statics work on."""

    system: System
    linear: Linear
    kkt: Kkt
    path: Path

    @classmethod
    def of(cls, system: System, linear: Linear, path: Path) -> Problem:
        return cls(system, linear, Kkt(system, linear), path)

    def size(self, dq: Array) -> float:
        """The longest motion, as a share of the system's length."""
        return float(np.max(np.abs(dq) * self.system.levers, initial=0.0)) / self.system.length

    def tangent(self, x: Point) -> Tangent:
        return self.linear.tangent(self.system.joints.at(x.q).gradient, self.path.stiffness(x.q, x.s, x.stress, x.multipliers))

    def settled(self, x: Point) -> Point:
        """The point with the stresses of its coordinates."""
        return x._replace(stress=self.system.modulus * self.system.strains(x.q).value) if self.system.n_stresses else x


class Linearised:
    """The equations at a point, factorised. Raises Singular."""

    def __init__(self, problem: Problem, x: Point, shift: float = 0.0):
        system, path = problem.system, problem.path
        self.problem, self.x = problem, x
        self.joints = system.joints.at(x.q)
        self.strains: Any = system.strains(x.q) if system.n_stresses else None
        self.tangent = problem.tangent(x)
        self.factor = problem.kkt.factor(self.tangent, shift)
        self.rate = path.rate(x.q)

    def _stress(self, dq: Array) -> Array:
        return self.problem.system.modulus * self.strains.push(dq) if self.strains else np.zeros((*dq.shape[:-1], 0))

    def residual(self) -> tuple[Array, Array, Array]:
        """-r2 - B' r5 [n], -r3 [m], r5 [n_stresses]."""
        x, path, excess = self.x, self.problem.path, np.zeros(0)
        balance = path.load(x.q, x.s) - self.joints.pull(x.multipliers)
        if self.strains:
            excess = self.problem.system.modulus * self.strains.value - x.stress
            balance = balance - self.strains.pull(x.stress + excess)
        return balance, path.target(x.s) - self.joints.value, excess

    def changes(self) -> tuple[Change, Change]:
        """Newton's correction, and the motion with s, per unit."""
        balance, gap, excess = self.residual()
        goal = np.broadcast_to(self.problem.path.target_rate, gap.shape)
        dq, dm = self.factor.solve(np.stack((balance, self.rate)), np.stack((gap, goal)))
        stress = self._stress(dq)
        return Change(dq[0], stress[0] + excess, dm[0]), Change(dq[1], stress[1], dm[1])


def moved(x: Point, ds: float, correction: Change, along: Change) -> Point:
    """The point after a correction and a step of s."""
    parts = (a + b + ds * c for a, b, c in zip(x[1:], correction, along))
    return Point(x.s + ds, *parts)


@dataclass
class Outcome:
    """Where the iteration ended: its last good point, what was spent, and why it failed, or ""; ``worst`` is the coordinate that moved most."""

    x: Point
    iterations: int
    restarts: int = 0
    failure: str = ""
    worst: int = -1

    def then(self, later: Outcome) -> Outcome:
        """The later outcome, with the work of both."""
        worst = later.worst if later.worst >= 0 else self.worst
        return Outcome(later.x, self.iterations + later.iterations, self.restarts + later.restarts, later.failure, worst)


def advance(problem: Problem, x: Point, end: float = 1.0, most: int = 1000) -> Outcome:
    """From a point near balance to balance at s = end."""
    farthest, good, since, best, before, out = FARTHEST, x, 0, np.inf, np.inf, Outcome(x, 0)
    while out.iterations < most:
        out.iterations += 1
        try:
            correction, along = Linearised(problem, x).changes()
            size = problem.size(correction.q)
            failure = "" if np.isfinite(size) and since < PATIENCE else "Newton's iteration diverges"
            out.worst = int(np.argmax(np.abs(correction.q) * problem.system.levers)) if np.isfinite(size) else out.worst
        except Singular as trouble:
            failure = f"the stiffness is singular ({trouble})"
            farthest = farthest if x is not good else 0.0
        if failure:
            farthest, since, best, before, x = 0.25 * farthest, 0, np.inf, np.inf, good
            out.restarts += 1
            if farthest < SHORTEST:
                out.x, out.failure = good, failure
                return out
            continue
        ds = _longest(problem, correction.q, along.q, end - x.s, farthest)
        since = 0 if ds or size < 0.7 * best else since + 1
        best = np.inf if ds else min(best, size)
        if size < NEAR * farthest:
            good = x
        x = moved(x, ds, correction, along)._replace(s=end if ds == end - x.s else x.s + ds)
        if x.s == end and not ds and (size < CONVERGED or (size < ROUNDING and size > 0.25 * before)):
            out.x = problem.settled(x)
            return out
        before = size
    out.x, out.failure = good, "too many iterations"
    return out


def _longest(problem: Problem, correction: Array, along: Array, rest: float, farthest: float) -> float:
    """The longest step of s, of its sign, with which the motion stays short; none while the correction itself is long."""
    levers = problem.system.levers / problem.system.length
    limit = np.sign(rest) * problem.path.longest
    ds = rest if abs(rest) <= 1.000001 * abs(limit) else limit
    room = farthest - np.sign(ds) * np.sign(along) * correction * levers
    if problem.size(correction) > farthest:
        return 0.0
    reach = float(np.min(room / np.maximum(np.abs(along) * levers, 1e-300)))
    return float(ds if abs(ds) <= reach else np.sign(ds) * reach)
