"""Scenes on other meshes, and the errors of meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd
from mbd.verification.meshes import carried, doublings, remeshed

from .. import machines

BEAM = {"E": 1e7, "A": 1e-3, "I": 1e-8, "rho": 1000.0}
KINDS = [mbd.AncfCable, mbd.CorotationalBeam, mbd.GeometricallyExactBeam, mbd.FloatingFrameBeam]


def machine(kind: Any, n: int) -> mbd.Scene:
    """A beam with all that can hang on one."""
    scene = mbd.Scene()
    beam = scene.add(kind((0, 0), (1, 0), n_elements=n, **BEAM))
    body = scene.add(mbd.RigidBody.rod((1, 0), (1.5, 0), mass=0.1, name="arm"))
    scene.add(mbd.Pin(beam.start, scene.ground.at(0, 0)))
    scene.add(mbd.Pin(body.at(-0.25, 0), beam.end))
    scene.add(mbd.Force(body.at(0.25, 0), lambda t: (0.0, np.sin(t))))
    scene.add(mbd.Spring(beam.at(0.25), scene.ground.at(0.25, 1.0), stiffness=5.0))
    turn = scene.add(mbd.Angle(body.at(), scene.ground.at()))
    scene.add(mbd.PD(turn, 0.1, proportional=2.0, derivative=0.1))
    return scene


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_on_a_mesh_twice_as_fine_is_the_one_described_so(kind: Any) -> None:
    made, described = remeshed(machine(kind, 4), 1), machine(kind, 8)
    assert made.coordinates() == described.coordinates()
    one, other = (mbd.simulate(scene, 0.05, rtol=1e-8) for scene in (made, described))
    assert np.array_equal(one.q, other.q)
    assert np.array_equal(remeshed(made, -1).build().q0, machine(kind, 4).build().q0)


def test_markers_keep_their_place_on_a_curved_cable() -> None:
    scene = mbd.Scene()
    angles = np.linspace(0.0, 2.0, 5)
    nodes, tangents = np.stack((np.cos(angles), np.sin(angles)), axis=1), np.stack((-np.sin(angles), np.cos(angles)), axis=1)
    cable = scene.add(mbd.AncfCable(nodes=nodes, tangents=tangents, **BEAM))
    finer = remeshed(scene, 1)
    assert len(finer["cable 1"].lengths) == 8 and finer["cable 1"].length == pytest.approx(cable.length, rel=1e-4)
    for s in (0.0, 0.3, 0.5, 1.0):
        there = carried(cable.at(s), finer)
        places = there.point.value(finer.build().q0), cable.at(s).point.value(scene.build().q0)
        assert places[0] == pytest.approx(places[1], abs=1e-4)
    back = remeshed(finer, -1)
    assert back.build().q0 == pytest.approx(scene.build().q0, abs=1e-12)


def test_which_meshes_are_compared() -> None:
    assert doublings(machine(mbd.AncfCable, 4)) == (-1, 1)
    assert doublings(machine(mbd.AncfCable, 3)) == (1, 2)


def truth(kind: Any, n: int, t: np.ndarray) -> np.ndarray:
    scene = falling(kind, n)
    return np.asarray(mbd.simulate(scene, t[-1], rtol=1e-7, t_eval=t).position(scene["rod"].end))


def falling(kind: Any, n: int) -> mbd.Scene:
    """A pendulum, bent by its own weight."""
    scene = mbd.Scene()
    rod = scene.add(kind((0, 0), (1.2, 0), n_elements=n, E=2e7, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    return scene


@pytest.mark.parametrize(("kind", "n"), [(mbd.AncfCable, 4), (mbd.AncfCable, 3), (mbd.GeometricallyExactBeam, 2), (mbd.CorotationalBeam, 4)])
def test_the_error_of_a_mesh(kind: Any, n: int) -> None:
    """Against a mesh six times as fine: within three times the estimate at all times, and not below a hundredth of it."""
    scene = falling(kind, n)
    times = np.linspace(0.02, 0.25, 12)
    found = mbd.verify(scene, 0.25, outputs={"tip": scene["rod"].end}, rtol=1e-5, t_eval=times, meshes=True)
    assert found.ok, str(found)
    assert found.rows[0].mesh_order > 1.0
    error = np.linalg.norm(found.result.position(scene["rod"].end) - truth(kind, 6 * n, times), axis=1)
    assert np.all(error <= 3.0 * found.errors["tip"])
    assert error.max() >= 0.01 * found.errors["tip"].max()
    assert np.all(found.errors["tip"] == found.time_errors["tip"] + found.mesh_errors["tip"])
    assert found.result.scene is scene


def test_functions_need_a_scene_for_each_mesh() -> None:
    def build(factor: float) -> tuple[mbd.Scene, dict[str, Any]]:
        scene = falling(mbd.AncfCable, round(4 * factor))
        return scene, {"height": lambda result: result.position(scene["rod"].end)[:, 1]}

    scene, outputs = build(1)
    with pytest.raises(ValueError, match="found functions: 'height'"):
        mbd.verify(scene, 0.2, outputs=outputs, meshes=True)
    found = mbd.verify(scene, 0.2, outputs=outputs, rtol=1e-5, meshes=build)
    assert found.ok and found.mesh_errors["height"].max() > found.time_errors["height"].max()
    with pytest.raises(ValueError, match="outputs named"):
        mbd.verify(scene, 0.2, outputs={"tip": scene["rod"].end}, rtol=1e-5, meshes=build)


def test_a_start_belongs_to_one_mesh() -> None:
    scene = falling(mbd.AncfCable, 4)
    start = mbd.State(scene.build().q0, scene.build().v0)
    with pytest.raises(ValueError, match="start: expected none with meshes"):
        mbd.verify(scene, 0.2, outputs={"tip": scene["rod"].end}, start=start, meshes=True)


@pytest.mark.slow
@pytest.mark.parametrize("n", [4, 8])
def test_spin_up_against_another_method(n: int) -> None:
    """The beam on a driven hub, against a spline solution: seven digits, every second."""
    from benchmarks import machines as numbers

    book = machines.data("spinup_beam")
    scene = mbd.Scene(gravity=(0, 0))
    words = numbers.SPINUP._asdict() | {"n_elements": n}
    beam = scene.add(mbd.AncfCable(**words, name="rod"))
    turning = mbd.Motion(numbers.hub_angle, rate=numbers.hub_speed, acceleration=numbers.hub_acceleration)
    scene.add(mbd.Prescribed(beam.start, (0.0, 0.0), angle=turning))
    rows = [row for row in book["values"] if row["t"] <= 10.0]
    found = mbd.verify(scene, 10.0, outputs={"tip": beam.end}, rtol=1e-6, t_eval=[row["t"] for row in rows], meshes=True)
    assert found.ok, str(found)
    error = np.linalg.norm(found.result.position(beam.end) - [row["end1"] for row in rows], axis=1)
    assert np.all(error <= 3.0 * found.errors["tip"] + 1e-7)
    assert error.max() >= 0.01 * found.errors["tip"].max()
