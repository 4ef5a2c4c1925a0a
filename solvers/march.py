"""The only time loop: chooses steps, accepts or rejects attempts, records states, and says what failed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .linear import Linear
from .protocol import Attempt, Integrator, State
from .system import System

SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0
CONTRACTION = 0.35
"""Newton's rate that steps aim at. Where tolerances are loose it is what limits them, and it grows with about their fourth power."""

BELOW_FAILURE, RELAX = 0.7, 1.15
"""After a failed iteration steps stay below this share of the failed one; the limit relaxes by this factor with each easy step."""


@dataclass
class Record:
    """Accepted states of a run and what it cost."""

    states: list[State]
    work: list[float] = field(default_factory=lambda: [0.0])
    steps: int = 0
    rejected: int = 0
    failed: int = 0
    solves: int = 0
    failure: str = ""
    worst: int = -1


def march(
    system: System,
    linear: Linear,
    method: Integrator,
    record: Record,
    t_end: float,
    tolerance: float,
    first_step: float,
    *,
    work: Callable[[Attempt], float] | None = None,
    watch: Callable[[State], None] | None = None,
) -> None:
    """Steps from the record's last state to t_end. Stops early, with ``failure`` set, where steps become too short."""
    start = state = record.states[-1]
    h = min(method.fixed or first_step, t_end - start.t)
    history: tuple[float, float] | None = None
    ceiling = np.inf
    span = t_end - start.t
    while state.t < t_end:
        remaining = t_end - state.t
        if h >= remaining * (1.0 - 1e-10):
            h = remaining
        elif method.fixed is None and h > 0.55 * remaining:
            h = 0.5 * remaining
        attempt = method.step(system, linear, state, h, tolerance)
        record.solves += attempt.solves
        if attempt.state is not None and (attempt.error <= 1.0 or method.fixed is not None):
            record.steps += 1
            h_next, history = _grown(h, attempt, history)
            ceiling *= RELAX if attempt.rate < CONTRACTION else 1.0
            h_next = min(h_next, ceiling)
            landed = attempt.state if h < remaining else attempt.state._replace(t=t_end)
            record.work.append(record.work[-1] + (work(attempt) if work else 0.0))
            record.states.append(landed._replace(memory=method.kept(landed.memory)))
            state = landed
            h = h_next if method.fixed is None else method.fixed
            if watch:
                watch(state)
            continue
        if attempt.state is None:
            record.failed += 1
            h, ceiling = 0.5 * h, BELOW_FAILURE * h
        else:
            record.rejected += 1
            h *= max(SHRINK, SAFETY * attempt.error ** (-1.0 / attempt.order))
        if h < 1e-12 * span or h < 4.0 * np.spacing(max(abs(state.t), abs(t_end))):
            record.failure = attempt.failure or "the estimated error stays above the tolerance"
            record.worst = attempt.worst
            break


def _grown(h: float, attempt: Attempt, history: tuple[float, float] | None) -> tuple[float, tuple[float, float]]:
    """The next step: by the error, by its trend (Gustafsson 1994), and by Newton's contraction."""
    error = max(attempt.error, 1e-8)
    factor = SAFETY * error ** (-1.0 / attempt.order)
    if history is not None:
        last_h, last_error = history
        factor = min(factor, SAFETY * (h / last_h) * (last_error / error**2) ** (1.0 / attempt.order))
    by_contraction = (CONTRACTION / max(attempt.rate, 1e-4)) ** 0.25
    return h * min(max(factor, SHRINK), max(by_contraction, 0.5), GROW), (h, error)
