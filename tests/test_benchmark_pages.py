"""The pages on cost of size and on accuracy: fits and marks of what exceeds a bar, tables from known numbers, merging, a smoke run."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest

import mbd

ROOT = Path(__file__).parents[1]
if importlib.util.find_spec("benchmarks") is None:
    sys.path.append(str(ROOT))  # bare pytest has not got the root on its path; mbd is loaded already and stays what it is

from benchmarks import accuracy, fits, probes, report, scaling, scenes  # noqa: E402
from benchmarks.fronts import fronts  # noqa: E402
from benchmarks.work import Row, Rung, Sample  # noqa: E402


def cells(text: str, first: str) -> list[str]:
    """The cells of the table's row that begins with a word."""
    return [cell.strip() for line in text.splitlines() if line.startswith(f"| {first} ") for cell in line.strip("| ").split("|")]


@pytest.mark.parametrize("power", [0.5, 1.0, 2.7])
def test_an_exponent_is_that_of_the_power_law(power):
    sizes = [100, 1000, 10000]
    assert fits.exponent(sizes, [3e-6 * n**power for n in sizes]) == pytest.approx(power, abs=1e-12)
    assert fits.exponent([7, *sizes, 5], [np.nan, *(n**power for n in sizes), 0.0]) == pytest.approx(power, abs=1e-12)


def test_an_exponent_needs_two_sizes():
    assert np.isnan(fits.exponent([100], [1.0]))
    assert np.isnan(fits.exponent([100, 100], [1.0, 2.0]))


def test_excess_compares_with_all_later_runs():
    assert fits.excess([10, 20, 30]) == 1.0
    assert fits.excess([10, 30, 25, 20, 40]) == 1.5
    assert fits.excess([30, 0, 20]) == 1.5
    assert fits.excess([]) == 1.0


def test_what_exceeds_a_bar_is_marked():
    assert fits.marked(1.1, 1.1) == "1.1"
    assert fits.marked(1.2, 1.1) == "1.2 !"
    assert fits.marked(float("nan"), 1.1) == ""
    assert accuracy.marked_work(12, [10, 20]) == "12"
    assert accuracy.marked_work(13, [10, 20]) == "13 !"
    assert accuracy.marked_work(13, []) == "13"


def size(count: int, us: float, kB: float) -> dict:
    method = {"us": us, "kB": kB, "steps": 3, "newton iterations": 6}
    return {"coordinates": 4 * count, "describe": 1e-6 * count**2, "build": 1e-5 * count, "methods": {"Radau 3": method}}


def test_the_page_on_size_marks_what_grows_too_fast():
    sizes = {10: size(10, 100.0, 40.0), 100: size(100, 1e3, 5.0), 1000: size(1000, 2e4, 20.0), 10000: {"failed": "MemoryError"}}
    start = {"total": 0.6, "on the processor": 0.5, "import mbd": 0.1, "other imports": 0.44, "building and stepping": 0.06}
    text = scaling.page({"start": [start], "sizes": {"chain": sizes}, "stars": {"2 arms": {"failed": "why"}}}, "here")
    growth = cells(text, "power of size")
    assert growth[:5] == ["power of size", "", "1.3 !", "2 !", "1"]
    assert growth[5:] == ["power of size", "", "1.6 !"]
    assert "MemoryError" in text
    assert cells(text, "10")[-1] == "40"
    assert cells(text, "1000")[-1] == "20 !"
    assert cells(text, "0.6 !") == ["0.6 !", "0.5", "0.1", "0.44", "0.06", "90 %"]


def test_a_failed_process_says_why():
    assert "KeyError" in scaling.probe("no such probe")["failed"]


def test_a_start_is_measured_in_its_parts():
    """In a process of its own, where nothing was imported before."""
    found = scaling.probe("start")
    assert found["total"] == pytest.approx(found["import mbd"] + found["other imports"] + found["building and stepping"])
    assert 0.0 < found["building and stepping"] < found["total"]


@pytest.mark.parametrize("elements", [0, 2])
def test_the_star_has_the_unknowns_it_should(elements):
    arms = 5
    scene = probes._star(arms, elements)
    system = scene.build()
    nodes = 2 * (elements + 1) if elements else 2  # rows of the table: position and slope, or mass centre and axis
    assert system.n == 2 * (2 + arms * nodes)
    assert system.m == 2 * (1 + arms) + 1 + (0 if elements else arms)
    found = probes._matrix(scene)
    assert found["unknowns"] == system.n + system.m
    assert found["fill"] >= found["unknowns"]
    assert found["factor"] > 0.0


def test_stored_steps_are_counted_apart():
    scene, _ = scenes.chain(3)
    result = mbd.simulate(scene, 0.05)
    system = scene.build()
    assert probes._stored(result) == 8 * len(result.t) * (4 * system.n + system.m)
    assert probes.peak() > 1e7


def entry(errors: list[float | None], work: list[int], energy: float | None = 1e-12) -> dict:
    rows = [
        {"rtol": 10.0 ** -(k + 2), "error": error, "work": count, "energy": energy, "seconds": 0.5, "note": ""}
        for k, (error, count) in enumerate(zip(errors, work))
    ]
    return {"where": "here", "length": 2.0, "scale": 1.0, "known": 1e-9, "rows": rows}


