"""Elements too long for a thin beam are told of, and only these."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest

import mbd
from benchmarks import machines
from benchmarks.stress.families import frames, ratios


def said(run: Callable[[], object]) -> tuple[object, str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        value = run()
    return value, "; ".join(str(w.message) for w in caught)


def half_circle(slenderness: float, elements: int) -> float:
    """The error of the end of a beam of 1 m that a moment bends to a half circle."""
    given = ratios.square(slenderness, elements)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable(**given._asdict(), name="beam"))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0)))
    scene.add(mbd.Torque(beam.end, np.pi * given.E * given.I))
    return float(np.linalg.norm(mbd.equilibrium(scene).position(beam.end) - (0.0, 2.0 / np.pi)))


@pytest.mark.parametrize("elements", [8, 16, 32])
@pytest.mark.parametrize("slenderness", [1e2, 1e3, 1e4, 1e5])
def test_locking_is_announced_where_it_spoils_the_result(slenderness: float, elements: int) -> None:
    error, told = said(lambda: half_circle(slenderness, elements))
    assert ("locking" in told) == (error > 0.01), (error, told)
    assert "locking" not in told or f"'beam': {elements} elements are too few" in told


def pendulum(modulus: float, elements: int, **options: object) -> mbd.Result:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable(**{**machines.pendulum_cable(modulus, elements)._asdict(), **options}))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    return mbd.simulate(scene, 0.3)


FINE: dict[str, Callable[[], object]] = {
    "soft pendulum": lambda: pendulum(machines.SOFT, 8),
    "stiff pendulum": lambda: pendulum(machines.STEEL, 4),
    "one element": lambda: pendulum(machines.STEEL, 1),
    "chord frame": lambda: pendulum(machines.SOFT, 4, elasticity="local_frame"),
    "spinning rod": lambda: frames.blade(1e4),
}


@pytest.mark.parametrize("name", FINE)
def test_no_alarm_is_raised_without_need(name: str) -> None:
    assert "locking" not in said(FINE[name])[1]
