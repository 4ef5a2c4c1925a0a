"""One part of a scene from its start to its end, step by step: the way of every run, once for each part."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .errors import SimulationError
from .event import Events
from .failures import stopped, undetermined
from .parts import Part
from .progress import Mark, Stage
from .signal import OneSided, discontinuities, stops
from .trajectory import Trajectory
from .watch import Watch
from .work import Work


class Aim(NamedTuple):
    """Where a run goes, and how exactly: t_end [s], rtol, and the events to look for."""

    t_end: float
    rtol: float
    events: Mapping[str, Any]


class Back(NamedTuple):
    """Where a part goes on from: a mark, the work [k] of the steps until there at least, and the events found."""

    mark: Mark
    work: Array
    events: Events


class Leg:
    """A part on its way.

    solver, reason   as chosen, and why
    linear           its linear algebra, made for its start
    states           of the solver, so far: the start at least
    back             where to go on from; None: from the start

    ``fork`` is the last mark up to which the run is the same as one with a later end; None before the first step.
    """

    def __init__(self, part: Part, linear: Any, solver: Any, reason: str, states: list[Any], aim: Aim, back: Back | None = None):
        from .solvers.march import Record

        self.part, self.linear, self.solver, self.reason, self._aim = part, linear, solver, reason, aim
        system, rtol = part.system, aim.rtol
        self._jumps, self._spent = discontinuities(system), linear.factorizations
        self._restless: dict[str, int] = {}
        method = solver.integrator(rtol)
        self.method: Any = method if system.steady and not self._jumps.size else OneSided(method, self._jumps)
        self._tolerance = rtol * system.length
        self._record = Record(states)
        self.watch = Watch(dict(aim.events), system, linear, self.method, self._tolerance) if aim.events else None
        self.fork = self._mark = back.mark if back else None
        self._work = Work(system, self._jumps, back.work[: back.mark.pending.done + 1] if back else None)
        if back:
            self._rewind(back.mark, back.events)
        self.trouble: SimulationError | None = None
        self._seconds, self._way = 0.0, self._steps()

    @property
    def t(self) -> float:
        """The last time reached [s]."""
        return float(self._record.states[-1].t)

    def advance(self) -> bool:
        """Takes a step; False at the end, or where ``trouble`` says why there is none. What interrupts it leaves it between two steps."""
        clock = time.perf_counter()
        try:
            state = next(self._way, None)
        except BaseException as error:
            if self._mark:
                self._rewind(self._mark)
            if not isinstance(error, SimulationError):
                raise
            self.trouble, state = error, None
        finally:
            self._seconds += time.perf_counter() - clock
        if state is None and self._record.failure:
            self.trouble = stopped(self.part.system, self.linear, self.method, self._record)
        return state is not None

    def _steps(self) -> Iterator[Any]:
        from .solvers.march import march

        system, method = self.part.system, self.method
        if not system.steady or system.joints.drives:
            self._look_for_jumps()
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected and rejected
            state, pace = self._begun()
        way = march(system, self.linear, method, self._record, state, pace, self._tolerance, note=self._work, watch=self._look)
        while True:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                state = next(way, None)
            if state is None:
                return
            self._mark = self._marked(state, pace)
            self.fork = self._mark if pace.free else self.fork
            yield state

    def _look_for_jumps(self) -> None:
        """Those that nobody declared: part of the run, so that it can be interrupted there."""
        from .jumps import look

        found = look(self.part.system, self._record.states[0].t, self._aim.t_end)
        self._restless = found.restless
        if found.times.size:
            self.method.jumps = self._work.jumps = self._jumps = np.union1d(self._jumps, found.times)

    def _begun(self) -> tuple[Any, Any]:
        """The state to step from, and the pace."""
        from .solvers.pace import Pace, Rhythm

        state, rhythm = (self._mark.state, self._mark.rhythm) if self._mark else self._started()
        halts = [*stops(self._jumps, state.t, self._aim.t_end), self._aim.t_end]
        return state, Pace(Rhythm(*rhythm), halts, self.method.fixed)

    def _started(self) -> tuple[Any, tuple[float, float]]:
        """The start with its multipliers, and the first step."""
        from .solvers.formats import Singular
        from .solvers.start import accelerations, mass_factor

        system, first = self.part.system, self._record.states[0]
        try:
            factor = mass_factor(system, self.linear, first.q)
        except Singular as trouble:
            raise undetermined(system, self.linear, first.q, first.t, trouble) from trouble
        a, multipliers = accelerations(system, factor, first.q, first.v, system.inputs(first.t))
        self._record.states[0] = first = first._replace(multipliers=multipliers)
        adaptive = self.method.first_step(system, first, a, self._aim.t_end - first.t, self._tolerance)
        return first, (first.t, self.method.fixed or adaptive)

    def _look(self, before: Any, attempt: Any) -> Any:
        return self.watch.inspect(before, attempt) if self.watch else None

    def _marked(self, state: Any, pace: Any) -> Mark:
        record, seen = self._record, self.watch.seen if self.watch else None
        return Mark(len(record.states) - 1, state, pace.rhythm, record.counts, self.linear.factorizations, self._work.pending, seen)

    def _rewind(self, mark: Mark, events: Events | None = None) -> None:
        """Back to a mark, whatever was begun since."""
        del self._record.states[mark.steps + 1 :]
        self._record.counts, self.linear.factorizations = mark.counts, mark.factorizations
        self._work.rewind(mark.pending)
        if self.watch and mark.seen:
            self.watch.rewind(mark.seen, [state.t for state in self._record.states[:-1]], events)

    def trajectory(self) -> Trajectory:
        """The steps so far."""
        states = list(self._record.states)
        return Trajectory.of(self.part, states, self._work.so_far(), self.solver, self.method, self.linear)

    def stage(self) -> Stage:
        """How far it came."""
        from .solvers.memory import packed

        mark = self.fork
        if mark:
            mark = mark._replace(state=mark.state._replace(memory=packed(mark.state.memory)))
        return Stage(self.trajectory(), mark, self.linear.softened, self._spent, self.reason)

    def stats(self) -> dict[str, Any]:
        """What they cost."""
        counts = self._record.counts
        return {
            "solver": self.method.name,
            "linear algebra": f"{self.linear.format.name}, {self.linear.size} unknowns",
            "rtol": self._aim.rtol,
            "steps": counts.steps,
            "rejected": counts.rejected,
            "failed": counts.failed,
            "newton iterations": counts.solves,
            "factorizations": self.linear.factorizations,
            "wall time": self._seconds,
            "coarseness": self._aim.rtol * counts.error if self.method.fixed is not None else 0.0,
            "leapt over": [item for item, turns in self._restless.items() if counts.steps < turns],
            "reason": self.reason,
        }
