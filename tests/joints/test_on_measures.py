"""Actuators, controllers, stops, force laws and users' measures, against closed forms, sympy and other models of the same machine."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy as sp

import mbd

from ..kinds import dense, derivative

G = 9.81


def run(scene: mbd.Scene, t_end: float, rtol: float = 1e-11) -> Any:
    return mbd.simulate(scene, t_end, rtol=rtol, t_eval=np.linspace(0.0, t_end, 9))


def cart(**motion: Any) -> tuple[mbd.Scene, Any, Any]:
    """A particle of 2 kg on the x axis, its displacement from the origin: scene, particle, measure."""
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.Particle(2.0, (1.0, 0.0), **motion))
    scene.add(mbd.PointOnLine(body.at(), scene.ground.at(), axis=(1, 0)))
    return scene, body, scene.add(mbd.Displacement(body, scene.ground, axis=(1, 0), name="x"))


# Actuators.


@pytest.mark.parametrize("way", ["value", "rate", "force"])
def test_a_cylinder_lifts_a_boom(way: str) -> None:
    """Driven by length, by speed, or by the force that either takes: the same motion, and the force is that of virtual work."""
    length: Callable[[float], float] = lambda t: np.sqrt(0.5) + 0.1 * t + 0.05 * np.sin(2.0 * t)  # noqa: E731

    def boom(**drive: Any) -> tuple[Any, Any, Any, Any]:
        scene = mbd.Scene()
        arm = scene.add(mbd.RigidBody.rod((0, 0), (2, 0), mass=10.0))
        scene.add(mbd.Pin(arm.at(-1.0, 0), scene.ground.at()))
        ram = scene.add(mbd.Length(arm.at(-0.5, 0), scene.ground.at(0, -0.5)))
        scene.add(mbd.Actuator(ram, **drive))
        motion = {} if way == "value" else {"angular_velocity": 0.2 * np.sqrt(0.5) / 0.25}
        return scene, arm, ram, motion

    scene, arm, ram, _ = boom(value=length)
    driven = run(scene, 1.0, 1e-9)
    force = driven.reaction(ram)[:, :2]
    joint = driven.position(arm.at(-0.5, 0)) - (0.0, -0.5)
    direction = joint / np.linalg.norm(joint, axis=1)[:, None]
    assert np.abs(np.linalg.norm(joint, axis=1) - [length(t) for t in driven.t]).max() < 1e-12
    assert np.abs(force - np.sum(force * direction, axis=1)[:, None] * direction).max() < 1e-9 * np.abs(force).max(), "along the ram"
    angle, lever = driven.angle(arm), 0.5 * (direction[:, 1] * np.cos(driven.angle(arm)) - direction[:, 0] * np.sin(driven.angle(arm)))
    outer, inner = driven.acceleration(arm.at(1.0, 0)), driven.acceleration(arm.at(-1.0, 0))
    alpha = (np.cos(angle) * (outer - inner)[:, 1] - np.sin(angle) * (outer - inner)[:, 0]) / 2.0
    expected = (10.0 * 4.0 / 3.0 * alpha + 10.0 * G * np.cos(angle)) / lever
    assert np.abs(np.sum(force * direction, axis=1) - expected).max() < 1e-9 * np.abs(expected).max()
    if way == "rate":
        scene, arm, *_ = boom(rate=lambda t: 0.1 + 0.1 * np.cos(2.0 * t))
        assert np.abs(run(scene, 1.0, 1e-9).position(arm.at()) - driven.position(arm.at())).max() < 1e-9


def test_force_on_a_length_is_a_pair_of_forces() -> None:
    """Two particles pushed apart: each by the force over its mass."""
    scene = mbd.Scene(gravity=(0, 0))
    a, b = scene.add(mbd.Particle(1.0, (0, 0))), scene.add(mbd.Particle(3.0, (0.6, 0.8)))
    apart = scene.add(mbd.Length(a, b))
    scene.add(mbd.Actuator(apart, force=lambda t: 6.0 * t))
    result = run(scene, 1.0)
    way = result.t[:, None] ** 3 * np.array((0.6, 0.8))
    assert np.abs(result.position(a.at()) + way).max() < 1e-10 and np.abs(result.position(b.at()) - (0.6, 0.8) - way / 3.0).max() < 1e-10
    assert result.reaction(apart)[:, :2] == pytest.approx(-6.0 * result.t[:, None] * np.array((0.6, 0.8)), abs=1e-10)
    assert result.q[:, apart.coordinate] == pytest.approx(1.0 + 4.0 / 3.0 * result.t**3, abs=1e-10)


# Controllers.


def test_controlled_cart_follows_its_closed_form() -> None:
    """m x'' = -p (x - c) - d (x' - c') with c = 1 + t^2: the error obeys m e'' + d e' + p e = -2 m."""
    scene, body, x = cart()
    scene.add(mbd.PD(x, lambda t: 1.0 + t**2, proportional=50.0, derivative=8.0))
    result = run(scene, 2.0)
    t = sp.symbols("t")
    e = sp.Function("e")
    error = sp.dsolve(2 * e(t).diff(t, 2) + 8 * e(t).diff(t) + 50 * e(t) + 4, e(t), ics={e(0): 0, e(t).diff(t).subs(t, 0): 0}).rhs
    expected = [1.0 + s**2 + float(error.subs(t, s)) for s in result.t]
    assert np.abs(result.position(body.at())[:, 0] - expected).max() < 1e-9
    assert result.reaction(x)[:, 0] == pytest.approx(2.0 * result.acceleration(body.at())[:, 0], abs=1e-9)
    assert result.audit.energy_error < 1e-7 * result.audit.energy_scale


