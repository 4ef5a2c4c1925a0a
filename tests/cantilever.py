"""Equilibria for tests, by Newton's method on the equations of a system: independent of the integrators."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import mbd

from .kinds import dense

SECTION = {"E": 1e6, "A": 1e-2, "I": 1e-5, "rho": 1000.0}


class Cantilever:
    """Scenes of a beam of 2 m, clamped at its start, with a share of a force [2] and torque at its end; ``item`` is the beam of the last."""

    item: Any

    def __init__(self, name: str, n: int, *, force: Any = (0, 0), torque: float = 0.0, **changes: Any):
        self.name, self.force, self.torque = name, np.asarray(force, dtype=float), torque
        self.words = {"start": (0, 0), "end": (2, 0), "n_elements": n, **SECTION, **changes}

    def __call__(self, share: float) -> mbd.Scene:
        scene = mbd.Scene(gravity=(0, 0))
        self.item = scene.add(getattr(mbd, self.name)(**self.words))
        scene.add(mbd.Clamp(self.item.start, scene.ground.at(0, 0), name="clamp"))
        scene.add(mbd.Torque(self.item.end, share * self.torque))
        scene.add(mbd.Force(self.item.end, share * self.force))
        return scene


def equilibria(make: Callable[[float], mbd.Scene], steps: int) -> Iterator[tuple[mbd.State, float]]:
    """Equilibria of ``make(load)`` -> scene for loads 1/steps, 2/steps, ..., 1, each from the one before."""
    state: tuple[np.ndarray, np.ndarray] | None = None
    for k in range(1, steps + 1):
        system = make(k / steps).build()
        q, multipliers = state if state is not None else (system.q0, np.zeros(system.m))
        for _ in range(60):
            q, multipliers, change = _newton(system, q, multipliers)
            if change < 1e-12 * system.length:
                break
        else:
            raise AssertionError(f"no equilibrium at load {k / steps}: changes of {change:.1e} m remain")
        state = q, multipliers
        yield mbd.State(q, np.zeros_like(q)), k / steps


def _newton(system: Any, q: np.ndarray, multipliers: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    still, n = np.zeros(system.n), system.n
    joints, inputs = system.joints.at(q), system.inputs(0.0)
    stress = system.stress(system.strains(q), still)
    k = dense(system.stiffness_rows, system.stiffness_cols, system.stiffness(q, still, inputs, stress, multipliers), (n, n))
    g = dense(system.joints.rows, system.joints.cols, np.broadcast_to(joints.gradient, system.joints.rows.shape), (system.m, n))
    matrix = np.block([[k, g.T], [g, np.zeros((system.m, system.m))]])
    right = np.concatenate((system.force(q, still, inputs) - joints.pull(multipliers), -joints.value))
    change = np.linalg.solve(matrix, right)
    size = float(np.max(np.abs(change[:n]) * np.where(system.levers > 0, system.levers, 1.0)))
    share = min(1.0, 0.2 * system.length / max(size, 1e-300))
    return q + share * change[:n], multipliers + share * change[n:], size
