"""Independent parts of a scene: what no joint, spring or load connects is integrated separately, with steps of its own.

Two items belong together where a marker of one lies on the other; the ground connects nothing. Each part becomes a scene of its own,
made of the same descriptions, whose coordinates and equations are those of the whole scene in the same order, without the others.

Small parts of one kind are bundled: what a step of them costs is the interpreter's, the same for one pendulum and for many. They share the
steps of the fastest, within the tolerance of the smallest, where that costs less than steps of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array
from .marker import Marker
from .scene import Scene
from .system import System

Index = slice | NDArray[np.intp]

OVERHEAD = 150
"""A step costs, whatever its size, as much as this number of unknowns add to it (measured: 600; but rates are rough)."""


@dataclass(frozen=True, eq=False)
class Part:
    """A subsystem: the names of its items, its own equations, and where its coordinates and equations are in the whole scene."""

    items: tuple[str, ...]
    system: System
    columns: Index
    rows: Index

    @classmethod
    def whole(cls, scene: Scene) -> Part:
        """All of a scene as one part."""
        return cls(tuple(item.name for item in scene.items), scene.build(), slice(None), slice(None))

    def widened(self, x: Array, n: int) -> Array:
        """[..., n] in order of the whole scene from the part's own [..., n_part]; NaN where it has no say."""
        if isinstance(self.columns, slice):
            return x
        wide = np.full((*x.shape[:-1], n), np.nan)
        wide[..., self.columns] = x
        return wide


def split(scene: Scene) -> list[Part]:
    """The parts of a scene, in order of their first items."""
    groups = components(scene)
    if len(groups) == 1 or not all(is_dataclass(item.description) for item in scene.items):
        return [Part.whole(scene)]
    system = scene.build()
    number = {item.name: k for k, group in enumerate(groups) for item in group}
    by_column = np.array([number[name] for name, _ in system.owners])
    by_row = np.array([number[name] for name, _ in system.joints.labels], dtype=np.intp)
    if np.unique(by_column).size < len(groups):  # an item without coordinates or markers may act on anything
        return [Part.whole(scene)]
    places = zip(_placed(by_column, len(groups)), _placed(by_row, len(groups)))
    return _bundled(scene, [_part(scene, group, *place, system.length) for group, place in zip(groups, places)])


def _bundled(scene: Scene, parts: list[Part]) -> list[Part]:
    """The parts, small ones of one kind and similar pace put together, in order of their first items."""
    kinds: dict[Any, list[Part]] = {}
    for part in parts:
        kinds.setdefault(_kind(part), []).append(part)
    bundles = [bundle for kind in kinds.values() for bundle in _by_pace(scene, kind)]
    place = {item.name: k for k, item in enumerate(scene.items)}
    bundles.sort(key=lambda bundle: min(place[part.items[0]] for part in bundle))
    return [_bundle(scene, bundle, place) for bundle in bundles]


def _kind(part: Part) -> Any:
    """Equal for parts that may share steps: rigid ones under gravity, small elastic ones of the same masses and stiffness. Loads and drives
    may do anything at any time: what has some is of its own kind."""
    system = part.system
    if system.loads or system.joints.drives or system.dead.any():
        return part
    if not system.n_stresses:
        return "rigid"
    if system.n + system.m > OVERHEAD:
        return part
    masses = system.mass_values[system.mass_rows == system.mass_cols]
    viscosity = np.zeros(0) if system.viscosity is None else system.viscosity
    numbers = tuple(tuple(np.char.mod("%.9g", values)) for values in (masses, system.modulus, viscosity))  # equal but for rounding
    return (system.n, system.m, numbers)


def _by_pace(scene: Scene, parts: list[Part]) -> list[list[Part]]:
    """Bundles of parts of one kind: each joins a faster one where steps of its own would cost more than its share of all of those."""
    bundles: list[list[Part]] = []
    fastest = np.inf
    for part in sorted(parts, key=lambda part: -_rate(scene, part.system)):
        rate, size = _rate(scene, part.system), part.system.n + part.system.m
        if fastest * size <= rate * (OVERHEAD + size):
            bundles[-1].append(part)
        else:
            bundles.append([part])
            fastest = rate
    return bundles


