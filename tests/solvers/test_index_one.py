"""The forms that explicit methods use: all give the accelerations of the KKT matrix, and land on the joints."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.assembly import consistent
from mbd.solvers import index_one, reduced
from mbd.solvers.automatic import Automatic, default
from mbd.solvers.start import accelerations, mass_factor, project_positions, project_velocities
from mbd.state import State

from .. import machines


def with_springs() -> mbd.Scene:
    """A chain of two links with a torque, a following force, springs and a damper, and a particle on a spring beside it."""
    scene, bodies, _ = machines.chain(2)
    scene.add(mbd.Torque(bodies[0].at(0, 0), 3.0))
    scene.add(mbd.Force(bodies[1].at(0.1, 0), (1.0, -2.0), follower=True))
    scene.add(mbd.Spring(bodies[1].at(0.2, 0.1), scene.ground.at(3, 0), stiffness=40.0, damping=2.0))
    mass = scene.add(mbd.Particle(0.7, (0.3, 2.0)))
    scene.add(mbd.Spring(mass.at(), bodies[0].at(0, 0), stiffness=15.0))
    return scene


def driven() -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=2.0))
    scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0)))
    block = scene.add(mbd.Particle(1.0, (1.5, 0.0)))
    scene.add(mbd.Prescribed(block.at(), lambda t: (1.5 + 0.1 * np.sin(3.0 * t), 0.2 * t**2)))
    scene.add(mbd.Spring(block.at(), crank.at(0.5, 0), stiffness=30.0, length=0.2))
    return scene


SCENES = {
    "double pendulum": lambda: machines.double_pendulum()[0],
    "chain": lambda: machines.chain(6)[0],
    "heavy top": lambda: machines.heavy_top()[0],
    "springs and loads": with_springs,
}


def moved(scene: mbd.Scene, seed: int) -> tuple[Any, Any, np.ndarray, np.ndarray, float]:
    """The system, its matrices, and a consistent state away from the start."""
    system = scene.build()
    rng = np.random.default_rng(seed)
    far = State(system.q0 + 0.05 * rng.standard_normal(system.n), rng.standard_normal(system.n), 0.3)
    start = consistent(system, State(system.q0, system.v0))
    goal = system.inputs(far.t).targets
    q = project_positions(system, start.linear, far.q, goal.value)
    v = project_velocities(system, mass_factor(system, start.linear, q), q, far.v, goal.rate)
    return system, start.linear, q, v, far.t


@pytest.mark.parametrize("form", ["reduced", "normal", "kkt"])
@pytest.mark.parametrize("name", SCENES)
def test_accelerations_are_those_of_the_kkt_matrix(name, form):
    system, linear, q, v, t = moved(SCENES[name](), 3)
    if form == "normal" and not index_one.Normal.serves(system):
        assert name == "heavy top"  # a director of which has no inertia of its own
        return
    made = {
        "reduced": lambda: reduced.reduced(system, linear),
        "normal": lambda: index_one.Normal(system, linear),
        "kkt": lambda: index_one.Kkt(system, linear),
    }[form]()
    w, rates = made.enter(q, v), np.zeros((3, made.width))
    places = made.places(np.stack((w, w, w)), rates)
    for k in (2, 1):
        places.rates(system, k, t)
    assert (places.shares(slice(1, 3)) > 1e-3).all()
    multipliers = made.all_rows(places.multipliers)[1]
    a, known = accelerations(system, mass_factor(system, linear, q), q, v, system.inputs(t))
    found = made.leave(np.stack((w[0], rates[1])))[1]
    assert np.array_equal(rates[1], rates[2]) and not rates[0].any()
    np.testing.assert_allclose(made.leave(w), (q, v), atol=1e-12 * np.abs(v).max())
    np.testing.assert_allclose(found, a, atol=1e-10 * np.abs(a).max())
    kept = ~system.joints.constant_rows if form == "reduced" else np.ones(system.m, bool)
    np.testing.assert_allclose(multipliers[kept], known[kept], atol=1e-9 * np.abs(known).max())


@pytest.mark.parametrize("name", SCENES)
def test_reduced_and_whole_forms_land_on_the_joints_with_the_least_motion(name):
    system, linear, q, v, t = moved(SCENES[name](), 5)
    rng = np.random.default_rng(1)
    small, whole = reduced.reduced(system, linear), index_one.Kkt(system, linear)
    push = np.zeros((2, small.width))
    push[:, :-1] = 1e-5 * rng.standard_normal((2, small.k))
    w = small.enter(q, v) + push
    off = np.stack(small.leave(w))
    landed = []
    forms = [(small, w), (whole, off.copy())]
    if index_one.Normal.serves(system):
        forms.append((index_one.Normal(system, linear), off.copy()))
    for form, start in forms:
        form.places(start[None], np.zeros((1, form.width))).land(system, 0, t)
        landed.append(np.stack(form.leave(start)))
        gap = system.joints.at(landed[-1][0])
        assert np.max(np.abs(gap.value) * linear.reach) < 1e-12 * max(system.length, 1.0)
        assert np.max(np.abs(gap.push(landed[-1][1])) * linear.reach) < 1e-11
    for other in landed[1:]:
        np.testing.assert_allclose(landed[0], other, atol=1e-9)
    assert np.abs(landed[0] - off).max() > 1e-7


def test_linear_rows_leave_their_coordinates_and_cost_nothing():
    scene, *_ = machines.chain(6)
    system = scene.build()
    form = reduced.reduced(system, consistent(system, State(system.q0, system.v0)).linear)
    assert (form.m, form.k) == (6, 12) and (system.m, system.n) == (18, 24)


def test_a_reduced_run_asks_the_joints_nothing_after_its_preparation(monkeypatch):
    scene, *_ = machines.chain(4)
    calls = []
    joints = type(scene.build().joints)
    at = joints.at
    monkeypatch.setattr(joints, "at", lambda self, q: calls.append(1) or at(self, q))
    counts = []
    for t_end in (0.2, 0.8):
        calls.clear()
        steps = mbd.simulate(scene, t_end, rtol=1e-8, solver=mbd.DormandPrince()).stats["steps"]
        counts.append((steps, len(calls)))
    assert counts[1][0] > counts[0][0] and counts[1][1] == counts[0][1]


def test_large_or_redundant_systems_have_no_reduced_form():
    system = machines.chain(60)[0].build()
    assert reduced.reduced(system, consistent(system, State(system.q0, system.v0)).linear) is None
    assert isinstance(index_one.index_one(system, consistent(system, State(system.q0, system.v0)).linear), index_one.Normal)


def test_a_driven_machine_in_reduced_form():
    scene = driven()
    tight = {"rtol": 1e-10}
    explicit = mbd.simulate(scene, 2.0, solver=mbd.DormandPrince(), **tight)
    implicit = mbd.simulate(scene, 2.0, solver=mbd.Radau(), **tight)
    np.testing.assert_allclose(explicit.q[-1], implicit.q[-1], atol=1e-7)
    assert explicit.audit.balanced and abs(explicit.audit.energy_error) < 1e-7 * explicit.audit.energy_scale


def spring_scene(stiffness: float) -> mbd.Scene:
    """A pendulum hanging on a particle that a spring holds."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    knob = scene.add(mbd.Particle(0.1, (0.0, -0.5)))
    rod = scene.add(mbd.RigidBody.rod((0, -0.5), (1, -0.5), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), knob.at()))
    scene.add(mbd.Spring(knob.at(), scene.ground.at(0, 0), stiffness=stiffness, damping=0.05 * stiffness**0.5, length=0.5))
    return scene


