"""``mbd.verify``: estimated errors against closed forms and references, refusals, meshes, and what its report says."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import mbd
from benchmarks.verify_cases import BY_NAME, double_pendulum, long_chain, pendulum_force, pendulum_path, simple_pendulum
from mbd.verification.runs import climb

from .. import machines

MOST, LEAST = 3.0, 0.01


def within(error: np.ndarray, found: mbd.Verification, name: str) -> None:
    """The worst error is within the bars, and nowhere is it above three times the estimate there."""
    assert LEAST * found.errors[name].max() <= error.max() <= MOST * found.errors[name].max()
    assert np.all(error <= MOST * found.errors[name])


def distances(a: Any, b: Any) -> np.ndarray:
    return np.linalg.norm(np.asarray(a, dtype=float) - np.asarray(b, dtype=float), axis=1)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_simple_pendulum(rtol: float) -> None:
    """Place and force against elliptic functions."""
    scene, outputs = simple_pendulum()
    found = mbd.verify(scene, 10.0, outputs=outputs, rtol=rtol)
    assert found.ok and found.predictable_until == 10.0
    within(distances(found.result.position(outputs["bob"]), pendulum_path(found.t)), found, "bob")
    within(distances(found.result.reaction(outputs["force"])[:, :2], pendulum_force(found.t)), found, "force")
    assert not found.growth.exponential


@pytest.mark.parametrize("name", ["free fall", "oscillator", "free top", "rolling disc"])
def test_closed_forms(name: str) -> None:
    from mbd.verification.outputs import outputs_of

    case = BY_NAME[name]
    scene, outputs = case.build()
    found = mbd.verify(scene, case.t_end, outputs=outputs, rtol=1e-5)
    assert found.ok
    for output in outputs_of(scene, outputs):
        error = distances(output.values(found.result), case.exact[output.name](found.t))
        if error.max() > 1e-13:  # a parabola is exact
            within(error, found, output.name)


@pytest.mark.parametrize("rtol", [1e-3, 1e-6])
def test_a_free_top_exchanges_nothing_and_is_not_warned_of(rtol: float) -> None:
    """What its energy changes by are errors alone."""
    scene, _ = BY_NAME["free top"].build()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = mbd.simulate(scene, 10.0, rtol=rtol)
    assert result.audit.balanced and result.audit.energy_error == pytest.approx(result.audit.energy_scale)


FIXED = (mbd.GeneralizedAlpha(8e-3), mbd.GeneralizedAlpha(4e-3), mbd.Gauss(0.04), mbd.Gauss(0.02), mbd.Gauss(0.05, stages=3), mbd.Radau(3, step=0.05))


@pytest.mark.parametrize("solver", FIXED, ids=str)
def test_fixed_steps(solver: Any) -> None:
    """Of known order: the estimate is the error within a factor of two, and the order is seen."""
    scene, outputs = simple_pendulum()
    found = mbd.verify(scene, 0.8, outputs={"bob": outputs["bob"]}, solver=solver, rtol=1e-12)
    assert found.ok and found.settings == (2.0 * solver.step, solver.step, 0.5 * solver.step)
    assert found.rows[0].order == pytest.approx(solver.integrator(1e-12).order, abs=0.3)
    error = distances(found.result.position(outputs["bob"]), pendulum_path(found.t))
    assert 0.5 < error.max() / found.errors["bob"].max() < 2.0
    assert np.all(error <= MOST * found.errors["bob"])


@pytest.mark.parametrize("solver", [mbd.GeneralizedAlpha(8e-3), mbd.Gauss(0.02), mbd.Radau(3, step=0.02)], ids=str)
def test_the_longest_steps_go_as_far_as_is_paid_for(solver: Any) -> None:
    """Half, one and two times the step would cost 3.5 runs by steps alone."""
    scene, _ = double_pendulum()
    ladder = climb(scene, 2.0, 1e-10, solver, None, None)
    assert ladder.coarse is not None
    works = [run.stats["newton iterations"] + run.stats["factorizations"] for run in (ladder.coarse, *ladder.runs)]
    assert sum(works) <= 3.4 * works[1]
    t, times = ladder.coarse.trajectory.t, ladder.times()
    assert 0.5 <= t[-1] <= 2.0 and times[-1] == 2.0
    assert np.isin(times, ladder.runs[1].trajectory.t).all() and np.isin(t, ladder.runs[0].trajectory.t).all()


def test_positions_that_are_not_known_between_steps_are_left_out() -> None:
    """The bars of a parallelogram are aligned twice in each turn: some steps across cannot be solved anew."""
    case = BY_NAME["four-bar 1"]
    scene, outputs = case.build()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbd.SceneWarning)
        found = mbd.verify(scene, case.t_end, outputs=outputs, rtol=1e-4)
    assert found.ok and found.predictable_until == case.t_end


def test_squeezer_against_the_test_set() -> None:
    from ..references.squeezer import BOOK, squeezer

    rows = BOOK["reference"]["own_binary128"]
    scene, bodies, _ = squeezer()
    named, beta = np.array([row["F"] for row in rows], dtype=float), float(BOOK["parameters"]["q0"][0])
    point = bodies[0].at(*(float(BOOK["parameters"]["rr"]) * np.array((np.cos(beta), np.sin(beta))) - bodies[0].description.position))
    found = mbd.verify(scene, 0.03, outputs={"F": point}, rtol=1e-6, t_eval=[row["t"] for row in rows])
    assert found.ok
    assert found.t.tolist() == [row["t"] for row in rows]
    within(distances(found.result.position(point), named), found, "F")


def test_heavy_top_against_its_reference() -> None:
    rows = [row for row in machines.data("heavy_top")["reference"] if row["t"] <= 1.0]
    scene, top, tip = machines.heavy_top()
    found = mbd.verify(scene, 1.0, outputs={"centre": top.at(), "force": tip}, rtol=1e-6, t_eval=[row["t"] for row in rows])
    assert found.ok and set(found.errors) == {"centre", "force"}  # a ball joint bears no moment
    within(distances(found.result.position(top.at()), [row["com"] for row in rows]), found, "centre")


def test_flexible_pendulum_against_its_reference() -> None:
    """The same mesh, integrated independently to 8 digits."""
    reference = machines.data("pendulum")["continuum"]
    times = [t for t in reference["t"] if t <= 0.5]
    scene, rod, _ = machines.flexible_pendulum()
    found = mbd.verify(scene, 0.5, outputs={"tip": rod.end}, rtol=1e-5, t_eval=times)
    assert found.ok
    error = distances(found.result.position(rod.end), np.array(reference["tip"])[: len(times)])
    within(error, found, "tip")


def lyapunov(t_end: float) -> float:
    """The slope of the logarithm of the distance of two double pendulums, of which one starts 1e-7 rad lower, joints intact."""
    times = np.linspace(0.1 * t_end, t_end, 100)
    one, other = (mbd.simulate(scene, t_end, rtol=1e-10).position(tip, t=times) for scene, tip in map(turned_double_pendulum, (0.0, 1e-7)))
    return float(np.polyfit(times, np.log(distances(one, other)), 1)[0])


def turned_double_pendulum(angle: float) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene()
    place = np.array((np.cos(angle), -np.sin(angle)))
    first, second = scene.add(mbd.Particle(1.0, place)), scene.add(mbd.Particle(1.0, 2.0 * place))
    scene.add(mbd.Distance(first.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Distance(second.at(), first.at()))
    return scene, second.at()


def test_chaos_is_refused_beyond_a_time() -> None:
    """A chain of four rods: errors are right until then, the exponent is that of neighbouring starts, and a tighter run reaches farther."""
    rows = machines.data("four_bar_chain")["reference"]
    scene, outputs = long_chain()
    loose, tight = (mbd.verify(scene, 14.0, outputs={"tip": outputs["tip"]}, rtol=rtol) for rtol in (1e-5, 1e-8))
    assert not loose.ok and not tight.ok and loose.growth.exponential
    assert "not predictable beyond" in loose.rows[0].verdict and "not predictable beyond" in str(loose)
    assert 1.0 < loose.predictable_until < tight.predictable_until < 14.0
    assert np.isinf(loose.errors["tip"][loose.t > loose.predictable_until + 0.3]).all()
    assert np.isfinite(loose.errors["tip"][loose.t <= loose.predictable_until]).all()
    for found in (loose, tight):
        known = [row for row in rows if row["t"] <= found.predictable_until]
        assert known
        error = distances(found.result.position(outputs["tip"], t=[row["t"] for row in known]), [row["P"][0][:2] for row in known])
        assert np.all(error <= MOST * np.interp([row["t"] for row in known], found.t, found.errors["tip"]))


def test_the_exponent_is_that_of_neighbouring_starts() -> None:
    scene, outputs = double_pendulum()
    found = mbd.verify(scene, 25.0, outputs={"tip": outputs["tip"]}, rtol=1e-6)
    assert not found.ok and found.growth.exponential and found.predictable_until > 10.0
    assert 0.5 < found.growth.exponent / lyapunov(16.0) < 2.0


def test_a_jump_that_is_not_declared_spoils_the_order() -> None:
    """Gauss's steps see fourth order until a torque jumps within one; declared, it is there again."""

    def kicked(torque: Any) -> mbd.Verification:
        scene = mbd.Scene()
        rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
        scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
        scene.add(mbd.Torque(rod.at(), torque))
        return mbd.verify(scene, 1.0, outputs={"tip": rod.at(0.5, 0)}, solver=mbd.Gauss(0.02))

    def jump(t: float) -> float:
        return 3.0 if t > 0.4137 else 0.0

    jump.discontinuities = ()  # type: ignore[attr-defined]  # said to have none: else it would be found
    refused, fine = kicked(jump), kicked(mbd.piecewise(jump, at=[0.4137]))
    assert "observed order wrong" in refused.rows[0].verdict and not refused.ok
    assert np.isinf(refused.errors["tip"]).all()
    assert fine.ok and fine.rows[0].order > 3.0


