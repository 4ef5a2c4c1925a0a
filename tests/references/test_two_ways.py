"""The same machine modelled in two ways agrees to 1e-9: a rope at rest, guides in space, bodies clamped together, a driven crank."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

TWO_WAYS = 1e-9


def hanging_rope(stiffness: float | None) -> np.ndarray:
    """Seven particles between two supports 6 m apart on eight links of 1 m, springs or distances: their places at rest [7, 2]."""
    scene = mbd.Scene()
    turn = np.linspace(np.pi - 0.3, 0.3, 9)
    places = np.stack((3.0 + 3.0 * np.cos(turn) / np.cos(0.3), -2.0 * np.sin(turn)), axis=1)
    ends = [scene.ground.at(*places[0]), *(scene.add(mbd.Particle(1.0, place)).at() for place in places[1:-1]), scene.ground.at(*places[-1])]
    for a, b in zip(ends[:-1], ends[1:]):
        scene.add(mbd.Distance(a, b, length=1.0) if stiffness is None else mbd.Spring(a, b, stiffness=stiffness, length=1.0))
    found = mbd.equilibrium(scene)
    return np.stack([found.position(marker) for marker in ends[1:-1]])


def test_a_rope_of_springs_at_rest_is_one_of_distances_in_the_limit() -> None:
    """The difference is a power series in 1 / stiffness; two of its terms are taken out by runs at 1e5, 1e6 and 1e7 N/m."""
    soft, medium, stiff = (hanging_rope(stiffness) for stiffness in (1e5, 1e6, 1e7))
    rigid = hanging_rope(None)
    assert np.abs(stiff - rigid).max() == pytest.approx(0.1 * np.abs(medium - rigid).max(), rel=0.01)
    once, twice = (10.0 * medium - soft) / 9.0, (10.0 * stiff - medium) / 9.0
    assert np.abs((100.0 * twice - once) / 99.0 - rigid).max() < TWO_WAYS


def turned() -> np.ndarray:
    """A rotation that lies along no axis."""
    w, x, y, z = np.array((0.7, 0.3, -0.5, 0.4)) / np.linalg.norm((0.7, 0.3, -0.5, 0.4))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def sleeve(way: str) -> tuple[np.ndarray, np.ndarray]:
    """A block on a swinging arm that slides along it and, unless it is a slider, turns about it: place and rotation of the block."""
    scene, frame = mbd.Scene(gravity=(0, 0, -9.81)), turned()
    along = frame @ (1.0, 0.0, 0.0)
    arm = scene.add(mbd.RigidBody(mass=2.0, inertia=(0.1, 0.4, 0.35), position=0.5 * along, rotation=frame))
    spin = 3.0 * along if way in ("cylindrical", "two points") else np.zeros(3)
    block = scene.add(mbd.RigidBody(mass=1.0, inertia=(0.02, 0.03, 0.04), position=0.3 * along, rotation=frame, angular_velocity=spin))
    scene.add(mbd.Ball(arm.at(-0.5, 0, 0), scene.ground.at(0, 0, 0)))
    if way == "slider":
        scene.add(mbd.Slider(block.at(), arm.at(), axis=(1, 0, 0)))
    elif way == "cylindrical":
        scene.add(mbd.Cylindrical(block.at(), arm.at(), axis=(1, 0, 0)))
    else:
        for x in (-0.1, 0.1):
            scene.add(mbd.PointOnLine(block.at(x, 0, 0), arm.at(), axis=(1, 0, 0)))
        if way == "two points and no turn":
            turn = scene.add(mbd.Angle(block, arm, axis=along))
            scene.add(mbd.Coupling([(1.0, turn)]))
    times = np.linspace(0.0, 0.4, 9)
    result = mbd.simulate(scene, 0.4, rtol=1e-11, t_eval=times)
    assert np.ptp(result.position(block.at()), axis=0).max() > 0.2
    return result.position(block.at()), result.rotation(block)


@pytest.mark.parametrize(("one", "other"), [("slider", "two points and no turn"), ("cylindrical", "two points")])
def test_guides_in_space(one: str, other: str) -> None:
    """A slider as two points on a line and no turn about it; a cylindrical joint as two points on its line."""
    for x, y in zip(sleeve(one), sleeve(other)):
        assert np.abs(x - y).max() < TWO_WAYS


def dumbbell(clamped: bool) -> tuple[np.ndarray, np.ndarray]:
    """A free spinning body of two boxes, as two bodies on a clamp and as one with the inertia of both: place of a corner, rotation."""
    scene = mbd.Scene(gravity=(0, 0, 0))
    sizes, masses, apart, spin = ((0.2, 0.3, 0.4), (0.5, 0.1, 0.2)), (2.0, 1.0), np.array((0.3, 0.2, -0.1)), np.array((1.0, 5.0, 2.0))
    boxes = [mbd.RigidBody.box(size, mass=m, position=place, velocity=np.cross(spin, place), angular_velocity=spin)
             for size, m, place in zip(sizes, masses, (np.zeros(3), apart))]  # fmt: skip
    if clamped:
        first, second = (scene.add(box) for box in boxes)
        scene.add(mbd.Clamp(second.at(), first.at(*apart)))
        corner, body = first.at(0.1, 0.15, 0.2), first
    else:
        centre = apart * masses[1] / sum(masses)
        inertia = np.zeros((3, 3))
        for box, m in zip(boxes, masses):
            arm = np.asarray(box.position) - centre
            inertia += np.diag(box.inertia) + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        body = scene.add(mbd.RigidBody(mass=sum(masses), inertia=inertia, position=centre, velocity=np.cross(spin, centre), angular_velocity=spin))
        corner = body.at(*((0.1, 0.15, 0.2) - centre))
    result = mbd.simulate(scene, 2.0, rtol=1e-12, t_eval=np.linspace(0.0, 2.0, 9))
    return result.position(corner), result.rotation(body)


def test_clamped_bodies_are_one_body() -> None:
    for x, y in zip(dumbbell(True), dumbbell(False)):
        assert np.abs(x - y).max() < TWO_WAYS


def driven(way: str) -> tuple[np.ndarray, np.ndarray]:
    """A crank at 4 rad/s with a rod that hangs from it: place of the rod's end, torque of the drive."""
    scene = mbd.Scene()
    crank = scene.add(mbd.RigidBody.rod((0, 0), (0.5, 0), mass=1.0))
    rod = scene.add(mbd.RigidBody.rod((0.5, 0), (0.5, -1), mass=1.0))
    scene.add(mbd.Pin(crank.at(-0.25, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(rod.at(-0.5, 0), crank.at(0.25, 0)))
    drive: Any
    if way == "motor":
        drive = mbd.Motor(crank, scene.ground, speed=4.0)
    elif way == "prescribed":
        drive = mbd.Prescribed(crank.at(), angle=lambda t: 4.0 * t)
    else:
        turn = scene.add(mbd.Angle(crank, scene.ground))
        drive = mbd.Actuator(turn, value=lambda t: 4.0 * t)
    drive = scene.add(drive)
    result = mbd.simulate(scene, 1.0, rtol=1e-11, t_eval=np.linspace(0.0, 1.0, 9))
    torque = result.reaction(turn if way == "actuator" else drive)[:, 2]
    return result.position(rod.at(0.5, 0)), torque


@pytest.mark.parametrize("way", ["prescribed", "actuator"])
def test_drives_of_one_crank(way: str) -> None:
    """A motor, a prescribed angle, and an actuator on the crank's angle; torques of up to 30 N m."""
    places, torques = driven(way)
    expected = driven("motor")
    assert np.abs(places - expected[0]).max() < TWO_WAYS
    assert np.abs(torques - expected[1]).max() < 30.0 * TWO_WAYS
