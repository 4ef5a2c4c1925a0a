"""The audit of driven scenes: drift from what is asked, and the work of the drives. Save and load of drives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd

from .test_drives import crank, driven_pendulum


@pytest.mark.parametrize("solver", [None, mbd.Radau(3, step=0.01), mbd.DormandPrince()], ids=["default", "Radau 3", "explicit"])
def test_a_driven_scene_balances(solver: Any) -> None:
    audit = mbd.simulate(driven_pendulum(False), 1.0, rtol=1e-9, solver=solver).audit
    assert max(audit.position_drift, audit.velocity_drift) < 1e-10
    assert abs(audit.work) > 1.0 and audit.energy_error < 1e-7 * audit.energy_scale


def test_generalized_alpha_balances_to_its_order() -> None:
    audits = [mbd.simulate(driven_pendulum(True), 1.0, solver=mbd.GeneralizedAlpha(1.0 / n)).audit for n in (200, 400)]
    assert max(audits[1].position_drift, audits[1].velocity_drift) < 1e-10
    assert audits[1].energy_error < 0.3 * audits[0].energy_error < 1e-3 * audits[0].energy_scale


def test_work_of_a_motor_that_runs_up() -> None:
    """From rest to 3 rad/s within a second, without gravity: J omega^2 / 2."""
    scene = mbd.Scene(gravity=(0, 0))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=2.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at()))
    scene.add(mbd.Motor(rod, scene.ground, speed=lambda t: 3.0 * t**2 * (3.0 - 2.0 * t)))
    audit = mbd.simulate(scene, 1.0, rtol=1e-9).audit
    assert audit.work == pytest.approx(0.5 * (2.0 / 3.0) * 9.0, abs=1e-8) and audit.energy_error < 1e-8


def test_drives_are_saved(tmp_path: Path) -> None:
    for drive in ({"speed": 2.0}, {"angle": lambda t: 2.0 * t}):
        scene, rod, *_ = crank(**drive)
        scene.add(mbd.Prescribed(scene.add(mbd.Particle(1.0, (3, 0))).at(), (3, 0)))
        result = mbd.simulate(scene, 0.5)
        with np.errstate() if "speed" in drive else pytest.warns(mbd.SceneWarning, match="motor"):
            result.save(tmp_path / "run.npz")
        loaded = mbd.load(tmp_path / "run.npz")
        assert np.array_equal(loaded.angle(loaded.scene["rod"]), result.angle(rod))
        if "speed" in drive:
            assert loaded.audit == result.audit
        else:
            with pytest.raises(mbd.SimulationError, match="motor"):
                loaded.reaction(loaded.scene["motor"])
