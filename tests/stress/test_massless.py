"""Bodies without mass or inertia: joints, with what else has mass, tell where they are; where these do not, the body is refused by name."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import mbd
from benchmarks.stress import exact

G = exact.GRAVITY


def parallelogram(mass: float, solver: object = None) -> float:
    """The error of two links of 1 m and 1 kg, released 60 degrees from hanging, with such a coupler: one pendulum."""
    tip = np.array([np.sin(np.pi / 3.0), -0.5])
    scene = mbd.Scene(gravity=(0.0, -G))
    left = scene.add(mbd.RigidBody.rod((0, 0), tip, mass=1.0))
    right = scene.add(mbd.RigidBody.rod((1, 0), tip + (1, 0), mass=1.0))
    coupler = scene.add(mbd.RigidBody.rod(tip, tip + (1, 0), mass=mass))
    for k, link in enumerate((left, right)):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(k, 0)))
        scene.add(mbd.Pin(link.at(0.5, 0), coupler.at(k - 0.5, 0)))
    result = mbd.simulate(scene, 0.5, solver=solver)
    angle = exact.swing(np.pi / 3.0, np.sqrt(1.5 * G), 0.5)
    return float(np.linalg.norm(result.position(left.at(0.5, 0))[-1] - (np.sin(angle), -np.cos(angle))))


SOLVERS = [None, mbd.DormandPrince(), mbd.Radau(), mbd.Gauss(step=0.01), mbd.GeneralizedAlpha(step=0.0005)]


@pytest.mark.parametrize("solver", SOLVERS, ids=["automatic", "explicit", "radau", "gauss", "alpha"])
def test_every_method_runs_with_a_massless_coupler(solver: object) -> None:
    assert parallelogram(0.0, solver) < 1e-5


@pytest.mark.parametrize("mass", [1e-300, 1e-30, 1e-18, 1e-17, 1e-16, 1e-15])
def test_tiny_masses_raise_no_alarm(mass: float) -> None:
    """Joints hold such a coupler once, whatever its mass: none of them is redundant."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert parallelogram(mass) < 1e-6


def test_a_massless_arm_in_space() -> None:
    scene = mbd.Scene(gravity=(0.0, 0.0, -G))
    arm = scene.add(mbd.RigidBody(mass=0.0, inertia=(0.0, 0.0, 0.0), position=(0.5, 0.0, 0.0)))
    bob = scene.add(mbd.Particle(1.0, (1.0, 0.0, 0.0)))
    scene.add(mbd.Pin(arm.at(-0.5, 0, 0), scene.ground.at(0, 0, 0), axis=(0, 1, 0)))
    scene.add(mbd.Ball(arm.at(0.5, 0, 0), bob.at()))
    angle = exact.swing(0.5 * np.pi, np.sqrt(G), 0.5)
    np.testing.assert_allclose(mbd.simulate(scene, 0.5).position(bob.at())[-1], (np.sin(angle), 0.0, -np.cos(angle)), atol=1e-6)


def test_inertia_without_mass_is_followed() -> None:
    """A wheel of inertia J and no mass under a torque M cos t turns by M / J (1 - cos t); its size is unknown, its error is not."""
    scene = mbd.Scene(gravity=(0.0, -G))
    wheel = scene.add(mbd.RigidBody(mass=0.0, inertia=2.0, position=(1.0, 1.0)))
    scene.add(mbd.Pin(wheel.at(0, 0), scene.ground.at(1, 1)))
    scene.add(mbd.Torque(wheel.at(0, 0), mbd.Expression("4 * cos(t)")))
    angle = 2.0 * (1.0 - np.cos(1.0))
    np.testing.assert_allclose(mbd.simulate(scene, 1.0).q[-1, 2:], (np.cos(angle), np.sin(angle)), atol=1e-6)


def loose(kind: str) -> mbd.Scene:
    """A particle 'dot' that has no mass and too little that holds it."""
    scene = mbd.Scene(gravity=(0.0, -G))
    dot, other = scene.add(mbd.Particle(0.0, (1.0, 0.0), name="dot")), scene.add(mbd.Particle(1.0, (2.0, 0.0)))
    if kind == "springs":
        scene.add(mbd.Spring(dot.at(), other.at(), stiffness=100.0))
        scene.add(mbd.Spring(dot.at(), scene.ground.at(0, 0), stiffness=100.0))
    if kind == "rods in line":
        scene.add(mbd.Distance(dot.at(), other.at()))
        scene.add(mbd.Distance(dot.at(), scene.ground.at(0, 0)))
    return scene


@pytest.mark.parametrize("kind", ["free", "springs", "rods in line"])
def test_what_nothing_determines_is_refused_by_name(kind: str) -> None:
    with pytest.raises(mbd.SceneError, match="'dot': expected inertia or joints for every coordinate"):
        mbd.simulate(loose(kind), 1.0)
    assert any("dot" in name for name in mbd.check(loose(kind)).unheld)


@pytest.mark.parametrize("item", [mbd.Particle(-1.0, (0, 0)), mbd.RigidBody(mass=-1.0, inertia=0.0, position=(0, 0))])
def test_negative_masses_are_refused(item: object) -> None:
    scene = mbd.Scene(gravity=(0.0, -G))
    scene.add(item)
    with pytest.raises(mbd.SceneError, match="mass: expected a number not below zero"):
        scene.build()