def _rate(scene: Scene, system: System) -> float:
    """How fast a system moves [1/s]: by its velocities, or as a pendulum of its length. Of one kind, steps are taken in proportion to it."""
    speed = float(np.max(np.abs(system.v0) * system.levers, initial=0.0))
    return max(speed / system.length, float(np.sqrt(np.linalg.norm(scene.gravity) / system.length)))


def _bundle(scene: Scene, parts: list[Part], place: dict[str, int]) -> Part:
    if len(parts) == 1:
        return parts[0]
    names = sorted((name for part in parts for name in part.items), key=place.__getitem__)
    columns, rows = (np.sort(np.concatenate([getattr(part, what) for part in parts])) for what in ("columns", "rows"))
    return _part(scene, [scene[name] for name in names], columns, rows, min(part.system.length for part in parts))


def _placed(owner: NDArray[np.intp], count: int) -> list[NDArray[np.intp]]:
    """Where each of so many parts is mentioned, ascending."""
    return np.split(np.argsort(owner, kind="stable"), np.cumsum(np.bincount(owner, minlength=count))[:-1])


def components(scene: Scene) -> list[list[Any]]:
    """The items of each part, in order of ``add``."""
    leader = {item.name: item.name for item in scene.items}

    def find(name: str) -> str:
        while leader[name] != name:
            leader[name] = leader[leader[name]]
            name = leader[name]
        return name

    owners, d = scene.build().owners, scene.dimension
    for item in scene.items:
        for marker in getattr(item.description, "markers", ()):
            for map_ in (marker.point, *marker.axes):
                for row in map_.rows.tolist():
                    leader[find(owners[d * row][0])] = find(item.name)
        for other in _mentioned(list(vars(item.description).values())):
            leader[find(other)] = find(item.name)
    groups: dict[str, list[Any]] = {}
    for item in scene.items:
        groups.setdefault(find(item.name), []).append(item)
    return list(groups.values())


def _part(scene: Scene, items: Sequence[Any], columns: NDArray[np.intp], rows: NDArray[np.intp], longest: float) -> Part:
    """The part of these items, whose errors are measured by its own length, ``longest`` [m] at most: a point alone has none."""
    d = scene.dimension
    table = columns[columns < d * scene.layout.n_rows][::d] // d
    new_row = np.full(scene.layout.n_rows, -1)
    new_row[table] = np.arange(table.size)
    own = Scene(scene.gravity)
    for item in items:
        links = links_in(own, item.description, lambda marker: _moved_marker(marker, own, new_row))
        own.add(replace(item.description, **links | {"name": item.name}))
    system = own.build()
    system.length = min(system.length, longest)
    return Part(tuple(item.name for item in items), system, columns, rows)


def _is_item(value: Any) -> bool:
    return hasattr(value, "description") and hasattr(value, "name")


def _mentioned(value: Any) -> list[str]:
    """Names of the items that a field holds, in lists too: a cable that is slid along, measures that are coupled."""
    if isinstance(value, (list, tuple)):
        return [name for part in value for name in _mentioned(part)]
    return [value.name] if _is_item(value) else []


def links_in(scene: Scene, description: Any, carry: Callable[[Marker], Marker]) -> dict[str, Any]:
    """The fields of a description that lead to other items, as they are in another scene of the same names; ``carry`` takes markers there."""
    given = {field.name: getattr(description, field.name) for field in fields(description)}
    return {name: _moved(value, scene, carry) for name, value in given.items() if isinstance(value, (Marker, list, tuple)) or _is_item(value)}


def _moved(value: Any, scene: Scene, carry: Callable[[Marker], Marker]) -> Any:
    """A field in another scene: a marker as it is carried, an item by its name, lists of them; anything else as it is."""
    if isinstance(value, (list, tuple)):
        return [_moved(part, scene, carry) for part in value]
    if _is_item(value):
        return scene[value.name]
    return carry(value) if isinstance(value, Marker) else value


def _moved_marker(marker: Marker, scene: Scene, new_row: NDArray[np.intp]) -> Marker:
    """The marker with the rows of its part."""
    point, *axes = (Affine(new_row[map_.rows], map_.weights, map_.constant) for map_ in (marker.point, *marker.axes))
    return Marker(marker.item, scene, point, tuple(axes), marker.rigid, marker.arguments)
