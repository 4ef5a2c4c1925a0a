"""``mbd.kinematics``: against closed forms, against the simulated machine, and what it says where motions are not determined."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import mbd

from .mechanisms import four_bar, slider_crank, slider_place

TIMES = np.linspace(0.0, 3.0, 13)
TURN = mbd.Motion(lambda t: 2.0 * t + np.sin(t), rate=lambda t: 2.0 + np.cos(t), acceleration=lambda t: -np.sin(t))


def motor(scene: mbd.Scene, crank: Any, slider: Any) -> mbd.Motor:
    return mbd.Motor(crank, scene.ground, angle=TURN, name="motor")


def piston(path: Any) -> Any:
    return lambda scene, crank, slider: mbd.Prescribed(slider.at(), path, name="piston")


def quietly(scene: mbd.Scene, times: Any, **options: Any) -> Any:
    """The guide and a prescribed position hold y twice, which is warned of."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbd.SceneWarning)
        return mbd.kinematics(scene, times, **options)


def test_slider_crank_in_closed_form() -> None:
    """Position, velocity, acceleration of the slider, and the motor's torque by the power of all inertial and weight forces."""
    scene, crank, slider, drive = slider_crank(0.0, motor)
    result = mbd.kinematics(scene, TIMES)
    angle, rate, growth = (np.array([f(t) for t in TIMES]) for f in (TURN.value, TURN.rate, TURN.acceleration))
    h = 1e-4
    assert result.t == pytest.approx(TIMES, abs=0.0)
    assert result.position(slider.at())[:, 0] == pytest.approx(slider_place(angle), abs=1e-12)
    root = np.sqrt(4.0 - np.sin(angle) ** 2)
    slope = -np.sin(angle) - np.sin(angle) * np.cos(angle) / root
    bend = -np.cos(angle) - np.cos(2 * angle) / root - np.sin(2 * angle) ** 2 / (4 * root**3)
    assert result.velocity(slider.at())[:, 0] == pytest.approx(slope * rate, abs=1e-12)
    assert result.acceleration(slider.at())[:, 0] == pytest.approx(bend * rate**2 + slope * growth, abs=1e-11)
    assert result.angle(crank) == pytest.approx(angle, abs=1e-12)
    # Lagrange's equation of the one freedom: torque = J(phi) phi'' + J'/2 phi'^2 + dV/dphi.

    def inertia(phi: Any) -> Any:
        root = np.sqrt(4.0 - np.sin(phi) ** 2)
        swing = np.cos(phi) / root  # of the rod's angle, arcsin(sin(phi) / 2), times -1
        slide = -np.sin(phi) - np.sin(phi) * swing
        centre = slide + np.sin(phi) * swing / 2, np.cos(phi) / 2
        return (0.2 + 2.0 / 4) + 2.0 * (centre[0] ** 2 + centre[1] ** 2) + 0.2 * swing**2 + 1.5 * slide**2

    weight = 9.81 * (2.0 * 0.5 + 2.0 * 0.5) * np.cos(angle)
    growth_of_inertia = (8 * (inertia(angle + h) - inertia(angle - h)) - (inertia(angle + 2 * h) - inertia(angle - 2 * h))) / (12 * h)
    torque = inertia(angle) * growth + 0.5 * growth_of_inertia * rate**2 + weight
    assert result.reaction(drive)[:, 2] == pytest.approx(torque, abs=1e-9)


def test_the_simulated_machine() -> None:
    """The same drive, integrated: at the times and between them, reactions and work."""
    scene, crank, slider, drive = slider_crank(0.0, motor)
    result, run = mbd.kinematics(scene, TIMES), mbd.simulate(scene, TIMES[-1], rtol=1e-12, t_eval=TIMES)
    between = [0.33, 1.0, 2.9]
    for t in (None, between):
        assert np.abs(result.position(slider.at(), t=t) - run.position(slider.at(), t=t)).max() < 1e-10
        assert np.abs(result.velocity(crank.at(0.5, 0), t=t) - run.velocity(crank.at(0.5, 0), t=t)).max() < 1e-10
        for joint in (drive, scene["wrist"]):
            assert np.abs(result.reaction(joint, t=t) - run.reaction(joint, t=t)).max() < 1e-9
    assert result.audit.energy_error < 1e-6 and result.audit.position_drift < 1e-12 and result.audit.velocity_drift < 1e-12
    assert result.audit.work == pytest.approx(run.audit.work, abs=1e-6)
    assert np.abs(mbd.simulate(scene, 3.1, start=result.final).q[0] - result.q[-1]).max() < 1e-12


