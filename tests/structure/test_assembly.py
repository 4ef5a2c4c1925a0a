"""``mbd.assemble``: loops close from rough positions, velocities are corrected, the report says what moved, impossible ones are refused."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.solvers.linear import Linear

from ..machines import simple_pendulum
from .mechanisms import bricard, four_bar, slider_crank, slider_place


def residual(scene: mbd.Scene, state: Any) -> float:
    return float(np.max(np.abs(scene.build().joints.at(state.q).value)))


def rough(scene: mbd.Scene, amount: float, seed: int) -> mbd.State:
    """All coordinates off by up to an amount: positions [m] and axes, which need not be of unit length any more."""
    system = scene.build()
    return mbd.State(system.q0 + amount * np.random.default_rng(seed).uniform(-1, 1, system.n), system.v0)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("make", [lambda: four_bar(2)[0], lambda: four_bar(3)[0], lambda: bricard()[0], lambda: slider_crank(0.7)[0]])
def test_rough_positions_close(make: Any, seed: int) -> None:
    """A third of a metre off in every coordinate."""
    scene = make()
    report = mbd.assemble(scene, rough(scene, 0.3, seed))
    system = scene.build()
    assert residual(scene, report.state) < 1e-11
    assert np.max(np.abs(system.joints.at(report.state.q).push(report.state.v))) < 1e-12
    closed = {c.item for c in report.corrections if c.quantity == "position error closed"}
    moved = {c.item for c in report.corrections if c.quantity == "position changed"}
    assert closed >= {item for item, _ in system.joints.labels} - system.internal
    assert moved == {item for item, _ in system.owners}


def test_what_moved_is_told_by_amount() -> None:
    """A crank alone, described 0.3 m from its bearing: it moves by that, all of it and nothing else."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0.3, 0), name="body"))
    scene.add(mbd.Particle(1.0, (5, 5), name="bystander"))
    scene.add(mbd.Pin(body.at(), scene.ground.at(0, 0), name="bearing"))
    report = mbd.assemble(scene)
    found = {(c.quantity, c.item): c.amount for c in report.corrections}
    assert found == {("position error closed", "bearing"): pytest.approx(0.3), ("position changed", "body"): pytest.approx(0.3)}
    assert "position changed of 'body': 0.3 (length)" in str(report)


def test_redundancy_is_told_of_where_the_joints_close() -> None:
    """Off the plane four spatial pins are not redundant; where they close they are."""
    scene = four_bar(3)[0]
    assert mbd.assemble(scene, rough(scene, 0.1, 1)).redundant == tuple(f"pin {k}" for k in (1, 2, 3, 4))


def test_bars_in_line_find_a_way() -> None:
    """Described at a dead centre, where no direction closes the gap: either of the two ways will do."""
    scene, crank, slider, _ = slider_crank(0.0, lambda scene, crank, slider: mbd.Prescribed(slider.at(), lambda t: (2.5, 0.0), name="piston"))
    state = mbd.assemble(scene).state
    knee = crank.at(0.5, 0).point.value(state.q)
    assert slider.at().point.value(state.q) == pytest.approx((2.5, 0), abs=1e-12)
    assert np.linalg.norm(knee) == pytest.approx(1.0, abs=1e-12)
    assert slider_place(np.arctan2(knee[1], knee[0])) == pytest.approx(2.5, abs=1e-12)


@pytest.mark.parametrize("far", [2.5, 4.0, 30.0])
def test_the_impossible_is_refused_with_its_distance(far: float) -> None:
    """Two links of 1 m cannot reach a point farther than 2 m: the joint, and how much is missing."""
    scene = mbd.Scene()
    links = [scene.add(mbd.RigidBody.rod(*ends, mass=1.0)) for ends in (((0, 0), (0.6, 0.8)), ((0.6, 0.8), (1.2, 0)))]
    scene.add(mbd.Pin(links[0].at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    scene.add(mbd.Pin(links[0].at(0.5, 0), links[1].at(-0.5, 0), name="elbow"))
    scene.add(mbd.Pin(links[1].at(0.5, 0), scene.ground.at(far, 0), name="far"))
    with pytest.raises(mbd.SceneError) as caught:
        mbd.assemble(scene)
    (line,) = caught.value.complaints
    assert "'far'" in line
    missing = float(re.findall(r"a distance of (\S+) remains", line)[0])
    assert missing == pytest.approx(far - 2.0, rel=0.02)


def test_a_speed_along_a_rod() -> None:
    """1 m/s along a rigid rod beside 2 m/s across it: the former is taken away and reported, the latter stays."""
    scene, bob, _ = simple_pendulum()
    report = mbd.assemble(scene, mbd.State([-1.0, 0.0], [1.0, 2.0]))
    assert report.state.v == pytest.approx([0.0, 2.0], abs=1e-13)
    found = {(c.quantity, c.item): c.amount for c in report.corrections}
    assert found == {("velocity error closed", "rod"): pytest.approx(1.0), ("velocity changed", bob.name): pytest.approx(1.0)}
    with pytest.warns(mbd.SceneWarning, match="velocity error closed of 'rod': 1 "):
        result = mbd.simulate(scene, 0.1, start=mbd.State([-1.0, 0.0], [1.0, 2.0]))
    assert result.audit.velocity_drift < 1e-10


def test_parts_are_assembled_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes, original = [], Linear.__init__

    def seen(self: Linear, system: Any, q: Any) -> None:
        sizes.append(system.n)
        original(self, system, q)

    monkeypatch.setattr(Linear, "__init__", seen)
    scene = mbd.Scene()
    for k in range(5):
        dot = scene.add(mbd.Particle(1.0 + k, (3 * k + 1.2, 0), name=f"dot {k}"))
        scene.add(mbd.Distance(dot.at(), scene.ground.at(3 * k, 0), length=1.0, name=f"rod {k}"))
        scene.add(mbd.Spring(dot.at(), scene.ground.at(3 * k, 1), stiffness=10.0**k))
    report = mbd.assemble(scene)
    assert sizes == [2] * 5
    assert report.state.q == pytest.approx(np.ravel([(3 * k + 1.0, 0.0) for k in range(5)]), abs=1e-12)
    assert len([c for c in report.corrections if c.quantity == "position error closed"]) == 5