def test_soft_springs_stay_explicit_and_stiff_ones_do_not():
    soft, stiff = spring_scene(50.0), spring_scene(1e9)
    assert isinstance(default(soft.build())[0], Automatic)
    easy, hard = mbd.simulate(soft, 3.0), mbd.simulate(stiff, 3.0)
    assert easy.stats["newton iterations"] == 12 * easy.stats["steps"]
    assert hard.stats["steps"] < 2000
    reference = mbd.simulate(stiff, 3.0, solver=mbd.Radau(), rtol=1e-9)
    np.testing.assert_allclose(hard.q[-1], reference.q[-1], atol=1e-4)
    middle = 0.5 * (hard.trajectory.t[5:] + hard.trajectory.t[4:-1])
    np.testing.assert_allclose(hard.trajectory.at(middle)[0], reference.trajectory.at(middle)[0], atol=1e-4)


def test_beams_are_implicit_from_the_start():
    scene, *_ = machines.flexible_pendulum(n_elements=2)
    assert isinstance(default(scene.build())[0], mbd.Radau)


def test_a_start_off_the_joints_is_corrected_before_coordinates_are_left_out():
    scene = mbd.Scene(gravity=(0.0, -9.81))
    body = scene.add(mbd.RigidBody.rod((0.05, 0.1), (1.05, 0.1), mass=1.0))
    pin = scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))
    with pytest.warns(mbd.SceneWarning, match="corrected"):
        result = mbd.simulate(scene, 0.5, solver=mbd.DormandPrince())
    assert np.abs(result.position(body.at(-0.5, 0))).max() < 1e-13
    assert pin.name in str(result.assembly)


def test_a_constant_matrix_is_factorised_once():
    scene, *_ = machines.flexible_pendulum(n_elements=2)
    counts = {}
    for t_end in (0.01, 0.05):
        run = mbd.simulate(scene, t_end, rtol=1e-5, solver=mbd.DormandPrince())
        run.acceleration(run.scene["rod"].end if "rod" in {item.name for item in run.scene.items} else run.scene.items[0].end)
        counts[run.stats["steps"]] = run.trajectory.linear.factorizations
    assert len(counts) == 2 and set(counts.values()) == {1}


def test_values_between_steps_from_several_threads():
    """What a method works in belongs to one thread."""
    scene, *_ = machines.chain(4)
    result = mbd.simulate(scene, 0.5, rtol=1e-8)
    times = np.linspace(0.0, 0.5, 60)
    alone = result.trajectory.at(times)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(result.trajectory.at, [times] * 8):
            assert np.array_equal(found, alone)
