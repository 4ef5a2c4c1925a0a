"""IFToMM A02, windows of bars that all come into line twice a turn, against elliptic functions (20 digits), to 10 s."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from .. import machines

BOOK = machines.data("iftomm_a02_n_four_bar")


def windows(n: int) -> tuple[mbd.Scene, list[Any], list[Any]]:
    """n + 1 links that stand upright on the ground and turn to the right, n couplers between their tops: scene, links, couplers."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    links = [scene.add(mbd.RigidBody.rod((i, 0), (i, 1), mass=1.0, velocity=(0.5, 0.0), angular_velocity=-1.0)) for i in range(n + 1)]
    couplers = [scene.add(mbd.RigidBody.rod((i, 1), (i + 1, 1), mass=1.0, velocity=(1.0, 0.0))) for i in range(n)]
    for i, link in enumerate(links):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(i, 0)))
    for i, coupler in enumerate(couplers):
        scene.add(mbd.Pin(coupler.at(-0.5, 0), links[i].at(0.5, 0)))
        scene.add(mbd.Pin(coupler.at(0.5, 0), links[i + 1].at(0.5, 0)))
    return scene, links, couplers


@pytest.mark.parametrize("n", [1, 2])
def test_windows_turn_as_one_pendulum(n: int) -> None:
    """Positions and velocities of the first top, angles of all links, within 1e-9 (measured 3e-11 m and 1.5e-10 m/s); the energy."""
    reference = BOOK["reference"][str(n)]
    times = [float(t) for t in reference["values"]]
    scene, links, couplers = windows(n)
    result = mbd.simulate(scene, times[-1], rtol=1e-12, solver=mbd.Radau(), t_eval=times)

    def book(*names: str) -> np.ndarray:
        return np.array([[row[name] for name in names] for row in reference["values"].values()], dtype=float)

    assert np.abs(result.position(links[0].at(0.5, 0)) - book("B0x", "B0y")).max() < 1e-9
    assert np.abs(result.velocity(links[0].at(0.5, 0)) - book("vB0x", "vB0y")).max() < 1e-9
    for link in links:
        assert np.abs(0.5 * np.pi - result.angle(link) - book("psi_clockwise_from_vertical")[:, 0]).max() < 1e-9
    for coupler in couplers:
        assert np.abs(result.angle(coupler)).max() < 1e-9
    assert result.energy.kinetic + result.energy.potential == pytest.approx(float(reference["energy_about_ground"]), rel=1e-10)
