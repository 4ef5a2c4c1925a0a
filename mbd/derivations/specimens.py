"""Small scenes of every kind in ``elements/`` and ``joints/``, for its kernels to be tried in.

What stands between markers is built from the names of its fields (WORDS), in the plane and in space, between items of several kinds; scenes
that it refuses are left out. A new joint whose fields have the usual names needs nothing here; others a word, or a line in VARIANTS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

import mbd
from mbd import elements, joints
from mbd.errors import SceneError
from mbd.scene import Scene

GRAVITY = {2: (0.3, -9.81), 3: (0.3, -9.81, 0.7)}
STEEL: dict[str, Any] = {"E": 10.0, "A": 0.2, "I": 0.03, "rho": 2.0}
POINTS = 3  # Gauss points: the fewest allowed keep the sums short


class Specimen(NamedTuple):
    """A scene, and what is special about it."""

    what: str
    scene: Scene


def kinds() -> dict[str, type]:
    """Every description that the library exports, by name."""
    exported: dict[str, Any] = {name: getattr(home, name) for home in (elements, joints) for name in home.__all__}
    return {name: kind for name, kind in exported.items() if isinstance(kind, type) and is_dataclass(kind)}


def specimens(kind: type) -> list[Specimen]:
    """Scenes with an item of this kind; never none."""
    made = list(MASSIVE[kind.__name__]() if kind.__name__ in MASSIVE else _between(kind))
    if not made:
        raise LookupError(f"{kind.__module__}.{kind.__name__} has no specimen: add its fields to WORDS or VARIANTS in mbd/derivations/specimens.py")
    return made


# What has mass.


def _scene(d: int, *descriptions: Any) -> Scene:
    scene = Scene(GRAVITY[d])
    for description in descriptions:
        scene.add(description)
    return scene


def _cables() -> Iterator[Specimen]:
    variants: list[tuple[int, dict[str, Any]]] = [(2, {}), (3, {}), (2, {"elasticity": "local_frame"}), (2, {"gravity": "lumped"})]
    for d, words in variants:
        common: dict[str, Any] = {"n_elements": 2, "gauss_points": POINTS, "damping": 0.3} | STEEL | words
        ends = [(np.array([0.5 * k, 1.0, 0.3])[:d], np.array([1.3, 0.4 - k, 1.0])[:d]) for k in (0, 1)]
        cables = [mbd.AncfCable(*pair, name=f"rod{k}", **common) for k, pair in enumerate(ends)]
        yield Specimen(" ".join(["planar" if d == 2 else "spatial", *words.values()]), _scene(d, *cables))
    angles = np.array([0.0, 0.5, 1.2])
    arc: dict[str, Any] = {
        "nodes": np.stack((np.cos(angles), np.sin(angles)), axis=1),
        "tangents": np.stack((-np.sin(angles), np.cos(angles)), axis=1),
    }
    yield Specimen("curved", _scene(2, mbd.AncfCable(**arc, gauss_points=POINTS, damping=0.2, name="arc", **STEEL)))


def _bodies() -> Iterator[Specimen]:
    yield Specimen("planar", _scene(2, mbd.RigidBody(mass=1.5, inertia=0.3, position=(0.2, -0.4), angle=0.6, name="body")))
    inertia = np.array([[0.5, 0.05, 0.02], [0.05, 0.6, -0.04], [0.02, -0.04, 0.7]])
    yield Specimen("spatial", _scene(3, mbd.RigidBody(mass=1.5, inertia=inertia, position=(0.2, -0.4, 0.1), name="body")))


def _particles() -> Iterator[Specimen]:
    yield Specimen("planar", _scene(2, mbd.Particle(0.7, (0.2, -0.4), name="bob")))
    yield Specimen("spatial", _scene(3, mbd.Particle(0.7, (0.2, -0.4, 0.1), name="bob")))


MASSIVE: dict[str, Callable[[], Iterator[Specimen]]] = {"AncfCable": _cables, "RigidBody": _bodies, "Particle": _particles}

# What stands between markers.


def _body(scene: Scene, place: Any, name: str) -> Any:
    inertia = 0.3 if scene.dimension == 2 else (0.3, 0.4, 0.5)
    position = np.array(place[: scene.dimension]) - np.array([0.5, 0.25, 0.0])[: scene.dimension]
    return scene.add(mbd.RigidBody(mass=1.5, inertia=inertia, position=position, name=name)).at(*(0.5, 0.25, 0.0)[: scene.dimension])


def _cable(scene: Scene, place: Any, name: str) -> Any:
    start = np.array(place[: scene.dimension])
    axis = np.array([1.0, 0.0, 0.0])[: scene.dimension]
    return scene.add(mbd.AncfCable(start, start + axis, n_elements=1, gauss_points=POINTS, name=name, **STEEL)).start


def _particle(scene: Scene, place: Any, name: str) -> Any:
    return scene.add(mbd.Particle(0.7, place[: scene.dimension], name=name)).at()


def _ground(scene: Scene, place: Any, name: str) -> Any:
    return scene.ground.at(*place[: scene.dimension])


ENDS = {"body": _body, "cable": _cable, "particle": _particle, "ground": _ground}
PAIRS = (
    *(("body", "body"), ("cable", "body"), ("body", "cable"), ("cable", "cable")),
    *(("particle", "cable"), ("body", "ground"), ("particle", "particle")),
)
PLACES = ((0.0, 0.0, 0.0), (0.0, 0.5, 1.5))
"""Of the markers; apart across the cables, which lie along x."""


def _wave(t: float) -> float:
    return float(np.sin(3.0 * t) + 2.0 * t)


def _waves(d: int) -> Callable[[float], tuple[float, ...]]:
    return lambda t: tuple(_wave(t + k) for k in range(d))


FIRST, SECOND = ("a", "marker", "point"), ("b", "marker_on_line")
WORDS: dict[str, Callable[[int], Any]] = {
    "axis": lambda d: (3.0, -4.0) if d == 2 else (0.0, 3.0, -4.0),
    "stiffness": lambda d: 3.0,
    "damping": lambda d: 0.5,
    "vector": lambda d: (1.5, -2.0, 0.5)[:d],
    "value": lambda d: 1.5 if d == 2 else (1.5, -2.0, 0.5),
}
"""Required fields by name, for each dimension."""

AXIS = {"axis": (0.0, 3.0, -4.0)}
VARIANTS: dict[str, list[Any]] = {
    "Pin": [{}, AXIS],
    "Distance": [{}, {"length": 0.7}],
    "Spring": [{"damping": 0.5}, {"damping": 0.5, "length": 0.4}, {"damping": 0.5, "length": 0.0}],
    "TorsionSpring": [{"damping": 0.5, "angle": 0.2}],
    "Force": [{}, {"follower": True}, lambda d: {"vector": _waves(d)}, {"vector": (1.5, 0.0, 0.0), "follower": True}],
    "Torque": [{}, {"follower": True}, lambda d: {"value": _wave if d == 2 else _waves(3)}, {"value": (0.0, 1.5, -0.5)}],
    "Motor": [{"angle": _wave}, {"speed": _wave}, {"torque": _wave}],
    "Prescribed": [lambda d: {"position": _waves(d)}, {"angle": _wave}, {"position": (1.0, 2.0), "angle": 0.2}],
}
"""Further fields that make a kind another one, or functions of the dimension to such fields."""


def _between(kind: type) -> Iterator[Specimen]:
    names = [field.name for field in fields(kind)]
    required = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
    two = any(name in SECOND for name in names)
    pairs = PAIRS if two else tuple((first, "") for first in dict.fromkeys(first for first, _ in PAIRS))
    for k, variant in enumerate(VARIANTS.get(kind.__name__, [{}])):
        for d in (2, 3):
            words = variant(d) if callable(variant) else variant
            for ends in pairs[: 2 if k else None]:  # one variant between all ends, the others between the first
                scene = _built(kind, required, words, d, ends)
                if scene is not None:
                    special = (f"{name}={'f(t)' if callable(value) else value}" for name, value in words.items())
                    yield Specimen(" ".join(["planar" if d == 2 else "spatial", "-".join(filter(None, ends)), *special]), scene)


def _built(kind: type, required: list[str], words: dict[str, Any], d: int, ends: tuple[str, str]) -> Scene | None:
    """None for what the kind refuses, or cannot be made of WORDS."""
    scene = Scene(np.zeros(d))
    given = {name: WORDS[name](d) for name in required if name in WORDS} | words
    for side, names, name in ((0, FIRST, "A"), (1, SECOND, "B")):
        for field in (f.name for f in fields(kind) if f.name in names):
            given[field] = ENDS[ends[side]](scene, PLACES[side], name)
    if not set(required) <= set(given):
        return None
    try:
        scene.add(kind(**given, name="it"))
        scene.build()
    except SceneError:
        return None
    return scene
