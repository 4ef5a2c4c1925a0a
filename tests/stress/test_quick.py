"""Ordinary and extreme levels of every family of the stress suite: right against its reference; the rest is in ``test_sweeps.py``."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
if importlib.util.find_spec("benchmarks") is None:
    sys.path.append(str(ROOT))  # bare pytest has not got the root on its path; mbd is loaded already and stays what it is

from benchmarks.stress import page  # noqa: E402
from benchmarks.stress.families import FAMILIES  # noqa: E402
from benchmarks.stress.family import REFUSED, RIGHT, SILENT, Checked, Family, Verdict, judged, reach  # noqa: E402

QUICK = [(family, level) for family in FAMILIES for level in family.quick]


@pytest.mark.parametrize(("family", "level"), QUICK, ids=[f"{family.name} {level:g}" for family, level in QUICK])
def test_extremes_are_right(family: Family, level: float) -> None:
    found = judged(family, level)
    refused_rightly = family.name == "conflicting joints" and level >= 1e-6
    assert found.kind == (REFUSED if refused_rightly else RIGHT), found
    if refused_rightly:
        assert "'short rod', 'long rod'" in found.said


def test_families_are_consistent() -> None:
    """Levels are ordered and named once; what is wanted or quick is among them."""
    assert len({family.name for family in FAMILIES}) == len(FAMILIES)
    for family in FAMILIES:
        assert {*family.quick, *family.wanted, family.nominal} <= set(family.levels), family.name
        assert list(family.levels) == sorted(set(family.levels)), family.name


def swept(errors: dict[float, float | Checked | Exception]) -> tuple[Family, dict[float, Verdict]]:
    def run(level: float) -> float | Checked:
        found = errors[level]
        if isinstance(found, Exception):
            raise found
        return found

    family = Family("made up", "level", "nothing", tuple(errors), 1.0, 1e-3, run)
    return family, {level: judged(family, level) for level in errors}


def test_verdicts_and_limits() -> None:
    """The limit is the first level that is not right, on each side; a wrong result without a word is silent, one that its audit shows is not."""
    import mbd

    refused = mbd.SimulationError("stopped", item="rod", advice=("this", "that", "more"), time=0.5)
    family, found = swept({0.01: 1e-9, 0.1: refused, 1.0: 1e-4, 10.0: Checked(1e-4, 1e-5), 100.0: 0.5, 1000.0: Checked(0.5, 0.4)})
    assert [verdict.kind for verdict in found.values()] == [RIGHT, REFUSED, RIGHT, RIGHT, SILENT, "announced"]
    assert reach(family, found) == [1.0, 10.0]
    assert [level for level, _ in page.limits(family, found)] == [0.1, 100.0]
    cells = page.row(family, found, {})
    assert cells[3:6] == ["1 to 10", "1e-04", "0.1: refused; 100: SILENT"]


def test_a_run_that_takes_too_long_is_stopped() -> None:
    def endless(level: float) -> float:
        while True:
            pass

    assert judged(Family("endless", "", "", (1.0,), 1.0, 1.0, endless, patience=0.05), 1.0).kind == "too slow"


def test_records_survive_writing(tmp_path: Path) -> None:
    name = FAMILIES[0].name
    found = {name: ({1.0: Verdict(RIGHT, 1e-7, "", 0.1)}, {1.0: Verdict(SILENT, float("inf"), "", 0.1)})}
    page.write(tmp_path, found, "a machine")
    page.write(tmp_path, {FAMILIES[1].name: ({1.0: Verdict(RIGHT, 1e-7)}, {})}, "another machine")
    text = (tmp_path / "stress.md").read_text()
    assert all(word in text for word in (name, FAMILIES[1].name, "a machine", "another machine", "SILENT"))
