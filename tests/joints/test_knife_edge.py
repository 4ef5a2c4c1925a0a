"""Nonholonomic rows: derivatives, Chaplygin's sleigh and the edge on an incline, order of convergence, mistakes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from ..kinds import dense, derivative

G = 9.81 * np.sin(0.3)


def edge(gravity: float = G, arm: float = 0.0, spin: float = 2.0, speed: float = 0.0) -> tuple[mbd.Scene, Any, Any]:
    """A body on an incline along x, 1.5 kg and 0.5 kg m^2, with a knife edge along its first axis: scene, body, joint."""
    scene = mbd.Scene(gravity=(gravity, 0))
    velocity = (speed, -arm * spin)
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.5, position=(0, 0), velocity=velocity, angular_velocity=spin, name="body"))
    return scene, body, scene.add(mbd.KnifeEdge(body.at(arm, 0), axis=(2, 0)))


@pytest.mark.parametrize("solver", [None, mbd.Radau(3), mbd.Radau(5), mbd.Radau(7)], ids=["default", "3", "5", "7"])
def test_edge_on_an_incline(solver: Any) -> None:
    """Through the mass centre it does not slide down: a cycloid across, x = g sin^2(w t) / 2 w^2, y = g (w t - sin(w t) cos(w t)) / 2 w^2
    (Neimark and Fufaev 1972); its force is the inertial balance."""
    scene, body, joint = edge()
    result = mbd.simulate(scene, 4.0, rtol=1e-9, solver=solver)
    w, t = 2.0, result.t
    expected = G / (2 * w * w) * np.stack((np.sin(w * t) ** 2, w * t - np.sin(w * t) * np.cos(w * t)), axis=1)
    assert np.abs(result.position(body.at()) - expected).max() < 1e-8
    balance = 1.5 * (result.acceleration(body.at()) - (G, 0.0))
    assert np.abs(result.reaction(joint)[:, :2] - balance).max() < 1e-9
    across = np.stack((-np.sin(result.angle(body)), np.cos(result.angle(body))), axis=1)
    assert np.abs(np.sum(result.velocity(body.at()) * across, axis=1)).max() < 1e-12
    assert result.audit.energy_error < 1e-8 * result.audit.energy_scale
    between = np.linspace(0.1, 3.9, 5)
    dense_output = G / (2 * w * w) * np.sin(w * between) ** 2
    assert np.abs(result.position(body.at(), t=between)[:, 0] - dense_output).max() < 1e-8


def test_sleigh() -> None:
    """Chaplygin's, without gravity, edge 0.3 m behind the mass centre: energy is kept, the spin dies, all goes into forward motion."""
    scene, body, _ = edge(gravity=0.0, arm=-0.3)
    result = mbd.simulate(scene, 20.0, rtol=1e-9)
    total = result.energy.total
    assert np.abs(total - total[0]).max() < 1e-8 * total[0]
    assert abs(result.angular_velocity(body)[-1]) < 1e-6
    assert np.linalg.norm(result.velocity(body.at())[-1]) == pytest.approx(np.sqrt(2.0 * total[0] / 1.5), rel=1e-9)


@pytest.mark.parametrize("solver", [None, mbd.Radau(5)], ids=["default", "Radau"])
def test_a_wheel_is_driven(solver: Any) -> None:
    """An engine's torque T on the wheel of a vehicle that turns evenly: speed T t / (m r) along the heading, the turn T t^2 / (2 m r^2)."""
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.5, position=(0, 0), angular_velocity=2.0))
    wheel = scene.add(mbd.Wheel(body, axis=(3, 0), radius=0.25))
    scene.add(mbd.Actuator(wheel, force=0.6))
    result = mbd.simulate(scene, 3.0, rtol=1e-9, solver=solver)
    pull, w, t = 0.6 / (1.5 * 0.25), 2.0, result.t
    expected = pull / w**2 * np.stack((np.cos(w * t) + w * t * np.sin(w * t) - 1.0, np.sin(w * t) - w * t * np.cos(w * t)), axis=1)
    assert np.abs(result.position(body.at()) - expected).max() < 1e-7
    assert np.abs(result.q[:, wheel.coordinate] - 0.5 * pull / 0.25 * t**2).max() < 1e-7
    along = np.stack((np.cos(w * t), np.sin(w * t)), axis=1)
    assert np.sum(result.reaction(wheel)[:, :2] * along, axis=1) == pytest.approx(np.full(t.size, 0.6 / 0.25), abs=1e-7)
    assert result.audit.energy_error < 1e-7


