"""Jumps that nobody declared: found where a function of t has them, and nowhere else."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.jumps import COMPARED, SAMPLES, Found, look
from mbd.signal import Signal
from mbd.thresholds import Noting

Function = Callable[[float], Any]


def found(function: Any, start: float = 0.0, end: float = 1.0) -> Found:
    system = SimpleNamespace(loads=[SimpleNamespace(signals=[Signal(function, (), "blow", "")])], joints=SimpleNamespace(drives=[]))
    return look(system, start, end)


JUMPS: dict[str, tuple[Function, list[float]]] = {
    "step": (lambda t: 1.0 if t >= 1.0 / 3.0 else 0.0, [1.0 / 3.0]),
    "small step on a wave": (lambda t: np.sin(20.0 * t) + 0.01 * (t >= 0.7), [0.7]),
    "of one component": (lambda t: (t, 5.0 * (t >= 0.2)), [0.2]),
    "pulse of one thousandth": (lambda t: float(0.5 <= t < 0.501), [0.5, 0.501]),
    "staircase": (lambda t: np.floor(8.0 * t), [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875]),
}


@pytest.mark.parametrize("name", JUMPS)
def test_jumps_are_found_to_the_clock(name: str) -> None:
    function, times = JUMPS[name]
    np.testing.assert_array_equal([t for t in found(function).times if t < 1.0], times)


SMOOTH: dict[str, Function] = {
    "constant": lambda t: 3.0,
    "waves": lambda t: np.sin(2.0 * np.pi * 40.0 * t),
    "growth": lambda t: np.exp(30.0 * t),
    "kink": lambda t: abs(t - 0.5),
    "onset": lambda t: max(0.0, t - 0.5),
    "root": lambda t: np.sqrt(abs(t - 0.5)),
    "triangles": lambda t: abs((10.0 * t) % 1.0 - 0.5),
    "steep": lambda t: np.tanh(1e4 * (t - 0.5)),
    "bump": lambda t: np.exp(-(((t - 0.5) / 0.003) ** 2)),
    "rounding": lambda t: 1.0 + 1e-15 * np.sin(1e9 * t),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_none_is_found_where_there_is_none(name: str) -> None:
    assert not found(SMOOTH[name]).times.size and not found(SMOOTH[name]).restless


KNOTS = np.array([0.0, 0.3, 0.3 + 1e-6, 0.3 + 2e-6, 1.0])

HIDDEN: dict[str, tuple[Function, list[float]]] = {
    "pulse": (lambda t: float(0.5 <= t < 0.5 + 1e-9), [0.5, 0.5 + 1e-9]),
    "by arrays": (lambda t: np.where((t >= np.float64(0.5)) & (t < 0.5 + 1e-9), 1.0, 0.0), [0.5, 0.5 + 1e-9]),
    "by its middle": (lambda t: float(abs(t - 0.5) < 0.25e-9), [0.5 - 0.25e-9, 0.5 + 0.25e-9]),
    "by a square": (lambda t: float((t - 0.5) ** 2 < 1e-16), [0.5 - 1e-8, 0.5 + 1e-8]),
    "triangle": (lambda t: max(0.0, 1.0 - abs(t - 0.3) / 1e-6), [0.3 - 1e-6, 0.3, 0.3 + 1e-6]),
    "half sine": (lambda t: np.sin((t - 0.3) / 1e-6) if 0.3 < t < 0.3 + np.pi * 1e-6 else 0.0, [0.3, 0.3 + np.pi * 1e-6]),
    "switches": (lambda t: np.sign(t - 0.3) - np.heaviside(t - 0.3 - 1e-6, 0.0), [0.3, 0.3 + 1e-6]),
    "train": (lambda t: float(t % 0.25 < 1e-6), [1e-6, 0.25, 0.25 + 1e-6, 0.5, 0.5 + 1e-6, 0.75, 0.75 + 1e-6]),
    "counted": (lambda t: float(int(t * 100.0) == 33 and (t * 100.0) % 1.0 < 1e-4), [0.33, 0.33 + 1e-6]),
    "table": (lambda t: float(np.searchsorted(KNOTS, t) == 2), [0.3, 0.3 + 1e-6]),
    "interpolated": (lambda t: np.interp(t, KNOTS, [0.0, 0.0, 1.0, 0.0, 0.0]), [0.3, 0.3 + 1e-6, 0.3 + 2e-6]),
    "within a pulse": (lambda t: float((t - 0.3) * 1e6 % 1.0 < 0.5) if 0.3 <= t < 0.3 + 1.5e-6 else 0.0, [0.3, 0.3 + 0.5e-6, 0.3 + 1e-6]),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_what_is_shorter_than_samples_shows_in_comparisons(name: str) -> None:
    function, times = HIDDEN[name]
    at = found(function).times
    assert all(np.min(np.abs(at - t)) < 1e-14 for t in times) and len(at) <= len(times) + 1
    assert not found(function).restless


def test_pulses_that_the_clock_cannot_tell_are_named() -> None:
    assert list(found(lambda t: 1e15 if 0.5 <= t < 0.5 + 1e-15 else 0.0).restless) == ["blow"]


def test_more_jumps_than_can_be_looked_at_are_named() -> None:
    assert list(found(lambda t: float((1e4 * t) % 1.0 < 1e-3)).restless) == ["blow"]
    assert not found(lambda t: np.floor(1e5 * t) * 1e-5).restless, "samples of something smooth, held"


def test_what_does_not_hold_still_is_named() -> None:
    assert list(found(lambda t: np.sin(1e5 * t)).restless) == ["blow"]


def test_who_declares_is_believed_and_who_fails_is_left_alone() -> None:
    assert not found(mbd.piecewise(lambda t: float(t > 0.5), at=[0.2])).times.size
    assert not found(lambda t: 1.0 / 0.0 if t > 0.5 else 0.0).times.size


def struck(load: Any, t_end: float = 1.0) -> mbd.Result:
    """A free particle of 1 kg under a force along x."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    scene.add(mbd.Force(scene.add(mbd.Particle(1.0, (0.0, 0.0))).at(), load, name="blow"))
    return mbd.simulate(scene, t_end)


