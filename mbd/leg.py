"""One part of a scene from its start to its end: the way of every run, once for each part."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .affine import Array
from .assembly import Assembly
from .errors import SimulationError
from .event import Event
from .parts import Part
from .signal import OneSided, discontinuities, stops
from .system import System
from .trajectory import Trajectory
from .watch import Watch
from .work import Work

if TYPE_CHECKING:
    from .solvers.protocol import Attempt


class Leg(NamedTuple):
    """What a part did: its steps, what they cost, what ended them before the time, who looked for events, and, where steps were fixed,
    the sum of the errors estimated in them as a share of the length."""

    trajectory: Trajectory
    stats: dict[str, Any]
    trouble: SimulationError | None
    watch: Watch | None
    coarseness: float = 0.0


def travel(part: Part, start: Assembly, solver: Any, t_end: float, rtol: float, events: dict[str, Event], bar: Callable[[float], None] | None) -> Leg:
    """A part from a consistent start to t_end. What stops it before is in the leg, not raised."""
    from .solvers.march import Record
    from .solvers.protocol import State as SolverState

    system, linear, begin = part.system, start.linear, start.state
    method, jumps = solver.integrator(rtol), discontinuities(system)
    if jumps.size:
        method = OneSided(method, jumps)
    clock = time.perf_counter()
    stress = system.stress(system.strains(begin.q), begin.v) if system.n_stresses else np.zeros(0)
    record = Record([SolverState(begin.t, begin.q, begin.v, np.zeros(system.m), stress)])
    watch = Watch(events, system, linear, method, rtol * system.length) if events else None
    work = Work(system, jumps)
    trouble = _march(system, linear, method, record, t_end, rtol * system.length, jumps, work, _watching(watch, bar))
    stats = {
        "solver": method.name,
        "linear algebra": f"{linear.format.name}, {linear.size} unknowns",
        "rtol": rtol,
        "steps": record.steps,
        "rejected": record.rejected,
        "failed": record.failed,
        "newton iterations": record.solves,
        "factorizations": linear.factorizations,
        "wall time": time.perf_counter() - clock,
    }
    coarseness = record.error * rtol if method.fixed is not None else 0.0
    return Leg(Trajectory.of(part, record, work.done(), solver, method, linear), stats, trouble, watch, coarseness)


def _march(
    system: System, linear: Any, method: Any, record: Any, t_end: float, tolerance: float, jumps: Array, work: Work, look: Any
) -> SimulationError | None:
    """To t_end; returns what stopped it before."""
    from .solvers.march import march
    from .solvers.start import accelerations, mass_factor

    first = record.states[0]
    if not t_end > first.t:
        return None
    halts = stops(jumps, first.t, t_end)
    try:
        a, multipliers = accelerations(system, mass_factor(system, linear, first.q), first.q, first.v, system.inputs(first.t))
        record.states[0] = first = first._replace(multipliers=multipliers)
        h = method.first_step(system, first, a, t_end - first.t, tolerance)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected and rejected
            march(system, linear, method, record, t_end, tolerance, h, stops=halts, note=work, watch=look)
    except SimulationError as error:
        return error
    except KeyboardInterrupt:
        advice = "The partial result is in .result; continue with start=result.final"
        return SimulationError("interrupted", time=record.states[-1].t, advice=advice)
    return _failure(system, record) if record.failure else None


def _watching(watch: Watch | None, bar: Callable[[float], None] | None) -> Callable[[Any, Attempt], Attempt | None]:
    """What looks at each accepted step, and may end the run with a shorter one."""

    def look(before: Any, attempt: Attempt) -> Attempt | None:
        last = watch.inspect(before, attempt) if watch else None
        if bar:
            bar((last or attempt).state.t)  # type: ignore[union-attr]
        return last

    return look


def _failure(system: System, record: Any) -> SimulationError:
    state = record.states[-1]
    if record.worst >= 0:
        item = system.label(record.worst)
    else:
        item = system.owners[int(np.argmax(np.abs(state.v) * system.levers))][0]
    advice = "Try a smaller rtol, mbd.Radau(stages=3), or look for a singular position, an instability or a load that jumps there"
    return SimulationError(f"steps became too short: {record.failure}", time=state.t, item=item, advice=advice)
