"""mbd.work_precision: rows that are true, errors that fall, references of another method, and clear refusals."""

from __future__ import annotations

import numpy as np
import pytest

import mbd

from . import machines


@pytest.fixture(scope="module")
def pendulum():
    return machines.flexible_pendulum(n_elements=4)[:2]


def test_errors_fall_with_the_tolerance_and_rows_say_what_ran(pendulum):
    scene, rod = pendulum
    report = mbd.work_precision(scene, 0.3, output=rod.end, solvers=[mbd.Radau(3), mbd.Radau(5)], rtols=[1e-7, 1e-3, 1e-5], repeats=2)
    assert [(row.solver, row.rtol) for row in report.rows] == [(f"Radau(stages={s})", r) for s in (3, 5) for r in (1e-3, 1e-5, 1e-7)]
    for k in (0, 3):
        errors = [row.error for row in report.rows[k : k + 3]]
        assert errors[0] > errors[1] > errors[2]
        assert errors[2] < 30 * 1e-7 * 1.2
    assert all(row.wall_time > 0.0 and 0 < row.steps <= row.newton_iterations for row in report.rows)
    assert report.source.startswith("Radau(stages=7) at rtol 1e-09; the nearest other run differs by")
    direct = mbd.simulate(scene, 0.3, rtol=1e-5, solver=mbd.Radau(5))
    assert report.rows[4].error == pytest.approx(np.linalg.norm(direct.position(rod.end)[-1] - report.reference[0]), rel=1e-12)
    assert (report.rows[4].steps, report.rows[4].newton_iterations) == (direct.stats["steps"], direct.stats["newton iterations"])


def test_solvers_of_fixed_steps_run_once_each_and_halving_quarters_their_error(pendulum):
    scene, rod = pendulum
    solvers = [mbd.GeneralizedAlpha(step=h) for h in (2e-3, 1e-3)]
    rows = mbd.work_precision(scene, 0.3, output=rod.end, solvers=solvers, rtols=[1e-6]).rows
    assert [row.rtol for row in rows] == [None, None]
    assert [row.steps for row in rows] == [150, 300]
    assert rows[0].solver == "GeneralizedAlpha(step=0.002)"
    assert 3.0 < rows[0].error / rows[1].error < 5.0


def test_a_given_reference_and_times_are_used_as_they_are():
    """A particle in free fall: exact at every time."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    ball = scene.add(mbd.Particle(1.0, (0.0, 0.0), velocity=(1.0, 0.0)))
    times = np.array([0.5, 1.0])
    exact = np.stack((times, -0.5 * 9.81 * times**2), axis=1)
    right = mbd.work_precision(scene, 1.0, output=ball.at(), rtols=[1e-4], times=times, reference=exact)
    shifted = mbd.work_precision(scene, 1.0, output=ball.at(), rtols=[1e-4], times=times, reference=exact + [[0.0, 0.25], [0.0, 0.0]])
    assert right.source == "given"
    assert right.rows[0].error < 1e-12
    assert shifted.rows[0].error == pytest.approx(0.25, abs=1e-12)
    assert right.rows[0].solver == "default"


def test_it_prints_a_table(pendulum):
    scene, rod = pendulum
    lines = str(mbd.work_precision(scene, 0.05, output=rod.end, rtols=[1e-3, 1e-5])).splitlines()
    assert lines[0].split() == ["solver", "rtol", "wall", "time", "[s]", "error", "[m]", "steps", "Newton"]
    assert [line.split()[:2] for line in lines[1:3]] == [["default", "1e-03"], ["default", "1e-05"]]
    assert lines[3].startswith("reference: Radau(stages=7)")


def test_it_plots_a_curve_for_each_solver(pendulum):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    scene, rod = pendulum
    report = mbd.work_precision(scene, 0.1, output=rod.end, solvers=[mbd.Radau(3), mbd.Radau(5)], rtols=[1e-3, 1e-5])
    axes = report.plot()
    assert [line.get_label() for line in axes.lines] == ["Radau(stages=3)", "Radau(stages=5)"]
    assert axes.lines[0].get_xdata() == pytest.approx([row.error for row in report.rows[:2]])
    assert axes.lines[0].get_ydata() == pytest.approx([row.wall_time for row in report.rows[:2]])
    assert axes.xaxis_inverted()
    assert report.plot(axes) is axes
    assert axes.xaxis_inverted()
    matplotlib.pyplot.close("all")


class Stuck:
    """A solver whose runs stop at once."""

    def integrator(self, rtol: float):
        raise mbd.SimulationError("stuck", time=0.1, item="rod", advice=("wait", "push", "give up"))


def test_a_run_that_stops_is_a_row_with_an_infinite_error(pendulum):
    scene, rod = pendulum
    rows = mbd.work_precision(scene, 0.1, output=rod.end, solvers=[Stuck()], rtols=[1e-3], reference=[1.2, 0.0]).rows
    assert rows[0].error == np.inf
    assert rows[0].note == "stopped at 0.1 s"


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"output": "tip"}, "output: expected a marker"),
        ({"output": machines.double_pendulum()[1]}, "of another"),
        ({"solvers": []}, "solvers: expected at least one"),
        ({"solvers": [5]}, "solvers: expected solvers such as"),
        ({"rtols": []}, "rtols: expected tolerances"),
        ({"rtols": [1e-3, 0.0]}, "rtols: expected tolerances"),
        ({"times": [0.2, 9.0]}, "times: expected times from 0 to 0.3 s"),
        ({"reference": [1.0, 2.0, 3.0]}, "reference: expected finite positions of shape"),
        ({"repeats": 0}, "repeats: expected 1 or more"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(pendulum, change, complaint):
    scene, rod = pendulum
    with pytest.raises(ValueError, match=complaint):
        mbd.work_precision(scene, 0.3, **({"output": rod.end} | change))


def test_every_complaint_comes_at_once(pendulum):
    scene, rod = pendulum
    with pytest.raises(ValueError, match=r"(?s)solvers.*repeats"):
        mbd.work_precision(scene, 0.3, output=rod.end, solvers=[], repeats=0)