def test_the_report_reads_as_a_table() -> None:
    scene, outputs = simple_pendulum()
    found = mbd.verify(scene, 2.0, outputs=outputs, rtol=1e-6)
    head, bob, force, *rest = str(found).splitlines()
    assert head.split()[:3] == ["output", "unit", "worst"]
    assert bob.split()[:2] == ["bob", "m"] and bob.endswith("ok")
    assert force.split()[:2] == ["force", "N"]
    assert "rtol 0.001, 1e-06, " in rest[0]
    assert found.rows[0].worst == pytest.approx(found.errors["bob"].max())
    assert 0.0 <= found.rows[0].at <= 2.0


def test_complaints_come_together() -> None:
    scene, outputs = simple_pendulum()
    _, other = double_pendulum()
    with pytest.raises(ValueError, match=r"outputs: 'far': .*another") as caught:
        mbd.verify(scene, 1.0, outputs={"far": other["tip"], "what": 3.0, "ground": scene.ground})
    assert len(str(caught.value).splitlines()) == 3
    for wrong in ({}, outputs["bob"], None):
        with pytest.raises(ValueError, match="outputs: expected names"):
            mbd.verify(scene, 1.0, outputs=wrong)
    with pytest.raises(ValueError, match="rtol: expected a tolerance"):
        mbd.verify(scene, 1.0, outputs=outputs, rtol=0.5)
    with pytest.raises(ValueError, match="meshes: expected a scene with beams"):
        mbd.verify(scene, 1.0, outputs=outputs, meshes=True)
    with pytest.raises(ValueError, match="expected finite numbers for each"):
        mbd.verify(scene, 1.0, outputs={"odd": lambda result: np.zeros(3)})
