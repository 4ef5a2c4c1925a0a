"""Simo and Vu-Quoc's spin-up (1986) of a beam on a driven hub, against a spline Galerkin solution of seven digits, every second."""

from __future__ import annotations

import numpy as np
import pytest

import mbd

from .. import machines

BOOK = machines.data("spinup_beam")


def spin_up(t: float) -> float:
    return 0.4 * (t**2 / 2.0 + (7.5 / np.pi) ** 2 * (np.cos(2.0 * np.pi * t / 15.0) - 1.0)) if t < 15.0 else 6.0 * t - 45.0


@pytest.mark.parametrize("t_end", [8.0, pytest.param(20.0, marks=pytest.mark.slow)])
def test_spin_up(t_end: float) -> None:
    """16 elements: tip and middle within 1e-6 m of a beam of 10 m (measured 5.4e-7 and 2.4e-7), tip in the hub's frame too."""
    p, area = BOOK["parameters"], 1e-2
    rows = [row for row in BOOK["values"] if row["t"] <= t_end]
    times = np.array([row["t"] for row in rows])
    scene = mbd.Scene(gravity=(0, 0))
    section = {"E": p["EA"] / area, "A": area, "I": p["EI"] * area / p["EA"], "rho": p["rhoA"] / area}
    beam = scene.add(mbd.AncfCable((0, 0), (p["L"], 0), n_elements=16, gauss_points=3, **section))
    scene.add(mbd.Prescribed(beam.start, (0, 0), angle=mbd.piecewise(spin_up, at=[15.0])))
    result = mbd.simulate(scene, t_end, rtol=1e-8, t_eval=times)
    tip, middle = result.position(beam.end), result.position(beam.at(0.5))
    assert np.abs(tip - [row["end1"] for row in rows]).max() < 1e-6
    assert np.abs(middle - [row["mid"] for row in rows]).max() < 1e-6
    turned = tip @ (1.0, 0.0) + 1j * (tip @ (0.0, 1.0))
    turned = turned * np.exp(-1j * np.array([spin_up(t) for t in times])) - p["L"]
    assert turned.imag == pytest.approx([row["u2"] for row in rows], abs=1e-6)
    assert result.energy.elastic == pytest.approx([row["U"] for row in rows], rel=1e-4)
