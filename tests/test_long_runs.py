"""Pendulums over many periods: phase, energy and joints stay where they should. The page of 10000 periods is docs/long_runs.md."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def long_runs(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks import long_runs

    return long_runs


@pytest.mark.parametrize(
    ("method", "phase", "energy"), [("default, rtol 1e-10", 5e-11, 1e-10), ("Gauss, 4 stages, T/20", 1e-7, 1e-8), ("Radau, rtol 1e-8", 1e-8, 1e-8)]
)
def test_ten_periods_of_the_rigid_pendulum(long_runs, method, phase, energy):
    """Against elliptic integrals: a quarter after ten whole periods it hangs down."""
    row = long_runs.swing("rigid", method, 10)
    assert abs(row.angle + 0.5 * np.pi) / abs(row.rate) < phase * long_runs.CASES["rigid"].period
    assert row.energy < energy and row.position_drift < 1e-12 and row.velocity_drift < 1e-12


def test_a_budget_ends_a_run_with_a_chunk(long_runs, monkeypatch):
    monkeypatch.setattr(long_runs, "CHUNK", 2)
    row = long_runs.swing("rigid", "default, rtol 1e-6", 6, budget=0.0)
    assert row.periods == 2 and abs(row.angle + 0.5 * np.pi) < 1e-5


@pytest.mark.slow
def test_ten_thousand_periods_of_the_rigid_pendulum(long_runs):
    """The structure-preserving method keeps energy within 1e-8, and its phase error grows in proportion to time, not faster."""
    short, long = (long_runs.swing("rigid", "Gauss, 4 stages, T/20", periods) for periods in (1000, 10000))
    assert long.energy < 1e-8 and long.position_drift < 1e-12
    ahead = [(row.angle + 0.5 * np.pi) / row.rate for row in (short, long)]
    assert abs(ahead[1]) < 12.0 * abs(ahead[0])


@pytest.mark.slow
def test_a_thousand_periods_of_the_elastic_pendulum(long_runs):
    row = long_runs.swing("elastic", "Gauss, 2 stages, 8 samples, T/80")
    assert row.energy < 1e-8 and row.position_drift < 1e-12


def test_the_page_says_what_was_measured(long_runs):
    rows = [long_runs.Row(**row) for row in json.loads(long_runs.OUT.with_suffix(".json").read_text(encoding="utf-8"))]
    assert long_runs.OUT.read_text(encoding="utf-8") == long_runs.page(rows)
    preserving = [row for row in rows if row.method.startswith("Gauss") and row.method != long_runs.REFERENCE]
    assert {row.case: row.periods for row in preserving} == {"rigid": 10000, "elastic": 1000}
    assert all(row.energy < 1e-8 for row in preserving)
