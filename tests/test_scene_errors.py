"""Bad scenes: one clear line for each mistake (which item, what was expected, what found, how to mend), all lines of a scene at once."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mbd

NAN = float("nan")
ONES = {"n_elements": 2, "E": 1.0, "A": 1.0, "I": 1.0, "rho": 1.0}


def scene_of(d: int) -> mbd.Scene:
    return mbd.Scene(gravity=(0.0,) * d)


def body(d: int = 2, **changes: Any) -> mbd.RigidBody:
    return mbd.RigidBody(**{"mass": 1.0, "inertia": 1.0 if d == 2 else (1.0, 1.0, 1.0), "position": (0.0,) * d, "name": "it", **changes})


def cable(d: int = 2, **changes: Any) -> mbd.AncfCable:
    start, end = (0.0,) * d, (1.0,) + (0.0,) * (d - 1)
    return mbd.AncfCable(changes.pop("start", start), changes.pop("end", end), **{**ONES, "name": "it", **changes})


def through(nodes: Any, **changes: Any) -> mbd.AncfCable:
    return mbd.AncfCable(nodes=nodes, **{**ONES, "n_elements": None, "name": "it", **changes})


def on_body(attach: Callable[[Any], Any], d: int = 2) -> Callable[[mbd.Scene], Any]:
    """An item attached to a good body by its marker at the mass centre, displaced from the origin."""
    return lambda s: s.add(attach(s.add(body(d, position=(1.0,) * d, name="good")).at()))


def on_particle(attach: Callable[[Any], Any], d: int = 2) -> Callable[[mbd.Scene], Any]:
    return lambda s: s.add(attach(s.add(mbd.Particle(1.0, (1.0,) * d, name="dust")).at()))


def on_cable(attach: Callable[[Any], Any], d: int = 3) -> Callable[[mbd.Scene], Any]:
    return lambda s: s.add(attach(s.add(cable(d, name="rope")).end))


def on_origin(kind: Callable[..., Any], **words: Any) -> Callable[[mbd.Scene], Any]:
    """Between a good planar body and the origin of the ground."""
    return lambda s: s.add(kind(s.add(body(position=(1.0, 1.0), name="good")).at(), s.ground.at(0, 0), name="it", **words))


def alien(d: int, other: int) -> Callable[[mbd.Scene], Any]:
    """A pin between a good body and a marker of another scene."""
    return on_body(lambda m: mbd.Pin(m, scene_of(other).add(body(other, name="alien")).at(), name="it", axis=None if d == 2 else (0, 0, 1)), d)


def add(description: Any) -> Callable[[mbd.Scene], Any]:
    return lambda s: s.add(description)


# id: (dimension, what is done to the scene, how the line begins, what it says)
BAD: dict[str, tuple[int, Callable[[mbd.Scene], Any], str, str]] = {
    # planar and spatial mixed
    "3 components in a planar body": (2, add(body(3)), "body 'it': position", "2 numbers in a planar scene"),
    "2 components in a spatial body": (3, add(body(2, angle=0.1)), "body 'it': position", "3 numbers in a spatial scene"),
    "spatial rod in a planar scene": (2, add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=1, name="it")), "body 'it': position", "planar"),
    "spatial cable in a planar scene": (2, add(cable(3)), "cable 'it': start", "planar"),
    "planar cable in a spatial scene": (3, add(cable(2)), "cable 'it': start", "spatial"),
    "spatial nodes in a planar scene": (2, add(through([(0, 0, 0), (1, 0, 0)])), "cable 'it': nodes", "2 numbers"),
    "spatial particle in a planar scene": (2, add(mbd.Particle(1, (0, 0, 0), name="it")), "particle 'it': position", "planar"),
    "spatial velocity in a planar scene": (2, add(body(velocity=(0, 0, 0))), "body 'it': velocity", "planar"),
    "spatial force in a planar scene": (2, on_body(lambda m: mbd.Force(m, (0, 0, 1), name="it")), "force 'it': vector", "2 numbers"),
    "spatial torque in a planar scene": (2, on_body(lambda m: mbd.Torque(m, (0, 0, 1), name="it")), "torque 'it': value", "a number"),
    "planar torque in a spatial scene": (3, on_body(lambda m: mbd.Torque(m, 1.0, name="it"), 3), "torque 'it': value", "3 numbers"),
    "spatial ground point in a planar scene": (
        2,
        on_body(lambda m: mbd.Pin(m, m.scene.ground.at(0, 0, 0), name="it")),
        "pin 'it': marker",
        "do not mix",
    ),
    "marker of a spatial scene": (2, alien(2, 3), "pin 'it': marker", "do not mix"),
    "marker of a planar scene": (3, alien(3, 2), "pin 'it': marker", "do not mix"),
    "rotation matrix in a planar scene": (2, add(body(rotation=np.eye(3))), "body 'it': rotation", "angle="),
    "angle in a spatial scene": (3, add(body(3, angle=0.1)), "body 'it': angle", "rotation="),
    "axis of a planar pin": (2, on_origin(mbd.Pin, axis=(0, 0, 1)), "pin 'it': axis", "planar"),
    "torsion spring in space": (
        3,
        on_body(lambda m: mbd.TorsionSpring(m, m.scene.ground.at(0, 0, 0), stiffness=1, name="it"), 3),
        "torsion spring 'it': scene",
        "spatial",
    ),
    # attached to nothing, or wrongly
    "marker None": (2, on_body(lambda m: mbd.Pin(m, None, name="it")), "pin 'it': marker", "found None"),
    "both markers None": (2, lambda s: (s.add(body(name="good")), s.add(mbd.Clamp(None, None, name="it"))), "clamp 'it': marker", "found None"),
    "force on nothing": (2, lambda s: (s.add(body(name="good")), s.add(mbd.Force(None, (0, 0), name="it"))), "force 'it': marker", "found None"),
    "an item for a marker": (
        2,
        lambda s: s.add(mbd.Pin(s.add(body(name="good")), s.ground.at(0, 0), name="it")),
        "pin 'it': marker",
        "the item 'good'",
    ),
    "both ends on the ground": (
        2,
        lambda s: (s.add(body(name="good")), s.add(mbd.Pin(s.ground.at(0, 0), s.ground.at(0, 0), name="it"))),
        "pin 'it': marker",
        "a moving item",
    ),
    "both ends on one body": (
        2,
        lambda s: (b := s.add(body(name="good"))) and s.add(mbd.Distance(b.at(0, 0), b.at(1, 0), name="it")),
        "distance 'it': marker",
        "both ends on 'good'",
    ),
    "marker of another scene": (2, alien(2, 2), "pin 'it': marker", "another scene"),
    "ground of another scene": (
        2,
        on_body(lambda m: mbd.Pin(m, scene_of(2).ground.at(0, 0), name="it")),
        "pin 'it': marker",
        "another scene",
    ),
    "clamp on a particle": (2, on_particle(lambda m: mbd.Clamp(m, m.scene.ground.at(1, 1), name="it")), "clamp 'it': marker", "'dust'"),
    "torque on a particle": (2, on_particle(lambda m: mbd.Torque(m, 1.0, name="it")), "torque 'it': marker", "'dust'"),
    "follower force on a particle": (2, on_particle(lambda m: mbd.Force(m, (1, 0), follower=True, name="it")), "force 'it': marker", "'dust'"),
    "torsion spring on a particle": (
        2,
        on_particle(lambda m: mbd.TorsionSpring(m, m.scene.ground.at(0, 0), stiffness=1, name="it")),
        "torsion spring 'it': marker",
        "'dust'",
    ),
    "spatial pin on a particle": (
        3,
        on_particle(lambda m: mbd.Pin(m, m.scene.ground.at(1, 1, 1), axis=(0, 0, 1), name="it"), 3),
        "pin 'it': marker",
        "'dust'",
    ),
    # directions
    "spatial pin without axis": (3, on_body(lambda m: mbd.Pin(m, m.scene.ground.at(1, 1, 1), name="it"), 3), "pin 'it': axis", "found none"),
    "pin with a zero axis": (3, on_body(lambda m: mbd.Pin(m, m.scene.ground.at(1, 1, 1), axis=(0, 0, 0), name="it"), 3), "pin 'it': axis", "zero"),
    "pin about a cable's tangent": (
        3,
        on_cable(lambda m: mbd.Pin(m, m.scene.ground.at(1, 0, 0), axis=(1, 0, 0), name="it")),
        "pin 'it': axis",
        "'rope'",
    ),
    "pin between two spatial cables": (
        3,
        on_cable(lambda m: mbd.Pin(m, m.scene.add(cable(3, start=(1, 0, 0), end=(2, 0, 0), name="other")).start, axis=(0, 0, 1), name="it")),
        "pin 'it': marker",
        "Ball",
    ),
    "clamp of cables at an angle": (
        3,
        on_cable(lambda m: mbd.Clamp(m, m.scene.add(cable(3, start=(1, 0, 0), end=(1, 2, 0), name="other")).start, name="it")),
        "clamp 'it': tangents",
        "parallel",
    ),
    "torque along a spatial cable": (3, on_cable(lambda m: mbd.Torque(m, (1, 2, 0), name="it")), "torque 'it': ", "no component along"),
    "varying torque along a spatial cable": (3, on_cable(lambda m: mbd.Torque(m, lambda t: (1, t, 0), name="it")), "torque 'it': ", "no component"),
    "follower torque on a spatial cable": (
        3,
        on_cable(lambda m: mbd.Torque(m, (0, 1, 0), follower=True, name="it")),
        "torque 'it': follower",
        "dead",
    ),
    "follower force across a spatial cable": (
        3,
        on_cable(lambda m: mbd.Force(m, (0, 1, 0), follower=True, name="it")),
        "force 'it': vector",
        "tangent",
    ),
    "distance of zero": (2, on_origin(mbd.Distance, length=0), "distance 'it': length", "0.0"),
    "distance between coinciding points": (
        2,
        on_body(lambda m: mbd.Distance(m, m.scene.ground.at(1, 1), name="it")),
        "distance 'it': markers",
        "Ball",
    ),
    "spring of a length between coinciding points": (
        2,
        on_body(lambda m: mbd.Spring(m, m.scene.ground.at(1, 1), stiffness=1, length=1, name="it")),
        "spring 'it': ",
        "length=0",
    ),
    # numbers out of range
    "negative mass of a body": (2, add(body(mass=-1)), "body 'it': mass", "-1.0"),
    "no mass of a body": (3, add(body(3, mass=0)), "'it': expected inertia or joints", "give it mass"),
    "negative mass of a rod": (2, add(mbd.RigidBody.rod((0, 0), (1, 0), mass=-1, name="it")), "body 'it': mass", "-1.0"),
    "negative mass of a spatial rod": (3, add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=-1, name="it")), "body 'it': mass", "-1.0"),
    "negative mass of a box": (2, add(mbd.RigidBody.box((1, 1), mass=-1, position=(0, 0), name="it")), "body 'it': mass", "-1.0"),
    "negative mass of a particle": (2, add(mbd.Particle(-1, (0, 0), name="it")), "particle 'it': mass", "-1.0"),
    "negative density": (2, add(cable(rho=-1)), "cable 'it': rho", "-1.0"),
    "negative damping": (2, add(cable(damping=-1)), "cable 'it': damping", "-1.0"),
    "negative stiffness": (2, on_origin(mbd.Spring, stiffness=-1), "spring 'it': stiffness", "-1.0"),
    "text for a number": (2, add(body(mass="heavy")), "body 'it': mass", "'heavy'"),
    "two Young's moduli": (2, add(cable(E=(1, 2))), "cable 'it': E", "[1.0, 2.0]"),
    "zero-length cable": (2, add(cable(end=(0, 0))), "cable 'it': length", "[0.0, 0.0]"),
    "zero-length cable, spatial": (3, add(cable(3, end=(0, 0, 0))), "cable 'it': length", "[0.0, 0.0]"),
    "zero-length element": (2, add(through([(0, 0), (0, 0), (1, 0)])), "cable 'it': length", "[0.0, 1.0]"),
    "zero-length rod": (2, add(mbd.RigidBody.rod((1, 1), (1, 1), mass=1, name="it")), "body 'it': length", "equal ends"),
    "zero-length rod, spatial": (3, add(mbd.RigidBody.rod((1, 1, 1), (1, 1, 1), mass=1, name="it")), "body 'it': length", "equal ends"),
    "flat box": (2, lambda s: s.add(mbd.RigidBody.box((1, 0), mass=1, position=(0, 0), name="it")), "body 'it': size", "[1.0, 0.0]"),
    "negative radius": (3, lambda s: s.add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=1, radius=-1, name="it")), "body 'it': radius", "-1"),
    "zero tangent": (2, add(through([(0, 0), (1, 0)], tangents=[(1, 0), (0, 0)])), "cable 'it': tangents", "a zero one"),
    "backward tangent": (2, add(through([(0, 0), (1, 0)], tangents=[(1, 0), (-1, 0)])), "cable 'it': tangents", "node 1"),
    "no elements": (2, add(cable(n_elements=0)), "cable 'it': n_elements", "found 0"),
    "negative number of elements": (2, add(cable(n_elements=-1)), "cable 'it': n_elements", "found -1"),
    "half an element": (2, add(cable(n_elements=2.5)), "cable 'it': n_elements", "found 2.5"),
    "elements not given": (2, add(cable(n_elements=None)), "cable 'it': n_elements", "found None"),
    "elements against nodes": (2, add(through([(0, 0), (1, 0)], n_elements=3)), "cable 'it': n_elements", "expected 1"),
    "two Gauss points": (2, add(cable(gauss_points=2)), "cable 'it': gauss_points", "found 2"),
    "unknown elasticity": (2, add(cable(elasticity="rubber")), "cable 'it': elasticity", "'rubber'"),
    "unknown gravity": (2, add(cable(gravity="heavy")), "cable 'it': gravity", "'heavy'"),
    "chord frame in space": (3, add(cable(3, elasticity="local_frame")), "cable 'it': elasticity", "'continuum'"),
    "chord frame, curved": (2, add(through([(0, 0), (1, 0), (1.8, 0.8)], elasticity="local_frame")), "cable 'it': nodes", "straight"),
    "curved cable in space": (3, add(through([(0, 0, 0), (1, 0, 0), (1.8, 0.8, 0)])), "cable 'it': nodes", "straight"),
    "one node": (2, add(through([(0, 0)])), "cable 'it': nodes", "at least two"),
    "nodes and ends": (2, add(mbd.AncfCable((0, 0), nodes=[(0, 0), (1, 0)], **{**ONES, "n_elements": None}, name="it")), "cable 'it': nodes", "both"),
    "tangents of another shape": (2, add(through([(0, 0), (1, 0)], tangents=[(1, 0)])), "cable 'it': tangents", "2 nodes"),
    "tangents without nodes": (2, add(cable(tangents=[(1, 0)])), "cable 'it': tangents", "found none"),
    "fraction of a cable": (2, lambda s: s.add(cable()).at(1.2), "cable 'it': at", "1.2"),
    "3 components of a planar arm": (2, lambda s: s.add(body()).at(0, 0, 0), "body 'it': at", "(0, 0, 0)"),
    # inertia
    "triangle inequality": (3, add(body(3, inertia=(1, 1, 3))), "body 'it': inertia", "triangle inequality"),
    "triangle inequality of a matrix": (3, add(body(3, inertia=[[2, 1.5, 0], [1.5, 2, 0], [0, 0, 1]])), "body 'it': inertia", "[0.5, 1.0, 3.5]"),
    "negative moment": (3, add(body(3, inertia=(-1, 1, 1))), "body 'it': inertia", "-1.0"),
    "asymmetric inertia": (3, add(body(3, inertia=[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])), "body 'it': inertia", "symmetric"),
    "one moment in space": (3, add(body(3, inertia=1.0)), "body 'it': inertia", "three moments"),
    "three moments in the plane": (2, add(body(inertia=(1, 1, 1))), "body 'it': inertia", "[1.0, 1.0, 1.0]"),
    "no inertia in the plane": (2, add(body(inertia=0)), "'it': expected inertia or joints", "give it mass"),
    "a mirror for a rotation": (3, add(body(3, rotation=np.diag((1, 1, -1)))), "body 'it': rotation", "right-handed"),
    "needle without inertia about its axis": (3, add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=1, name="it")), "'it': ", "inertia"),
    # names
    "duplicate name": (2, lambda s: (s.add(body()), s.add(mbd.Particle(1, (1, 0), name="it"))), "particle 'it': name", "a second time"),
    "the ground's name": (2, add(body(name="ground")), "body 'ground': name", "a second time"),
    "a number for a name": (2, add(body(name=3)), "body: name", "found 3"),
    # scenes
    "empty scene": (2, lambda s: None, "scene: ", "at least one item"),
    "only loads": (2, lambda s: s.ground.at(0, 0), "scene: ", "at least one item"),
}

NANS: dict[str, tuple[int, Callable[[mbd.Scene], Any], str]] = {
    **{f"body {f}": (2, add(body(**{f: NAN})), f"body 'it': {f}") for f in ("mass", "inertia", "angle", "angular_velocity")},
    **{f"body {f}": (2, add(body(**{f: (0, NAN)})), f"body 'it': {f}") for f in ("position", "velocity")},
    **{
        f"spatial body {f}": (3, add(body(3, **{f: (0, 0, NAN)})), f"body 'it': {f}") for f in ("position", "velocity", "angular_velocity", "inertia")
    },
    "spatial body rotation": (3, add(body(3, rotation=np.eye(3) * NAN)), "body 'it': rotation"),
    "spatial body inertia matrix": (3, add(body(3, inertia=np.eye(3) * NAN)), "body 'it': inertia"),
    "rod end": (2, add(mbd.RigidBody.rod((0, NAN), (1, 0), mass=1, name="it")), "body 'it': position"),
    "spatial rod end": (3, add(mbd.RigidBody.rod((0, NAN, 0), (1, 0, 0), mass=1, name="it")), "body 'it': position"),
    "rod mass": (2, add(mbd.RigidBody.rod((0, 0), (1, 0), mass=NAN, name="it")), "body 'it': mass"),
    "rod radius": (3, lambda s: s.add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=1, radius=NAN, name="it")), "body 'it': radius"),
    "box size": (2, lambda s: s.add(mbd.RigidBody.box((1, NAN), mass=1, position=(0, 0), name="it")), "body 'it': size"),
    **{f"cable {f}": (2, add(cable(**{f: NAN})), f"cable 'it': {f}") for f in ("E", "A", "I", "rho", "damping", "n_elements", "gauss_points")},
    **{f"cable {f}": (2, add(cable(**{f: (NAN, 0)})), f"cable 'it': {f}") for f in ("start", "end")},
    "cable nodes": (2, add(through([(0, 0), (1, NAN)])), "cable 'it': nodes"),
    "cable tangents": (2, add(through([(0, 0), (1, 0)], tangents=[(1, 0), (1, NAN)])), "cable 'it': tangents"),
    "cable at": (2, lambda s: s.add(cable()).at(NAN), "cable 'it': at"),
    "particle mass": (2, add(mbd.Particle(NAN, (0, 0), name="it")), "particle 'it': mass"),
    "particle position": (2, add(mbd.Particle(1, (0, NAN), name="it")), "particle 'it': position"),
    "particle velocity": (2, add(mbd.Particle(1, (0, 0), (0, NAN), name="it")), "particle 'it': velocity"),
    **{f"spring {f}": (2, on_origin(mbd.Spring, **{"stiffness": 1, f: NAN}), f"spring 'it': {f}") for f in ("stiffness", "damping", "length")},
    **{
        f"torsion spring {f}": (2, on_origin(mbd.TorsionSpring, **{"stiffness": 1, f: NAN}), f"torsion spring 'it': {f}")
        for f in ("stiffness", "damping", "angle")
    },
    "force": (2, on_body(lambda m: mbd.Force(m, (0, NAN), name="it")), "force 'it': vector"),
    "torque": (2, on_body(lambda m: mbd.Torque(m, NAN, name="it")), "torque 'it': value"),
    "spatial torque": (3, on_body(lambda m: mbd.Torque(m, (0, 0, NAN), name="it"), 3), "torque 'it': value"),
    "distance": (2, on_origin(mbd.Distance, length=NAN), "distance 'it': length"),
    "pin axis": (3, on_body(lambda m: mbd.Pin(m, m.scene.ground.at(1, 1, 1), axis=(NAN, 0, 0), name="it"), 3), "pin 'it': axis"),
    "ground point": (2, on_body(lambda m: mbd.Pin(m, m.scene.ground.at(0, NAN), name="it")), "pin 'it': marker"),
    "body point": (2, lambda s: s.add(mbd.Pin(s.add(body(name="good")).at(NAN, 0), s.ground.at(0, 0), name="it")), "pin 'it': marker"),
}


def complaints(d: int, prepare: Callable[[mbd.Scene], Any]) -> list[str]:
    scene = scene_of(d)
    with pytest.raises(mbd.SceneError) as caught:
        prepare(scene)
        mbd.assemble(scene)
    assert str(caught.value) == "\n".join(caught.value.complaints)
    return caught.value.complaints


def is_clear(line: str) -> bool:
    """what: expected ..., found ...; how to mend."""
    return re.fullmatch(r".+: (.+: )?expected .+, found .+; .+", line) is not None and "\n" not in line and "object at 0x" not in line


@pytest.mark.parametrize("case", BAD)
def test_one_clear_line(case: str) -> None:
    d, prepare, start, part = BAD[case]
    lines = complaints(d, prepare)
    assert len(lines) == 1
    assert lines[0].startswith(start)
    assert part in lines[0]
    assert is_clear(lines[0])


@pytest.mark.parametrize("case", NANS)
def test_one_clear_line_for_nan(case: str) -> None:
    d, prepare, start = NANS[case]
    lines = complaints(d, prepare)
    assert len(lines) == 1
    assert lines[0].startswith(start)
    assert "nan" in lines[0].lower()
    assert is_clear(lines[0])


@pytest.mark.parametrize(
    ("gravity", "found"), [((0, NAN), "nan"), ((0, 0, NAN), "nan"), ((0, 0, 0, 0), "[0.0, 0.0, 0.0, 0.0]"), (9.81, "9.81"), ("down", "'down'")]
)
def test_gravity(gravity: Any, found: str) -> None:
    scene = mbd.Scene(gravity=gravity)
    d = len(gravity) if np.size(gravity) == 3 and not isinstance(gravity, str) else 2
    scene.add(body(d))
    with pytest.raises(mbd.SceneError) as caught:
        scene.build()
    (line,) = caught.value.complaints
    assert line.startswith("scene: gravity: expected two (planar) or three (spatial)")
    assert found in line
    assert is_clear(line)


def test_all_complaints_of_a_scene_at_once() -> None:
    """In order of ``add``, one for each mistake; good items are not mentioned."""
    scene = scene_of(2)
    scene.add(body(mass=-1, inertia=NAN, name="a"))
    good = scene.add(body(name="good"))
    scene.add(cable(n_elements=0, elasticity="rubber", name="b"))
    scene.add(mbd.Pin(good.at(), None, name="c"))
    scene.add(mbd.Particle(1, (0, 0, 0), name="good"))
    with pytest.raises(mbd.SceneError) as caught:
        mbd.simulate(scene, t_end=1.0)
    starts = ["body 'a': mass", "body 'a': inertia", "cable 'b': elasticity", "cable 'b': n_elements", "pin 'c': marker"]
    starts += ["particle 'good': name", "particle 'good"]
    assert len(caught.value.complaints) == len(starts)
    for line, start in zip(caught.value.complaints, starts):
        assert line.startswith(start)
        assert is_clear(line)


def test_what_leans_on_a_refused_item_adds_no_noise() -> None:
    """Joints, springs and loads on a refused item are silent."""
    for refused in (body(mass=-1), cable(end=(0, 0)), mbd.Particle(-1, (0, 0), name="it")):
        scene = scene_of(2)
        it, good = scene.add(refused), scene.add(body(name="good"))
        scene.add(mbd.Pin(it.at(), scene.ground.at(0, 0)))
        scene.add(mbd.Clamp(scene.ground.at(0, 0), it.at(0.5)))
        scene.add(mbd.Distance(good.at(), it.end if hasattr(it, "end") else it.at()))
        scene.add(mbd.Ball(it.start, it.end))
        scene.add(mbd.Spring(it.at(), good.at(), stiffness=1, length=1))
        scene.add(mbd.TorsionSpring(it.at(), good.at(), stiffness=1))
        scene.add(mbd.Force(it.at(), (0, 1), follower=True))
        scene.add(mbd.Torque(it.at(), 1.0))
        with pytest.raises(mbd.SceneError) as caught:
            scene.build()
        (line,) = caught.value.complaints
        assert line.startswith(f"{refused.kind} 'it': ")


def test_a_forgotten_keyword_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="rho"):
        mbd.AncfCable((0, 0), (1, 0), n_elements=1, E=1, A=1, I=1)
    with pytest.raises(TypeError, match="descriptions"):
        scene_of(2).add("a body")


# Times, tolerances and start states.


def oscillator() -> mbd.Scene:
    scene = scene_of(2)
    dot = scene.add(mbd.Particle(1.0, (1.0, 0.0), name="dot"))
    scene.add(mbd.Spring(dot.at(), scene.ground.at(0, 0), stiffness=1.0, length=0.5))
    return scene


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ({"t_end": NAN}, "t_end"),
        ({"t_end": -1.0}, "t_end"),
        ({"t_end": 0.0}, "t_end"),
        ({"t_end": float("inf")}, "t_end"),
        ({"rtol": 0.0}, "rtol"),
        ({"rtol": -1e-6}, "rtol"),
        ({"rtol": NAN}, "rtol"),
        ({"rtol": 2.0}, "rtol"),
        ({"t_eval": [0.0, NAN]}, "t_eval"),
        ({"t_eval": [0.5, 0.2]}, "t_eval"),
        ({"t_eval": [0.5, 1.5]}, "t_eval"),
        ({"t_eval": [-0.5, 0.5]}, "t_eval"),
        ({"t_eval": [[0.1, 0.2]]}, "t_eval"),
        ({"start": mbd.State([1.0, 2.0, 3.0], [0.0, 0.0])}, "start: q"),
        ({"start": mbd.State([1.0, 2.0], [0.0])}, "start: v"),
        ({"start": mbd.State([1.0, NAN], [0.0, 0.0])}, "start: q"),
        ({"start": mbd.State([1.0, 2.0], [NAN, 0.0])}, "start: v"),
        ({"start": mbd.State([1.0, 2.0], [0.0, 0.0], t=2.0)}, "t_end"),
    ],
    ids=str,
)
def test_times_tolerances_and_states(words: dict[str, Any], start: str) -> None:
    with pytest.raises(mbd.SceneError) as caught:
        mbd.simulate(oscillator(), **{"t_end": 1.0, **words})
    (line,) = caught.value.complaints
    assert line.startswith(f"{start}: ")
    assert is_clear(line)
    if start.startswith("start") and np.isnan([*words["start"].q, *words["start"].v]).any():
        assert "dot position" in line


# Joints that repeat or contradict each other.


def linkage(extra: Callable[[mbd.Scene, Any, Any], Any] | None = None) -> tuple[mbd.Scene, Any]:
    """A double pendulum of rods, with something more."""
    scene = mbd.Scene(gravity=(0, -9.81))
    upper = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="upper"))
    lower = scene.add(mbd.RigidBody.rod((1, 0), (2, 0.5), mass=2.0, name="lower"))
    scene.add(mbd.Pin(upper.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    scene.add(mbd.Pin(upper.at(0.5, 0), lower.at(-lower.length / 2, 0), name="elbow"))
    if extra:
        extra(scene, upper, lower)
    return scene, lower.at(lower.length / 2, 0)


REDUNDANT = {
    "twin": (lambda s, a, b: s.add(mbd.Pin(a.at(0.5, 0), b.at(-b.length / 2, 0), name="twin")), "'elbow', 'twin'"),
    "turned twin": (lambda s, a, b: s.add(mbd.Ball(b.at(-b.length / 2, 0), a.at(0.5, 0), name="twin")), "'elbow', 'twin'"),
    "rod along a body": (lambda s, a, b: s.add(mbd.Distance(a.at(0.2, 0), s.ground.at(0, 0), name="stay")), "'pivot', 'stay'"),
}


@pytest.mark.parametrize("case", REDUNDANT)
def test_redundant_joints_warn_by_name_and_change_nothing(case: str) -> None:
    extra, names = REDUNDANT[case]
    with warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        scene, tip = linkage()
        plain = mbd.simulate(scene, t_end=0.3, rtol=1e-9)
    scene, other_tip = linkage(extra)
    with pytest.warns(mbd.SceneWarning, match=f"redundant joints {names}:"):
        doubled = mbd.simulate(scene, t_end=0.3, rtol=1e-9)
    times = plain.t[-1]
    assert doubled.position(other_tip, t=[times])[0] == pytest.approx(plain.position(tip, t=[times])[0], abs=1e-9)
    assert doubled.audit.position_drift < 1e-10
    assert doubled.audit.velocity_drift < 1e-10


def test_clamp_and_pin_at_one_place() -> None:
    """The pin repeats what the clamp holds; the motion stays."""
    tips = []
    for twice in (False, True):
        scene = mbd.Scene(gravity=(0, -9.81))
        beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=1000, name="beam"))
        scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0), name="clamp"))
        if twice:
            scene.add(mbd.Pin(beam.start, scene.ground.at(0, 0), name="pin"))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = mbd.simulate(scene, t_end=0.1, rtol=1e-9)
        texts = [str(w.message) for w in caught if w.category is mbd.SceneWarning]
        assert len(texts) == int(twice)
        assert not twice or "redundant joints 'clamp', 'pin':" in texts[0]
        tips.append(result.position(beam.end)[-1])
    # Two runs at rtol 1e-9 whose equations differ by the softening of redundant rows only.
    assert tips[0] == pytest.approx(tips[1], abs=1e-9)


CONFLICTING = {
    "two distances": (
        lambda s, a, b: [s.add(mbd.Distance(b.at(), s.ground.at(3, 0), length=length, name=f"rod {length}")) for length in (2.0, 1.5)],
        ("'rod 2.0'", "'rod 1.5'"),
    ),
    "two ground points": (lambda s, a, b: s.add(mbd.Pin(a.at(-0.5, 0), s.ground.at(0.1, 0), name="pin 2")), ("'pivot'", "'pin 2'")),
    "out of reach": (lambda s, a, b: s.add(mbd.Pin(b.at(0.5, 0), s.ground.at(9, 0), name="far")), ("'pivot'", "'elbow'", "'far'")),
    "a clamp too many": (lambda s, a, b: s.add(mbd.Clamp(a.at(0, 0), b.at(0, 0), name="weld")), ("'elbow'", "'weld'")),
}


# Known debts: see the reasons; strict, so that mending them shows here.
@pytest.mark.parametrize("case", CONFLICTING)
def test_conflicting_joints_are_refused_by_name(case: str) -> None:
    extra, names = CONFLICTING[case]
    for use in (mbd.assemble, lambda scene: mbd.simulate(scene, t_end=0.1)):
        with pytest.raises(mbd.SceneError) as caught:
            use(linkage(extra)[0])
        (line,) = caught.value.complaints
        assert is_clear(line)
        for name in names:
            assert name in line
        assert "'upper'" not in line and "'lower'" not in line  # the bodies' own equations are not to blame


def test_an_inconsistent_start_is_corrected_and_reported() -> None:
    """A body 0.1 from its pin, moving away from it: what was closed where, what was moved how far."""
    scene = mbd.Scene(gravity=(0, 0))
    disc = scene.add(body(position=(1.1, 0), velocity=(1, 2), angular_velocity=3.0, name="disc"))
    scene.add(mbd.Pin(disc.at(-1, 0), scene.ground.at(0, 0), name="pin"))
    report = mbd.assemble(scene)
    found = {(c.quantity, c.item): c.amount for c in report.corrections}
    # The arm is at (0.1, 0) and moves with (1, 2) + 3 (0, -1) = (1, -1); mass 1, inertia 1.
    assert found[("position error closed", "pin")] == pytest.approx(0.1, rel=1e-12)
    assert found[("velocity error closed", "pin")] == pytest.approx(1.0, rel=1e-12)
    assert found[("position changed", "disc")] == pytest.approx(0.1, rel=1e-12)
    assert ("velocity changed", "disc") in found
    q, v = report.state.q, report.state.v
    joints = scene.build().joints.at(q)
    assert np.max(np.abs(joints.value)) < 1e-13
    assert np.max(np.abs(joints.push(v))) < 1e-13
    # The impulse (-1, j) at the pin: v + (0, j) - turned, momentum about the pin kept: 2 w = 2 + 3.
    assert v[:2] == pytest.approx([0.0, 2.5], abs=1e-12)
    assert "'pin': 0.1" in str(report)
    with pytest.warns(mbd.SceneWarning, match=r"corrected: position error closed of 'pin': 0\.1"):
        mbd.simulate(scene, t_end=0.01)


def test_a_consistent_start_says_nothing() -> None:
    report = mbd.assemble(linkage()[0])
    assert report.corrections == ()
    assert report.redundant == ()
