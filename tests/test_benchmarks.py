"""The benchmark: both programs are given one problem, its fronts and tables say what was measured, and a run writes its pages."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")
"""Exudyn renamed physicsMass and its like in 1.12; the old names serve all versions from 1.9 to 2031."""
ROOT = Path(__file__).parents[1]
if importlib.util.find_spec("benchmarks") is None:
    sys.path.append(str(ROOT))  # bare pytest has not got the root on its path; mbd is loaded already and stays what it is

from benchmarks import __main__ as command  # noqa: E402
from benchmarks import checks, machines, mbd_runs, report, scenes, tables  # noqa: E402
from benchmarks.fronts import Front, fronts  # noqa: E402
from benchmarks.work import Ladder, Row, Rung, Sample, sweep  # noqa: E402

NAMES = [case.name for case in scenes.CASES]
QUICK = ["soft pendulum", "steel pendulum", "four-bar 1", "squeezer", "slider-crank", "flexible slider-crank", "chain 10", "spaghetti", "heavy top"]


@pytest.fixture(scope="module")
def exudyn_runs():
    pytest.importorskip("exudyn")
    from benchmarks import exudyn_runs

    return exudyn_runs


def distance(case: scenes.Case, program: str, sample: Sample) -> float:
    assert sample.value is not None, sample.note
    return float(np.linalg.norm(sample.value - case.reference(program))) / case.scale


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_builds_and_has_a_reference(name):
    case = scenes.BY_NAME[name]
    scene, marker = case.build()
    assert scene.build().n > 0
    assert case.reference("mbd").shape == (scene.dimension,)
    assert np.linalg.norm(case.reference("mbd") - case.reference("Exudyn")) < checks.CLOSE * case.scale
    assert marker.scene is scene
    entry = machines.data("references")[name]
    assert entry["t_end"] == case.t_end
    assert entry["source"]


@pytest.mark.parametrize("name", QUICK)
def test_mbd_comes_to_the_reference(name):
    """The references were found elsewhere, or at far tighter tolerances by two methods."""
    case = scenes.BY_NAME[name]
    rtol = 1e-7 if name == "flexible slider-crank" else 1e-8  # its vibrations are followed one by one, in thousands of steps
    assert distance(case, "mbd", mbd_runs.run(case, None, rtol)) < 1e-5


@pytest.mark.parametrize("name", [name for name in QUICK if name != "steel pendulum"])
def test_exudyn_comes_to_the_same_reference(name, exudyn_runs):
    """By second order, so that four times the steps leave less than an eighth of the error."""
    case, first = scenes.BY_NAME[name], {"soft pendulum": 16, "heavy top": 16}.get(name, 8)
    coarse, fine = (distance(case, "Exudyn", exudyn_runs.implicit(case, case.steps * k, case.newton[0], 0.6)) for k in (first, 4 * first))
    assert fine < 1e-3
    assert fine < coarse / 8.0 or fine < 1e-5


def test_the_kinematic_tree_is_the_chain(exudyn_runs):
    case = scenes.BY_NAME["chain 10"]
    assert distance(case, "Exudyn", exudyn_runs.tree(case, 1600, "RK67")) < 1e-9


def test_the_squeezer_closes():
    numbers = machines.squeezer_numbers()
    points, poses = machines.squeezer_points(numbers), machines.squeezer_poses(numbers)

    def place(body: int, name: str) -> complex:
        (x, y), angle = poses[body] if body < 7 else ((0.0, 0.0), 0.0)
        return complex(x, y) + np.exp(1j * angle) * complex(*points[body][name])

    assert len(machines.SQUEEZER_PINS) == 10
    assert max(abs(place(*one) - place(*other)) for one, other in machines.SQUEEZER_PINS) < 1e-15


def row(error: float, seconds: float, *, program: str = "mbd", rtol: float | None = None, newton: int = 0) -> Row:
    rung = Rung("a setting", lambda: Sample(seconds, np.zeros(2)), rtol)
    return Row(program, "a method", rung, error, Sample(seconds, np.zeros(2), {"newton iterations": newton}), [seconds])


def test_a_front_interpolates_in_logarithms():
    front = Front([row(1e-2, 1.0), row(1e-4, 100.0), row(1e-3, 200.0), row(np.inf, 0.1)])
    assert [r.error for r in front.rows] == [1e-2, 1e-4]
    assert front.at(1e-3).seconds == pytest.approx(10.0)
    assert front.at(1e-1).seconds == 1.0
    assert front.at(1e-5) is None
    assert front.best == 1e-4


def test_ratios_say_who_cannot_reach():
    both = fronts([row(1e-2, 1.0), row(1e-6, 1.0), row(1e-2, 4.0, program="Exudyn"), row(1e-4, 8.0, program="Exudyn")])
    assert tables.ratio(both, "Exudyn", 1e-2) == "0.25"
    assert tables.ratio(both, "Exudyn", 1e-5) == "only mbd"
    assert tables.ratio(both, "Exudyn", 1e-8) == "neither reaches"
    assert "cannot reach" in tables.ratios(both, [1e-5])


def test_what_does_not_converge_is_left_out():
    case = scenes.BY_NAME["chain 10"]
    assert checks.disagreement(case, "Exudyn", Front([row(1e-1, 1.0), row(1e-4, 2.0)])) == ""
    assert "not the same problem" in checks.disagreement(case, "Exudyn", Front([row(2e-2, 1.0), row(1e-2, 2.0)]))
    assert "do not fall" in checks.disagreement(case, "Exudyn", Front([row(2e-4, 1.0), row(1.5e-4, 2.0)]))
    assert "no run" in checks.disagreement(case, "Exudyn", Front([row(np.inf, 1.0)]))


def test_tolerances_are_judged_by_error_and_by_work():
    rows = [row(1e-3, 1.0, rtol=1e-3, newton=30), row(1e-4, 1.0, rtol=1e-5, newton=20), row(np.inf, 1.0, rtol=1e-7)]
    assert tables.costlier(rows[:2]) == 1.5
    text = tables.tolerances(rows, scale=2.0, length=1.0)
    assert "| 2 " in text
    assert "| 20 " in text or "| 20   " in text
    assert "failed" in text
    rows[1] = row(2e-4, 1.0, rtol=1e-5, newton=20)
    assert "40 !" in tables.tolerances(rows, scale=2.0, length=1.0)


def test_a_sweep_takes_turns_stops_at_the_budget_and_repeats_what_matters():
    ran: list[str] = []

    def ladder(name: str, seconds: list[float]) -> Ladder:
        def rung(s: float) -> Rung:
            return Rung(f"{s}", lambda: ran.append(name) or Sample(s, np.array([1.0 / s])))

        return Ladder(name, "a method", (rung(s) for s in seconds))

    rows = sweep([ladder("mbd", [1.0, 2.0, 3.0]), ladder("Exudyn", [1.0, 9.0, 10.0])], lambda program, value: float(value[0]), 2, 5.0)
    assert ran[:5] == ["mbd", "Exudyn", "mbd", "Exudyn", "mbd"]
    assert ran[5:] == ["mbd", "Exudyn", "mbd", "Exudyn", "mbd"]
    assert [len(r.seconds) for r in rows] == [2] * 5


def test_a_run_prints_and_writes_pages(tmp_path, monkeypatch):
    """With one method of mbd, and without the peer."""
    monkeypatch.setattr(command, "peers", lambda case: [])
    monkeypatch.setattr(mbd_runs, "ladders", lambda case: [Ladder("mbd", "default", mbd_runs.tolerances(case, None, (1e-3, 1e-8)))])
    case = scenes.BY_NAME["slider-crank"]
    rows, best, excluded = command.measure(case, 2, 5.0)
    assert [r.rung.rtol for r in rows] == [1e-3, 1e-8]
    assert rows[0].error > rows[1].error
    assert [len(r.seconds) for r in rows] == [2, 2]
    assert excluded == []
    text = report.page(case, rows, best, excluded, 1.0, SimpleNamespace(repeats=2, budget=5.0), report.machine())
    assert text.count("| default ") >= 2
    report.write(tmp_path, case, text, report.record(case, rows, best, excluded, "here"))
    assert (tmp_path / "slider_crank.md").read_text() == text
    assert "slider-crank" in (tmp_path / "README.md").read_text()


def test_plots_are_written(tmp_path):
    pytest.importorskip("matplotlib")
    from benchmarks.plots import plot

    plot(tmp_path / "a.png", "title", [row(1e-2, 1.0), row(1e-4, 3.0), row(np.inf, 1.0, program="Exudyn")])
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"


def test_quick_writes_nothing_by_itself():
    assert command.arguments(["--quick"]).out is None
    assert command.arguments(["--quick"]).repeats == 1
    assert command.arguments([]).out == report.OUT
    assert command.arguments([]).repeats == 3
