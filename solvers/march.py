"""The only time loop: accepts or rejects attempts, records states, and says what failed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from .linear import Linear
from .pace import Pace
from .protocol import Attempt, Integrator, State
from .system import System


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
    state = record.states[-1]
    pace = Pace(state.t, t_end, first_step, method.fixed)
    while state.t < t_end:
        h = pace.offer(state.t)
        attempt = method.step(system, linear, state, h, tolerance)
        record.solves += attempt.solves
        if attempt.state is None:
            record.failed += 1
            pace.failed(h)
        elif attempt.error > 1.0 and method.fixed is None:
            record.rejected += 1
            pace.rejected(h, attempt)
        else:
            landed = attempt.state if h < t_end - state.t else attempt.state._replace(t=t_end)
            pace.accepted(landed.t, h, attempt)
            record.steps += 1
            record.work.append(record.work[-1] + (work(attempt) if work else 0.0))
            record.states.append(landed._replace(memory=method.kept(landed.memory)))
            state = landed
            if watch:
                watch(state)
            continue
        if pace.exhausted(state.t):
            record.failure = attempt.failure or "the estimated error stays above the tolerance"
            record.worst = attempt.worst
            break
