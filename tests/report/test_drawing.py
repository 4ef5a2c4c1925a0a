"""What is drawn: points lie where the items are, forms follow the kinds, and nothing is drawn twice."""

from __future__ import annotations

import numpy as np
import pytest

import mbd
import mbd.elements
import mbd.joints
from mbd.drawing import Drawing
from mbd.drawn import DRAWN

from .scenes import slider_crank

CABLE = {"n_elements": 4, "E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 2000}
PLACELESS = {"Actuator", "Angle", "Coupling", "Displacement", "ForceLaw", "Friction", "Length", "PD", "Stop", "UserMeasure"}
"""Kinds that are no thing at a place."""


@pytest.fixture(scope="module")
def run() -> mbd.Result:
    return slider_crank()


def forms(drawing: Drawing, item: str) -> list[str]:
    return [shape.form for shape in drawing.shapes if shape.item == item]


def test_every_kind_is_drawn_or_known_to_have_no_place():
    kinds = {name for module in (mbd.elements, mbd.joints) for name in module.__all__}
    with_mass = {"AncfCable", "CorotationalBeam", "FloatingFrameBeam", "GeometricallyExactBeam", "Particle", "RigidBody"}
    assert {kind.__name__ for kind in DRAWN} | with_mass | PLACELESS == kinds


def test_forms_by_kind(run):
    drawing = Drawing(run.scene, run.q)
    expected = {
        "crank": ["rod", "centre"],
        "rod": ["beam"],
        "block": ["arm", "arm", "centre"],
        "bearing": ["ground", "pin"],
        "crank pin": ["pin"],
        "slide": ["guide", "slider"],
        "motor": ["motor"],
        "spring": ["ground", "spring"],
        "push": ["force"],
    }
    assert {name: forms(drawing, name) for name in expected} == expected


def test_points_are_where_the_markers_are(run):
    drawing, scene = Drawing(run.scene, run.q), run.scene
    points = drawing.at(run.q)
    first = {(shape.item, shape.form): points[:, shape.points[0]] for shape in drawing.shapes}
    last = {(shape.item, shape.form): points[:, shape.points[-1]] for shape in drawing.shapes}
    for key, found, marker in (
        (("crank", "rod"), first, scene["crank"].at(-0.15, 0)),
        (("crank", "rod"), last, scene["crank"].at(0.15, 0)),
        (("rod", "beam"), first, scene["rod"].start),
        (("rod", "beam"), last, scene["rod"].end),
        (("spring", "spring"), first, scene["block"].at(0.1, 0)),
        (("motor", "motor"), first, scene["crank"].at(-0.15, 0)),
        (("push", "force"), first, scene["block"].at(0.1, 0.05)),
    ):
        np.testing.assert_allclose(found[key], run.position(marker), atol=1e-13)


def test_guides_reach_as_far_as_the_joint_slides(run):
    drawing = Drawing(run.scene, run.q)
    (guide,) = [shape for shape in drawing.shapes if shape.form == "guide"]
    ends = drawing.at(run.q)[0, list(guide.points)]
    places = run.position(run.scene["block"].at())[:, 0]
    assert np.all(ends[:, 1] == 0.0) and ends[0, 0] < min(places.min(), 0.0) and places.max() < ends[1, 0] < places.max() + 0.3


def test_equal_points_are_drawn_from_one():
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    other = scene.add(mbd.RigidBody.rod((1, 0), (2, 0), mass=1.0))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(body.at(0.5, 0), other.at(-0.5, 0)))
    drawing = Drawing(scene, scene.build().q0)
    rod, pin = (next(s for s in drawing.shapes if (s.item, s.form) == key) for key in (("body 1", "rod"), ("pin 2", "pin")))
    assert rod.points[1] == pin.points[0] and len({str(point) for point in drawing.points}) == len(drawing.points)


def test_the_outline_of_a_plate_is_the_hull_of_its_points():
    scene = mbd.Scene()
    plate = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(3, 4), angle=0.5, name="plate"))
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    for corner in (*corners, (0.2, 0.3), (0, -1)):
        scene.add(mbd.Force(plate.at(*corner), (1.0, 0.0)))
    drawing = Drawing(scene, scene.build().q0)
    (hull,) = [shape for shape in drawing.shapes if shape.form == "hull"]
    found = drawing.at(scene.build().q0[None])[0, list(hull.points)]
    turned = [(3, 4) + np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]]) @ corner for corner in corners]
    assert len(found) == 5 and np.array_equal(found[0], found[-1])
    np.testing.assert_allclose(sorted(map(tuple, found[:-1])), sorted(map(tuple, turned)), atol=1e-12)


def test_a_rolling_disc_turns_with_its_body():
    scene = mbd.Scene()
    disc = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0.2), velocity=(1.0, 0.0), angular_velocity=-5.0, name="disc"))
    scene.add(mbd.Rolling(disc, scene.ground, axis=(1, 0), radius=0.2, name="rolling"))
    run = mbd.simulate(scene, 0.3)
    drawing = Drawing(scene, run.q)
    (shape,) = [shape for shape in drawing.shapes if shape.form == "disc"]
    points = drawing.at(run.q)[:, list(shape.points)]
    centre, spoke = points[:, 0], points[:, 1] - points[:, 0]
    np.testing.assert_allclose(np.linalg.norm(points[:, 1:] - centre[:, None], axis=-1), 0.2, atol=1e-12)
    np.testing.assert_allclose(np.arctan2(spoke[:, 1], spoke[:, 0]), -run.t * 5.0, atol=1e-6)
    assert np.abs(points[..., 1].min(axis=1)).max() < 0.2 * (1.0 - np.cos(np.pi / 32)) + 1e-12  # it touches the line


def test_the_axis_of_a_hinge_in_space_moves_with_its_body():
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    arm = scene.add(mbd.RigidBody.rod((0, 0, 0), (1, 0, 0), mass=1.0, radius=0.05, name="arm"))
    hand = scene.add(mbd.RigidBody.rod((1, 0, 0), (1.5, 0, 0), mass=1.0, radius=0.05, name="hand"))
    scene.add(mbd.Pin(arm.at(-0.5, 0, 0), scene.ground.at(0, 0, 0), axis=(0, 1, 0)))
    scene.add(mbd.Pin(hand.at(-0.25, 0, 0), arm.at(0.5, 0, 0), axis=(0, 0, 1), name="wrist"))
    run = mbd.simulate(scene, 0.3)
    drawing = Drawing(scene, run.q)
    shape = next(s for s in drawing.shapes if (s.item, s.form) == ("wrist", "pin"))
    at = drawing.at(run.q)[:, list(shape.points)]
    axis = (at[:, 1] - at[:, 0]) / np.linalg.norm(at[:, 1] - at[:, 0], axis=1, keepdims=True)
    turn = run.rotation(arm) @ run.rotation(arm)[0].T
    np.testing.assert_allclose(axis, turn @ (0, 0, 1), atol=1e-9)
    assert abs(axis[-1, 2]) < 0.98


def test_beams_of_many_elements_stay_within_the_detail():
    scene = mbd.Scene()
    scene.add(mbd.AncfCable((0, 0), (1, 0), **CABLE | {"n_elements": 500}))
    drawing = Drawing(scene, scene.build().q0, fine=120)
    assert 100 < len(drawing.points) <= 130
