"""The only time loop: accepts or rejects attempts, records states, and says what failed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .linear import Linear
from .pace import Pace
from .protocol import Attempt, Integrator, State
from .system import System


@dataclass
class Record:
    """Accepted states of a run, what it cost, and the sum of the errors estimated in its steps, over the tolerance."""

    states: list[State]
    steps: int = 0
    rejected: int = 0
    failed: int = 0
    solves: int = 0
    error: float = 0.0
    failure: str = ""
    worst: int = -1

    def accept(self, state: State, error: float) -> None:
        self.steps += 1
        self.error += error
        self.states.append(state)

    def refuse(self, attempt: Attempt) -> None:
        self.failed += attempt.state is None
        self.rejected += attempt.state is not None


def march(
    system: System,
    linear: Linear,
    method: Integrator,
    record: Record,
    t_end: float,
    tolerance: float,
    first_step: float,
    *,
    stops: Sequence[float] = (),
    note: Callable[[Attempt], None] = lambda attempt: None,
    watch: Callable[[State, Attempt], Attempt | None] = lambda before, attempt: None,
) -> None:
    """Steps from the record's last state to t_end. Stops early, with ``failure`` set, where steps become too short.

    stops  ascending times before t_end: steps end on them, and the next starts anew, as no forecast reaches across what may jump there
    note   is told of each step as it was recorded
    watch  sees each step before that; it may give a shorter one in its place, with which the run ends
    """
    state = record.states[-1]
    pace = Pace(state.t, (*stops, t_end), first_step, method.fixed)
    while state.t < t_end:
        h, stop = pace.offer(state.t)
        attempt = method.step(system, linear, state, h, tolerance)
        record.solves += attempt.solves
        if attempt.state is not None and (attempt.error <= 1.0 or method.fixed is not None):
            landed = attempt.state if stop is None else attempt.state._replace(t=stop)
            pace.accepted(landed.t, h, attempt)
            last = watch(state, attempt._replace(state=landed))
            if last is not None and last.state is not None:
                attempt, landed, t_end = last, last.state, last.state.t
                record.solves += last.solves
            record.accept(landed._replace(memory=method.kept(landed.memory)), attempt.error)
            note(attempt)
            state = landed if stop is None else landed._replace(memory=None)
            continue
        record.refuse(attempt)
        pace.refused(h, attempt)
        if pace.exhausted(state.t):
            record.failure, record.worst = attempt.failure or "the estimated error stays above the tolerance", attempt.worst
            break