def test_controlled_angle_is_a_torsion_spring() -> None:
    """A constant target: the same as TorsionSpring, over several turns."""
    angles = []
    for controlled in (False, True):
        scene = mbd.Scene(gravity=(0, 0))
        wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0), angular_velocity=30.0))
        scene.add(mbd.Pin(wheel.at(), scene.ground.at()))
        if controlled:
            scene.add(mbd.PD(scene.add(mbd.Angle(wheel, scene.ground)), 2.0, proportional=3.0, derivative=0.2))
        else:
            scene.add(mbd.TorsionSpring(wheel.at(), scene.ground.at(), stiffness=3.0, damping=0.2, angle=2.0))
        angles.append(run(scene, 2.0).angle(wheel))
    assert np.abs(angles[0] - angles[1]).max() < 1e-9 and np.ptp(angles[0]) > 7.0


# Stops.


def test_stop_reflects_with_its_energy() -> None:
    """Without damping a cart returns with its speed; at the turning point all its energy is in the stop."""
    scene, body, x = cart(velocity=(3.0, 0.0))
    stop = mbd.Stop(x, lower=0.5, upper=1.5, stiffness=5e3, width=0.02)
    scene.add(stop)
    turn = mbd.Event(lambda state: state.velocity(body.at())[0], name="turn")
    result = mbd.simulate(scene, 0.9, rtol=1e-11, events=[turn])
    assert len(result.events[turn].t) == 2, "both sides"
    for q, deep in zip(result.events[turn].q, (1.0, -1.0)):
        s = q[x.coordinate] - (1.5 if deep > 0 else 0.5)
        stored = 0.5 * ((abs(s) - 0.01) ** 2 + 0.05 * 0.02**2)  # the integral of g, x > w
        assert 5e3 * stored == pytest.approx(9.0, rel=1e-7) and s * deep > 0.02
    assert np.abs(np.abs(result.velocity(body.at())[-1]) - (3.0, 0.0)).max() < 1e-6
    assert result.audit.energy_error < 1e-7 * 9.0


