"""The same scene on other meshes: every item described again, beams with more or fewer elements, markers found again by their places.

Functions of t, of measures and of states are the user's own and stay as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..marker import Marker
from ..parts import links_in
from ..scene import Scene


def doublings(scene: Scene) -> tuple[int, int]:
    """Which two other meshes to compare with: half and twice as many elements; where a number is odd, twice and four times. Raises ValueError
    for a scene without elements."""
    counts = [elements(item) for item in scene.items if _has_elements(item)]
    if not counts:
        raise ValueError("meshes: expected a scene with beams, found none that is made of elements; leave it out")
    return (-1, 1) if all(count % 2 == 0 for count in counts) else (1, 2)


def _has_elements(item: Any) -> bool:
    return hasattr(item.description, "n_elements")


def elements(item: Any) -> int:
    """How many an item is made of."""
    nodes = getattr(item.description, "nodes", None)
    return int(item.description.n_elements) if nodes is None else len(nodes) - 1


def remeshed(scene: Scene, doublings: int) -> Scene:
    """The scene with 2^doublings times as many elements in every beam, or half as many for -1."""
    other = Scene(scene.gravity)
    for item in scene.items:
        links = links_in(other, item.description, lambda marker: carried(marker, other))
        mesh = _mesh(item, 2.0**doublings) if _has_elements(item) else {}
        other.add(replace(item.description, **links | mesh | {"name": item.name}))
    return other


def carried(marker: Marker, scene: Scene) -> Marker:
    """The marker of the same place in another scene of the same names."""
    if marker.arguments is None:
        raise ValueError(f"meshes: expected markers made by at(...), found {marker!r} of a scene read from a file; describe the scene anew")
    found: Marker = scene[marker.item].at(*marker.arguments)
    return found


def carried_outputs(outputs: Mapping[str, Any], scene: Scene) -> dict[str, Any]:
    """Markers and items of another scene of the same names. Raises ValueError for functions: they may hold markers of one mesh."""
    functions = [name for name, source in outputs.items() if not isinstance(source, Marker) and not hasattr(source, "description")]
    if functions:
        found = ", ".join(map(repr, functions))
        raise ValueError(f"outputs: expected markers, bodies and joints, which are found again on other meshes, found functions: {found}; "
                         f"give meshes=build, a function that makes a scene and its outputs for each refinement")  # fmt: skip
    return {name: carried(source, scene) if isinstance(source, Marker) else scene[source.name] for name, source in outputs.items()}


def _mesh(item: Any, factor: float) -> dict[str, Any]:
    description = item.description
    if getattr(description, "nodes", None) is None:
        return {"n_elements": round(factor * elements(item))}
    nodes, tangents = _curve(item, factor)
    return {"nodes": nodes, "tangents": tangents, "n_elements": None}


def _curve(item: Any, factor: float) -> tuple[Any, Any]:
    """Nodes and unit tangents on the rest shape: those there are and the points between them, or every other one."""
    ends = np.concatenate(([0.0], np.cumsum(item.lengths))) / item.length
    count = round(factor * elements(item))
    places = np.interp(np.linspace(0.0, ends.size - 1.0, count + 1), np.arange(ends.size), ends)
    q = item.site.scene.layout.start()[0]
    markers = [item.at(float(min(place, 1.0))) for place in places]
    nodes, tangents = (np.array([value.value(q) for value in values]) for values in zip(*((m.point, m.axes[0]) for m in markers)))
    return nodes, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)
