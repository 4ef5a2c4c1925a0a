"""``simulate``: a scene in, a trustworthy trajectory out."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .assembly import Assembly, announce, consistent
from .errors import SceneError, SceneWarning, SimulationError
from .result import Result
from .state import State
from .system import System
from .trajectory import Trajectory

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
    progress: bool = False,
) -> Result:
    """The motion of a scene from its start, or from a given state, to the absolute time t_end [s].

    rtol      error allowed in one step, relative to the scene's length
    solver    mbd.Radau(...) (the default) or mbd.GeneralizedAlpha(...)
    t_eval    times [n_t] that ``result.t`` shall hold, ascending; None: the accepted steps
    start     a state such as ``result.final``; None: positions and velocities as described
    progress  a bar on the terminal (needs tqdm)

    Raises SceneError for a scene that cannot be built or assembled, SimulationError, with the partial result, for a run that stops.
    """
    system = scene.build()
    state = start or State(system.q0, system.v0)
    state.check(system)
    times = _checked_times(t_end, rtol, t_eval, state.t)
    assembly = consistent(system, state)
    announce(assembly)
    if solver is None:
        from .solvers import Radau

        solver = Radau()
    return _run(scene, system, assembly, solver, float(t_end), rtol, times, progress)


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
    scene: Scene, system: System, assembly: Assembly, solver: Any, t_end: float, rtol: float, t_eval: Array | None, progress: bool
) -> Result:
    from .solvers.march import Record, march
    from .solvers.protocol import State as SolverState
    from .solvers.start import accelerations, mass_factor

    linear, begin, method = assembly.linear, assembly.state, solver.integrator(rtol)
    clock = time.perf_counter()
    stress = system.stress(system.strains(begin.q), begin.v) if system.n_stresses else np.zeros(0)
    tolerance = rtol * system.length
    record = Record([SolverState(begin.t, begin.q, begin.v, np.zeros(system.m), stress)])
    bar = _Bar(begin.t, t_end) if progress else None
    trouble: SimulationError | None = None
    try:
        a, multipliers = accelerations(system, mass_factor(system, linear, begin.q), begin.q, begin.v, system.inputs(begin.t))
        record.states[0] = first = record.states[0]._replace(multipliers=multipliers)
        h = method.first_step(system, first, a, t_end - begin.t, tolerance)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected and rejected
            march(system, linear, method, record, t_end, tolerance, h, work=_work(system), watch=bar)
    except SimulationError as error:
        trouble = error
    except KeyboardInterrupt:
        advice = "The partial result is in .result; continue with start=result.final"
        trouble = SimulationError("interrupted", time=record.states[-1].t, advice=advice)
    finally:
        if bar:
            bar.close()
    stats = _stats(method, linear, record, rtol, time.perf_counter() - clock)
    result = Result(scene, system, Trajectory.of(record, solver, method, linear), stats, assembly, t_eval)
    if trouble is None and record.failure:
        trouble = _failure(system, record)
    if trouble:
        trouble.result = result
        raise trouble
    _warn_of_imbalance(result)
    return result


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


def _work(system: System) -> Callable[[Attempt], float] | None:
    """The work of loads and dampers over a step, by the step's own quadrature; None where nothing does any."""
    if not system.exchanges:
        return None

    def work(attempt: Attempt) -> float:
        assert attempt.nodes is not None
        t, q, v, weights = attempt.nodes
        return float(weights @ system.power(q, v, system.inputs(t)))

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