def test_stop_brings_to_rest() -> None:
    """Under its weight a load settles where the stop carries it; nothing acts away from the stop."""
    scene = mbd.Scene()
    load = scene.add(mbd.Particle(2.0, (0, 0.3)))
    scene.add(mbd.PointOnLine(load.at(), scene.ground.at(), axis=(0, 1)))
    height = scene.add(mbd.Displacement(load, scene.ground, axis=(0, 1)))
    scene.add(mbd.Stop(height, lower=0.0, stiffness=2e3, damping=60.0, width=0.001))
    result = mbd.simulate(scene, 3.0, rtol=1e-7)
    free = result.t < np.sqrt(2.0 * 0.3 / G) - 1e-6
    assert np.abs(result.position(load.at())[free, 1] - 0.3 + 0.5 * G * result.t[free] ** 2).max() < 1e-7 and free.sum() > 2
    assert np.abs(result.reaction(height)[free]).max() < 1e-9
    assert result.position(load.at())[-1, 1] == pytest.approx(-2.0 * G / 2e3 - 0.0005, abs=1e-7)
    assert result.reaction(height)[-1, 1] == pytest.approx(2.0 * G, abs=1e-3)


@pytest.mark.parametrize("solver", [mbd.Radau(3), mbd.Radau(7), mbd.DormandPrince()], ids=["Radau 3", "Radau 7", "explicit"])
@pytest.mark.parametrize("damping", [0.0, 60.0])
def test_steps_do_not_pass_into_a_stop(solver: Any, damping: float) -> None:
    """A free flight has long steps, and the stop shall not be overlooked by the one that meets it: error against one at a tight tolerance."""

    def fall(rtol: float, method: Any) -> Any:
        scene = mbd.Scene()
        load = scene.add(mbd.Particle(2.0, (0, 0.3)))
        scene.add(mbd.PointOnLine(load.at(), scene.ground.at(), axis=(0, 1)))
        height = scene.add(mbd.Displacement(load, scene.ground, axis=(0, 1)))
        scene.add(mbd.Stop(height, lower=0.0, stiffness=2e3, damping=damping, width=0.001))
        return mbd.simulate(scene, 0.6, rtol=rtol, solver=method)

    true = fall(1e-11, mbd.DormandPrince()).final.q[1]
    for rtol in (1e-4, 1e-6):
        assert abs(fall(rtol, solver).final.q[1] - true) < 30.0 * rtol  # a tolerance of each step, and a stiff bounce magnifies errors of its time


def test_onset_is_smooth() -> None:
    """Strain, force and stiffness by sympy's piecewise polynomial, before, within and after the onset, on both sides; with the damper."""
    scene, _, x = cart()
    scene.add(mbd.Stop(x, lower=-1.0, upper=2.0, stiffness=7.0, damping=3.0, width=0.4))
    system = scene.build()
    s, k = sp.symbols("s"), x.coordinate
    u = s / sp.Rational(2, 5)
    g = sp.Piecewise((0, s < 0), (sp.Rational(2, 5) * (u**3 - u**4 / 2), u < 1), (s - sp.Rational(1, 5), True))
    for at in (-1.7, -1.2, -1.01, 0.0, 1.9, 2.1, 2.39, 3.0):
        q, v = system.q0.copy(), np.arange(1.0, system.n + 1)
        q[k] = at
        p = g.subs(s, s - 2) - g.subs(s, -1 - s)
        value, slope, bend = (float(sp.diff(p, s, n).subs(s, at)) if n else float(p.subs(s, at)) for n in range(3))
        stress = 3.0 * slope * v[k]
        assert system.force(q, v, system.inputs(0.0))[k] == pytest.approx(-7.0 * value - slope * stress, abs=1e-12)
        tangent = system.stiffness(q, v, system.inputs(0.0), np.array([stress]), np.zeros(system.m))
        found = dense(system.stiffness_rows, system.stiffness_cols, tangent, (system.n, system.n))[k, k]
        assert found == pytest.approx(7.0 * slope + stress * bend + 3.0 * slope * bend * v[k], abs=1e-11)
        damping = dense(system.damping_rows, system.damping_cols, system.damping(q, v, system.inputs(0.0)), (system.n, system.n))[k, k]
        assert damping == pytest.approx(3.0 * slope**2, abs=1e-12)
        many, twice = system.strains(np.stack((q, system.q0))), np.stack((v, v))
        assert many.push(twice)[0] == pytest.approx([slope * v[k]], abs=1e-12)
        assert many.swirl_times(twice, twice)[0] == pytest.approx([bend * v[k] ** 2], abs=1e-11)


