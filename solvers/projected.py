"""Explicit Runge-Kutta of order 8 on the accelerations, projected to the joints after each step: for systems where nothing is stiff.

Dormand and Prince's method (``nystrom.py``) for q'' = a(q, q', t) with index-1 accelerations (``index_one.py``); positions, then
velocities, are projected at the end of each step. Hairer, Norsett and Wanner (1993), II.10; Eich (1993), SIAM J. Numer. Anal. 30.
A step whose stages come near a singular position of the joints is taken in two parts that avoid it (``stride.py``, ``leap.py``); where that does
not help it fails and says so: it is for an implicit method to go on (``automatic.py``).
"""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np

from .between import value
from .formats import Singular
from .index_one import index_one
from .linear import Linear
from .places import NEARLY_SINGULAR
from .protocol import Attempt, State
from .start import Inconsistent
from .stride import Stride
from .system import Array, System
from .workspace import Memory, Workspace


@dataclass(frozen=True)
class DormandPrince:
    """Explicit, order 8, with projection to the joints and error control; for scenes without stiff elements."""

    def integrator(self, rtol: float) -> ProjectedExplicit:
        """The method for a tolerance."""
        return ProjectedExplicit()


class _Prepared(threading.local):
    """What a method has prepared for the system asked last, in each thread its own; its making costs as much as a step."""

    workspace: Workspace | None = None


class ProjectedExplicit:
    """The method."""

    name = "projected Dormand-Prince (order 8, explicit)"
    fixed: float | None = None

    def __init__(self) -> None:
        self._prepared = _Prepared()

    def __reduce__(self) -> tuple[type, tuple[()]]:
        return ProjectedExplicit, ()

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        """A step over which velocities and accelerations move things by a modest part of the length."""
        speed = float(np.max(np.abs(state.v) * system.levers, initial=0.0))
        pull = float(np.max(np.abs(acceleration) * system.levers, initial=0.0))
        reach = system.length * (tolerance / system.length) ** (1.0 / 8.0)
        steps = [span, *([reach / speed] if speed > 0.0 else []), *([np.sqrt(2.0 * reach / pull)] if pull > 0.0 else [])]
        return 0.1 * min(steps)

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are the ends of shorter ones."""

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h; ``tolerance`` is a length: the local error allowed in positions."""
        stride = Stride(system, self._workspace(system, linear), tolerance)
        try:
            return stride.take(stride.remembered(state), state, h)
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 0.0, 0, f"singular equations ({trouble})")

    def _workspace(self, system: System, linear: Linear) -> Workspace:
        workspace = self._prepared.workspace
        if workspace is None or workspace.linear is not linear:
            workspace = self._prepared.workspace = Workspace(linear, index_one(system, linear))
        return workspace

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the ends of steps of their own from its start, as accurate as the step itself."""
        workspace, w = self._workspace(system, linear), []
        try:
            start = workspace.remembered(system, before.t, workspace.form.enter(before.q, before.v), NEARLY_SINGULAR)

            def reached(t: float) -> Memory:
                return workspace.reached(system, start, before.t, t - before.t, NEARLY_SINGULAR) if t > before.t else start

            for t in times.tolist():
                w.append(value(reached, t, before.t, after.t))
        except (Singular, Inconsistent) as trouble:
            raise ArithmeticError(f"no interpolation at {t:.9g} s: the joints are in a nearly singular position ({trouble})") from None
        return workspace.form.leave(np.array(w))
