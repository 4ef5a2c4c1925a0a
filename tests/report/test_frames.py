"""Frames: between them the motion to the eye, as many as the size allows; and what becomes of functions that a file lost."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import mbd
from mbd.report.frames import MISS, frames, missed, packed

from ..machines import flexible_pendulum
from .scenes import numbers, slider_crank


@pytest.fixture(scope="module")
def run() -> mbd.Result:
    return slider_crank()


def test_the_cubic_between_frames_has_order_three():
    """By SciPy's cubics with slopes of differences; halving the distance divides the error by eight or more."""
    errors = []
    for count in (40, 80):
        t = np.linspace(0.0, 3.0, 2 * count + 1)
        x = np.stack((np.sin(3.0 * t), np.cos(2.0 * t)), axis=-1)
        cubic = CubicHermiteSpline(t[::2], x[::2], np.gradient(x[::2], t[::2], axis=0, edge_order=2))
        expected = np.max(np.linalg.norm(cubic(t[1::2]) - x[1::2], axis=-1))
        errors.append(missed(x[:, None]))
        assert errors[-1] == pytest.approx(expected, rel=1e-9)
    assert errors[0] > 7.0 * errors[1]


def test_frames_are_the_motion(run):
    """Between the frames too, at times that no frame was made for: below a pixel of a screen of 1000."""
    film = frames(run, {"tip": run.scene["rod"].end})
    t = np.linspace(0.0, 0.2, 97)[1:-1]
    index = film.drawing.shapes[-1].points[0]
    cubic = CubicHermiteSpline(film.run.t, film.points[:, index], np.gradient(film.points[:, index], film.run.t, axis=0, edge_order=2))
    assert film.between and np.max(np.abs(cubic(t) - run.position(run.scene["rod"].end, t=t))) < MISS * run.system.length
    np.testing.assert_allclose(film.points[:, index], run.position(run.scene["rod"].end, t=film.run.t), atol=1e-12)


def test_faster_motions_get_more_frames():
    counts = []
    for speed in (1.0, 200.0):
        scene = mbd.Scene(gravity=(0.0, 0.0))
        body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, angular_velocity=speed, velocity=(0, 0.5 * speed)))
        scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))
        counts.append(len(frames(mbd.simulate(scene, 1.0, rtol=1e-9), {}).run.t))
    assert counts[0] == 121 < counts[1] <= 961


@pytest.mark.parametrize("size", [100_000, 20_000])
def test_the_size_is_kept(size):
    scene, *_ = flexible_pendulum()
    film = frames(mbd.simulate(scene, 0.3, rtol=1e-4), {}, size=size)
    assert 0.2 * size < film.points.size * 4 <= size


def test_forces_are_arrows_in_inertial_axes(run):
    film = frames(run, {})
    expected = np.stack((-5.0 * np.cos(9.0 * film.run.t), 0.0 * film.run.t), axis=-1)
    np.testing.assert_allclose(film.forces["push"], expected, atol=1e-12)


def test_follower_forces_turn():
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), angular_velocity=2.0))
    scene.add(mbd.Force(body.at(0, 0), (3.0, 4.0), follower=True, name="jet"))
    film = frames(mbd.simulate(scene, 0.5), {})
    a = 2.0 * film.run.t
    np.testing.assert_allclose(film.forces["jet"], np.stack((3 * np.cos(a) - 4 * np.sin(a), 3 * np.sin(a) + 4 * np.cos(a)), -1), atol=1e-6)


def test_follower_forces_in_space_go_along_the_tangent():
    scene = mbd.Scene(gravity=(0, 0, 0))
    cable = scene.add(mbd.AncfCable((0, 0, 0), (0, 2, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=1000))
    scene.add(mbd.Force(cable.end, (7.0, 0, 0), follower=True, name="pull"))
    film = frames(mbd.simulate(scene, 0.01), {})
    np.testing.assert_allclose(film.forces["pull"], np.tile((0.0, 7.0, 0.0), (len(film.run.t), 1)), atol=1e-9)


def test_a_run_from_a_file_is_shown_at_its_steps(run, tmp_path):
    """The file lost the functions of time: no values between the steps, no arrow of the force."""
    with pytest.warns(mbd.SceneWarning, match="functions of t are not stored"):
        run.save(tmp_path / "run.npz")
    film = frames(mbd.load(tmp_path / "run.npz"), {})
    assert not film.between and not film.forces
    np.testing.assert_array_equal(film.run.t, run.t)


def test_numbers_survive_packing():
    values = np.array([0.0, -1.5, 1e-30, np.nan, np.inf, 1e300])
    found = numbers(packed(values))
    np.testing.assert_allclose(found[:3], values[:3], rtol=1e-7)
    assert np.isnan(found[3:]).all()
    np.testing.assert_array_equal(numbers(packed(np.pi, "<f8"), "<f8"), [np.pi])