# Force laws.


def duffing(t: float, x: float) -> float:
    return -30.0 * (x - 1.0) - 400.0 * (x - 1.0) ** 3


@pytest.mark.parametrize("given", [False, True], ids=["differences", "given gradient"])
@pytest.mark.parametrize("solver", [None, mbd.Radau(5)], ids=["explicit", "implicit"])
def test_hardening_spring(solver: Any, given: bool) -> None:
    """Its first integral, m v^2 / 2 + 15 y^2 + 100 y^4, and the energy balance."""
    scene, body, x = cart(velocity=(1.5, 0.0))
    scene.add(mbd.ForceLaw(x, duffing, gradient=(lambda t, x: -30.0 - 1200.0 * (x - 1.0) ** 2) if given else None))
    result = mbd.simulate(scene, 2.0, rtol=1e-9, solver=solver)
    y, v = result.position(body.at())[:, 0] - 1.0, result.velocity(body.at())[:, 0]
    assert np.ptp(y) > 0.5 and np.abs(v**2 + 15.0 * y**2 + 100.0 * y**4 - 2.25).max() < 1e-7
    assert result.reaction(x)[:, 0] == pytest.approx([duffing(0.0, s) for s in y + 1.0], abs=1e-9)
    assert result.audit.energy_error < 1e-6 * result.audit.energy_scale


def test_law_on_several_measures() -> None:
    """A linear spring between two carts as a law on their displacements is a Spring; its gradient by differences is that of the matrix."""
    ends = []
    for law in (False, True):
        scene = mbd.Scene(gravity=(0, 0))
        bodies = [scene.add(mbd.Particle(m, (x, 0), (x, 0))) for m, x in ((1.0, 0.5), (2.0, 1.5))]
        for body in bodies:
            scene.add(mbd.PointOnLine(body.at(), scene.ground.at(), axis=(1, 0)))
        if law:
            x = [scene.add(mbd.Displacement(body, scene.ground, axis=(1, 0))) for body in bodies]
            item = scene.add(mbd.ForceLaw(x, lambda t, a, b: (20.0 * (b - a - 1.0), -20.0 * (b - a - 1.0))))
            system = scene.build()
            kernel = next(kernel for kernel in system.loads)
            assert kernel.gradient(system.q0, kernel.inputs(np.zeros(())))[0] == pytest.approx(20.0 * np.array([[-1, 1], [1, -1]]), abs=1e-9)
            assert item.name == "force law 1"
        else:
            scene.add(mbd.Spring(bodies[0].at(), bodies[1].at(), stiffness=20.0, length=1.0))
        result = run(scene, 1.0, 1e-10)
        ends.append([result.position(body.at())[:, 0] for body in bodies])
    assert np.abs(np.array(ends[0]) - np.array(ends[1])).max() < 1e-9


def test_law_lands_on_declared_jumps() -> None:
    scene, body, x = cart()
    kick = mbd.piecewise(lambda t: 0.0, at=[0.3])

    def law(t: float, s: float) -> float:
        return 4.0 if t >= 0.3 else 0.0

    law.discontinuities = kick.discontinuities  # type: ignore[attr-defined]
    scene.add(mbd.ForceLaw(x, law))
    result = mbd.simulate(scene, 1.0)
    assert 0.3 in result.t
    assert result.position(body.at())[-1, 0] == pytest.approx(1.0 + 0.7**2, abs=1e-9)


# Users' measures.


