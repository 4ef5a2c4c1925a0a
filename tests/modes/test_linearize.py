"""Linearised equations against formulas, against modes, and against small motions of the full simulation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import mbd

PUSH = 1e-6


def crank() -> tuple[mbd.Scene, dict[str, Any]]:
    """A slider-crank with a flexible rod, a spring and a damper on the slider, hanging in balance."""
    scene = mbd.Scene()
    arm = scene.add(mbd.RigidBody.rod((0, 0), (0.3, 0.1), mass=1.0, name="arm"))
    rod = scene.add(mbd.AncfCable((0.3, 0.1), (1.2, 0), n_elements=3, E=1e8, A=1e-4, I=1e-9, rho=2000.0, damping=1e-3, name="rod"))
    block = scene.add(mbd.RigidBody.box((0.1, 0.1), mass=0.5, position=(1.2, 0), name="block"))
    half = arm.length / 2
    scene.add(mbd.Pin(arm.at(-half, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(arm.at(half, 0), rod.start))
    scene.add(mbd.Pin(rod.end, block.at(0, 0)))
    scene.add(mbd.Slider(block.at(0, 0), scene.ground.at(1.2, 0), axis=(1, 0)))
    scene.add(mbd.Spring(block.at(0, 0), scene.ground.at(2, 0), stiffness=50.0, damping=1.0, length=0.7))
    push = scene.add(mbd.Force(block.at(0, 0), lambda t: (PUSH if t > 0.0 else 0.0, 0.0), name="push"))
    turn = scene.add(mbd.Torque(arm.at(0, 0), 0.0, name="turn"))
    return scene, {"arm": arm, "rod": rod, "block": block, "push": push, "turn": turn}


def test_one_degree_of_freedom() -> None:
    """A mass on a spring and damper: the matrices are numbers, up to the length of the basis."""
    scene = mbd.Scene(gravity=(0, 0))
    bead = scene.add(mbd.Particle(2.0, (1.0, 0.0)))
    scene.add(mbd.Spring(bead.at(), scene.ground.at(0, 0), stiffness=8.0, damping=3.0))
    scene.add(mbd.PointOnLine(bead.at(), scene.ground.at(0, 0), axis=(1, 0)))
    push = scene.add(mbd.Force(bead.at(), (0.0, 0.0)))
    linear = mbd.linearize(scene, [push], [bead.at()])
    assert linear.mass.shape == (1, 1) and linear.inputs.shape == (1, 2) and linear.outputs.shape == (2, 1)
    b = linear.basis[0, 0]
    assert [linear.mass[0, 0], linear.damping[0, 0], linear.stiffness[0, 0]] == pytest.approx(np.array([2.0, 3.0, 8.0]) * b**2)
    assert linear.inputs == pytest.approx(np.array([[b, 0.0]])) and linear.outputs == pytest.approx(np.array([[b], [0.0]]))
    assert linear.input_names == ("force 1 x", "force 1 y") and linear.output_names == ("particle 1 x", "particle 1 y")


def test_degrees_of_freedom_and_eigenvalues_are_those_of_the_modes() -> None:
    scene, _ = crank()
    rest = mbd.equilibrium(scene)
    linear, modes = mbd.linearize(scene, about=rest), mbd.modes(scene, 4, about=rest)
    a = linear.matrices[0]
    values = np.linalg.eigvals(a)
    assert len(a) == 2 * len(linear.mass) == 2 * (16 + 4 + 4 - 2 - 2 - 2 - 2 - 2 * 1)
    for s in modes.eigenvalues:
        assert np.abs(values - s).min() < 1e-7 * abs(s)


def test_small_motions_are_those_of_a_simulation() -> None:
    """A step of force by the matrix exponential of (A, B, C) and by the full equations."""
    scene, items = crank()
    rest, out = mbd.equilibrium(scene), [items["block"].at(0, 0), items["rod"].at(0.5)]
    a, b, c, d = mbd.linearize(scene, ["push"], out, about=rest).matrices
    assert not d.any() and b.shape[1] == 2 and c.shape[0] == 4
    times = np.linspace(0.05, 0.5, 10)
    block = np.zeros((len(a) + 1, len(a) + 1))
    block[:-1, :-1], block[:-1, -1] = a, b[:, 0] * PUSH
    expected = np.array([c @ expm(block * t)[:-1, -1] for t in times])
    result = mbd.simulate(scene, 0.5, start=rest.state, rtol=1e-13, t_eval=times)
    moved = np.concatenate([result.position(marker) - rest.position(marker) for marker in out], axis=1)
    assert np.abs(moved - expected).max() < 1e-5 * np.abs(expected).max()


def test_inputs_push_as_their_items_do() -> None:
    """The static answer to each input, C K^-1 F, against equilibria with the load a little larger."""
    for value, column in ((1e-4, 0), (-1e-4, 0)):
        scene, items = crank()
        before = mbd.equilibrium(scene)
        linear = mbd.linearize(scene, [items["turn"]], [items["block"].at(0, 0)], about=before)
        scene.add(mbd.Torque(items["arm"].at(0, 0), value))
        after = mbd.equilibrium(scene, start=before.state)
        moved = after.position(items["block"].at(0, 0)) - before.position(items["block"].at(0, 0))
        assert (linear.outputs @ np.linalg.solve(linear.stiffness, linear.inputs))[:, column] * value == pytest.approx(moved, rel=1e-3, abs=1e-12)


def test_follower_and_spatial_inputs() -> None:
    """Unit loads of items that turn are taken in the axes that they have in the equilibrium."""
    scene = mbd.Scene(gravity=(0, 0, 0))
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=(1, 2, 3), position=(0, 0, 0), rotation=turned))
    jet = scene.add(mbd.Force(body.at(0, 0, 0), (0, 0, 0), follower=True))
    wheel = scene.add(mbd.Torque(body.at(0, 0, 0), (0, 0, 0)))
    linear = mbd.linearize(scene, [jet, wheel], [body.at(0, 0, 0), body.at(1, 0, 0)])
    assert linear.mass.shape == (6, 6) and not linear.stiffness.any()
    response = linear.outputs @ np.linalg.solve(linear.mass, linear.inputs)
    assert response[:3, :3] == pytest.approx(turned, abs=1e-12)
    assert response[3:, 5] == pytest.approx([-1 / 3, 0, 0], abs=1e-12)
    assert response[3:, 3] == pytest.approx([0, 0, 1 / 2], abs=1e-12)


def test_scipy_state_space() -> None:
    scene, items = crank()
    linear = mbd.linearize(scene, ["push"], [items["block"].at(0, 0)], about=mbd.equilibrium(scene))
    system = linear.state_space
    frequency = 3.0
    h = system.C @ np.linalg.solve(1j * frequency * np.eye(len(system.A)) - system.A, system.B) + system.D
    direct = linear.outputs @ np.linalg.solve(-(frequency**2) * linear.mass + 1j * frequency * linear.damping + linear.stiffness, linear.inputs)
    assert h == pytest.approx(direct, rel=1e-8, abs=1e-12)


def test_bad_inputs_and_outputs_are_listed_together() -> None:
    scene, items = crank()
    with pytest.raises(mbd.SceneError) as raised:
        mbd.linearize(scene, [items["arm"], "nobody"], [items["rod"]], about=mbd.equilibrium(scene))
    assert len(raised.value.complaints) == 3 and "outputs: expected markers" in raised.value.complaints[2]
