"""Loads that depend on velocities: friction in pins and sliders against closed forms, for every solver; derivatives; mistakes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from ..kinds import dense

SOLVERS = [mbd.Radau(3), mbd.Radau(7), mbd.DormandPrince(), mbd.Gauss(1e-3), mbd.GeneralizedAlpha(1e-3)]


def wheel(**friction: float) -> tuple[mbd.Scene, Any]:
    """0.5 kg m^2 at 3 rad/s on a pin that rubs: scene, angle."""
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0), angular_velocity=3.0))
    scene.add(mbd.Pin(body.at(), scene.ground.at()))
    turn = scene.add(mbd.Angle(body, scene.ground))
    scene.add(mbd.Friction(turn, **friction))
    return scene, turn


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: f"{type(s).__name__} {getattr(s, 'stages', '')}")
def test_a_wheel_runs_down(solver: Any) -> None:
    """J w' = -M tanh(w / w0): sinh(w / w0) falls as exp(-M t / (J w0)); friction's reaction and work."""
    scene, turn = wheel(force=2.0, speed=0.1)
    result = mbd.simulate(scene, 1.5, rtol=1e-7, solver=solver)
    exact = 0.1 * np.arcsinh(np.sinh(30.0) * np.exp(-40.0 * result.t))
    accuracy = 1e-5 if isinstance(solver, mbd.GeneralizedAlpha) else 1e-7
    assert np.abs(result.v[:, turn.coordinate] - exact).max() < accuracy
    assert result.reaction(turn)[:, 2] == pytest.approx(-2.0 * np.tanh(exact / 0.1), abs=20.0 * accuracy)
    assert result.trajectory.work[-1] == pytest.approx(0.25 * (exact[-1] ** 2 - 9.0), abs=10.0 * accuracy)
    assert result.audit.energy_error < 1e-5


def test_a_block_on_an_incline() -> None:
    """Above the angle of friction it slides with g (sin - mu cos), below it creeps at the speed where the smooth law carries its weight."""
    for slope, moves in ((0.5, True), (0.2, False)):
        scene, down = mbd.Scene(), np.array((np.cos(slope), -np.sin(slope)))
        block = scene.add(mbd.RigidBody(mass=2.0, inertia=0.1, position=(0, 0)))
        scene.add(mbd.Slider(block.at(), scene.ground.at(), axis=down))
        way = scene.add(mbd.Displacement(block, scene.ground, axis=down))
        limit = 0.3 * 2.0 * 9.81 * np.cos(slope)
        scene.add(mbd.Friction(way, force=limit, speed=1e-3))
        result = mbd.simulate(scene, 1.0, rtol=1e-8)
        pull = 2.0 * 9.81 * np.sin(slope)
        expected = (pull - limit) / 2.0 if moves else 1e-3 * np.arctanh(pull / limit)
        assert result.v[-1, way.coordinate] == pytest.approx(expected, abs=2e-3 if moves else 1e-9)


def test_derivatives() -> None:
    """D is -df/dv by differences."""
    scene, turn = wheel(force=2.0, speed=0.7)
    system = scene.build()
    v, inputs = np.linspace(0.2, 1.0, system.n), system.inputs(0.0)
    found = dense(system.damping_rows, system.damping_cols, system.damping(system.q0, v, inputs), (system.n, system.n))
    for k, axis in enumerate(np.eye(system.n)):
        slope = (system.force(system.q0, v + 1e-5 * axis, inputs) - system.force(system.q0, v - 1e-5 * axis, inputs)) / 2e-5
        assert found[:, k] == pytest.approx(-slope, abs=1e-9)
    assert found[turn.coordinate, turn.coordinate] > 0.5


def test_mistakes_are_named() -> None:
    scene, _ = wheel(force=1.0, speed=0.0)
    scene.add(mbd.Friction(scene["body 1"], force=-1.0, speed=1.0, name="second"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    text = "\n".join(error.value.complaints)
    assert "friction 'friction 1': speed: expected a positive number" in text
    assert "'second': measure: expected a measure" in text and "'second': force: expected a number not below zero" in text
