"""Scenes as data, to be built in any units, anywhere, turned, and in any order: what metamorphic tests compare.

A plan is a list of entries; an entry is a kind of ``mbd`` and words for it, in nominal units. Words that mean something in the world, a
point, a direction, a mass, are of the classes below and translated when the plan is built; anything else is passed on as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

import mbd

GROUND = "ground"


@dataclass(frozen=True)
class World:
    """Units (of length, mass and time, in nominal ones), and where the scene lies: turned by ``turn`` [d, d], then shifted [d] (nominal)."""

    units: tuple[float, float, float]
    turn: np.ndarray
    shift: np.ndarray

    @classmethod
    def plain(cls, d: int) -> World:
        return cls((1.0, 1.0, 1.0), np.eye(d), np.zeros(d))

    def unit(self, dims: tuple[int, int, int]) -> float:
        return float(np.prod([unit**power for unit, power in zip(self.units, dims)]))

    def point(self, p: Any) -> np.ndarray:
        return self.units[0] * (self.turn @ np.array(p) + self.shift)

    def nominal(self, points: np.ndarray) -> np.ndarray:
        """Points [..., d] of a result in nominal units, turned and shifted back."""
        return (points / self.units[0] - self.shift) @ self.turn


class Number(NamedTuple):
    value: float
    dims: tuple[int, int, int]

    def seen(self, world: World, scene: Scene) -> float:
        return self.value * world.unit(self.dims)


class Numbers(NamedTuple):
    """In axes of their own, that turn with the scene."""

    value: tuple[float, ...]
    dims: tuple[int, int, int]

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return np.array(self.value) * world.unit(self.dims)


class Point(NamedTuple):
    value: tuple[float, ...]

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return world.point(self.value)


class Vector(NamedTuple):
    """In inertial axes."""

    value: tuple[float, ...]
    dims: tuple[int, int, int] = (0, 0, 0)

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return world.turn @ np.array(self.value) * world.unit(self.dims)


class Vectors(NamedTuple):
    value: tuple[tuple[float, ...], ...]

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return np.array(self.value) @ world.turn.T


class Heading(NamedTuple):
    """The angle of a planar body."""

    value: float

    def seen(self, world: World, scene: Scene) -> float:
        return self.value + float(np.arctan2(world.turn[1, 0], world.turn[0, 0]))


class Frame(NamedTuple):
    """The axes of a body as columns."""

    value: tuple[tuple[float, ...], ...]

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return world.turn @ np.array(self.value)


class Spot(NamedTuple):
    """A marker: of a body at ``place`` in its axes, of a beam at the fraction ``place``, of a particle, of the ground at a point."""

    item: str
    place: tuple[float, ...]
    point: tuple[float, ...]
    axes: int  # 0: none, 1: of a cable, 2: of a body or the ground

    def seen(self, world: World, scene: Scene) -> mbd.Marker:
        if self.item == GROUND:
            return scene.mbd.ground.at(*world.point(self.place))
        item = scene.mbd[self.item]
        return item.at(*self.place) if self.axes < 2 else item.at(*(world.units[0] * np.array(self.place)))


class Line(NamedTuple):
    """A direction in the axes of the body that a marker is of: those of the ground do not turn with the scene."""

    value: tuple[float, ...]
    spot: Spot

    def seen(self, world: World, scene: Scene) -> np.ndarray:
        return world.turn @ np.array(self.value) if self.spot.item == GROUND else np.array(self.value)


class Item(NamedTuple):
    name: str

    def seen(self, world: World, scene: Scene) -> Any:
        return scene.mbd[self.name]


class Terms(NamedTuple):
    value: tuple[tuple[Number, Item], ...]

    def seen(self, world: World, scene: Scene) -> list[tuple[float, Any]]:
        return [(number.seen(world, scene), item.seen(world, scene)) for number, item in self.value]


class Wave(NamedTuple):
    """The function amplitude sin(rate t); with ``jump``, doubled after that time. ``inertial``: of a vector in inertial axes.
    ``origin``: of a motion of points, about it."""

    amplitude: Any
    rate: float
    dims: tuple[int, int, int]
    inertial: bool = False
    origin: Any = None
    jump: float | None = None

    def seen(self, world: World, scene: Scene) -> Callable[[float], Any]:
        size = np.array(self.amplitude) * world.unit(self.dims)
        size = world.turn @ size if self.inertial else size
        about = 0.0 if self.origin is None else world.point(self.origin)
        time, rate, jump = world.units[2], self.rate, self.jump

        def wave(t: float) -> Any:
            return about + size * np.sin(rate * t / time) * (2.0 if jump is not None and t > jump * time else 1.0)

        return wave if jump is None else mbd.piecewise(wave, at=[jump * time])


@dataclass(frozen=True)
class Entry:
    name: str
    kind: str
    words: dict[str, Any]

    @property
    def needs(self) -> set[str]:
        """The names of the entries that must be there before."""
        found = set()
        for word in self.words.values():
            words = [part for term in word.value for part in term] if isinstance(word, Terms) else [word]
            found |= {word.item for word in words if isinstance(word, Spot)} | {word.name for word in words if isinstance(word, Item)}
        return found - {GROUND}


@dataclass(frozen=True)
class Plan:
    """What a scene is made of, in nominal units; the markers that tests watch; and how it is run."""

    gravity: tuple[float, ...]
    entries: tuple[Entry, ...]
    watched: tuple[Spot, ...]
    t_end: float
    rtol: float
    solver: tuple[str, dict[str, Any]] | None
    world: World = field(repr=False)

    @property
    def dimension(self) -> int:
        return len(self.gravity)

    def moved(self, **changes: Any) -> Plan:
        """In another world."""
        return replace(self, world=replace(self.world, **changes))

    def shuffled(self, order: Sequence[float]) -> Plan:
        """Entries added in another order, as far as some need others before."""
        left = [entry for _, entry in sorted(zip(order, self.entries), key=lambda pair: pair[0])]
        done: list[Entry] = []
        while left:
            names = {entry.name for entry in done}
            ready = next(entry for entry in left if entry.needs <= names)
            left.remove(ready)
            done.append(ready)
        return replace(self, entries=tuple(done))

    def method(self) -> Any:
        if self.solver is None:
            return None
        name, words = self.solver
        return getattr(mbd, name)(**{key: value * self.world.units[2] if key == "step" else value for key, value in words.items()})


class Scene:
    """A plan as a scene of ``mbd``."""

    def __init__(self, plan: Plan):
        self.plan, self.world = plan, plan.world
        self.mbd = mbd.Scene(gravity=plan.world.turn @ np.array(plan.gravity) * plan.world.unit((1, 0, -2)))
        for entry in plan.entries:
            words = {name: word.seen(self.world, self) if hasattr(word, "seen") else word for name, word in entry.words.items()}
            self.mbd.add(_described(entry.kind)(name=entry.name, **words))

    def points(self, result: mbd.Result) -> np.ndarray:
        """[n_watched, d]: where the watched markers ended, in nominal units."""
        return self.world.nominal(np.array([result.position(spot.seen(self.world, self))[-1] for spot in self.plan.watched]))

    def run(self, t_end: float | None = None, **words: Any) -> mbd.Result:
        """To the plan's end, or another (nominal) time."""
        options = {"rtol": self.plan.rtol, "solver": self.plan.method()} | words
        return mbd.simulate(self.mbd, t_end=(self.plan.t_end if t_end is None else t_end) * self.world.units[2], **options)


def _described(kind: str) -> Callable[..., Any]:
    head, _, tail = kind.partition(".")
    return getattr(getattr(mbd, head), tail) if tail else getattr(mbd, head)
