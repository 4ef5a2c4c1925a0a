"""Consistent starts: positions and velocities projected to the equations with the least motion in the sense of the mass matrix, then
accelerations and multipliers from the index-1 equations

    [ M  G' ] [ a      ]   [ f(q, v, t)              ]
    [ G  0  ] [ lambda ] = [ c''(t) - v' d2g/dq2 v   ].

Driven equations are gamma(q) = c(t): projections take the values of c and c' that they shall meet.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .formats import Singular, dense
from .linear import Factor, Linear
from .protocol import State
from .system import STILL, Array, System, Targets, targets

CONSISTENT = 1e-13
"""Largest |g| / length and |G v| / speed left by a projection."""

REDUNDANT = 1e-9
"""Singular values of the scaled G below this times the largest count as zero."""

DOUBTFUL = 1e-13
"""Estimated reciprocal condition of the mass KKT matrix below which singular values decide: of singular ones it may be above rounding."""


class Defect(NamedTuple):
    """Equations that cannot be met, or are met twice: what is wrong with which rows."""

    what: str
    rows: list[int]
    coordinates: list[int]


class Inconsistent(ArithmeticError):
    """No consistent start; ``defect`` says which equations or coordinates are to blame."""

    def __init__(self, defect: Defect):
        self.defect = defect
        super().__init__(defect.what)


def mass_factor(system: System, linear: Linear, q: Array) -> Factor:
    """The KKT matrix of the mass at q, factorised: once and for all where G is constant. Raises Singular."""
    if not system.joints.linear:
        return linear.factor(linear.tangent(system.joints.at(q).gradient))
    if linear.constant_factor is None:
        linear.constant_factor = linear.factor(linear.tangent(system.joints.at(q).gradient))
    return linear.constant_factor


def refuse_slips(system: System, method: str) -> None:
    """Raises ValueError for nonholonomic rows."""
    if system.joints.slips.size:
        names = ", ".join(dict.fromkeys(repr(system.label(int(row))) for row in system.joints.slips))
        raise ValueError(f"{method}: expected joints that hold positions, found nonholonomic {names}; use Radau or DormandPrince")


def project_positions(
    system: System, linear: Linear, q: Array, target: Array = STILL.value, *, factor: Factor | None = None, sweeps: int = 50, allowed: float = 0.0
) -> Array:
    """q with gamma(q) = target, by Newton's method (with a given factor: the simplified one). Nonholonomic rows do not hold it back.

    Raises Inconsistent where it does not converge, unless a residual of at most the length ``allowed`` was reached on the way.
    """
    if not system.m:
        return q
    floor = floor_of(system, q)
    best, nearest, fresh, pull = np.inf, q, factor is None or bool(system.joints.slips.size), np.zeros(system.m)
    for _ in range(sweeps):
        joints = system.joints.at(q)
        gap = joints.value - target
        residual = np.abs(gap) * linear.reach
        worst = float(residual.max())
        if worst <= floor or (worst <= 100.0 * floor and worst >= best):
            return q
        if not np.isfinite(worst):
            break
        if worst < best:
            best, nearest = worst, q
        if fresh:
            factor = linear.factor(linear.tangent_of_positions(joints.gradient))
        assert factor is not None
        change, pull = factor.solve(np.zeros(system.n), -gap)
        limit = 0.5 * system.length / max(float((np.abs(change) * system.levers).max()), 1e-300)
        q = q + min(1.0, limit) * change
    if best <= allowed:
        return nearest
    effort = np.abs(pull) / linear.scale[system.n :]
    stuck = [int(row) for row in np.flatnonzero((residual > 0.1 * worst) | (effort > 0.1 * np.max(effort, initial=0.0)))]
    raise Inconsistent(Defect(f"positions cannot satisfy them together (a distance of {worst:.6g} remains)", stuck, []))


def settle(x: Array, gap: Callable[[Array], Array], correction: Callable[[Array], Array], reach: Array, floor: float, *, sweeps: int = 8) -> Array:
    """x with gap(x) = 0 [m], m > 0, to the length ``floor``, from nearby: x - correction(gap) again and again. Raises Inconsistent."""
    best = np.inf
    for _ in range(sweeps):
        distance = gap(x)
        worst = float(np.maximum.reduce(np.abs(distance * reach)))
        if worst <= floor or (worst <= 100.0 * floor and worst >= best):
            return x
        if not math.isfinite(worst):
            break
        best = min(best, worst)
        x = x - correction(distance)
    rows = [int(row) for row in np.flatnonzero(np.abs(distance) * reach > 0.1 * worst)]
    raise Inconsistent(Defect(f"positions cannot satisfy them together (a distance of {worst:.6g} remains)", rows, []))


def floor_of(system: System, q: Array) -> float:
    """The residual of equations, as a length, that rounding leaves."""
    return max(CONSISTENT * system.length, 4e-16 * float(np.abs(q).max()))


def project_velocities(system: System, factor: Factor, q: Array, v: Array, target: Array = STILL.rate, *, sweeps: int = 8) -> Array:
    """v with G v = target, by the mass KKT matrix at q or near it; what remains shows in an audit."""
    if not system.m:
        return v
    joints, reach = system.joints.at(q), factor.linear.reach
    best, floor = np.inf, CONSISTENT * float((np.abs(v) * system.levers).max())
    for _ in range(sweeps):
        slip = joints.push(v) - target
        worst = float((np.abs(slip) * reach).max())
        if worst <= floor or worst >= best:
            break
        best = worst
        v = v + factor.solve(np.zeros(system.n), -slip)[0]
    return v


def project_samples(system: System, linear: Linear, q: Array, v: Array, goal: Targets) -> tuple[Array, Array]:
    """q, v [k, n] near the joints, each projected to them as they are at its time."""
    q, v = q.copy(), v.copy()
    values, rates = (np.broadcast_to(x, (len(q), system.m)) for x in (goal.value, goal.rate))
    for k in range(len(q)):
        q[k] = project_positions(system, linear, q[k], values[k])
        v[k] = project_velocities(system, mass_factor(system, linear, q[k]), q[k], v[k], rates[k])
    return q, v


def hermite(before: State, after: State, fraction: Array) -> tuple[Array, Array]:
    """q, v [k, n] on the cubic between two states, at fractions [k] of the step; [k, steps, n] where states of several steps are stacked,
    with their times as [steps, 1]."""
    x, h = fraction.reshape(-1, *(1,) * before.q.ndim), after.t - before.t
    jump = after.q - before.q
    q = before.q + (3.0 * x**2 - 2.0 * x**3) * jump + h * ((x - 2.0 * x**2 + x**3) * before.v + (x**3 - x**2) * after.v)
    v = (6.0 * x - 6.0 * x**2) * jump / h + (1.0 - 4.0 * x + 3.0 * x**2) * before.v + (3.0 * x**2 - 2.0 * x) * after.v
    return q, v


def accelerations(system: System, factor: Factor, q: Array, v: Array, inputs: Any) -> tuple[Array, Array]:
    """a [n] and multipliers [m] at a consistent state; ``factor`` is the mass KKT matrix at q."""
    strains = system.strains(q)
    force = system.load(q, v, inputs)
    if system.n_stresses:
        force = force - strains.pull(system.stress(strains, v))
    joints = system.joints.at(q)
    bias = targets(inputs).acceleration - joints.bias(v)
    a, multipliers = factor.solve(force, bias)
    for _ in range(2 if factor.linear.softened else 0):
        da, more = factor.solve(force - system.mass(a) - joints.pull(multipliers), bias - joints.push(a))
        a, multipliers = a + da, multipliers + more
    return a, multipliers


def dense_gradient(system: System, q: Array) -> Array:
    """G [m, n] at q."""
    joints = system.joints
    return dense(joints.rows, joints.cols, joints.at(q).gradient, (system.m, system.n))


def scaled_gradient(system: System, linear: Linear, q: Array) -> Array:
    """G [m, n] at q, in scaled unknowns."""
    return dense_gradient(system, q) * (linear.scale[system.n :, None] * linear.scale[: system.n])


def redundancy(system: System, linear: Linear, q: Array) -> Defect | None:
    """The equations that are met twice at q, or the coordinates without inertia that nothing holds; None where all is regular.
    A matrix softened before tells nothing: then singular values alone decide."""
    doubtful = linear.softened
    if not linear.softened:
        try:
            if mass_factor(system, linear, q).rcond > DOUBTFUL:
                return None
            doubtful = True
        except Singular:
            pass
    left, sizes, right = np.linalg.svd(scaled_gradient(system, linear, q))
    rank = int(np.sum(sizes > REDUNDANT * max(float(sizes.max(initial=0.0)), 1e-300)))
    rows: list[int] = []
    if rank < system.m:
        weight = np.max(np.abs(left[:, rank:]), axis=1)
        rows = [int(row) for row in np.flatnonzero(weight > 1e-6)]
    coordinates = _loose(system, linear, right[rank:]) if rank < system.n else []
    if doubtful and not rows and not coordinates:
        return None
    what = f"{system.m - rank} of {system.m} equations follow from the others" if rows else "no inertia and no joint determines them"
    return Defect(what, rows, coordinates)


def _loose(system: System, linear: Linear, free: Array) -> list[int]:
    """The coordinates that may move, free [k, n] in scaled units, without moving any mass."""
    motions = free * linear.scale[: system.n]
    values, vectors = np.linalg.eigh(motions @ system.mass(motions).T)
    loose = vectors[:, values < 1e-12].T @ free
    return [int(c) for c in np.flatnonzero(np.max(np.abs(loose), axis=0, initial=0.0) > 1e-6)]
