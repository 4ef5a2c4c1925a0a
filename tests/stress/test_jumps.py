"""Jumps that nobody declared: found where a function of t has them, and nowhere else."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.jumps import SAMPLES, Found, look
from mbd.signal import Signal

Function = Callable[[float], Any]


def found(function: Any, start: float = 0.0, end: float = 1.0) -> Found:
    return look(SimpleNamespace(loads=[SimpleNamespace(signals=[Signal(function, (), "blow", "")])]), start, end)


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


@pytest.mark.parametrize("width", [1e-3, 1e-2])
def test_a_pulse_of_a_plain_function_is_not_leapt_over(width: float) -> None:
    """An impulse of 1 N s at 0.5 s."""
    x = struck(lambda t: (1.0 / width if 0.5 <= t < 0.5 + width else 0.0, 0.0)).q[-1, 0]
    assert abs(x - (0.5 - 0.5 * width)) < 1e-6


def test_resumed_runs_find_the_same() -> None:
    def blow(t: float) -> tuple[float, float]:
        return 50.0 * (0.3 <= t < 0.31) - 20.0 * (t > 0.7), 0.0

    np.testing.assert_array_equal(mbd.resume(struck(blow, 0.5), 1.0).q, struck(blow).q)


def test_what_looking_costs() -> None:
    """SAMPLES calls of each function, some 60 for each jump, and none of functions that are data."""
    calls = [0]

    def counted(t: float) -> tuple[float, float]:
        calls[0] += 1
        return float(t > 0.5), 0.0

    found(counted)
    assert SAMPLES < calls[0] < SAMPLES + 70
    calls[0], counted.discontinuities = 0, (0.5,)  # type: ignore[attr-defined]
    found(counted)
    assert calls[0] == 0


def test_leaps_are_announced() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        struck(lambda t: (1e-9 * np.sin(1e5 * t), 0.0))
    assert any("'blow' turn round more often than the run has steps" in str(w.message) for w in caught)
