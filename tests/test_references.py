"""Rigid machines against references of 18 and more digits, values between the steps, drift, and reactions by independent formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from . import machines


def _reference(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and positions, up to where the motion is not yet chaotic."""
    reference = machines.data(name)["reference"]
    if name == "iftomm_a01_pendulum":
        values = reference["values"]
        return np.array([float(t) for t in values]), np.array([[float(row["x"]), float(row["y"])] for row in values.values()])
    last = {"double_pendulum": 3.0, "four_bar_chain": 2.0, "heavy_top": 2.0}[name]
    rows = [row for row in reference if row["t"] <= last]
    points = [row["com"] if name == "heavy_top" else row["P"][0][:2] for row in rows]
    return np.array([row["t"] for row in rows]), np.array(points, dtype=float)


def _machine(name: str) -> tuple[mbd.Scene, Any]:
    if name == "double_pendulum":
        return machines.double_pendulum()
    if name == "iftomm_a01_pendulum":
        scene, bob, _ = machines.simple_pendulum()
        return scene, bob.at()
    if name == "heavy_top":
        scene, top, _ = machines.heavy_top()
        return scene, top.at(0, 0, 0)
    scene, bodies, _ = machines.chain(4)
    return scene, bodies[-1].at(0.5, 0)


NAMES = ["double_pendulum", "four_bar_chain", "iftomm_a01_pendulum", "heavy_top"]


@pytest.mark.parametrize("name", NAMES)
def test_reference(name: str) -> None:
    times, points = _reference(name)
    scene, marker = _machine(name)
    result = mbd.simulate(scene, times[-1], rtol=1e-12)
    assert np.abs(result.position(marker)[-1] - points[-1]).max() < 1e-8
    assert np.abs(result.position(marker, t=times) - points).max() < 1e-8
    assert result.audit.position_drift < 1e-10
    assert result.audit.velocity_drift < 1e-10


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("stages", [3, 5, 7])
def test_values_between_steps(name: str, stages: int) -> None:
    """Against a tight run, the error anywhere inside of steps is at most ten times the largest at the steps."""
    scene, marker = _machine(name)
    t_end = 0.3 if name == "heavy_top" else 1.5
    tight = mbd.simulate(scene, t_end, rtol=1e-12)
    result = mbd.simulate(scene, t_end, rtol=1e-7, solver=mbd.Radau(stages))
    at_steps = np.abs(result.position(marker) - tight.position(marker, t=result.t)).max()
    between = np.concatenate([result.t[:-1] + f * np.diff(result.t) for f in (0.2, 0.5, 0.85)])
    inside = np.abs(result.position(marker, t=between) - tight.position(marker, t=between)).max()
    assert inside <= 10.0 * max(at_steps, 1e-11)
    q, _ = result.trajectory.at(between)
    assert np.abs(scene.build().joints.at(q).value * result.trajectory.linear.reach).max() < 1e-12 * scene.build().length


def test_states_of_the_double_pendulum() -> None:
    row = machines.data("double_pendulum")["reference"][2]
    scene, tip = machines.double_pendulum()
    result = mbd.simulate(scene, row["t"], rtol=1e-12, t_eval=[1.0, row["t"]])
    assert result.t.tolist() == [1.0, row["t"]]
    assert result.velocity(tip)[-1] == pytest.approx(np.array(row["P"][0][3:5], dtype=float), abs=1e-8)


def test_heavy_top_rotation() -> None:
    """The body components of the angular velocity and the rotation itself at 1 s."""
    row = next(row for row in machines.data("heavy_top")["reference"] if row["t"] == 1.0)
    scene, top, _ = machines.heavy_top()
    result = mbd.simulate(scene, 1.0, rtol=1e-12)
    rotation = result.rotation(top)[-1]
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
    assert rotation.T @ result.angular_velocity(top)[-1] == pytest.approx(np.array(row["omega_body"], dtype=float), abs=3e-7)
    w, x, y, z = np.array(row["quat"], dtype=float)
    expected = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    assert rotation == pytest.approx(expected, abs=1e-8)


