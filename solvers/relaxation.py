"""The next stable equilibrium downhill, where no path of balance leads to one.

Newton's method with K + c M in place of K: c makes it positive definite on the null space of G, so that every motion goes downhill, and
keeps motions short. As implicit steps of length 1/c of M q' = -residual it is pseudo-transient continuation (Kelley and Keyes 1998, SIAM J.
Numer. Anal. 35, 508-523): c falls as balance comes near, and the last iterations are Newton's own.
"""

from __future__ import annotations

import numpy as np

from .formats import Singular
from .statics import CONVERGED, FARTHEST, ROUNDING, Linearised, Outcome, Point, Problem, advance
from .system import Array

BEYOND = 0.02
"""How much further the loads are when the system is let go; four times as much each further time."""

FALLS = 25

NOTHING = 1e-8
"""Share of the first c below which none is left, but where the equilibrium is neutral."""

MOST = 1e12


def balance(problem: Problem, x: Point, end: float = 1.0) -> tuple[Outcome, list[float]]:
    """Balance at s = end along the path; where it breaks off, from the next stable equilibrium. Also the factors where it broke off."""
    out = advance(problem, x, end)
    breaks: list[float] = []
    while out.failure and len(breaks) < FALLS:
        further = min(BEYOND * 4.0 ** len(breaks), max(BEYOND, problem.path.longest))
        breaks.append(out.x.s)
        fallen = out.then(relax(problem, out.x._replace(s=min(out.x.s + further, end))))
        if fallen.failure:
            fallen.failure = f"{out.failure}; released there, {fallen.failure}"
        if fallen.failure or fallen.x.s == end:
            return fallen, breaks
        out = fallen.then(advance(problem, fallen.x, end))
    return out, breaks


def relax(problem: Problem, x: Point, most: int = 400) -> Outcome:
    """From any point near the joints to a stable (or neutral) equilibrium at its s; a point in balance stays, stable or not."""
    out = Outcome(x, 0)
    try:
        x, first = _released(problem, problem.settled(x))
    except Singular as trouble:
        out.failure = f"the joints lock ({trouble})"
        return out
    if not first:
        out.x = x
        return out
    shift, before = first if _size(problem, x) > CONVERGED else 0.0, np.inf
    while out.iterations < most and shift < MOST * first:
        out.iterations += 1
        change = _downhill(problem, x, shift)
        if change is None or not (size := problem.size(change[0])) <= FARTHEST:
            shift = max(4.0 * shift, NOTHING * first)
            continue
        dq, multipliers = change
        x = problem.settled(x._replace(q=x.q + dq, multipliers=x.multipliers + multipliers))
        out.worst = int(np.argmax(np.abs(dq) * problem.system.levers))
        if shift <= NOTHING * first and (size < CONVERGED or (size < ROUNDING and size > 0.25 * before)):
            out.x = x
            return out
        before, shift = size, 0.25 * shift if shift > NOTHING * first else 0.0
    out.x, out.failure = x, "nothing brings it to rest"
    return out


def _released(problem: Problem, x: Point) -> tuple[Point, float]:
    """The point with the multipliers of its release from rest, and the c with which a step would be as long as allowed."""
    system, linear = problem.system, problem.linear
    joints = system.joints.at(x.q)
    force = problem.path.load(x.q, x.s)
    if system.n_stresses:
        force = force - system.strains(x.q).pull(x.stress)
    a, multipliers = linear.factor(linear.tangent(joints.gradient)).solve(force, np.zeros(system.m))
    return x._replace(multipliers=multipliers), problem.size(a) / FARTHEST


def _size(problem: Problem, x: Point) -> float:
    """The length of Newton's correction; infinite where there is none."""
    try:
        return problem.size(Linearised(problem, x).changes()[0].q)
    except Singular:
        return np.inf


def _downhill(problem: Problem, x: Point, shift: float) -> tuple[Array, Array] | None:
    """dq and dlambda with K + shift M; None unless it is positive definite on the null space of G, or the point in balance already."""
    try:
        at = Linearised(problem, x, shift)
        change = at.changes()[0]
        if problem.size(change.q) > CONVERGED and problem.kkt.negatives(at.tangent, shift) > 0:
            return None
    except Singular:
        return None
    return (change.q, change.multipliers) if np.isfinite(change.q).all() else None
