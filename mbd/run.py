"""``simulate``: a scene in, a trustworthy trajectory out."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .assembly import Assembly, announce
from .errors import SceneError, SceneWarning
from .event import Event, Events, named
from .leg import Leg, travel
from .parts import Part
from .result import Result
from .starts import starts, together
from .state import State
from .trajectory import joined

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
) -> Result:
    """The motion of a scene from its start, or from a given state, to the absolute time t_end [s].

    rtol      error allowed in one step, relative to the length of the scene, or of its part
    solver    mbd.Radau(...), mbd.DormandPrince(), mbd.GeneralizedAlpha(...), mbd.Gauss(...); None: Radau where something is elastic,
              else DormandPrince with Radau at hand
    t_eval    times [n_t] that ``result.t`` shall hold, ascending; None: the accepted steps
    start     a state such as ``result.final``; None: positions and velocities as described
    events    mbd.Event(...) each: zero crossings to record in ``result.events``, or to stop at
    progress  a bar on the terminal (needs tqdm)

    Parts of the scene that nothing but the ground connects are integrated separately, each with steps and a default solver of its own; with
    events, which see all of the state, the scene is integrated as one.
    Steps end on the times at which functions of t declare that they jump (``mbd.piecewise``); the integrator starts there anew.
    Raises SceneError for a scene that cannot be built or assembled, SimulationError, with the partial result, for a run that stops.
    """
    system = scene.build()
    state = start or State(system.q0, system.v0)
    state.check(system)
    times, wanted = _checked_times(t_end, rtol, t_eval, state.t), named(events)
    parts = [Part.whole(scene)] if wanted else scene.parts()
    begin = starts(parts, state)
    assembly = together(begin, parts, system.n)
    announce(assembly)
    bar = _Bar(state.t, float(t_end), len(parts)) if progress else None
    try:
        legs = _legs(parts, begin, solver, float(t_end), rtol, wanted, bar)
    finally:
        if bar:
            bar.close()
    result = _result(scene, legs, assembly, times)
    trouble = next((leg.trouble for leg in reversed(legs) if leg.trouble), None)
    if trouble:
        trouble.result = result
        raise trouble
    _warn_of_imbalance(result)
    _warn_of_coarse_steps(legs)
    _warn_of_passages(legs)
    _warn_of_doubts(result)
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


def _default(part: Part) -> tuple[Any, str]:
    from .solvers.automatic import default

    return default(part.system)


def _legs(parts: Sequence[Part], begin: Sequence[Assembly], solver: Any, t_end: float, rtol: float, events: dict[str, Event], bar: Any) -> list[Leg]:
    """Every part, one after the other. Where one stops early, the others go on to that time only."""
    legs = []
    for part, start in zip(parts, begin):
        chosen, reason = (solver, "chosen by the user") if solver is not None else _default(part)
        legs.append(travel(part, start, chosen, t_end, rtol, events, bar))
        legs[-1].stats["reason"] = reason
        if legs[-1].trouble:
            t_end = float(legs[-1].trajectory.t[-1])
    return legs


def _result(scene: Scene, legs: Sequence[Leg], assembly: Assembly, t_eval: Array | None) -> Result:
    system, watch = scene.build(), legs[0].watch
    trajectory, stats = joined([leg.trajectory for leg in legs], system.n), _stats(legs)
    if watch:
        stats["ended by"] = watch.ended_by
    chosen = None
    if t_eval is not None:
        reached = t_eval[t_eval <= trajectory.t[-1]]
        chosen = (reached, *trajectory.at(reached))
    return Result(scene, system, trajectory, stats, assembly, chosen, watch.events if watch else Events({}, {}))


COUNTS = ("steps", "rejected", "failed", "newton iterations", "factorizations", "wall time")


def _stats(legs: Sequence[Leg]) -> dict[str, Any]:
    """Of one part its own; of several the sums, and under "parts" those of each."""
    if len(legs) == 1:
        return legs[0].stats
    each = [leg.stats for leg in legs]
    said = {name: "; ".join(dict.fromkeys(stats[name] for stats in each)) for name in ("solver", "linear algebra", "reason")}
    sums = {name: sum(stats[name] for stats in each) for name in COUNTS}
    parts = [{"items": list(leg.trajectory.part.items)} | leg.stats for leg in legs]
    return said | {"rtol": each[0]["rtol"]} | sums | {"parts": parts}


def _warn_of_imbalance(result: Result) -> None:
    """An energy that does not add up is the one sign of an unstable or far too coarse run that every scene gives."""
    audit = result.audit
    pieces = result.trajectory.pieces()
    for piece, part in zip(pieces, audit.parts or (audit,)):
        if not part.balanced:
            where = f" of {', '.join(map(repr, piece.part.items[:3]))}" if len(pieces) > 1 else ""
            warnings.warn(
                f"the energy{where} is off by {part.energy_error:.3g} J where {part.energy_scale:.3g} J were exchanged: "
                "do not trust this run; lower rtol or the step",
                SceneWarning,
                stacklevel=3,
            )


COARSE = 0.03
"""The sum of the errors estimated in fixed steps, as a share of the length, above which a run is not to be trusted."""


def _warn_of_coarse_steps(legs: Sequence[Leg]) -> None:
    """Nothing controls fixed steps: their errors are added up instead."""
    worst = max(leg.coarseness for leg in legs)
    if worst > COARSE:
        warnings.warn(
            f"the fixed steps are too long: errors estimated in them add up to {worst:.2g} of the scene's length: "
            "do not trust this run; take shorter steps or a solver with error control",
            SceneWarning,
            stacklevel=3,
        )


def _warn_of_passages(legs: Sequence[Leg]) -> None:
    """Where joints lose their grip a mechanism may go on in two ways, and equations do not say in which."""
    from .passages import passages

    found = sorted(passage for leg in legs for passage in passages(leg.trajectory))
    if found:
        t, items = found[0]
        warnings.warn(
            f"joints {', '.join(map(repr, items))} went through a singular position at t = {t:.6g} s: there they hold less than elsewhere, and "
            "the motion may go on in another way too; the smooth one was followed. If no such position is meant to be reached, do not trust this "
            "run: lower rtol; mbd.check(scene, state) tells more",
            SceneWarning,
            stacklevel=3,
        )


def _warn_of_doubts(result: Result) -> None:
    """What items know of the limits of their own formulation."""
    for item in result.scene.items:
        for doubt in item.doubts(result.q) if hasattr(item, "doubts") else []:
            warnings.warn(doubt, SceneWarning, stacklevel=3)


class _Bar:
    """Simulated time on the terminal, of several parts the mean."""

    def __init__(self, t_start: float, t_end: float, parts: int):
        from tqdm import tqdm

        self._start = self._t = t_start
        self._parts = parts
        self._bar = tqdm(total=t_end - t_start, unit="s", bar_format="{l_bar}{bar}| {n:.4g}/{total:.4g} s [{elapsed}<{remaining}]")

    def __call__(self, t: float) -> None:
        before = self._t if t > self._t else self._start  # of the next part
        self._bar.update((t - before) / self._parts)
        self._t = t

    def close(self) -> None:
        self._bar.close()
