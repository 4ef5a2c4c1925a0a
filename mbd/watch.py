"""Looking for events in the steps of a run.

Each accepted step is looked at twice. First roughly, at the method's own samples: stages come free of charge, and the cubics between them
fill the gaps. Only where these show a crossing, or something near one, the dense output is asked, for few batches of times
(``crossings.py``). A terminal event ends the run with a step of its own, so that the last state is as good as that of any other step.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .crossings import crossings
from .errors import SimulationError
from .event import Event, Events, Instant, Times, event_value

PRECISION = 1e-10  # of an event's time, as a share of the step
AT_START = 1e-9  # a value below this share of those in the first step is zero at the start
STORM, LATELY = 300, 100  # so many crossings in so many steps: the function varies faster than the motion, or is rounding
COARSE = 0.2  # gaps between a method's own samples above this share of the step are filled
ENDINGS = 5  # tries to end a step at zero

STORMY = (
    "let the function vary no faster than the motion",
    "give it a threshold if it stays at zero but for rounding: an event is a passage through zero, not a state of rest there",
    "give it a direction, 1 or -1, if it should count one way only",
)
UNSEEN = (
    "ask for a smaller rtol or step, so that events lie in shorter steps",
    "let the function be zero elsewhere than where bars come into line: joints are singular there",
    "leave the event out and look for it in the result: result.position(marker, t=...)",
)
UNENDED = (
    "ask for a smaller rtol or step",
    "let the event happen a little earlier, away from a jump of a load or from where bars come into line",
    "make it terminal=False and cut the result at result.events[...]",
)


class Seen(NamedTuple):
    """How often each event was found, and its value at the end of the last step."""

    counts: dict[str, int]
    last: dict[str, float]


class Watch:
    """Looks for events in the steps of a run: ``inspect`` sees each of them, ``events`` tells what was found, ``ended_by`` what stopped it."""

    def __init__(self, events: dict[str, Event], system: Any, linear: Any, method: Any, tolerance: float):
        self._events, self._system, self._linear, self._method, self._tolerance = events, system, linear, method, tolerance
        self._found: dict[str, list[Instant]] = {name: [] for name in events}
        self._starts: deque[float] = deque(maxlen=LATELY)
        self._last: dict[str, float] = {}
        self.ended_by: str | None = None

    @property
    def seen(self) -> Seen:
        return Seen({name: len(found) for name, found in self._found.items()}, dict(self._last))

    def rewind(self, seen: Seen, starts: Sequence[float], events: Events | None = None) -> None:
        """Back to what had been seen after steps from these times; of another run's events, if they are given."""
        found = self._found if events is None else {name: [Instant(float(t), q, v) for t, q, v in zip(*events[name])] for name in self._events}
        self._found = {name: list(instants[: seen.counts[name]]) for name, instants in found.items()}
        self._starts, self._last, self.ended_by = deque(starts[-LATELY:], maxlen=LATELY), dict(seen.last), None

    @property
    def events(self) -> Events:
        return Events({name: Times.of(found, self._system.n) for name, found in self._found.items()}, self._events)

    def inspect(self, before: Any, attempt: Any) -> Any:
        """Records the events of an accepted step; where a terminal one is among them, gives the shorter step that ends with it."""
        step = _Step(self, before, attempt)
        self._starts.append(before.t)
        found = [(t, name) for name in self._events for t in self._times(name, step)]
        for t, name in sorted(found):
            if self._events[name].terminal:
                self.ended_by = name
                last = attempt._replace(solves=0) if step.end - t <= step.resolution else self._ending(name, step, t)
                self._found[name].append(Instant(*last.state[:3]))
                return last
            self._found[name].append(step.exact[t])
        return None

    def _times(self, name: str, step: _Step) -> list[float]:
        """Of one event in a step. Its value at the end is kept as the first one of the next step."""
        values = np.array([0.0, *(self.value(name, x) for x in step.rough[1:])])
        values[0] = self._last.get(name, np.nan)
        if name not in self._last:
            first = self.value(name, step.rough[0])
            values[0] = first if abs(first) > AT_START * np.max(np.abs(values[1:])) else 0.0
        self._last[name] = values[-1]
        found = crossings(np.array([x.t for x in step.rough]), values, lambda times: step.look(name, times), step.resolution)
        wanted = [t for t, way in found if self._events[name].direction in (0, way)]
        lately = len(wanted) + sum(instant.t > self._starts[0] for instant in self._found[name][-STORM:])
        if lately > STORM:
            raise SimulationError(f"the event happened {lately} times in {len(self._starts)} steps", time=step.end, item=name, advice=STORMY)
        return wanted

    def value(self, name: str, instant: Instant) -> float:
        """The event's function at a state. Raises SimulationError where it fails."""
        return event_value(self._events[name], name, instant, instant.t)

    def inside(self, name: str, before: Any, after: Any, times: Array) -> list[Instant]:
        """States on the dense output."""
        try:
            q, v = self._method.inside(self._system, self._linear, before, after, times)
        except ArithmeticError as error:
            raise SimulationError(str(error), time=before.t, item=name, advice=UNSEEN) from error
        return [Instant(*state) for state in zip(times.tolist(), q, v)]

    def _ending(self, name: str, step: _Step, t: float) -> Any:
        """The step taken anew to end at t, then where the secant of its own ends says, until its last value is as near zero as it gets."""
        t_before = min(step.exact, key=lambda x: abs(abs(x - t) - 0.05 * (step.end - step.before.t)))  # near, but not too near for a slope
        value_before = self.value(name, step.exact[t_before])
        best, least, solves = None, np.inf, 0
        for _ in range(ENDINGS):
            last = self._shorter(name, step.before, t)
            value, solves = self.value(name, Instant(*last.state[:3])), solves + last.solves
            if abs(value) < least:
                best, least = last, abs(value)
            change = -value * (t - t_before) / (value - value_before) if value != value_before else 0.0
            if not 2.0 * np.spacing(abs(t)) < abs(change) < 0.1 * (t - step.before.t):
                break
            t_before, value_before, t = t, value, min(t + change, step.end)
        assert best is not None
        return best._replace(solves=solves)

    def _shorter(self, name: str, before: Any, t: float) -> Any:
        for slack in (1.0, 100.0):  # the estimated error of a shorter step need not be smaller
            attempt = self._method.step(self._system, self._linear, before, t - before.t, slack * self._tolerance)
            if attempt.state is not None and (attempt.error <= 1.0 or self._method.fixed is not None):
                return attempt._replace(state=attempt.state._replace(t=t))
        what = f"the step that shall end with the event fails ({attempt.failure or 'its error is too large'})"
        raise SimulationError(what, time=before.t, item=name, advice=UNENDED)


