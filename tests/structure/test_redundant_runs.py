"""Machines with redundant joints run: against their planar models and published numbers; reactions that are not unique are marked."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import mbd

from ..machines import data
from .mechanisms import bricard, four_bar

PLANAR, LOST = (0, 1, 5), (2, 3, 4)
POINTS = ((0, 0), (0.6, 0.8), (2, 1.5), (2, 0))


def test_four_spatial_pins_move_as_the_planar_machine() -> None:
    times = np.linspace(0.0, 1.5, 16)
    plane, links, pins = four_bar(2, POINTS)
    flat = mbd.simulate(plane, times[-1], rtol=1e-12, t_eval=times)
    space, spatial_links, spatial_pins = four_bar(3, POINTS)
    with pytest.warns(mbd.SceneWarning, match="redundant joints 'pin 1', 'pin 2', 'pin 3', 'pin 4'"):
        result = mbd.simulate(space, times[-1], rtol=1e-12, t_eval=times)
    for body, twin in zip(links, spatial_links):
        assert np.abs(flat.position(body.at()) - result.position(twin.at())[:, :2]).max() < 1e-9
        assert np.abs(flat.velocity(body.at()) - result.velocity(twin.at())[:, :2]).max() < 1e-9
        assert np.abs(flat.angular_velocity(body) - result.angular_velocity(twin)[:, 2]).max() < 1e-9
    assert np.ptp(flat.angle(links[0])) > 1.0  # it did move
    assert result.indeterminate == ("pin 1", "pin 2", "pin 3", "pin 4") and flat.indeterminate == ()
    for pin, twin in zip(pins, spatial_pins):
        with pytest.warns(mbd.SceneWarning, match=f"the reaction of '{twin.name}' is indeterminate"):
            forces = result.reaction(twin)
        assert np.abs(flat.reaction(pin) - forces[:, PLANAR]).max() < 1e-8 * np.abs(forces).max()
        assert np.abs(forces[:, LOST]).max() < 1e-8 * np.abs(forces).max()  # of least norm: nothing is forced out of the plane
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result.reaction(spatial_pins[0])  # once is enough


def test_the_mark_survives_a_file(tmp_path) -> None:
    space, *_ = four_bar(3)
    with pytest.warns(mbd.SceneWarning):
        result = mbd.simulate(space, 0.05)
    result.save(tmp_path / "run.npz")
    assert mbd.load(tmp_path / "run.npz").indeterminate == result.indeterminate != ()


def test_a_singular_start_makes_nothing_indeterminate() -> None:
    scene, *_ = four_bar(2, ((0, 0), (1, 0), (3, 0), (2, 0)))
    with pytest.warns(mbd.SceneWarning, match="redundant"):
        state = mbd.simulate(scene, 1e-3)
    assert state.assembly.redundant and state.indeterminate == ()


def test_bricard() -> None:
    """IFToMM A04 to 1e-8 over 10 s, positions and velocities of two joints."""
    reference = data("iftomm_a04_bricard")["reference"]
    times = np.array([row["t"] for row in reference], dtype=float)
    scene, rods, _ = bricard()
    with pytest.warns(mbd.SceneWarning, match="redundant joints 'pin 0', .* 'pin 5'"):
        result = mbd.simulate(scene, times[-1], rtol=1e-10, t_eval=times)
    for place, marker in enumerate((rods[1].at(0.5, 0, 0), rods[2].at(0.5, 0, 0))):
        found = np.hstack((result.position(marker), result.velocity(marker)))
        assert np.abs(found - np.array([row["P"][place] for row in reference], dtype=float)).max() < 1e-8
    assert result.energy.total == pytest.approx(-29.43, abs=1e-7)
    assert result.audit.position_drift < 1e-10
