"""What stops a run that no step could save is told by its cause: the clock, masses far apart, pulses shorter than rounding."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import mbd
from benchmarks.stress.families import frames, loads, ratios


def test_a_late_clock_is_to_blame() -> None:
    with pytest.raises(mbd.SimulationError, match=r"as short as the clock can tell: numbers near t = 1e\+15 s are 0.125 s apart") as stop:
        frames.clock(1e15)
    assert "start at t = 0" in str(stop.value)


def test_masses_far_apart_are_named() -> None:
    with pytest.raises(mbd.SimulationError, match=r"at distance \d.*'particle 2' has 1e\+18 times the mass of 'particle 1'"):
        ratios.double_pendulum(1e18)  # the light one on a string that the heavy one stretches: it may swing by 1e9 rad/s


@pytest.mark.parametrize("width", [4e-16, 1e-15, 3e-15])
def test_a_pulse_shorter_than_rounding_is_refused(width: float) -> None:
    with pytest.raises(mbd.SceneError, match="'blow': expected times of jumps that differ by more than rounding"):
        loads.pulse(width)


def test_one_jump_declared_twice_is_no_pulse() -> None:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    load = mbd.piecewise(lambda t: (float(t > 0.3), 0.0), at=[0.3, np.nextafter(0.3, 1.0)])
    scene.add(mbd.Force(scene.add(mbd.Particle(1.0, (0.0, 0.0))).at(), load))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_allclose(mbd.simulate(scene, 1.0).q[-1, 0], 0.5 * 0.7**2, rtol=1e-6)
