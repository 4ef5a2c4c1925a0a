"""What the sweeps found and the library mends since: each is a witness of one mistake."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import mbd
from benchmarks.stress import exact
from benchmarks.stress.families import frames, ratios, settings, singular


def said(run: object) -> str:
    """The library's warnings of a run."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run()  # type: ignore[operator]
    return "; ".join(str(warning.message) for warning in caught if issubclass(warning.category, mbd.SceneWarning))


def test_a_uniform_rotation_raises_no_alarm() -> None:
    """Nothing is exchanged, and a millionth of the kinetic energy is the run's error: that is no reason not to trust it."""
    assert "energy" not in said(lambda: singular.aligned(0.1))


def test_a_lost_rotation_raises_the_alarm() -> None:
    """A body that a far too coarse method slows down without a load."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, angular_velocity=10.0, velocity=(0.0, 5.0)))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 0.1)
    assert result.audit.balanced
    energies = {"energy_error": 0.01 * result.audit.moving_energy, "energy_scale": 0.01 * result.audit.moving_energy}
    assert not type(result.audit)(**{**vars(result.audit), **energies}).balanced


def test_weights_that_stand_still_raise_no_alarm() -> None:
    """A door on hinges that are not in line cannot move: what its energies do is rounding of m g L."""
    scene = mbd.Scene(gravity=(0.0, -9.81, 0.0))
    door = scene.add(mbd.RigidBody(mass=1.0, inertia=(0.04, 0.16, 0.12), position=(0.6, 0.0, 0.0)))
    for x in (0.0, 0.3):
        scene.add(mbd.Pin(door.at(x - 0.6, 0, 0), scene.ground.at(x, 0, 0), axis=(0, 0, 1)))
    assert "do not trust" not in said(lambda: mbd.simulate(scene, 0.5))


def test_late_clocks_do_not_spoil_steps() -> None:
    """At 1e12 s the clock counts in steps of 1e-4 s; positions know nothing of that."""
    assert max(frames.clock(1e12)) < 1e-6


def test_a_driven_joint_of_constant_slopes_survives_a_failed_iteration() -> None:
    """Pushed through its own start an element of 1998 fails, iterations are repeated with each stage's slopes, and the audit tells of it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert singular.chord_frame(-0.01).shown > 1e-3


@pytest.mark.parametrize("solver", [mbd.GeneralizedAlpha, lambda step: mbd.Radau(stages=3, step=step)], ids=["alpha", "radau"])
def test_steps_too_long_are_announced(solver) -> None:
    coarse, fine = said(lambda: settings.rod(solver(0.2))), said(lambda: settings.rod(solver(0.005), t_end=1.0))
    assert "the fixed steps are too long" in coarse
    assert "do not trust" in coarse
    assert not fine


@pytest.mark.parametrize("step", [0.02, 0.05, 0.1])
def test_the_errors_added_up_are_what_a_fixed_step_costs(step: float) -> None:
    """Generalized-alpha on a rod over 5 periods: within a factor of 5 of the error against elliptic functions."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1.2, 0), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.6, 0), scene.ground.at(0, 0)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = mbd.simulate(scene, settings.SPAN, solver=mbd.GeneralizedAlpha(step=step))
    error = np.linalg.norm(result.position(rod.at(0.6, 0))[-1] - exact.flat(settings.SPAN)) / result.system.length
    assert error / 5.0 < result.stats["coarseness"] < 5.0 * error


def test_a_branch_left_across_a_tiny_gap_is_announced() -> None:
    """A crank and a rod longer by 1e-8 of it: the gap between both ways of closing is finer than the steps. With 1e-3 it is not."""
    told = said(lambda: singular.dead_centre(1e-8))
    assert "'rod', 'guide' went through a singular position at t = " in told
    assert float(told.split("position at t = ")[1].split(" s")[0]) == pytest.approx(0.527, abs=1e-3)
    assert not said(lambda: singular.dead_centre(1e-3))


@pytest.mark.parametrize("excess", np.geomspace(1e-9, 1e-5, 7))
def test_a_run_next_to_dead_centres_is_right_or_announces_the_branch(excess: float) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        wrong = singular.dead_centre(excess).error > 1e-3
    assert wrong == any("singular position" in str(warning.message) for warning in caught)


def test_a_passage_through_the_line_of_all_bars_is_told() -> None:
    """Uniform rotation from 0.1 rad: all bars are in line at (pi - 0.1) / speed, and the first passage told is one of these."""
    told = said(lambda: singular.aligned(1e-4))
    time = float(told.split("at t = ")[1].split(" s")[0])
    turns = (1e-4 + singular.SPEED * time) / np.pi
    assert abs(turns - round(turns)) < 0.02


def test_a_driven_turn_through_right_angles_is_no_passage() -> None:
    """Where entries of a row are stored in several parts, their sum counts: the row of a turning angle has two for each coordinate."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e6, A=1e-2, I=1e-6, rho=1000))
    scene.add(mbd.Prescribed(beam.start, (0.0, 0.0), angle=lambda t: 2.0 * t * t))
    assert not said(lambda: mbd.simulate(scene, 1.5, rtol=1e-4))


@pytest.mark.parametrize("ratio", [1e4, 1e8])
def test_short_elements_do_not_shorten_steps(ratio: float) -> None:
    """Units in which masses are 1 make a short element so stiff that its matrix looks singular; steps were halved for that, to a thirtieth."""
    result, found = ratios.graded_run(ratio)
    assert found < 3e-4
    assert result.stats["steps"] < 500
    assert result.stats["rejected"] < 50


def test_stiffness_out_of_proportion_is_named() -> None:
    """Elements of 1e-9 of others: no joint is singular there, and none is blamed."""
    with pytest.raises(mbd.SimulationError, match=r"at rod: steps became too short: stiffnesses are too unequal.*the highest in 'rod'"):
        ratios.graded_run(1e9)


def test_a_slender_cantilever_keeps_its_energy() -> None:
    """Its stiffness along itself, 1e12 of that across, is not to be solved for in long steps: two digits would be right, and energies none."""
    checked = ratios.slenderness(1e6)
    assert max(checked) < 1e-3
