"""The only time loop: accepts or rejects attempts, records states, and says what failed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from .linear import Linear
from .pace import Pace
from .protocol import Attempt, Integrator, State
from .system import System


class Counts(NamedTuple):
    """Accepted, rejected and failed steps, Newton iterations, and the sum of the errors estimated in accepted steps, over the tolerance."""

    steps: int = 0
    rejected: int = 0
    failed: int = 0
    solves: int = 0
    error: float = 0.0


@dataclass
class Record:
    """Accepted states of a run and what it cost; where it failed, why, the equation most to blame (-1: none), and whether
    steps were as short as the clock can tell."""

    states: list[State]
    counts: Counts = field(default_factory=Counts)
    failure: str = ""
    worst: int = -1
    late: bool = False

    def accept(self, state: State, error: float) -> None:
        self.counts = self.counts._replace(steps=self.counts.steps + 1, error=self.counts.error + error)
        self.states.append(state)

    def tried(self, attempt: Attempt) -> None:
        """The iterations of an attempt, accepted or not."""
        self.counts = self.counts._replace(solves=self.counts.solves + attempt.solves)

    def refuse(self, attempt: Attempt) -> None:
        failed, counts = attempt.state is None, self.counts
        self.counts = counts._replace(failed=counts.failed + failed, rejected=counts.rejected + (not failed))


def march(
    system: System,
    linear: Linear,
    method: Integrator,
    record: Record,
    state: State,
    pace: Pace,
    tolerance: float,
    *,
    note: Callable[[Attempt], None] = lambda attempt: None,
    watch: Callable[[State, Attempt], Attempt | None] = lambda before, attempt: None,
) -> Iterator[State]:
    """Steps from a state, the record's last one and what the method remembers there, to the end of the pace. Yields the state before each
    step: there, and only there, all that goes on from it is consistent. Stops early, with ``failure`` set, where steps become too short.

    note   is told of each step as it was recorded
    watch  sees each step before that; it may give a shorter one in its place, with which the run ends
    """
    t_end = pace.t_end
    while state.t < t_end:
        yield state
        tried = _accepted(system, linear, method, record, state, pace, tolerance)
        if tried is None:
            return
        attempt, stopped = tried
        last = watch(state, attempt)
        if last is not None and last.state is not None:
            attempt, t_end = last, last.state.t
            record.tried(last)
        landed = attempt.state
        assert landed is not None
        record.accept(landed._replace(memory=method.kept(landed.memory)), attempt.error)
        note(attempt)
        state = landed._replace(memory=None) if stopped else landed  # no forecast reaches across what may jump at a stop


def _accepted(
    system: System, linear: Linear, method: Integrator, record: Record, state: State, pace: Pace, tolerance: float
) -> tuple[Attempt, bool] | None:
    """The first attempt that is accepted, and whether it lands on a stop; None where steps become too short."""
    while True:
        h, stop = pace.offer(state.t)
        attempt = method.step(system, linear, state, h, tolerance)
        record.tried(attempt)
        if attempt.state is not None and (attempt.error <= 1.0 or method.fixed is not None):
            landed = attempt.state if stop is None else attempt.state._replace(t=stop)
            pace.accepted(landed.t, h, attempt)
            return attempt._replace(state=landed), stop is not None
        record.refuse(attempt)
        pace.refused(h, attempt)
        if pace.exhausted(state.t):
            record.failure, record.worst = attempt.failure or "the estimated error stays above the tolerance", attempt.worst
            record.late = pace.late(state.t)
            return None
