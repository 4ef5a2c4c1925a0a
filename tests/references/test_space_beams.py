"""What thin cables can say of two spatial beam benchmarks, and that they say so of the rest.

A cable has one bending stiffness and no torsion. The Princeton beam bends in a plane of its own where its load lies along a principal axis
(0 and 90 degrees); at angles between it needs two stiffnesses and torsion. The 45 degree bend is curved at rest and twists under its load.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import trapezoid

import mbd

from .. import machines

BOOK = machines.data("princeton_beam")
P = BOOK["parameters"]
BEND = machines.data("bend45_cantilever")["parameters"]


def strip(stiffness: float, load: float, n: int = 32) -> tuple[mbd.Equilibrium, mbd.AncfCable]:
    """The clamped strip under a load down at its tip; its stiffness in bending as given."""
    scene, modulus = mbd.Scene(gravity=(0, 0)), P["EA"] / P["A"]
    beam = scene.add(mbd.AncfCable((0, 0), (P["L"], 0), n_elements=n, E=modulus, A=P["A"], I=stiffness / modulus, rho=1.0))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0)))
    scene.add(mbd.Force(beam.end, (0.0, -load)))
    return mbd.equilibrium(scene), beam


@pytest.mark.parametrize("load", ["4.448", "8.896", "13.345"])
@pytest.mark.parametrize(("angle", "stiffness", "share"), [("0", "EI_strong", 2e-3), ("90", "EI_weak", 0.2)])
def test_princeton_beam_in_its_planes(angle: str, stiffness: str, share: float, load: str) -> None:
    """The reference has shear, a cable none: shear by itself moves the tip by the integral of P cos(angle) n / GA, up to 7.5e-6 m of 0.2 m.
    With that added the tips agree to a small share of it: what shear changes of the lever arms, more where the beam bends far."""
    u = np.array(BOOK["reference"][f"P={load} beta={angle}"]["u"])
    expected = np.array((u[0], -np.hypot(u[1], u[2])))
    found, beam = strip(P[stiffness], float(load))
    s = np.linspace(0.0, 1.0, 101)
    turn = np.array([found.angle(beam.at(fraction)) for fraction in s])
    gap = -float(load) * np.cos(turn) / P["GA_k5/6"] * P["L"]
    shear = np.array([trapezoid(-np.sin(turn) * gap, s), trapezoid(np.cos(turn) * gap, s)])
    tip = found.position(beam.end) - (P["L"], 0.0)
    assert np.linalg.norm(tip + shear - expected) < share * np.linalg.norm(shear)
    assert np.linalg.norm(shear) < 4e-5 * P["L"]


def test_two_bending_stiffnesses_are_refused() -> None:
    """The strip under an oblique load cannot be stated."""
    scene = mbd.Scene(gravity=(0, 0, 0))
    scene.add(mbd.AncfCable((0, 0, 0), (P["L"], 0, 0), n_elements=8, E=P["E"], A=P["A"], I=(P["I_weak"], P["I_strong"]), rho=2800, name="strip"))
    with pytest.raises(mbd.SceneError, match=r"cable 'strip': I: expected"):
        mbd.equilibrium(scene)


def test_a_spatial_cable_that_is_curved_at_rest_is_refused() -> None:
    """The 45 degree bend cannot be stated either, and the message says why."""
    scene, angle = mbd.Scene(gravity=(0, 0, 0)), np.radians(np.linspace(0.0, 45.0, 9))
    nodes = BEND["R"] * np.stack((np.sin(angle), 1.0 - np.cos(angle), 0.0 * angle), axis=1)
    tangents = np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)
    scene.add(mbd.AncfCable(nodes=nodes, tangents=tangents, E=BEND["E"], A=1.0, I=1.0 / 12.0, rho=1.0, name="bend"))
    with pytest.raises(mbd.SceneError, match=r"cable 'bend': nodes: expected a straight rest shape.*without torsion"):
        mbd.equilibrium(scene)
