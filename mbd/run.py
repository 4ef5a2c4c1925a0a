"""``simulate``: a scene in, a trustworthy trajectory out."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .assembly import Assembly, announce, consistent
from .errors import SceneError, SceneWarning, SimulationError
from .event import Event, Events, named
from .result import Result
from .signal import OneSided, discontinuities, from_inside, stops
from .state import State
from .system import System
from .trajectory import Trajectory
from .watch import Watch

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.protocol import Attempt


def simulate(
    scene: Scene,
    t_end: float,
    *,
    rtol: float = 1e-6,
    solver: Any = None,
    t_eval: ArrayLike | None = None,
    start: State | None = None,
    events: Sequence[Event] | None = None,
    progress: bool = False,
) -> Result:
    """The motion of a scene from its start, or from a given state, to the absolute time t_end [s].

    rtol      error allowed in one step, relative to the scene's length
    solver    mbd.Radau(...), mbd.DormandPrince(), mbd.GeneralizedAlpha(...), mbd.Gauss(...); None: Radau where something is elastic,
              else DormandPrince with Radau at hand
    t_eval    times [n_t] that ``result.t`` shall hold, ascending; None: the accepted steps
    start     a state such as ``result.final``; None: positions and velocities as described
    events    mbd.Event(...) each: zero crossings to record in ``result.events``, or to stop at
    progress  a bar on the terminal (needs tqdm)

    Steps end on the times at which functions of t declare that they jump (``mbd.piecewise``); the integrator starts there anew.
    Raises SceneError for a scene that cannot be built or assembled, SimulationError, with the partial result, for a run that stops.
    """
    system = scene.build()
    state = start or State(system.q0, system.v0)
    state.check(system)
    times, wanted = _checked_times(t_end, rtol, t_eval, state.t), named(events)
    assembly = consistent(system, state)
    announce(assembly)
    reason = "chosen by the user"
    if solver is None:
        from .solvers.automatic import default

        solver, reason = default(system)
    result = _run(scene, system, assembly, solver, float(t_end), rtol, times, wanted, progress)
    result.stats["reason"] = reason
    return result


def _checked_times(t_end: float, rtol: float, t_eval: ArrayLike | None, t_start: float) -> Array | None:
    found = []
    if not (np.isfinite(t_end) and t_end > t_start):
        found.append(f"t_end: expected a finite time after the start at {t_start:g} s, found {t_end!r}; correct it")
    if not (np.isfinite(rtol) and 1e-14 <= rtol < 1.0):
        found.append(f"rtol: expected a tolerance from 1e-14 to below 1, found {rtol!r}; correct it")
    times = None if t_eval is None else np.atleast_1d(np.array(t_eval, dtype=float))
    if times is not None and (times.ndim != 1 or not np.isfinite(times).all() or np.any(np.diff(times) < 0)):
        found.append("t_eval: expected ascending finite times, found others; sort them")
    elif times is not None and times.size and (times[0] < t_start or times[-1] > t_end):
        found.append(f"t_eval: expected times between {t_start:g} and {t_end:g} s, found {times[0]:g} to {times[-1]:g}; correct them")
    if found:
        raise SceneError(found)
    return times


def _run(
    scene: Scene,
    system: System,
    assembly: Assembly,
    solver: Any,
    t_end: float,
    rtol: float,
    t_eval: Array | None,
    events: dict[str, Event],
    progress: bool,
) -> Result:
    from .solvers.march import Record
    from .solvers.protocol import State as SolverState

    linear, begin, method, jumps = assembly.linear, assembly.state, solver.integrator(rtol), discontinuities(system)
    if jumps.size:
        method = OneSided(method, jumps)
    clock = time.perf_counter()
    stress = system.stress(system.strains(begin.q), begin.v) if system.n_stresses else np.zeros(0)
    record = Record([SolverState(begin.t, begin.q, begin.v, np.zeros(system.m), stress)])
    watch = Watch(events, system, linear, method, rtol * system.length) if events else None
    trouble = _march(system, linear, method, record, t_end, rtol * system.length, jumps, watch, progress)
    stats = _stats(method, linear, record, rtol, time.perf_counter() - clock)
    if watch:
        stats["ended by"] = watch.ended_by
    found = watch.events if watch else Events({}, {})
    result = Result(scene, system, Trajectory.of(record, solver, method, linear), stats, assembly, t_eval, found)
    if trouble:
        trouble.result = result
        raise trouble
    _warn_of_imbalance(result)
    return result


def _march(
    system: System, linear: Any, method: Any, record: Any, t_end: float, tolerance: float, jumps: Array, watch: Watch | None, progress: bool
) -> SimulationError | None:
    """To t_end; returns what stopped it before."""
    from .solvers.march import march
    from .solvers.start import accelerations, mass_factor

    first = record.states[0]
    bar = _Bar(first.t, t_end) if progress else None
    halts, work, look = stops(jumps, first.t, t_end), _work(system, jumps), _watching(watch, bar)
    try:
        a, multipliers = accelerations(system, mass_factor(system, linear, first.q), first.q, first.v, system.inputs(first.t))
        record.states[0] = first = first._replace(multipliers=multipliers)
        h = method.first_step(system, first, a, t_end - first.t, tolerance)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected and rejected
            march(system, linear, method, record, t_end, tolerance, h, stops=halts, work=work, watch=look)
    except SimulationError as error:
        return error
    except KeyboardInterrupt:
        advice = "The partial result is in .result; continue with start=result.final"
        return SimulationError("interrupted", time=record.states[-1].t, advice=advice)
    finally:
        if bar:
            bar.close()
    return _failure(system, record) if record.failure else None


def _warn_of_imbalance(result: Result) -> None:
    """An energy that does not add up is the one sign of an unstable or far too coarse run that every scene gives."""
    audit = result.audit
    if not audit.balanced:
        warnings.warn(
            f"the energy is off by {audit.energy_error:.3g} J where {audit.energy_scale:.3g} J were exchanged: "
            "do not trust this run; lower rtol or the step",
            SceneWarning,
            stacklevel=4,
        )


def _watching(watch: Watch | None, bar: _Bar | None) -> Callable[[Any, Attempt], Attempt | None]:
    """What looks at each accepted step, and may end the run with a shorter one."""

    def look(before: Any, attempt: Attempt) -> Attempt | None:
        last = watch.inspect(before, attempt) if watch else None
        if bar:
            bar((last or attempt).state)
        return last

    return look


def _work(system: System, jumps: Array) -> Callable[[Attempt], float]:
    """The work of loads, drives and dampers over a step, by the step's own quadrature; nothing is evaluated where nothing does any."""
    if not system.exchanges:
        return lambda attempt: 0.0

    def work(attempt: Attempt) -> float:
        assert attempt.nodes is not None
        t, q, v, weights = attempt.nodes
        return float(weights @ system.power(q, v, from_inside(system, jumps, t[0], t[-1]).inputs(t), attempt.multipliers))

    return work