@pytest.mark.parametrize("width", [1e-12, 1e-6, 1e-3, 1e-2])
def test_a_pulse_of_a_plain_function_is_not_leapt_over(width: float) -> None:
    """An impulse of 1 N s at 0.5 s; the clock near it rounds the width."""
    x = struck(lambda t: (1.0 / width if 0.5 <= t < 0.5 + width else 0.0, 0.0)).q[-1, 0]
    assert abs(x - (0.5 - 0.5 * width) * ((0.5 + width) - 0.5) / width) < 1e-6


def test_resumed_runs_find_the_same() -> None:
    def blow(t: float) -> tuple[float, float]:
        return 50.0 * (0.3 <= t < 0.31) - 20.0 * (t > 0.7), 0.0

    np.testing.assert_array_equal(mbd.resume(struck(blow, 0.5), 1.0).q, struck(blow).q)


def test_what_looking_costs() -> None:
    """SAMPLES calls of each function, COMPARED for its comparisons, some 80 for each jump, and none of functions that are data."""
    calls = [0]

    def counted(t: float) -> tuple[float, float]:
        calls[0] += 1
        return float(t > 0.5), 0.0

    found(counted)
    assert SAMPLES < calls[0] < SAMPLES + COMPARED + 90
    calls[0], counted.discontinuities = 0, (0.5,)  # type: ignore[attr-defined]
    found(counted)
    assert calls[0] == 0


def test_leaps_are_announced() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        struck(lambda t: (1e-9 * np.sin(1e5 * t), 0.0))
    assert any("'blow' change more often, or for a shorter time, than the run has steps" in str(w.message) for w in caught)


