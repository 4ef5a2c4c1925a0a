"""The main job: the flexible pendulum of Escalona, Hussien and Shabana (1998) against independent integrations of its own mesh."""

from __future__ import annotations

import numpy as np
import pytest

import mbd

from . import machines


@pytest.mark.parametrize(("elasticity", "bound"), [("local_frame", 2e-8), ("continuum", 5e-8)])
def test_tip_and_middle_follow_the_reference(elasticity: str, bound: float) -> None:
    """The reference has 8 decimals; the continuum's was made with its own 7 Gauss points to a few 1e-8."""
    reference = machines.data("pendulum")[elasticity]
    scene, rod, _ = machines.flexible_pendulum(elasticity=elasticity)
    result = mbd.simulate(scene, 1.2, rtol=1e-10)
    tip, middle = (result.position(marker, t=reference["t"]) for marker in (rod.end, rod.at(0.5)))
    assert np.abs(tip - reference["tip"]).max() < bound
    assert np.abs(middle - reference["mid_node"]).max() < bound
    assert result.audit.energy_scale > 60.0
    assert result.audit.energy_error < 1e-8 * result.audit.energy_scale
    assert result.audit.position_drift < 1e-10
    assert result.audit.velocity_drift < 1e-10


def test_gauss_points_are_enough() -> None:
    """The tip changes by less than 1e-6 from 7 to 9 points (measured 9e-8 to 14 points at 1.2 s)."""
    tips = []
    for points in (7, 9):
        scene, rod, _ = machines.flexible_pendulum(gauss_points=points)
        tips.append(mbd.simulate(scene, 0.8, rtol=1e-8).position(rod.end)[-1])
    assert np.abs(tips[0] - tips[1]).max() < 1e-6


def hanging(L: float = 1.2, E: float = 0.7e6, rho: float = 5540.0, g: float = 9.81, n: int = 30) -> mbd.State:
    """Stretched by its own weight: y = -(x + rho g (L x - x^2/2)/E), exact on any mesh."""
    x = np.linspace(0.0, L, n + 1)
    y = -(x + rho * g * (L * x - 0.5 * x**2) / E)
    slope = -(1.0 + rho * g * (L - x) / E)
    zero = np.zeros_like(x)
    q = np.stack((zero, y, zero, slope), axis=1).ravel()
    return mbd.State(q, np.zeros_like(q))


@pytest.mark.parametrize("elasticity", ["local_frame", "continuum"])
def test_hanging_equilibrium_stays(elasticity: str) -> None:
    scene, rod, pivot = machines.flexible_pendulum(elasticity=elasticity)
    start = hanging()
    result = mbd.simulate(scene, 1.0, rtol=1e-8, start=start)
    assert np.abs(result.q - start.q).max() < 1e-10
    assert result.position(rod.end)[-1] == pytest.approx([0.0, -1.2559001828571428], abs=1e-12)
    weight = 5540 * 1.8e-3 * 1.2 * 9.81
    assert result.reaction(pivot)[-1] == pytest.approx([0.0, weight, 0.0], abs=1e-7 * weight)


def test_a_run_in_two_parts_is_the_same_run() -> None:
    scene, rod, _ = machines.flexible_pendulum()
    whole = mbd.simulate(scene, 0.6, rtol=1e-9)
    first = mbd.simulate(scene, 0.35, rtol=1e-9)
    second = mbd.simulate(scene, 0.6, rtol=1e-9, start=first.final)
    assert second.t[0] == 0.35
    # Each run's own error at this tolerance is about 1e-8.
    assert np.abs(whole.position(rod.end)[-1] - second.position(rod.end)[-1]).max() < 5e-8


