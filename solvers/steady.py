"""Relative equilibria: configurations p that turn steadily, (M S S) p + B' sigma(p) + G' lambda = f and g(p) = c, by Newton's method.

Dense, in scaled unknowns, by least squares: a free rotation leaves the position along itself open, and then p stays where it is nearest.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import lstsq

from .formats import dense
from .linear import Linear
from .system import Array, System

OPEN = 1e-14
"""Pivots below this share of the largest leave their motion open."""

SHORTEST = 1e-4
"""Of spin squared: steps of the centrifugal load become shorter where Newton's method fails, longer where it does not; here it is given up."""

CLOSE, SWEEPS = 1e-9, 25


class SteadyProblem(NamedTuple):
    """S [n, n], M [n, n], and the rates [n] of scalar coordinates at full spin."""

    system: System
    linear: Linear
    inputs: Any
    generator: Array
    mass: Array
    rates: Array


def steady_state(problem: SteadyProblem, q: Array) -> tuple[Array, float]:
    """p [n], reached from q as the spin grows, and the last correction as a share of the scene's length: above CLOSE there was none to be found."""
    done, step = 0.0, 1.0
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected
        while done < 1.0 and step > SHORTEST:
            reach = min(done + step, 1.0)
            p, left = _newton(problem, q, np.sqrt(reach))
            if left > CLOSE:
                step *= 0.25
            else:
                q, done, step = p, reach, 2.0 * step
    return q, left


def _newton(problem: SteadyProblem, q: Array, share: float) -> tuple[Array, float]:
    system = problem.system
    generator = share * problem.generator
    centrifugal = problem.mass @ generator @ generator
    multipliers, best = np.zeros(system.m), np.inf
    for _ in range(SWEEPS):
        change, multipliers = _correction(problem, q, multipliers, generator, centrifugal, share * problem.rates)
        size = float(np.max(np.abs(change) * system.levers, initial=0.0)) / system.length
        if not np.isfinite(size) or size > 10.0:
            return q, np.inf
        q = q + min(1.0, 0.5 / max(size, 1e-300)) * change
        if size < 1e-14 or (size < CLOSE and size >= 0.5 * best):
            return q, size
        best = size
    return q, best


def _correction(problem: SteadyProblem, q: Array, multipliers: Array, generator: Array, centrifugal: Array, rates: Array) -> tuple[Array, Array]:
    """dq [n] and the new multipliers [m]."""
    system, n, m = problem.system, problem.system.n, problem.system.m
    v = generator @ q + rates
    strains, joints = system.strains(q), system.joints.at(q)
    stress = system.stress(strains, v) if system.n_stresses else np.zeros(0)
    values = system.stiffness(q, v, problem.inputs, stress, multipliers)
    stiffness = dense(system.stiffness_rows, system.stiffness_cols, values, (n, n)) + centrifugal
    if system.damped:
        damping = system.damping(q, v, problem.inputs)
        stiffness += dense(system.damping_rows, system.damping_cols, damping, (n, n)) @ generator
    gradient = dense(system.joints.rows, system.joints.cols, joints.gradient, (m, n))
    matrix = np.block([[stiffness, gradient.T], [gradient, np.zeros((m, m))]])
    force = system.force(q, v, problem.inputs) - centrifugal @ q
    right = np.concatenate((force, problem.inputs.targets.value - joints.value))
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return np.full(n, np.nan), multipliers
    scale = problem.linear.scale
    matrix *= scale[:, None] * scale
    size = float(np.max(np.abs(matrix[:n, :n]), initial=0.0)) or 1.0  # stiffnesses and gradients as comparable numbers
    root = np.sqrt(size)
    weight = np.concatenate((np.full(n, 1.0 / root), np.full(m, root)))
    x = lstsq(matrix * weight[:, None] * weight, right * scale * weight, cond=OPEN, lapack_driver="gelsy", check_finite=False)[0]
    x = x * weight * scale
    return x[:n], x[n:]
