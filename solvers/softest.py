"""The softest motion of a state: K x + G' y = mu M x, G x = 0 with the mu nearest to zero, by inverse iteration."""

from __future__ import annotations

import numpy as np

from .formats import Singular
from .kkt import NEUTRAL
from .statics import Point, Problem
from .system import Array

SWEEPS = 60


def softest(problem: Problem, x: Point, guess: Array | None = None) -> tuple[float, Array]:
    """mu and the motion [n], x' M x = 1, continuing the sign of a guess; raises Singular."""
    system, kkt, tangent = problem.system, problem.kkt, problem.tangent(x)
    shift = 0.0
    try:
        factor = kkt.factor(tangent)
    except Singular:
        shift = 10.0 * NEUTRAL * kkt.buffer(tangent, 0.0)[1]
        factor = kkt.factor(tangent, shift)
    phi = np.random.default_rng(1).standard_normal(system.n) * problem.linear.scale[: system.n] if guess is None else guess
    still, mu = np.zeros(system.m), np.inf
    for _ in range(SWEEPS):
        previous, momentum = mu, system.mass(phi)
        new, _ = factor.solve(momentum, still)
        along, square = float(new @ momentum), float(new @ system.mass(new))
        mu = along / square - shift
        phi = new * (np.sign(along if guess is None else new @ system.mass(guess)) or 1.0) / np.sqrt(square)
        if abs(mu - previous) <= 1e-10 * abs(mu):
            break
    return mu, phi