FORMULAS: dict[str, Function] = {
    "sum": lambda t: 3.0 + (1.5 - t) - 2.0,
    "product": lambda t: (2.0 * t + 1.0) * (0.5 - t) * 3.0,
    "quotient": lambda t: (t - 2.0) / (1.0 + t) / 0.5,
    "reciprocal": lambda t: 1.0 / (1.0 + t),
    "power": lambda t: (1.0 + t) ** 2.5 - (t - 1.0) ** 3,
    "parts": lambda t: -abs(t - 0.9) + +max(t, 0.2) - 3.0 * min(2.0, t),
    "remainder": lambda t: (7.3 * t) % 0.8 - (-t) % 0.7,
    "of NumPy": lambda t: np.square(np.subtract(t, 0.3)) * np.absolute(np.negative(t)) + np.clip(t, 0.0, 0.5) + np.remainder(t, 0.21),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_rates_are_derivatives(name: str) -> None:
    function = FORMULAS[name]
    for t in (0.137, 0.6543):
        value = function(Noting(t, 1.0, []))
        assert float(value) == function(t)
        assert value.rate == pytest.approx((function(t + 1e-6) - function(t - 1e-6)) / 2e-6, rel=1e-6)


def test_rounding_is_floats_own() -> None:
    for x in (-2.5, -0.3, 0.0, 0.49, 2.5, 7.9):
        noting = Noting(x, 1.0, [])
        assert (math.floor(noting), math.ceil(noting), int(noting), math.trunc(noting)) == (math.floor(x), math.ceil(x), int(x), math.trunc(x))
        assert (round(noting), round(noting, 1), noting // 0.4, abs(noting)) == (round(x), round(x, 1), x // 0.4, abs(x))
        assert (np.rint(noting), np.trunc(noting), np.sign(noting), math.sin(noting)) == (np.rint(x), np.trunc(x), np.sign(x), math.sin(x))
        np.testing.assert_array_equal(np.array([0.1, 0.2]) * noting, np.array([0.1, 0.2]) * x)
        np.testing.assert_array_equal(np.array([noting, 1.0]) < noting, np.array([x, 1.0]) < x)


def test_what_raises_for_such_numbers_is_left_to_samples() -> None:
    def strict(t: float) -> float:
        if type(t) is not float:
            raise TypeError
        return float(t > 0.3)

    np.testing.assert_array_equal(found(strict).times, [math.nextafter(0.3, 1.0)])


@pytest.mark.parametrize(("speed", "told"), [(lambda t: 1e6 * (0.5 <= t < 0.5 + 1e-6), True), (lambda t: float(t >= 0.5), False)])
def test_pulses_of_drives_are_told(speed: Function, told: bool) -> None:
    """A motor cannot follow them: the integral of its speed leaps over what is that short."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    arm = scene.add(mbd.RigidBody.rod((0.0, 0.0), (1.0, 0.0), mass=1.0, name="arm"))
    scene.add(mbd.Pin(arm.at(-0.5, 0.0), scene.ground.at(0.0, 0.0)))
    scene.add(mbd.Motor(arm.at(-0.5, 0.0), scene.ground.at(0.0, 0.0), speed=speed, name="drive"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mbd.simulate(scene, 1.0)
    assert any("'drive' change more often, or for a shorter time" in str(w.message) for w in caught) == told


def test_a_fast_drive_is_told_by_how_often_it_turns_round() -> None:
    """A run with more steps than that sees it."""
    drive = SimpleNamespace(signals=[Signal(lambda t: np.sin(1e4 * t), (), "drive", "")])
    system = SimpleNamespace(loads=[], joints=SimpleNamespace(drives=[(slice(0, 1), drive)]), length=1.0)
    assert 1000 < look(system, 0.0, 1.0).restless["drive"] < SAMPLES


def test_what_rounding_leaves_of_a_smooth_start_is_no_motion() -> None:
    """A drive's first ten-thousandth: (w / T) (t^2 / 2 - (T / 2 pi)^2 (1 - cos(2 pi t / T))) grows with t^4, below the rounding of its terms."""

    def start(t: float) -> float:
        return 4.0 / 15.0 * (0.5 * t * t + (15.0 / (2.0 * math.pi)) ** 2 * (math.cos(2.0 * math.pi * t / 15.0) - 1.0))

    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.0, 0.0), n_elements=2, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
    scene.add(mbd.Prescribed(rod.start, (0.0, 0.0), angle=start, name="drive"))
    system = scene.build()
    values = np.array([start(t) for t in np.linspace(0.0, 1e-3, 100).tolist()])
    assert np.sum(np.diff(np.diff(values) > 0.0)) > 10, "it does turn round"
    assert not look(system, 0.0, 1e-3).restless
    assert not look(system, 0.0, 20.0).restless