def test_a_plane_in_space_gives_the_planar_motion() -> None:
    rotation = np.linalg.qr(np.random.default_rng(4).standard_normal((3, 3)))[0]
    rotation[:, 2] *= np.sign(np.linalg.det(rotation))
    planar, rod, pivot = machines.flexible_pendulum(n_elements=12)
    spatial = mbd.Scene(gravity=rotation @ (0.0, -9.81, 0.0))
    cable = spatial.add(mbd.AncfCable((0, 0, 0), rotation @ (1.2, 0, 0), n_elements=12, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540))
    hinge = spatial.add(mbd.Pin(cable.start, spatial.ground.at(0, 0, 0), axis=rotation[:, 2]))
    times = np.linspace(0.05, 0.6, 12)
    a, b = mbd.simulate(planar, 0.6, rtol=1e-11), mbd.simulate(spatial, 0.6, rtol=1e-11)
    turned = b.position(cable.end, t=times) @ rotation
    assert np.abs(turned[:, 2]).max() < 1e-9
    assert np.abs(turned[:, :2] - a.position(rod.end, t=times)).max() < 1e-9
    force = b.reaction(hinge, t=times)[:, :3] @ rotation
    assert np.abs(force[:, :2] - a.reaction(pivot, t=times)[:, :2]).max() < 1e-5 * np.abs(force).max()


@pytest.mark.parametrize("stages", [3, 5, 7])
def test_steel_pendulum_finishes_at_every_tolerance(stages: int) -> None:
    """E = 2.07e11: few steps for a useful answer, and a looser tolerance never costs over 20 % more Newton solves than a tighter one."""
    scene, rod, _ = machines.flexible_pendulum(E=2.07e11)
    solves, good = [], []
    for rtol in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        result = mbd.simulate(scene, 0.5, rtol=rtol, solver=mbd.Radau(stages=stages))
        error = np.linalg.norm(result.position(rod.end)[-1] - (0.1744832851, -1.1872474386))
        solves.append(result.stats["newton iterations"])
        good.append(error < 3e-4 and result.stats["steps"] < 60)
    assert any(good)
    assert error < 2e-5
    for loose in range(len(solves)):
        assert solves[loose] <= 1.2 * min(solves[loose:])


def test_distributed_gravity_keeps_a_falling_beam_straight() -> None:
    scene = mbd.Scene(gravity=(0, -9.81))
    beam = scene.add(mbd.AncfCable((0, 0), (2.4, 0), n_elements=4, E=0.7e11, A=0.0018, I=1.215e-8, rho=2770, elasticity="local_frame"))
    result = mbd.simulate(scene, 0.1, rtol=1e-6)
    fall = -0.5 * 9.81 * result.t**2
    for s in (0.0, 0.3, 0.5, 1.0):
        assert np.abs(result.position(beam.at(s)) - np.stack((0 * fall + 2.4 * s, fall), axis=1)).max() < 1e-13


def test_lumped_gravity_follows_its_closed_form() -> None:
    """One element, weight concentrated at midspan (Fig. 2): the chord stays horizontal, so the bending oscillation is exact."""
    L, A, I, rho, E, g = 2.4, 0.0018, 1.215e-8, 2770, 0.7e11, 9.81  # noqa: E741
    scene = mbd.Scene(gravity=(0, -g))
    beam = scene.add(mbd.AncfCable((0, 0), (L, 0), n_elements=1, E=E, A=A, I=I, rho=rho, elasticity="local_frame", gravity="lumped"))
    times = np.linspace(0.005, 0.1, 20)
    result = mbd.simulate(scene, 0.1, rtol=1e-11, t_eval=times)
    mass = rho * A * L
    frequency = np.sqrt(720 * E * I / (mass * L**3))
    assert frequency == pytest.approx(60.84, abs=5e-3)
    slope = -(mass * g * L**2 / (48 * E * I)) * (1 - np.cos(frequency * times))
    assert result.position(beam.start)[:, 1] == pytest.approx(-0.5 * g * times**2 - slope * L / 6, abs=1e-11)
    assert result.position(beam.at(0.5))[:, 1] == pytest.approx(-0.5 * g * times**2 + slope * L / 12, abs=1e-11)
