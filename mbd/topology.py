"""The graph of a scene: bodies, what holds them together, and the loops that this makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .system import System

if TYPE_CHECKING:
    from .scene import Scene

GROUND = "ground"


def bodies(scene: Scene) -> list[str]:
    """Items with rows of the table: what has a place of its own."""
    system = scene.build()
    return list(dict.fromkeys(name for name, _ in system.owners[: system.n_table]))


def joints(system: System) -> list[str]:
    """Items with equations, but for those by which a body holds itself together."""
    return list(dict.fromkeys(name for name, _ in system.joints.labels if name not in system.internal))


def loops(scene: Scene) -> list[tuple[str, ...]]:
    """Closed ways through bodies and joints in turn, a basis of all, each from its first item on."""
    import networkx

    graph = networkx.Graph()
    for joint, sides in _sides(scene).items():
        graph.add_edges_from((("joint", joint), ("body", side)) for side in sides)
    place = {item.name: k for k, item in enumerate(scene.items)} | {GROUND: -1}
    ways = [[name for _, name in way] for way in networkx.cycle_basis(graph, ("body", GROUND) if ("body", GROUND) in graph else None)]
    return sorted((_from_first(way, place) for way in ways), key=lambda way: [place[name] for name in way])


def _from_first(way: list[str], place: dict[str, int]) -> tuple[str, ...]:
    first = min(range(len(way)), key=lambda k: place[way[k]])
    turned = way[first:] + way[:first]
    back = turned[:1] + turned[:0:-1]
    return tuple(min(turned, back, key=lambda names: [place[name] for name in names]))


def _sides(scene: Scene) -> dict[str, list[str]]:
    """The bodies that each joint joins, without what only measures: equations that its own coordinates take up hold nothing."""
    system = scene.build()
    owner = [name for name, _ in system.owners]
    labels = [name for name, _ in system.joints.labels]
    held = {name: labels.count(name) - owner[system.n_table :].count(name) for name in joints(system)}
    for rows, _ in system.joints.drives:
        for row in range(rows.start, rows.stop):
            held[labels[row]] -= 1
    found = {}
    for item in scene.items:
        if held.get(item.name, 0) > 0:
            found[item.name] = _joined(item, system, labels, owner)
    return found


def _joined(item: Any, system: System, labels: list[str], owner: list[str]) -> list[str]:
    """By its markers; what has none holds what its equations are about."""
    markers = getattr(item.description, "markers", ())
    if not markers:
        own = np.array([labels[row] == item.name for row in system.joints.rows])
        return list(dict.fromkeys(owner[column] for column in system.joints.cols[own]))
    names = [marker.item for marker in markers]
    return list(dict.fromkeys(names if len(names) > 1 else [*names, GROUND]))