def test_a_pinned_crank_turned_often() -> None:
    """Times far apart: turns are counted."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=2.0, inertia=0.5, position=(0.5, 0), name="body"))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))
    drive = scene.add(mbd.Motor(body, scene.ground, angle=lambda t: 3.0 * t**2))
    result = mbd.kinematics(scene, [0.0, 2.5])
    assert result.angle(body)[-1] == pytest.approx(18.75, abs=1e-11)
    assert result.reaction(drive)[-1, 2] == pytest.approx((0.5 + 2.0 * 0.25) * 6.0 + 2.0 * 9.81 * 0.5 * np.cos(18.75), abs=1e-7)


def test_redundant_joints_in_space() -> None:
    """Four spatial pins, the crank's end led along its circle (once more than needed): the planar machine driven alike."""
    places = []
    for dimension in (2, 3):
        scene, links, _ = four_bar(dimension, ((0, 0), (0, 1), (2, 1.5), (2, 0)))
        tip = links[0].at(0.5, *np.zeros(dimension - 1))
        scene.add(mbd.Prescribed(tip, lambda t, d=dimension: (np.sin(t), np.cos(t), *np.zeros(d - 2)), name="lead"))
        result = quietly(scene, np.linspace(0, 0.5, 4))
        places.append(result.position(links[2].at())[:, :2])
    assert np.ptp(places[0][:, 0]) > 0.1
    assert np.abs(places[0] - places[1]).max() < 1e-11


def test_a_free_motion_is_named() -> None:
    with pytest.raises(mbd.SceneError, match=r"found free: 'crank' turns about \(0, 0\), 'rod' turns about \(3, 0\)"):
        mbd.kinematics(slider_crank(0.0)[0], TIMES)
    scene, *_ = slider_crank(1.0, motor)
    scene.add(mbd.Particle(1.0, (9, 9), name="stray"))
    with pytest.raises(mbd.SceneError, match="'stray' slides along"):
        mbd.kinematics(scene, TIMES)
    scene, crank, *_ = slider_crank(1.0, motor)
    whip = scene.add(mbd.AncfCable((0, 0), (0, 1), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=1000, name="whip"))
    scene.add(mbd.Clamp(whip.start, crank.at(-0.5, 0)))
    with pytest.raises(mbd.SceneError, match=r"found free: .*'whip' moves or bends|found free: .* degrees of freedom"):
        mbd.kinematics(scene, TIMES)


def test_dead_centres_are_refused() -> None:
    """The slider drives: at the start, at a time asked for, beyond reach, and passed on the way."""
    with pytest.raises(mbd.SceneError, match="'bearing', 'crank pin', 'wrist', 'piston': expected a start away from dead centres"):
        quietly(slider_crank(0.0, piston(lambda t: (3.0 - t * t, 0.0)))[0], TIMES)
    with pytest.raises(mbd.SceneError, match="a dead centre"):
        quietly(slider_crank(0.0, piston(lambda t: (3.0 - t, 0.0)))[0], TIMES)
    start = np.arccos(0.5625)  # where the slider is at 2.4271
    place = slider_place(start)
    for times, swing in (([0.0, 0.5, np.pi / 2], 3.0 - place), ([0.0, 1.0, 2.0, 3.0], 3.0 - place), ([0.0, 1.0, 2.0], 0.8)):
        with pytest.raises(mbd.SimulationError, match=r"dead centre.*'piston'") as caught:
            quietly(slider_crank(start, piston(lambda t, swing=swing: (place + swing * np.sin(t), 0.0)))[0], times)
        assert caught.value.time <= np.pi / 2 + 1e-9
        assert caught.value.result is not None and len(caught.value.result.t) >= 1


def test_the_slider_drives_within_reach() -> None:
    """Away from dead centres the slider turns the crank: the inverse of the closed form."""
    start = np.arccos(0.5625)
    place = slider_place(start)
    scene, crank, *_ = slider_crank(start, piston(lambda t: (place + 0.4 * np.sin(t), 0.0)))
    result = quietly(scene, TIMES)
    assert slider_place(result.angle(crank)) == pytest.approx(place + 0.4 * np.sin(TIMES), abs=1e-11)
    assert (np.diff(np.sign(np.sin(result.angle(crank)))) == 0).all()  # the same way of closing throughout


@pytest.mark.parametrize("times", [[], [1.0, 0.5], [0.0, np.nan], [[0.0, 1.0]], [0.0, 0.0]])
def test_times(times: Any) -> None:
    with pytest.raises(mbd.SceneError, match="times: expected"):
        mbd.kinematics(slider_crank(0.0, motor)[0], times)


def test_parts_and_files(tmp_path) -> None:
    """Two machines in one scene, each followed by itself; results are not written."""
    scene = mbd.Scene()
    bodies = []
    for k in range(2):
        bodies.append(scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(3 * k + 0.5, 0), name=f"body {k}")))
        scene.add(mbd.Pin(bodies[k].at(-0.5, 0), scene.ground.at(3 * k, 0)))
        scene.add(mbd.Motor(bodies[k], scene.ground, speed=1.0 + k))
    result = mbd.kinematics(scene, [0.5, 1.0])
    for k in range(2):
        assert result.angle(bodies[k]) == pytest.approx((1.0 + k) * result.t, abs=1e-11)
    with pytest.raises(ValueError, match=r"mbd\.kinematics"):
        result.save(tmp_path / "run.npz")
