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


def test_friction_in_sparse_matrices() -> None:
    """Friction has entries in D where no stiffness has any: hinges around a hub, M x + 3 D x + G' y = b, G x = c."""
    scene, rng = mbd.Scene(gravity=(0, 0)), np.random.default_rng(3)
    hub = scene.add(mbd.RigidBody(mass=5.0, inertia=2.0, position=(0, 0)))
    for k in range(50):
        arm = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), angular_velocity=k))
        scene.add(mbd.Pin(arm.at(), hub.at()))
        scene.add(mbd.Friction(scene.add(mbd.Angle(arm, hub)), force=0.5, speed=20.0))
    system, start = scene.build(), mbd.assemble(scene)
    linear, q, v = start.linear, start.state.q, start.state.v
    assert linear.format.name == "sparse"
    joints, inputs, none = system.joints.at(q), system.inputs(0.0), (np.zeros(0), np.zeros(system.m))
    damping = system.damping(q, v, inputs)
    top, bottom = rng.standard_normal(system.n), rng.standard_normal(system.m)
    x, y = linear.factor(linear.tangent(joints.gradient, system.stiffness(q, v, inputs, *none), damping), 1.0, 3.0).solve(top, bottom)
    d = dense(system.damping_rows, system.damping_cols, damping, (system.n, system.n))
    assert system.mass(x) + 3.0 * d @ x + joints.pull(y) == pytest.approx(top, abs=1e-9)
    assert joints.push(x) == pytest.approx(bottom, abs=1e-9) and np.count_nonzero(d) == 50


def test_other_scenes_do_not_pay(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without viscosity and loads that depend on velocities nothing asks for D."""
    scene = mbd.Scene()
    cable = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=4, E=1e6, A=1e-3, I=1e-8, rho=1000))
    scene.add(mbd.Pin(cable.start, scene.ground.at()))
    scene.add(mbd.Force(cable.end, lambda t: (0.0, t)))
    system = scene.build()
    assert not system.damped and system.damping_rows.size == 0
    monkeypatch.setattr(type(system), "damping", lambda *_: pytest.fail("D was asked for"))
    for solver in (mbd.Radau(), mbd.Gauss(1e-3), mbd.GeneralizedAlpha(1e-3)):
        mbd.simulate(scene, 0.01, solver=solver)


@pytest.mark.parametrize("given", [False, True], ids=["differences", "gradient"])
@pytest.mark.parametrize("solver", [mbd.Radau(5), mbd.DormandPrince(), mbd.Gauss(5e-3, stages=4)], ids=lambda s: type(s).__name__)
def test_a_law_of_rates_is_a_controller(given: bool, solver: Any) -> None:
    """-k s - c ds/dt - d (ds/dt)^3 with d = 0 is a PD controller's force; its work too; d makes it lose more."""
    ends = []
    for cubic in (None, 0.0, 0.5):
        scene, turn = wheel(force=0.0, speed=1.0)
        if cubic is None:
            scene.add(mbd.PD(turn, proportional=20.0, derivative=0.8))
        else:
            law, slope = (lambda t, s, v, d=cubic: -20.0 * s - 0.8 * v - d * v**3), (lambda t, s, v, d=cubic: (-20.0, -0.8 - 3.0 * d * v**2))
            scene.add(mbd.ForceLaw(turn, law, rates=True, gradient=slope if given else None))
        result = mbd.simulate(scene, 0.5, rtol=1e-9, solver=solver)
        ends.append((result.q[-1, turn.coordinate], result.v[-1, turn.coordinate], result.energy.kinetic[-1]))
        assert result.audit.energy_error < 1e-6
    assert ends[1] == pytest.approx(ends[0], abs=1e-7)
    assert ends[2][2] < 0.95 * ends[1][2]


def test_laws_of_several_rates() -> None:
    """K and D of two coupled measures by differences."""
    scene = mbd.Scene(gravity=(0, 0))
    measures = [scene.add(mbd.Angle(scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(k, 0))), scene.ground)) for k in range(2)]
    scene.add(mbd.ForceLaw(measures, lambda t, a, b, u, w: (a * u - np.sin(w), b * b * u * w + t), rates=True))
    system = scene.build()
    rng = np.random.default_rng(2)
    q, v, inputs = rng.standard_normal(system.n), rng.standard_normal(system.n), system.inputs(0.3)
    none = np.zeros(0), np.zeros(system.m)
    found = dense(system.stiffness_rows, system.stiffness_cols, system.stiffness(q, v, inputs, *none), (system.n, system.n))
    rates = dense(system.damping_rows, system.damping_cols, system.damping(q, v, inputs), (system.n, system.n))
    for k, axis in enumerate(1e-5 * np.eye(system.n)):
        assert found[:, k] == pytest.approx((system.load(q - axis, v, inputs) - system.load(q + axis, v, inputs)) / 2e-5, abs=1e-8)
        assert rates[:, k] == pytest.approx((system.load(q, v - axis, inputs) - system.load(q, v + axis, inputs)) / 2e-5, abs=1e-8)


def test_rest_and_modes() -> None:
    """At rest friction and dampers are nothing; about it they damp: ratio c / (2 sqrt(k J))."""
    scene, turn = wheel(force=0.3, speed=0.5)
    scene.add(mbd.ForceLaw(turn, lambda t, s, v: 1.0 - 8.0 * s - 0.2 * v, rates=True))
    rest = mbd.equilibrium(scene)
    assert rest.q[turn.coordinate] == pytest.approx(0.125, abs=1e-10)
    modes = mbd.modes(scene, n=1, about=rest)
    assert modes.damping_ratios[0] == pytest.approx((0.2 + 0.3 / 0.5) / (2.0 * np.sqrt(8.0 * 0.5)), rel=1e-8)
    assert abs(modes.eigenvalues[0]) == pytest.approx(4.0, rel=1e-8)


def test_mistakes_are_named() -> None:
    scene, _ = wheel(force=1.0, speed=0.0)
    scene.add(mbd.Friction(scene["body 1"], force=-1.0, speed=1.0, name="second"))
    scene.add(mbd.ForceLaw(scene["angle 1"], lambda t, s, v: -v, rates=1, name="law"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    text = "\n".join(error.value.complaints)
    assert "friction 'friction 1': speed: expected a positive number" in text
    assert "'second': measure: expected a measure" in text and "'second': force: expected a number not below zero" in text
    assert "'law': rates: expected True or False, found 1" in text
