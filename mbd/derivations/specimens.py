"""Small scenes of every kind in ``elements/`` and ``joints/``, for its kernels to be tried in.

What stands between markers is built from the names of its fields (``words.py``), in the plane and in space, between items of several kinds; scenes
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

from .words import ENDS, FIRST, PAIRS, PLACES, POINTS, SECOND, STEEL, VARIANTS, WORDS

GRAVITY = {2: (0.3, -9.81), 3: (0.3, -9.81, 0.7)}


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
        raise LookupError(f"{kind.__module__}.{kind.__name__} has no specimen: add its fields to WORDS or VARIANTS in mbd/derivations/words.py")
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


def _beams(kind: str, *variants: dict[str, Any]) -> Callable[[], Iterator[Specimen]]:
    """Two beams, one backwards and the other across."""

    def made() -> Iterator[Specimen]:
        for words in variants:
            ends = (((0.0, 1.0), (-1.3, 0.6)), ((0.5, 1.0), (0.3, -0.1)))
            common: dict[str, Any] = {"n_elements": 2, "damping": 0.3} | STEEL | words
            beams = [getattr(mbd, kind)(*pair, name=f"rod{k}", **common) for k, pair in enumerate(ends)]
            yield Specimen(" ".join(["planar", *(f"{name}={value}" for name, value in words.items())]), _scene(2, *beams))

    return made


def _bodies() -> Iterator[Specimen]:
    yield Specimen("planar", _scene(2, mbd.RigidBody(mass=1.5, inertia=0.3, position=(0.2, -0.4), angle=0.6, name="body")))
    inertia = np.array([[0.5, 0.05, 0.02], [0.05, 0.6, -0.04], [0.02, -0.04, 0.7]])
    yield Specimen("spatial", _scene(3, mbd.RigidBody(mass=1.5, inertia=inertia, position=(0.2, -0.4, 0.1), name="body")))


def _particles() -> Iterator[Specimen]:
    yield Specimen("planar", _scene(2, mbd.Particle(0.7, (0.2, -0.4), name="bob")))
    yield Specimen("spatial", _scene(3, mbd.Particle(0.7, (0.2, -0.4, 0.1), name="bob")))


MASSIVE: dict[str, Callable[[], Iterator[Specimen]]] = {
    "AncfCable": _cables,
    "CorotationalBeam": _beams("CorotationalBeam", {}),
    "FloatingFrameBeam": _beams("FloatingFrameBeam", {}, {"modes": "cantilever", "n_elements": 3}, {"stiffening": False}),
    "GeometricallyExactBeam": _beams("GeometricallyExactBeam", {}, {"GA": 0.7, "rotary_inertia": 0.2}),
    "RigidBody": _bodies,
    "Particle": _particles,
}


def _between(kind: type) -> Iterator[Specimen]:
    names = [field.name for field in fields(kind)]
    required = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
    two = any(name in SECOND for name in names)
    one = any(name in FIRST for name in names)
    pairs = PAIRS if two else tuple((first, "") for first in dict.fromkeys(first for first, _ in PAIRS)) if one else (("", ""),)
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
    given = {name: WORDS[name](scene) for name in required if name in WORDS and name not in words} | words
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