def test_a_wheel_with_inertia_rolls_like_a_heavier_body() -> None:
    """Through a coupling to a disc: straight ahead, m + J / r^2 move under a force."""
    scene = mbd.Scene(gravity=(9.81, 0))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.5, position=(0, 0), velocity=(1.0, 0.0)))
    disc = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 3), angular_velocity=4.0))
    scene.add(mbd.Pin(disc.at(), scene.ground.at(0, 3)))
    wheel = scene.add(mbd.Wheel(body, axis=(1, 0), radius=0.25))
    scene.add(mbd.Coupling([(1.0, wheel), (-1.0, scene.add(mbd.Angle(disc, scene.ground)))]))
    result = mbd.simulate(scene, 1.0, rtol=1e-9)
    pull = 1.5 * 9.81 / (1.5 + 0.1 / 0.25**2)
    assert result.position(body.at())[-1] == pytest.approx((1.0 + 0.5 * pull, 0.0), abs=1e-8)
    assert result.angular_velocity(disc)[-1] == pytest.approx((1.0 + pull) / 0.25, abs=1e-7)


def test_edges_do_not_hold_positions_back() -> None:
    """A joint far away is closed sideways to an edge, as if there were none; then they hold the velocity together."""
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.5, position=(0, 0.2), angle=0.3, velocity=(1, 0), angular_velocity=1.0))
    scene.add(mbd.PointOnLine(body.at(), scene.ground.at(), axis=(1, 0)))
    scene.add(mbd.KnifeEdge(body, axis=(1, 0)))
    state = mbd.assemble(scene).state
    assert state.q[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert state.v[:2] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_order_of_radau() -> None:
    true = mbd.simulate(edge(arm=0.3)[0], 1.0, rtol=1e-12, solver=mbd.DormandPrince()).final
    errors = []
    for count in (20, 40, 80):
        found = mbd.simulate(edge(arm=0.3)[0], 1.0, rtol=1e-12, solver=mbd.Radau(3, step=1.0 / count)).final
        errors.append([np.abs(found.q - true.q).max(), np.abs(found.v - true.v).max()])
    assert np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 5.0).max() < 0.3


def test_derivatives() -> None:
    rng = np.random.default_rng(1)
    scene, body, _ = edge(arm=0.3)
    scene.add(mbd.KnifeEdge(body.at(0.1, -0.4), axis=(1, 2)))
    system = scene.build()
    q, v, dq, multipliers = (rng.standard_normal(k) for k in (system.n, system.n, system.n, system.m))
    joints, at = system.joints, system.joints.at(q)
    assert joints.slips.tolist() == [1, 2] and not at.value[joints.slips].any()
    angle, rate = np.array(q[2:4]), np.array(v[2:4])
    for row, (arm, axis) in zip((1, 2), ((0.3 + 0j, 1 + 0j), (0.1 - 0.4j, (1 + 2j) / np.sqrt(5.0)))):
        across, velocity = 1j * axis * complex(*angle), complex(*v[:2]) + arm * complex(*rate)
        assert at.push(v)[row] == pytest.approx((np.conj(across) * velocity).real, abs=1e-14)
    swirl = dense(joints.rows, joints.cols, at.swirl(v), (system.m, system.n))
    assert swirl @ dq == pytest.approx(derivative(lambda x: joints.at(x).push(v), q, dq), abs=1e-10)
    assert at.bias(v) == pytest.approx(swirl @ v, abs=1e-12)
    curvature = dense(joints.curvature_rows, joints.curvature_cols, at.curvature(multipliers), (system.n, system.n))
    assert curvature @ dq == pytest.approx(derivative(lambda x: joints.at(x).pull(multipliers), q, dq), abs=1e-10)
    many = joints.at(np.stack((q, system.q0)))
    assert many.gradient[0] == pytest.approx(at.gradient, abs=1e-15) and many.bias(np.stack((v, v)))[0] == pytest.approx(at.bias(v), abs=1e-14)


def test_a_start_across_the_edge_is_corrected() -> None:
    scene = mbd.Scene(gravity=(G, 0))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.5, position=(0, 0), velocity=(1, 1)))
    scene.add(mbd.KnifeEdge(body, axis=(1, 0), name="edge"))
    report = mbd.assemble(scene)
    assert "'edge'" in str(report) and np.abs(report.state.v[:2] - (1, 0)).max() < 1e-14


@pytest.mark.parametrize("solver", [mbd.Gauss(1e-2), mbd.GeneralizedAlpha(1e-2)], ids=lambda s: type(s).__name__)
def test_other_solvers_refuse(solver: Any) -> None:
    with pytest.raises(ValueError, match="nonholonomic 'knife edge 1'"):
        mbd.simulate(edge()[0], 0.1, solver=solver)


def test_mistakes_are_named() -> None:
    scene = mbd.Scene()
    bead = scene.add(mbd.Particle(1.0, (0, 0)))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    scene.add(mbd.KnifeEdge(bead, axis=(1, 0), name="bead"))
    scene.add(mbd.KnifeEdge(body, axis=(0, 0), name="none"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    assert "knife edge 'bead': marker" in error.value.complaints[0] and "'none': axis: expected a direction" in error.value.complaints[1]
