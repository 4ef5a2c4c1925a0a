"""Andrews' squeezer to 0.03 s: angles and the forces of the loop closures, against a binary128 solution of the angles' equations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from .squeezer import BOOK, points, squeezer, turns

ROWS = BOOK["reference"]["own_binary128"]


def book(name: str) -> np.ndarray:
    return np.array([row[name] for row in ROWS], dtype=float)


@pytest.fixture(scope="module", params=[None, mbd.Radau(7)], ids=["default", "Radau"])
def run(request: pytest.FixtureRequest) -> tuple[mbd.Result, list[Any], list[Any]]:
    scene, bodies, closures = squeezer()
    return mbd.simulate(scene, 0.03, rtol=1e-13, t_eval=[row["t"] for row in ROWS], solver=request.param), bodies, closures


def test_angles_and_rates(run: tuple[mbd.Result, list[Any], list[Any]]) -> None:
    """Angles to 1e-10 (measured 1.3e-11); rates of 1e3 rad/s to 1e-10 of them."""
    result, bodies, _ = run
    turned = np.stack([result.angle(body) for body in bodies], axis=-1)
    start = turns(np.array(BOOK["parameters"]["q0"], dtype=float))
    assert np.abs(start + turned - turns(book("q"))).max() < 1e-10
    rates, expected = np.stack([result.angular_velocity(body) for body in bodies], axis=-1), turns(book("v"))
    assert np.abs(rates - expected).max() < 1e-10 * np.abs(expected).max()


def test_forces_of_the_loop_closures(run: tuple[mbd.Result, list[Any], list[Any]]) -> None:
    """The multipliers of E1 - E2, E1 - E3, E1 - E4 are the forces on bodies 3, 4 and 6, each to 1e-6 of itself (measured 1.4e-11)."""
    result, _, closures = run
    forces = np.concatenate([result.reaction(pin)[:, :2] for pin in closures], axis=1)
    assert forces == pytest.approx(book("lam"), rel=1e-6)


def test_the_reference_is_described_as_it_is_stated(run: tuple[mbd.Result, list[Any], list[Any]]) -> None:
    """The point F of the reference is that of the statement's formulas, and the run's."""
    result, bodies, _ = run
    named, centres = points(np.array(BOOK["parameters"]["q0"], dtype=float))
    assert np.stack([points(q)[0]["F"] for q in book("q")]) == pytest.approx(book("F"), abs=1e-15)
    assert result.position(bodies[0].at(*(named["F"] - centres[0]))) == pytest.approx(book("F"), abs=1e-12)
