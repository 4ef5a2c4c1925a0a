"""``continuation``: paths of equilibrium under a growing and falling load, with the points where they turn or branch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .assembly import prepare
from .balance import Equilibrium
from .errors import SceneError, SimulationError
from .event import Event, event_value, named
from .loading import Loading, dead_part
from .paths import Bifurcation, Branch, on_path
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene


def continuation(
    scene: Scene,
    load: Any = None,
    *,
    until: float | None = 1.0,
    events: Sequence[Event] = (),
    start: State | None = None,
    branch: Bifurcation | None = None,
    step: float = 0.02,
    longest: float = 0.1,
    most: int = 1000,
    reverse: bool = False,
    t: float | None = None,
) -> Branch:
    """The path of equilibrium along which a load, times a factor, is borne; by arc length, so that the factor may fall as well.

    load      a force or torque, or several: items or names. None: all loads and the weight. Others act in full all the time
    until     the factor with which the path ends; None: where an event ends it
    events    mbd.Event(function of the equilibrium, terminal=..., direction=...): where it passes through zero, and the path may end;
              the function sees ``.factor``, ``.q``, ``.position(marker)``, ``.angle(item)`` and more, see ``Equilibrium``
    start     the state to start from, with the factor 0; None: positions as described
    branch    a bifurcation of another path of the same load: start there, along the other branch
    step, longest   the first and the longest arc length between two points; in units of the scene's length, and of the factor
    most      points at most
    reverse   start the other way: factors below zero, or the other side of a branch
    t         time [s] of loads and drives; None: that of the start

    Give the load its expected size, so that factors are of the order of one. Raises SceneError for bad input, SimulationError where there
    is no equilibrium to start from, or no way to leave it.
    """
    system = scene.build()
    begin = start or State(system.q0, np.zeros(system.n))
    begin.check(system)
    items = _items(scene, load)
    wanted, time = named(events or None), float(begin.t if t is None else t)
    _check(until, step, longest, most)
    follow = _Follow(scene, system, items, time, begin.q if branch is None else branch.at.q)
    return follow.trace(branch, until, wanted, step, longest, most, -1.0 if reverse else 1.0)


def _items(scene: Scene, load: Any) -> list[Any] | None:
    if load is None:
        return None
    given = load if isinstance(load, (list, tuple)) else [load]
    found = []
    for one in given:
        item = scene[one] if isinstance(one, str) else one
        if getattr(getattr(item, "description", None), "kind", None) not in ("force", "torque") or item not in scene.items:
            raise SceneError([f"load: expected forces or torques of this scene, found {one!r}; give what scene.add(...) returned, or its name"])
        found.append(item)
    return found


def _check(until: Any, step: Any, longest: Any, most: Any) -> None:
    found = []
    if until is not None and not np.isfinite(until):
        found.append(f"until: expected a finite factor or None, found {until!r}; correct it")
    if not (np.isfinite(step) and np.isfinite(longest) and 0.0 < step <= longest):
        found.append(f"step: expected a positive length up to longest={longest!r}, found {step!r}; correct it")
    if isinstance(most, bool) or not isinstance(most, (int, np.integer)) or most < 1:
        found.append(f"most: expected a whole number from 1, found {most!r}; correct it")
    if found:
        raise SceneError(found)


class _Follow:
    """One path: the problem, its start, and results in the user's words."""

    def __init__(self, scene: Scene, system: System, items: list[Any] | None, t: float, q: Array):
        from .solvers.statics import Problem

        self.scene, self.system, self.t, self.q = scene, system, t, q
        self.linear, _ = prepare(system, q)
        if items is None:
            self.names, self.dead = [signal.item for kernel in system.loads for signal in kernel.signals], system.constant_force
        else:
            self.names, self.dead = [item.name for item in items], dead_part(system, scene, items)
        self.loading = Loading.of(system, t, self.names, self.dead)
        self.problem = Problem.of(system, self.linear, self.loading)

    def _stress(self, q: Array) -> Array:
        return self.system.modulus * self.system.strains(q).value if self.system.n_stresses else np.zeros(0)

    def _begin(self) -> Any:
        """The balance at factor 0: of the loads that act in full."""
        from .solvers.relaxation import balance
        from .solvers.statics import Point

        stress = self._stress(self.q)
        path = Loading.whole(self.system, self.t, self.q, stress, self.names, self.dead)
        out, _ = balance(self.problem._replace(path=path), Point(0.0, self.q, stress, np.zeros(self.system.m)))
        if out.failure:
            what, item = f"no equilibrium to start from: {out.failure}", self.system.owners[max(out.worst, 0)][0]
            advice = (
                f"hold what is loose: can {item!r} move without resistance while the load is zero?",
                "start from a balance: start=mbd.equilibrium(scene without this load).state",
                "let the other loads grow as well: load=None, or a list of them",
            )
            raise SimulationError(what, time=self.t, item=item, advice=advice, state=self._resting(out.x.q))
        return out.x._replace(s=0.0)

    def trace(
        self, branch: Bifurcation | None, until: float | None, events: dict[str, Event], step: float, longest: float, most: int, sign: float
    ) -> Branch:
        from .solvers.arc import Arc
        from .solvers.following import trace
        from .solvers.formats import Singular

        arc, nothing = Arc(self.problem), np.zeros(self.system.n)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # a diverging iteration is detected
            try:
                first = arc.station(self._begin(), (nothing, sign)) if branch is None else self._aside(arc, branch, sign, step)
                stations, found, ended = trace(arc, first, step, longest, most, self._functions(until, events))
            except Singular as trouble:
                item = self._loosest(q := self.q if branch is None else branch.at.q)
                advice = (
                    f"give {item!r} stiffness, or hold it: it moves without resistance",
                    "start beside a limit point or bifurcation: start=path[k].state of another path",
                    "use mbd.equilibrium(scene), which lets things fall into the next balance",
                )
                what = f"the path has no tangent: {trouble}"
                raise SimulationError(what, time=self.t, item=item, advice=advice, state=self._resting(q)) from None
        return self._branch(stations, found, ended, events)

    def _aside(self, arc: Any, branch: Bifurcation, sign: float, step: float) -> Any:
        """A first station beside the bifurcation, on the other path."""
        from .solvers.statics import Point

        x = Point(branch.at.factor, branch.at.q, self._stress(branch.at.q), branch.at.multipliers)
        station = arc.aside(x, sign * branch.motion, step)
        if station is None:
            item = self.system.owners[int(np.argmax(np.abs(branch.motion) * self.system.levers))][0]
            advice = (
                "leave to the other side: reverse=True",
                "leave by another first step: step=0.1 or step=0.002",
                "disturb the scene a little, by a small force across, and follow its only path",
            )
            what = "no other path found beside the bifurcation"
            raise SimulationError(what, time=self.t, item=item, advice=advice, state=self._resting(branch.at.q))
        return station

    def _resting(self, q: Array) -> State:
        return State(q, np.zeros(self.system.n), self.t)

    def _loosest(self, q: Array) -> str:
        """The item that moves most with what K resists least, as far as it can be told."""
        from .solvers.formats import Singular
        from .solvers.softest import softest
        from .solvers.statics import Point

        try:
            motion = softest(self.problem, Point(0.0, q, self._stress(q), np.zeros(self.system.m)))[1]
        except Singular:
            return str(self.names[0] if self.names else self.system.owners[0][0])
        return str(self.system.owners[int(np.argmax(np.abs(motion) * self.system.levers))][0])

    def _functions(self, until: float | None, events: dict[str, Event]) -> list[Any]:
        def seen(name: str, event: Event) -> Any:
            return lambda x: event_value(event, name, self._at(x, 0), self.t)

        functions: list[Any] = [(seen(name, event), event.direction, event.terminal) for name, event in events.items()]
        return functions if until is None else [*functions, (lambda x: x.s - until, 0, True)]

    def _at(self, x: Any, unstable: int) -> Equilibrium:
        return on_path(self.scene, self.loading, x.s, x.q, x.multipliers, unstable)

    def _branch(self, stations: list[Any], found: list[Any], ended: str, events: dict[str, Event]) -> Branch:
        points = [station.x for station in stations]
        kinds: dict[str, list[Any]] = {kind: [item for item in found if item.kind == kind] for kind in ("limit", "bifurcation")}
        times = {name: [self._at(f.station.x, f.station.negatives) for f in found if f.function == k] for k, name in enumerate(events)}
        by_event = {event: times[name] for name, event in events.items()}
        return Branch(
            self.scene,
            self.loading,
            np.array([x.s for x in points]),
            np.array([x.q for x in points]),
            np.array([x.multipliers for x in points]),
            np.array([station.negatives for station in stations]),
            [self._at(item.station.x, item.station.negatives) for item in kinds["limit"]],
            [Bifurcation(self._at(item.station.x, item.station.negatives), item.motion) for item in kinds["bifurcation"]],
            times | by_event,
            ended,
        )
