"""Events: what is asked (``Event``), what its function sees (``Instant``), and what a run answers (``Events``)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array
from .called import called
from .errors import SceneError
from .marker import Marker


@dataclass(frozen=True, eq=False)
class Event:
    """Zero crossings of function(state), a number that varies continuously; for ``simulate(..., events=[...])``.

    function   sees ``state.t`` [s], ``state.q``, ``state.v`` [n], ``state.position(marker)`` [d] [m], ``state.velocity(marker)`` [d] [m/s]
               and, in the plane, ``state.angle(body or marker)`` [rad], from -pi to pi
    terminal   the run ends there: ``result.final`` is the state at the event
    direction  +1: only rising through zero, -1: only falling, 0: both
    name       for messages and files; None: "event 1", ... in order

    Zero at the start is no crossing, arriving at zero is one, a jump over zero (of an angle from pi to -pi) is none. Times are found to
    1e-10 of a step. A function that varies faster than the motion may cross twice between two samples of a step, and be missed.
    """

    function: Callable[[Instant], float]
    terminal: bool = field(default=False, kw_only=True)
    direction: int = field(default=0, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise ValueError(f"Event({self.function!r}): expected a function of the state")
        if isinstance(self.direction, bool) or self.direction not in (-1, 0, 1):
            raise ValueError(f"Event(direction={self.direction!r}): expected 1 (rising), -1 (falling) or 0 (both)")
        if self.name is not None and not (isinstance(self.name, str) and self.name):
            raise ValueError(f"Event(name={self.name!r}): expected a text or None")


class Instant(NamedTuple):
    """A state as an event's function sees it: t [s], q, v [n], and what markers do."""

    t: float
    q: Array
    v: Array

    def position(self, marker: Marker) -> Array:
        """[d] [m]."""
        columns, matrix = _map(_marker(marker).point)
        return marker.point.constant + matrix @ self.q[columns]

    def velocity(self, marker: Marker) -> Array:
        """[d] [m/s]."""
        columns, matrix = _map(_marker(marker).point)
        return matrix @ self.v[columns]

    def angle(self, item: Any) -> float:
        """[rad] from -pi to pi, counter-clockwise: of a planar body's or marker's axis, of a cable marker's tangent."""
        axes = getattr(item, "axes", ())
        if not axes or axes[0].dimension != 2:
            raise TypeError(f"angle({item!r}): expected a planar rigid body, or a planar marker that carries an axis")
        columns, matrix = _map(axes[0])
        x, y = axes[0].constant + matrix @ self.q[columns]
        return float(np.arctan2(y, x))


def event_value(event: Event, name: str, state: Any, time: float) -> float:
    """An event's function at a state. Raises SimulationError where it fails."""

    def fits(given: Any, value: Array) -> bool:
        return value.shape == () and not isinstance(given, (bool, np.bool_)) and given is not None

    expected = "a finite number that passes through zero"
    return float(called(event.function, state, fits=fits, expected=expected, what="the event's function", item=name, time=time))


def _marker(marker: Any) -> Marker:
    if not isinstance(marker, Marker):
        raise TypeError(f"expected a marker such as rod.end or body.at(x, y), found {marker!r}")
    return marker


@lru_cache(maxsize=256)
def _map(affine: Affine) -> tuple[NDArray[np.intp], Array]:
    return affine.columns(), affine.matrix()


class Times(NamedTuple):
    """When an event happened, and the states there: t [k] [s], q, v [k, n]."""

    t: Array
    q: Array
    v: Array

    @classmethod
    def of(cls, instants: Sequence[Instant], n: int) -> Times:
        parts = (np.array([getattr(x, part) for x in instants]).reshape(len(instants), n) for part in "qv")
        return cls(np.array([x.t for x in instants]), *parts)


class Events(Mapping[Any, Times]):
    """What happened to each event: ``result.events[event]`` or ``result.events["its name"]``; iterates over names."""

    def __init__(self, times: dict[str, Times], events: Mapping[str, Event]):
        self._times, self._names = times, {event: name for name, event in events.items()}

    def __getstate__(self) -> dict[str, Any]:
        """Without the functions, which other processes may not know: there, events go by name."""
        return {"_times": self._times, "_names": {}}

    def __getitem__(self, key: Event | str) -> Times:
        name = self._names.get(key, key.name) if isinstance(key, Event) else key
        if name not in self._times:
            raise KeyError(f"no event {name or key!r} in this run; there are {', '.join(map(repr, self._times)) or 'none'}")
        return self._times[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._times)

    def __len__(self) -> int:
        return len(self._times)

    def __repr__(self) -> str:
        return f"<events: {', '.join(f'{name!r} {len(times.t)} times' for name, times in self._times.items()) or 'none'}>"


def named(events: Sequence[Event] | None) -> dict[str, Event]:
    """The events by their names. Raises SceneError where there is no event, or two of a name."""
    given: list[Any] = list(events) if isinstance(events, (list, tuple)) else [] if events is None else [events]
    found = [f"events: expected mbd.Event(function, ...), found {event!r}; wrap the function" for event in given if not isinstance(event, Event)]
    if found:
        raise SceneError(found)
    names = [event.name or f"event {k}" for k, event in enumerate(given, 1)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise SceneError([f"events: expected a name for each, found {name!r} more than once; rename one" for name in twice])
    return dict(zip(names, given))
