"""``mbd.check``: counts, loops, redundant joints as sets, singular positions, free motions, edits; each against what is known of the machine."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.dependence import minimal_sets

from ..machines import chain, double_pendulum, flexible_pendulum
from .mechanisms import bricard, four_bar, slider_crank

PINS = ("pin 1", "pin 2", "pin 3", "pin 4")


def test_a_planar_four_bar() -> None:
    report = mbd.check(four_bar(2)[0])
    assert report.bodies == ("crank", "coupler", "rocker") and report.joints == PINS
    assert report.parts == (("crank", "coupler", "rocker", *PINS),)
    (loop,) = report.loops
    assert loop in [
        ("crank", "pin 1", "ground", "pin 4", "rocker", "pin 3", "coupler", "pin 2"),
        ("ground", "pin 1", "crank", "pin 2", "coupler", "pin 3", "rocker", "pin 4"),
    ]
    assert (report.count, report.freedoms, report.free, report.driven) == (1, 1, 1, 0)
    assert report.redundant == () and report.unheld == () and report.complaints == () and not report.singular
    # Instant centres: crank and rocker about their bearings, the coupler where crank and rocker, prolonged, meet: they are parallel.
    assert report.motions == ("'crank' turns about (0, 0), 'coupler' slides along (1, 0), 'rocker' turns about (2, 0)",)


def test_four_spatial_pins_in_a_plane() -> None:
    """Three equations too many: the force along the axes and two moments; the names and an edit that mends it."""
    scene, *_ = four_bar(3)
    report = mbd.check(scene)
    assert (report.count, report.freedoms) == (-2, 1)
    (found,) = report.redundant
    assert found.joints == PINS and found.count == 3 and found.generic and not found.singular
    assert all(labels == ("position z", "axis 1", "axis 2") for labels in found.equations.values())
    assert report.indeterminate == PINS
    (edit,) = found.edit
    assert (edit.joint, edit.release, edit.becomes) == ("pin 4", ("position z", "axis 1", "axis 2"), "point on line")
    text = str(report)
    assert "3 equations too many in every pose among 'pin 1', 'pin 2', 'pin 3', 'pin 4'" in text
    assert "replace 'pin 4' by a point on line" in text and "1 by rank, -2 by count" in text


def test_the_proposed_edit_mends_it() -> None:
    """The joint that the edit names in the place of the pin: the same motion, nothing redundant."""
    scene, *_ = four_bar(3, last=lambda a, b, name: mbd.PointOnLine(a, b, axis=(0, 0, 1), name=name))
    report = mbd.check(scene)
    assert report.redundant == () and (report.count, report.freedoms) == (1, 1)


def test_bricard() -> None:
    """By count a structure, by rank a mechanism, in every pose: one equation follows from the others, and all six pins take part."""
    report = mbd.check(bricard()[0])
    assert (report.count, report.freedoms) == (0, 1)
    (found,) = report.redundant
    assert found.count == 1 and found.elsewhere == 1 and found.joints == tuple(f"pin {k}" for k in range(6))
    assert len(report.loops) == 1 and len(report.loops[0]) == 12
    (edit,) = found.edit
    assert edit.joint == "pin 5" and edit.becomes == "universal joint"


def test_bars_in_line() -> None:
    """A parallelogram folded flat may go on as parallelogram or as antiparallelogram: redundant in this pose only."""
    report = mbd.check(four_bar(2, ((0, 0), (1, 0), (3, 0), (2, 0)))[0])
    assert (report.count, report.freedoms) == (1, 2)
    (found,) = report.redundant
    assert found.count == 1 and found.elsewhere == 0 and not found.generic and report.singular
    assert found.joints == PINS and report.indeterminate == () and found.edit == ()
    assert "in this pose only" in str(report) and "come into line" in str(report)


def test_a_spatial_machine_in_line_is_both() -> None:
    """Folded flat in space: three equations too many everywhere, a fourth in this pose."""
    report = mbd.check(four_bar(3, ((0, 0), (1, 0), (3, 0), (2, 0)))[0])
    assert report.freedoms == 2 and report.singular and report.indeterminate == PINS
    (found,) = report.redundant
    assert found.count == 4 and found.elsewhere == 3 and "here (3 in every pose)" in str(found)
    assert [(edit.joint, edit.becomes) for edit in found.edit] == [("pin 4", "point on line")]


def test_bars_in_line_between_fixed_points() -> None:
    """Two bars in line: by rank they may move, and yet there is no other pose."""
    scene = mbd.Scene()
    middle = scene.add(mbd.Particle(1.0, (1, 0), name="middle"))
    for name, x in (("left", 0), ("right", 2)):
        scene.add(mbd.Distance(middle.at(), scene.ground.at(x, 0), name=name))
    report = mbd.check(scene)
    (found,) = report.redundant
    assert report.freedoms == 1 and found.rigid and found.singular and found.joints == ("left", "right")
    assert "infinitesimal" in str(report) and report.motions == ("'middle' slides along (0, 1)",)


def test_a_dead_centre_names_the_drive() -> None:
    drive = lambda scene, crank, slider: mbd.Prescribed(slider.at(), lambda t: (3.0 - t**2, 0.0), name="piston")  # noqa: E731
    report = mbd.check(slider_crank(0.0, drive)[0])
    (dead,) = [found for found in report.redundant if found.singular]
    assert dead.joints == ("bearing", "crank pin", "wrist", "piston") and dead.drives == ("piston",)
    assert "a dead centre of 'piston'" in str(report) and report.free == 1
    away = mbd.check(slider_crank(1.0, lambda *a: mbd.Prescribed(a[2].at(), lambda t: (2.5 - t, 0.0), name="piston"))[0])
    assert not away.singular and away.free == 0 and (away.freedoms, away.driven) == (1, 2)
    # The drive holds y = 0, as the guide does: too many in every pose.
    assert [(found.joints, found.generic) for found in away.redundant] == [(("guide", "piston"), True)]


def test_a_truss_has_one_pose() -> None:
    """A square with both diagonals: one bar too many, and no other pose to compare with."""
    scene = mbd.Scene()
    corners = [scene.add(mbd.Particle(1.0, place)).at() for place in ((1, 0), (1, 1), (0, 1))]
    points = [scene.ground.at(0, 0), *corners]
    for i in range(4):
        for j in range(i):
            scene.add(mbd.Distance(points[i], points[j], name=f"bar {j}{i}"))
    scene.add(mbd.PointOnLine(corners[0], scene.ground.at(0, 0), axis=(1, 0), name="roller"))
    report = mbd.check(scene)
    (found,) = report.redundant
    assert report.freedoms == 0 and found.elsewhere is None and "in the only pose there is" in str(found)
    assert found.joints == tuple(f"bar {k}" for k in ("01", "02", "12", "03", "13", "23")) and found.edit[0].becomes == ""


def test_sets_are_smallest_and_separate() -> None:
    """A triple pin and a doubled one elsewhere: no set holds a joint that it can do without, none mixes the two places."""
    scene, _, pins = chain(3)
    for copy, k in (("twin", 0), ("triplet", 0), ("double", 2)):
        scene.add(mbd.Pin(pins[k].description.a, pins[k].description.b, name=copy))
    report = mbd.check(scene)
    assert [found.joints for found in report.redundant] == [("pin 0", "twin"), ("pin 0", "triplet"), ("pin 2", "double")]
    assert [found.count for found in report.redundant] == [2, 2, 2]
    assert [found.edit[0].joint for found in report.redundant] == ["twin", "triplet", "double"]
    assert all(found.edit[0].becomes == "" for found in report.redundant)
    assert len(report.loops) == 3


def test_smallest_sets_of_a_space() -> None:
    """Made of three vectors with known supports, mixed at random: the supports come back."""
    rng = np.random.default_rng(3)
    supports = [(0, 1), (1, 2, 3), (4, 5)]
    vectors = np.zeros((12, 3))
    for k, support in enumerate(supports):
        for group in support:
            vectors[2 * group : 2 * group + 2, k] = rng.standard_normal(2)
    basis = np.linalg.qr(vectors @ rng.standard_normal((3, 3)))[0]
    groups = [np.array([2 * g, 2 * g + 1]) for g in range(6)]
    assert [tuple(members) for members, _ in minimal_sets(basis, groups)] == supports


def test_double_pendulum_and_its_parts() -> None:
    scene, _, _ = chain(2)
    scene.add(mbd.Particle(1.0, (9, 9), name="stray"))
    report = mbd.check(scene)
    assert len(report.parts) == 2 and report.freedoms == 4 and len(report.motions) == 4
    assert any(line.endswith("turns about (1, 0)") and "," not in line.replace("(1, 0)", "") for line in report.motions)  # the lower alone
    assert sum("'stray' slides along" in line for line in report.motions) == 2
    assert double_pendulum()[0] and mbd.check(double_pendulum()[0]).free == 2


def test_flexible_scenes_count() -> None:
    scene, *_ = flexible_pendulum(n_elements=3)
    report = mbd.check(scene)
    assert report.free == report.count == scene.build().n - 2 and report.motions == () and "14 more, too many to describe" in str(report)


def test_a_screw_of_space() -> None:
    """A ball on the ground: three turns about axes through it."""
    scene = mbd.Scene((0, 0, -9.81))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(1, 2, 3), name="body"))
    scene.add(mbd.Ball(body.at(0, 0, 1), scene.ground.at(1, 2, 4), name="ball"))
    report = mbd.check(scene)
    assert report.free == 3 and len(report.motions) == 3
    for line in report.motions:
        axis, through = (np.fromstring(text.split(")")[0], sep=",") for text in line.split("(")[1:])
        assert np.linalg.norm(np.cross(through - (1, 2, 4), axis)) < 2e-3


def test_what_nothing_holds_is_named() -> None:
    scene = mbd.Scene((0, 0, -9.81))
    thin = scene.add(mbd.RigidBody(mass=1.0, inertia=(0, 1, 1), position=(0, 0, 0), name="needle"))
    scene.add(mbd.Ball(thin.at(-1, 0, 0), scene.ground.at(-1, 0, 0)))
    report = mbd.check(scene)
    assert report.complaints and all(name.startswith("needle axis") for name in report.unheld) and report.unheld
    assert "give it mass or hold it" in str(report)


def test_impossible_scenes_are_still_described() -> None:
    scene, links, _ = four_bar(2)
    scene.add(mbd.Distance(links[1].at(), scene.ground.at(9, 9), length=1.0, name="short"))
    report = mbd.check(scene)
    assert "'short'" in report.complaints[0] and "cannot be assembled" in str(report) and len(report.bodies) == 3


def test_other_states() -> None:
    """The same machine, checked where it is in line."""
    scene, *_ = four_bar(2, ((0, 0), (0, 1), (2, 1), (2, 0)))
    assert not mbd.check(scene).singular
    folded = four_bar(2, ((0, 0), (1, 0), (3, 0), (2, 0)))[0].build()
    assert mbd.check(scene, mbd.State(folded.q0, folded.v0)).singular


def test_networkx_is_for_loops_only() -> None:
    """Neither runs nor kinematics load it."""
    code = """
import sys, mbd
scene = mbd.Scene()
body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
scene.add(mbd.Pin(body.at(), scene.ground.at(0, 0)))
scene.add(mbd.Motor(body, scene.ground, angle=lambda t: t))
mbd.kinematics(scene, [0.0, 1.0])
assert "networkx" not in sys.modules
mbd.check(scene)
assert "networkx" in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[2])


@pytest.mark.parametrize("shift,size", [((1e3, -2e3), 1.0), ((0, 0), 1e-3), ((5, 5), 1e3)])
def test_neither_units_nor_the_origin_matter(shift: Any, size: float) -> None:
    points = np.array(((0, 0), (0, 1), (2, 1.5), (2, 0))) * size + np.array(shift) * size
    for dimension, count in ((2, 0), (3, 3)):
        report = mbd.check(four_bar(dimension, points)[0])
        assert report.freedoms == 1 and sum(found.count for found in report.redundant) == count
        assert all(found.generic and found.edit for found in report.redundant)
