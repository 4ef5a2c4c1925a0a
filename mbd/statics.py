"""``equilibrium``: a scene in, its state of rest out."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .about import About
from .affine import Array
from .assembly import Assembly, announce, consistent, prepare
from .balance import Equilibrium
from .errors import SceneError, SceneWarning, SimulationError
from .loading import Loading
from .state import State
from .system import System
from .vibration import modes

if TYPE_CHECKING:
    from .scene import Scene

CLOSED = 1e-11
"""Share of the scene's length that joints may be open by in an equilibrium."""


def equilibrium(scene: Scene, *, load_steps: int = 1, start: State | None = None, t: float | None = None) -> Equilibrium:
    """The equilibrium of a scene under all its loads, with drives where they are at time t.

    load_steps  at least so many increments of the loads; more are taken where the motion is far. Dead loads may be of any size
    start       the state to start from, its velocities ignored; None: positions as described. Loads, targets of drives and joints that
                do not close grow from what is in balance there: from nothing, where it is free of stress
    t           time [s] of loads and drives; None: that of the start

    Where no path of balance leads there (a pendulum released sideways, an arch beyond its limit load), the scene is let fall or snap into
    the next stable equilibrium (``stats["falls"]`` counts). A snap under load, and an equilibrium that is not unique, are announced by a
    SceneWarning.
    Raises SceneError for a scene that cannot be built or assembled, SimulationError, naming what gives way, where there is no equilibrium.
    """
    system = scene.build()
    begin = start or State(system.q0, np.zeros(system.n))
    begin.check(system)
    time = begin.t if t is None else t
    _check(load_steps, time)
    return _solve(scene, system, begin.q, float(time), int(load_steps))


def _check(load_steps: Any, t: Any) -> None:
    found = []
    if isinstance(load_steps, bool) or not isinstance(load_steps, (int, np.integer)) or load_steps < 1:
        found.append(f"load_steps: expected a whole number from 1, found {load_steps!r}; correct it")
    if not np.isscalar(t) or not np.isfinite(t):
        found.append(f"t: expected a finite time [s], found {t!r}; correct it")
    if found:
        raise SceneError(found)


def _solve(scene: Scene, system: System, q: Array, t: float, load_steps: int) -> Equilibrium:
    from .solvers.relaxation import balance
    from .solvers.statics import Point, Problem

    linear, redundant = prepare(system, q)
    stress = system.modulus * system.strains(q).value if system.n_stresses else np.zeros(0)
    path = Loading.whole(system, t, q, stress)
    path.longest = 1.0 / max(load_steps, _parts(system, linear, path))
    problem = Problem.of(system, linear, path)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected
        out, breaks = balance(problem, Point(0.0, q, stress, np.zeros(system.m)))
    gap = np.abs(system.joints.at(out.x.q).value - path.target(1.0)) * linear.reach
    if not out.failure and np.max(gap, initial=0.0) > CLOSED * system.length:
        out.failure, out.worst = "the joints give way under the loads", -1
    if out.failure:
        consistent(system, State(q, np.zeros_like(q), t))  # joints that cannot close at all say so by name
        raise _failure(system, out, redundant, t)
    announce(Assembly(State(out.x.q, np.zeros_like(q), t), (), redundant, linear))
    work = {"iterations": out.iterations, "factorizations": linear.factorizations, "restarts": out.restarts}
    stats = work | {"falls": len(breaks), "redundant": redundant}
    if breaks and breaks[0] > 0.0:
        text = f"the path of balance breaks off near {100.0 * breaks[0]:.2g} % of the loads: this is where the scene then snaps to"
        warnings.warn(text, SceneWarning, stacklevel=3)
    return _judged(problem, out, Equilibrium(scene, system, out.x.q, out.x.multipliers, t, 1.0, 0, 0, stats, path.inputs(1.0)))


def _judged(problem: Any, out: Any, found: Equilibrium) -> Equilibrium:
    """The equilibrium with its stability."""
    at = About(found.scene, found, problem.linear)
    unstable, neutral = problem.kkt.signs(problem.tangent(out.x))
    if neutral:
        neutral = _truly(at, problem, out, neutral)
    if not at.conservative:
        unstable = modes(found.scene, about=found).unstable
    return replace(found, unstable=unstable, neutral=neutral)


def _truly(at: About, problem: Any, out: Any, neutral: int) -> int:
    """How many motions are neutral, announced; none where the softest is only too soft for the matrix's rounding, but strains something."""
    from .solvers.softest import softest

    motion = softest(problem, out.x)[1]
    if at.quotients(motion[None])[0] > at.rounding:
        return 0
    size = np.abs(motion) * at.system.levers
    names = dict.fromkeys(at.system.owners[k][0] for k in np.flatnonzero(size > 0.1 * size.max()))
    where = ", ".join(map(repr, names))
    text = f"the equilibrium is not unique: {where} can move without resistance; hold it, or give it stiffness"
    warnings.warn(text, SceneWarning, stacklevel=5)
    return neutral


def _parts(system: System, linear: Any, path: Loading) -> int:
    """Of half a radian, or half the scene's length, each at most: how far drives are from where they shall be."""
    gap = np.broadcast_to(path.target_rate, system.m)
    return int(np.ceil(np.max(np.abs(gap) * linear.reach, initial=0.0) / (0.5 * system.length)))


def _failure(system: System, out: Any, redundant: tuple[str, ...], t: float) -> SimulationError:
    """What gave way: the item that moved most when the iteration was given up."""
    item = system.owners[out.worst][0] if out.worst >= 0 else redundant[0] if redundant else system.owners[0][0]
    reached = f"balance was kept up to {100.0 * out.x.s:.3g} % of the loads, then " if 0.0 < out.x.s < 1.0 else ""
    dead = f"start away from the position in which {', '.join(map(repr, redundant))} depend on each other: a dead centre?" if redundant else ""
    advice = (
        dead or f"hold what nothing holds: can {item!r} move without end, or is it a mechanism that a load keeps turning?",
        "find the load that it bears, by mbd.continuation(scene, load), or take more steps: load_steps=10",
        "let it come to rest: mbd.simulate with dampers, then mbd.equilibrium(scene, start=result.final)",
    )
    last = State(out.x.q, np.zeros(system.n), t)
    return SimulationError(f"no equilibrium found: {reached}{out.failure}", time=t, item=item, advice=advice, state=last)