class _Step:
    """A step under inspection: rough samples from its start to its end, and exact states by time."""

    def __init__(self, watch: Watch, before: Any, attempt: Any):
        self.watch, self.before, self.after, self.end = watch, before, attempt.state, attempt.state.t
        self.rough = _rough(before, attempt)
        self.exact = {x.t: x for x in (self.rough[0], self.rough[-1])}
        self.resolution = PRECISION * (self.end - before.t)

    def look(self, name: str, times: Array) -> Array:
        """Values of an event's function on the dense output."""
        new = np.array([t for t in times.tolist() if t not in self.exact])
        if new.size:
            self.exact |= {x.t: x for x in self.watch.inside(name, self.before, self.after, new)}
        return np.array([self.watch.value(name, self.exact[t]) for t in times.tolist()])


def _rough(before: Any, attempt: Any) -> list[Instant]:
    """The ends of a step, exact, and between them the method's samples with cubics in wide gaps."""
    from .solvers.start import hermite

    start, end = Instant(*before[:3]), Instant(*attempt.state[:3])
    h, known = end.t - start.t, [start]
    if attempt.nodes is not None:
        for t, q, v in sorted(zip(*attempt.nodes[:3]), key=lambda node: node[0]):
            if known[-1].t + 1e-6 * h < t < end.t - 1e-6 * h:
                known.append(Instant(float(t), q, v))
    out = [start]
    for a, b in zip(known, [*known[1:], end]):
        pieces = int(np.ceil((b.t - a.t) / (COARSE * h) - 1e-9))
        fraction = np.arange(1, pieces) / max(pieces, 1)
        out += [Instant(*state) for state in zip((a.t + fraction * (b.t - a.t)).tolist(), *hermite(a, b, fraction))]  # type: ignore[arg-type]
        out.append(b)
    return out