def saddle(a: float, b: float) -> float:
    return np.sin(a) * b**2 + 0.3 * a * b


@pytest.mark.parametrize("given", [False, True], ids=["differences", "given"])
def test_derivatives_of_a_users_measure(given: bool) -> None:
    """Value, G, d(G v)/dq, bias and curvature of s - f(a, b) by sympy."""
    a, b = sp.symbols("a b")
    f = sp.sin(a) * b**2 + sp.Rational(3, 10) * a * b
    symbols = (a, b)
    first, second = [sp.diff(f, x) for x in symbols], [[sp.diff(f, x, y) for y in symbols] for x in symbols]
    words = {"gradient": sp.lambdify(symbols, first), "hessian": sp.lambdify(symbols, second)} if given else {}
    scene = mbd.Scene(gravity=(0, 0))
    bodies = [scene.add(mbd.Particle(1.0, (x, 0.3))) for x in (0.4, 1.1)]
    x = [scene.add(mbd.Displacement(body, scene.ground, axis=(1, 0))) for body in bodies]
    made = scene.add(mbd.UserMeasure(x, saddle, **words))
    system, rng = scene.build(), np.random.default_rng(1)
    q, v, multipliers = system.q0 + 0.1 * rng.standard_normal(system.n), rng.standard_normal(system.n), rng.standard_normal(system.m)
    joints, row = system.joints, [item for item, _ in system.joints.labels].index(made.name)
    at = joints.at(q)
    here = {a: q[x[0].coordinate], b: q[x[1].coordinate]}
    gradient = np.array([float(g.subs(here)) for g in first])
    hessian = np.array([[float(h.subs(here)) for h in line] for line in second])
    index = [item.coordinate % system.n for item in x]
    expected = np.zeros(system.n)
    expected[index], expected[made.coordinate] = -gradient, 1.0
    assert at.value[row] == pytest.approx(q[made.coordinate] - float(f.subs(here)), abs=1e-15)
    found = dense(joints.rows, joints.cols, at.gradient, (system.m, system.n))
    assert found[row] == pytest.approx(expected, abs=1e-11)
    swirl = dense(joints.rows, joints.cols, at.swirl(v), (system.m, system.n))[row]
    assert swirl[index] == pytest.approx(-hessian @ v[index], abs=1e-8)
    assert at.bias(v)[row] == pytest.approx(-v[index] @ hessian @ v[index], abs=1e-8)
    curvature = dense(joints.curvature_rows, joints.curvature_cols, at.curvature(multipliers), (system.n, system.n))
    only = np.zeros(system.m)
    only[row] = multipliers[row]
    mine = dense(joints.curvature_rows, joints.curvature_cols, at.curvature(only), (system.n, system.n))
    assert mine[np.ix_(index, index)] == pytest.approx(-multipliers[row] * hessian, abs=1e-8)
    change = rng.standard_normal(system.n)
    assert curvature @ change == pytest.approx(derivative(lambda y: joints.at(y).pull(multipliers), q, change), abs=1e-7)
    assert joints.at(np.stack((q, system.q0))).bias(np.stack((v, v)))[0] == pytest.approx(at.bias(v), abs=1e-12)


