"""``resume``: goes on with a run that was broken off, or had come to its end, as if it had never stopped."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .assembly import prepared
from .cautions import caution
from .checkpoint import Checkpoint
from .course import Course
from .errors import SceneError
from .event import Event, named
from .leg import Aim, Back, Leg
from .parts import Part
from .progress import Plan, Progress, Stage
from .result import Result
from .run import checked_times, finished

if TYPE_CHECKING:
    from .scene import Scene

FEW = 30
"""Steps of a run so short that its end may have bent the first one: with another end, they are taken anew."""


def resume(
    run: Result | str | os.PathLike[str],
    t_end: float | None = None,
    *,
    scene: Scene | None = None,
    t_eval: ArrayLike | None = None,
    events: Sequence[Event] | None = None,
    progress: bool = False,
    checkpoint: str | os.PathLike[str] | None = None,
    every: float = 60.0,
) -> Result:
    """Goes on with a run: the result is that of a run that was never broken off, bit by bit on the same machine.

    run     a result, partial (``error.result``) or whole, or the file of one: ``result.save``, ``simulate(..., checkpoint=)``
    t_end   absolute time [s]; None: where the run was to end. Not before what was reached
    scene   the same scene, described anew: needed where the file's has functions of t, which are not stored. One that replaces a function
            which failed is the same scene
    t_eval  times [n_t] of the whole run that ``result.t`` shall hold; None: those of the run
    events  the same events by name, where the run had some and comes from a file
    progress, checkpoint, every   as of ``simulate``

    The few steps that the end of the run had bent, so as to land on it, are taken anew; what they found is forgotten. So a run to 1 s, resumed
    to 2 s, is the run to 2 s. Only where nothing moved at the start and nothing pulled, which makes the first step a share of the span, the
    run to 2 s would have begun with another one. Solver and rtol stay those of the run.
    Raises SceneError for another scene or other events, a run that ended with a terminal event, and a t_end already reached; ValueError for
    a file that ``mbd.load`` refuses; otherwise as ``simulate``.
    """
    result = _loaded(run)
    before = _progress(result)
    plan = _plan(result, before.plan, t_end, t_eval, events)
    own = _scene(result, scene)
    parts = _parts(own, before, plan)
    kept = Checkpoint(own, checkpoint, every) if checkpoint is not None else None
    later = plan.t_end != before.plan.t_end
    legs = [_leg(part, stage, plan, result, later) for part, stage in zip(parts, before.stages)]
    assembly = replace(result.assembly, linear=legs[0].linear) if len(legs) == 1 else result.assembly
    whole = finished(Course(own, plan, assembly, legs), progress, kept)
    caution(whole)
    return whole


def _loaded(run: Any) -> Result:
    if isinstance(run, Result):
        return run
    from .archive import load

    return load(run)


def _progress(result: Result) -> Progress:
    if result.progress is None:
        raise SceneError(["run: expected the result of mbd.simulate, found one of another kind; only such runs go on"])
    if result.stats.get("ended by"):
        raise SceneError([f"run: expected one that can go on, found it ended by {result.stats['ended by']!r}; use simulate(..., start=result.final)"])
    return result.progress


def _plan(result: Result, plan: Plan, t_end: float | None, t_eval: ArrayLike | None, events: Sequence[Event] | None) -> Plan:
    end, given = plan.t_end if t_end is None else t_end, named(events) or plan.events
    found = []
    if not (np.isfinite(end) and end >= result.trajectory.t[-1]):
        found.append(f"t_end: expected a finite time from {result.trajectory.t[-1]:.9g} s on, which was reached, found {end!r}; correct it")
    if set(given) != set(plan.events) or None in given.values():
        names = ", ".join(map(repr, plan.events)) or "none"
        found.append(f"events: expected those of the run by name ({names}), found {', '.join(map(repr, named(events))) or 'none'}; give them")
    if found:
        raise SceneError(found)
    times = plan.t_eval if t_eval is None else checked_times(end, plan.rtol, t_eval, plan.start.t)
    return replace(plan, t_end=float(end), t_eval=times, events={name: given[name] for name in plan.events})


def _scene(result: Result, scene: Scene | None) -> Scene:
    """The scene to go on with. Raises SceneError unless it is that of the run."""
    if result.scene.build() is not result.system:
        raise SceneError(["run: expected the scene as it was in this run, found items added since; describe it anew and give scene="])
    from .descriptions import described, missing

    if scene is None:
        if unknown := missing(result.scene):
            names = ", ".join(map(repr, unknown))
            raise SceneError([f"scene: expected one with the functions of t of {names}, found none in the file; give scene="])
        return result.scene
    scene.build()
    ours, theirs = _alike(described(scene)), _alike(described(result.scene))
    if not np.array_equal(scene.gravity, result.scene.gravity) or ours != theirs:
        other = next((a["fields"]["name"] for a, b in zip(ours, theirs) if a != b), "gravity or the number of items")
        raise SceneError([f"scene: expected that of the run but for functions of t, found another one ({other!r} differs); describe it as it was"])
    return scene


def _alike(value: Any) -> Any:
    """Data of descriptions without the values of functions."""
    if isinstance(value, dict):
        return {"function": None} if "function" in value else {name: _alike(part) for name, part in value.items()}
    return [_alike(part) for part in value] if isinstance(value, (list, tuple)) else value


def _parts(scene: Scene, before: Progress, plan: Plan) -> list[Part]:
    whole = len(before.stages) == 1 and isinstance(before.stages[0].trajectory.part.columns, slice)
    parts = [Part.whole(scene)] if whole else scene.parts()
    if len(parts) != len(before.stages):
        raise SceneError([f"scene: expected the {len(before.stages)} independent parts of the run, found {len(parts)}; describe it as it was"])
    return parts


def _leg(part: Part, stage: Stage, plan: Plan, result: Result, later: bool) -> Leg:
    """A part where it went on from, with linear algebra of its own, as it was made for the start of the run."""
    from .solvers.memory import unpacked
    from .solvers.start import mass_factor

    steps, mark = stage.trajectory, stage.fork
    linear = prepared(part.system, plan.start.q[part.columns], stage.softened, steps.q[0])
    if part.system.joints.linear:
        mass_factor(part.system, linear, steps.q[0])  # which is kept, and was found before the run
    linear.factorizations = stage.spent
    aim = Aim(plan.t_end, plan.rtol, plan.events)
    if mark is None or (later and mark.steps < FEW):
        return Leg(part, linear, steps.solver, stage.reason, [steps.states[0]], aim)
    memory = unpacked(steps.solver.integrator(plan.rtol), part.system, linear, mark.state.memory)
    mark = mark._replace(state=mark.state._replace(memory=memory))
    return Leg(part, linear, steps.solver, stage.reason, list(steps.states[: mark.steps + 1]), aim, Back(mark, steps.work, result.events))
