"""``simulate``: a scene in, a trustworthy trajectory out."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .assembly import Assembly, announce
from .cautions import caution
from .checkpoint import Checkpoint
from .course import Course
from .errors import SceneError
from .event import Event, named
from .leg import Aim, Leg
from .parts import Part
from .progress import Plan
from .result import Result
from .signal import discontinuities
from .starts import starts, together
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene


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
    checkpoint: str | os.PathLike[str] | None = None,
    every: float = 60.0,
) -> Result:
    """The motion of a scene from its start, or from a given state, to the absolute time t_end [s].

    rtol      error allowed in one step, relative to the length of the scene, or of its part
    solver    mbd.Radau(...), mbd.DormandPrince(), mbd.GeneralizedAlpha(...), mbd.Gauss(...); None: Radau where something is elastic,
              else DormandPrince with Radau at hand
    t_eval    times [n_t] that ``result.t`` shall hold, ascending; None: the accepted steps
    start     a state such as ``result.final``; None: positions and velocities as described
    events    mbd.Event(...) each: zero crossings to record in ``result.events``, or to stop at
    progress  a bar on the terminal, silent where standard error is none (needs tqdm)
    checkpoint, every   a file for the result so far, written anew every so many seconds [s] of wall time, and at the end; a run that was
              killed goes on from it by ``mbd.resume``

    Parts of the scene that nothing but the ground connects are integrated separately, each with steps and a default solver of its own; with
    events, which see all of the state, the scene is integrated as one.
    Steps end on the times at which functions of t declare that they jump (``mbd.piecewise``); the integrator starts there anew.
    Raises SceneError for a scene that cannot be built or assembled; with the partial result, SimulationError for a run that stops, and
    Interrupted, a KeyboardInterrupt, at Ctrl-C: ``mbd.resume`` goes on from both.
    """
    system = scene.build()
    state = start or State(system.q0, system.v0)
    state.check(system)
    plan = Plan(State(state.q, state.v, float(state.t)), float(t_end), rtol, checked_times(t_end, rtol, t_eval, state.t), named(events))
    kept = Checkpoint(scene, checkpoint, every) if checkpoint is not None else None
    parts = [Part.whole(scene)] if plan.events else scene.parts()
    begin = starts(parts, plan.start)
    _refuse_lost_pulses(system, plan)
    assembly = together(begin, parts, system.n)
    announce(assembly)
    legs = [_leg(part, each, solver, plan) for part, each in zip(parts, begin)]
    result = finished(Course(scene, plan, assembly, legs), progress, kept)
    caution(result)
    return result


def finished(course: Course, progress: bool, checkpoint: Checkpoint | None) -> Result:
    """A run to its end, with a bar where one is wanted."""
    bar = _Bar(min(leg.t for leg in course.legs), course.plan.t_end) if progress else None
    try:
        return course.finish(bar, checkpoint)
    finally:
        if bar:
            bar.close()


def checked_times(t_end: float, rtol: float, t_eval: ArrayLike | None, t_start: float) -> Array | None:
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


def _refuse_lost_pulses(system: System, plan: Plan) -> None:
    """Raises SceneError for declared pulses that no step can see."""
    if discontinuities(system).size > 1:
        from .jumps import lost

        if found := lost(system, plan.start.t, plan.t_end):
            raise SceneError(found)


def _leg(part: Part, start: Assembly, solver: Any, plan: Plan) -> Leg:
    """A part at its consistent start, with the solver chosen or its default."""
    from .solvers.automatic import default
    from .solvers.protocol import State as SolverState

    system, at = part.system, start.state
    chosen, reason = (solver, "chosen by the user") if solver is not None else default(system)
    stress = system.stress(system.strains(at.q), at.v) if system.n_stresses else np.zeros(0)
    states = [SolverState(at.t, at.q, at.v, np.zeros(system.m), stress)]
    return Leg(part, start.linear, chosen, reason, states, Aim(plan.t_end, plan.rtol, plan.events))


class _Bar:
    """Simulated time of the part furthest behind on the terminal, the last step and the time that is left; nothing where there is none."""

    def __init__(self, t_start: float, t_end: float):
        from tqdm import tqdm

        self._t = t_start
        form = "{l_bar}{bar}| {n:.4g}/{total:.4g} s [{elapsed}<{remaining}{postfix}]"
        self._bar = tqdm(total=t_end - t_start, unit="s", bar_format=form, disable=None)

    def __call__(self, t: float) -> None:
        self._bar.set_postfix_str(f"step {t - self._t:.1e} s", refresh=False)
        self._bar.update(t - self._t)
        self._t = t

    def close(self) -> None:
        self._bar.close()