def test_cam_lifts_its_follower() -> None:
    """A cam at constant speed: lift, speed and force of the follower from the profile, at every instant."""
    profile: Callable[[float], float] = lambda x: 1.0 + 0.1 * np.sin(3.0 * x)  # noqa: E731
    scene = mbd.Scene()
    cam = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0)))
    scene.add(mbd.Pin(cam.at(), scene.ground.at()))
    motor = scene.add(mbd.Motor(cam, scene.ground, speed=2.0))
    follower = scene.add(mbd.Particle(0.4, (0, 1)))
    scene.add(mbd.PointOnLine(follower.at(), scene.ground.at(), axis=(0, 1)))
    turn = scene.add(mbd.Angle(cam, scene.ground))
    lift = scene.add(mbd.Displacement(follower, scene.ground, axis=(0, 1)))
    scene.add(mbd.Coupling([(1.0, lift), (-1.0, scene.add(mbd.UserMeasure(turn, profile)))], value=0.0))
    result = mbd.simulate(scene, 2.0, rtol=1e-7)
    phi = 2.0 * result.t
    assert result.position(follower.at())[:, 1] == pytest.approx([profile(x) for x in phi], abs=1e-10)
    assert result.velocity(follower.at())[:, 1] == pytest.approx(0.6 * np.cos(3.0 * phi), abs=1e-9)
    force = 0.4 * (G - 3.6 * np.sin(3.0 * phi))
    assert result.reaction(lift)[:, 1] == pytest.approx(force, abs=1e-7)
    assert result.reaction(motor)[:, 2] == pytest.approx(0.3 * np.cos(3.0 * phi) * force, abs=1e-7)


# Mistakes.


def test_mistakes_are_named() -> None:
    scene, body, x = cart()
    descriptions = {
        "none": (mbd.Actuator(x), "expected exactly one of value=, rate= and force=, found none"),
        "body": (mbd.Actuator(body, force=1.0), "measure: expected a measure"),
        "gain": (mbd.PD(x, proportional=-1.0), "proportional: expected a number not below zero"),
        "free": (mbd.Stop(x, stiffness=1.0, width=0.1), "expected lower= or upper=, found none"),
        "swapped": (mbd.Stop(x, lower=2.0, upper=1.0, stiffness=1.0, width=0.1), "lower: expected a limit below the upper one"),
        "hard": (mbd.Stop(x, upper=1.0, stiffness=1.0, width=0.0), "width: expected a positive number"),
        "number": (mbd.ForceLaw(x, 3.0), "function: expected a function of t and 1 numbers"),
        "text": (mbd.UserMeasure(x, "f"), "function: expected a function of 1 numbers"),
    }
    for name, (description, _) in descriptions.items():
        object.__setattr__(description, "name", name)
        scene.add(description)
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    assert len(error.value.complaints) == len(descriptions)
    for line, (name, (_, words)) in zip(error.value.complaints, descriptions.items()):
        assert repr(name) in line and words in line


def test_given_derivatives_are_checked() -> None:
    scene, _, x = cart()
    scene.add(mbd.ForceLaw(x, duffing, gradient=lambda t, s: -29.0, name="law"))
    scene.add(mbd.UserMeasure(x, lambda s: s**3, gradient=lambda s: 3.0 * s**2, hessian=lambda s: 6.5 * s, name="cube"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    assert "force law 'law': gradient: expected the derivative of the function" in error.value.complaints[0]
    assert "user measure 'cube': hessian: expected the derivative" in error.value.complaints[1] and len(error.value.complaints) == 2


@pytest.mark.parametrize("bad", [lambda t, s: 1.0 / 0.0, lambda t, s: np.nan, lambda t, s: (1.0, 2.0)], ids=["raises", "nan", "shape"])
def test_a_function_that_fails_names_its_item(bad: Any) -> None:
    scene, _, x = cart()
    scene.add(mbd.ForceLaw(x, lambda t, s: bad(t, s) if t > 0.1 else 0.0, name="law"))
    with pytest.raises(mbd.SimulationError, match="at law: its function") as error:
        mbd.simulate(scene, 1.0)
    assert error.value.item == "law" and error.value.time > 0.1


def test_a_users_measure_cannot_be_stored(tmp_path: Any) -> None:
    scene, _, x = cart(velocity=(1.0, 0.0))
    scene.add(mbd.UserMeasure(x, lambda s: s**2, name="square"))
    result = mbd.simulate(scene, 0.1)
    assert result.final.q[scene["square"].coordinate] == pytest.approx(1.21, abs=1e-12)
    with pytest.raises(ValueError, match=r"UserMeasure 'square'.* cannot be stored"):
        result.save(tmp_path / "run.npz")