def test_the_page_on_accuracy_marks_each_bar():
    found = {"chain 10": entry([1e-2, 1e-3, 1e-4], [10, 11, 20]), "four-bar 1": entry([1.0, 3e-2, 1e-2], [30, 20, 40], energy=5e-4)}
    errors = accuracy.errors(found)
    assert cells(errors, "chain 10") == ["chain 10", "0.5", "0.5", "0.5", "1.00", "1"]
    assert cells(errors, "four-bar 1") == ["four-bar 1", "50 !", "15", "50 !", "1.00", "1"]
    assert cells(accuracy.errors({"chain 10": entry([1e-3, 2e-3, None], [1, 1, 1])}), "chain 10")[3:] == ["failed !", "-0.30 !", "2"]
    work = accuracy.work(found)
    assert cells(work, "chain 10") == ["chain 10", "10", "11", "20", "1.00", "1.5"]
    assert cells(work, "four-bar 1") == ["four-bar 1", "30 !", "20", "40", "1.50 !", "1.5"]
    page = accuracy.page(found)
    assert cells(page.split("come into line")[1], "four-bar 1")[:5] == ["four-bar 1", "1e-03", "3.0e-02", "5.0e-04", "passes"]
    assert "passes, energy above rtol !" in page


def test_errors_at_the_reference_s_own_uncertainty_do_not_count_as_stagnation():
    assert cells(accuracy.errors({"chain 10": entry([1e-7, 1e-8, 1e-9, 1e-9], [1, 2, 3, 4])}), "chain 10")[-2:] == ["1.00", "1"]


def test_four_bars_pass_on_their_branch_only():
    row = {"rtol": 1e-4, "error": 1e-3, "energy": 1e-5, "note": ""}
    assert accuracy.verdict(row) == "passes"
    assert accuracy.verdict(row | {"error": 1.9}) == "left the branch !"
    assert accuracy.verdict(row | {"energy": 1e-3}) == "passes, energy above rtol !"
    assert accuracy.verdict(row | {"error": None, "note": "stopped at 1.2 s"}) == "stopped at 1.2 s !"


def test_a_scene_measured_again_keeps_the_others(tmp_path, monkeypatch):
    monkeypatch.setattr(accuracy, "measure", lambda case, rtols, budget: entry([1e-3], [1]) | {"known": len(case.name)})
    accuracy.main(["--scene", "squeezer", "four-bar 1", "--out", str(tmp_path)])
    accuracy.main(["--scene", "squeezer", "--out", str(tmp_path)])
    assert set(json.loads((tmp_path / "accuracy.json").read_text())) == {"squeezer", "four-bar 1"}
    assert "four-bar 1" in (tmp_path / "accuracy.md").read_text()


def test_the_summary_keeps_scenes_of_earlier_runs(tmp_path):
    """And sets the default at rtol 1e-6 beside the fastest method at the error it reached."""
    rows = [row("default", 1e-5, 2.0, 1e-5), row("default", 1e-6, 4.0, 1e-6), row("Radau 5", 1e-4, 1.0, 1e-4), row("Radau 5", 1e-6, 2.0, 1e-6)]
    for name, where in (("squeezer", "there"), ("chain 10", "there"), ("squeezer", "here")):
        case = scenes.BY_NAME[name]
        report.write(tmp_path, case, "page\n", report.record(case, rows, fronts(rows), [], where))
    entries = json.loads((tmp_path / "summary.json").read_text())
    assert {name: found["where"] for name, found in entries.items()} == {"squeezer": "here", "chain 10": "there"}
    text = (tmp_path / "README.md").read_text()
    assert cells(text, "chain 10") == ["chain 10", "1.0e-06", "4000", "2000", "Radau 5, a setting", "2 !"]


def row(method: str, error: float, seconds: float, rtol: float) -> Row:
    rung = Rung("a setting", lambda: Sample(seconds, np.zeros(2)), rtol)
    return Row("mbd", method, rung, error, Sample(seconds, np.zeros(2)), [seconds])


@pytest.mark.slow
def test_quick_runs_of_both_commands(tmp_path, capsys):
    """Everything but the large sizes: processes are started, scenes run, pages written."""
    scaling.main(["--quick", "--out", str(tmp_path)])
    found = json.loads((tmp_path / "scaling.json").read_text())
    assert {kind: list(rows) for kind, rows in found["sizes"].items()} == {"pendulum": ["30", "120"], "chain": ["10", "100"]}
    assert all("failed" not in row for rows in found["sizes"].values() for row in rows.values())
    assert all(np.isfinite(m["us"]) and m["us"] > 0 for rows in found["sizes"].values() for row in rows.values() for m in row["methods"].values())
    accuracy.main(["--quick", "--out", str(tmp_path), "--scene", "squeezer", "four-bar 1"])
    text = (tmp_path / "accuracy.md").read_text()
    assert len(cells(text, "four-bar 1")) > 20
    assert "failed" not in text