def test_reaction_of_the_simple_pendulum() -> None:
    """Tension of a particle on a rod: m v^2 / L - m g cos, along the rod."""
    scene, bob, rod = machines.simple_pendulum()
    result = mbd.simulate(scene, 3.0, rtol=1e-11)
    for t in (None, np.linspace(0.1, 2.9, 7)):
        p, v = result.position(bob.at(), t=t), result.velocity(bob.at(), t=t)
        tension = np.sum(v**2, axis=1) - 9.81 * p[:, 1]
        assert np.abs(result.reaction(rod, t=t)[:, :2] + tension[:, None] * p).max() < 1e-8
        assert np.abs(result.reaction(rod, t=t)[:, 2]).max() == 0.0


def test_reactions_of_a_chain_balance_what_hangs_on_them() -> None:
    """The pin force on link k and below: sum of m (a - g); the moment about a free pin vanishes."""
    scene, bodies, pins = machines.chain(4)
    result = mbd.simulate(scene, 1.0, rtol=1e-11)
    accelerations = [result.acceleration(body.at(0, 0)) - (0, -9.81) for body in bodies]
    for k, pin in enumerate(pins):
        reaction = result.reaction(pin)
        assert np.abs(reaction[:, :2] - sum(accelerations[k:])).max() < 1e-9 * np.abs(reaction).max()
        assert np.abs(reaction[:, 2]).max() == 0.0


def test_reaction_moment_of_a_clamped_link() -> None:
    """Newton and Euler for a body clamped to a swinging one: force m (a - g), moment of inertia forces about the joint."""
    scene = mbd.Scene()
    arm = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    tool = scene.add(mbd.RigidBody.box((0.2, 0.4), mass=3.0, position=(1.1, 0.3)))
    scene.add(mbd.Pin(arm.at(-0.5, 0), scene.ground.at(0, 0)))
    weld = scene.add(mbd.Clamp(tool.at(-0.1, -0.3), arm.at(0.5, 0), name="weld"))
    result = mbd.simulate(scene, 1.0, rtol=1e-11)
    reaction, inertia = result.reaction(weld), 3.0 * (0.2**2 + 0.4**2) / 12.0
    force = 3.0 * (result.acceleration(tool.at(0, 0)) - (0, -9.81))
    arm_vector = result.position(tool.at(0, 0)) - result.position(tool.at(-0.1, -0.3))
    spin = result.rotation(tool)
    spin_up = np.sum(spin[:, :, 1] * _director_acceleration(result, tool), axis=1)
    moment = inertia * spin_up + arm_vector[:, 0] * force[:, 1] - arm_vector[:, 1] * force[:, 0]
    assert np.abs(reaction[:, :2] - force).max() < 1e-9 * np.abs(force).max()
    assert np.abs(reaction[:, 2] - moment).max() < 1e-9 * np.abs(moment).max()


def _director_acceleration(result: mbd.Result, body: Any) -> np.ndarray:
    """Acceleration of the point one metre along the first axis, less the centre's."""
    return result.acceleration(body.at(1, 0)) - result.acceleration(body.at(0, 0))


def test_reaction_of_the_heavy_top() -> None:
    scene, top, tip = machines.heavy_top()
    result = mbd.simulate(scene, 0.2, rtol=1e-11)
    force = 15.0 * (result.acceleration(top.at(0, 0, 0)) - (0, 0, -9.81))
    reaction = result.reaction(tip)
    assert reaction.shape == (len(result.t), 6)
    assert np.abs(reaction[:, :3] - force).max() < 1e-9 * np.abs(force).max()
    assert np.abs(reaction[:, 3:]).max() == 0.0


def test_angle_is_unwrapped_over_turns() -> None:
    scene = mbd.Scene(gravity=(0, 0))
    wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0), angle=0.3, angular_velocity=-7.0))
    scene.add(mbd.Pin(wheel.at(0, 0), scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 10.0, rtol=1e-8)
    assert result.angle(wheel)[-1] == pytest.approx(0.3 - 70.0, abs=1e-5)
    assert result.angle(wheel, t=[0.0, 5.0]) == pytest.approx([0.3, 0.3 - 35.0], abs=1e-5)
    assert result.angular_velocity(wheel) == pytest.approx(-7.0, abs=1e-6)