def _stats(method: Any, linear: Any, record: Any, rtol: float, seconds: float) -> dict[str, Any]:
    return {
        "solver": method.name,
        "linear algebra": f"{linear.format.name}, {linear.size} unknowns",
        "rtol": rtol,
        "steps": record.steps,
        "rejected": record.rejected,
        "failed": record.failed,
        "newton iterations": record.solves,
        "factorizations": linear.factorizations,
        "wall time": seconds,
    }


def _failure(system: System, record: Any) -> SimulationError:
    state = record.states[-1]
    if record.worst >= 0:
        item = system.label(record.worst)
    else:
        item = system.owners[int(np.argmax(np.abs(state.v) * system.levers))][0]
    advice = "Try a smaller rtol, mbd.Radau(stages=3), or look for a singular position, an instability or a load that jumps there"
    return SimulationError(f"steps became too short: {record.failure}", time=state.t, item=item, advice=advice)


class _Bar:
    """Simulated time on the terminal."""

    def __init__(self, t_start: float, t_end: float):
        from tqdm import tqdm

        self._t = t_start
        self._bar = tqdm(total=t_end - t_start, unit="s", bar_format="{l_bar}{bar}| {n:.4g}/{total:.4g} s [{elapsed}<{remaining}]")

    def __call__(self, state: Any) -> None:
        self._bar.update(state.t - self._t)
        self._t = state.t

    def close(self) -> None:
        self._bar.close()
