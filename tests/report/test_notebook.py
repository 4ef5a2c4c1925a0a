"""What notebooks show: HTML that stands for itself, with the numbers of the objects."""

from __future__ import annotations

import pytest

import mbd

from ..machines import double_pendulum, flexible_pendulum
from .scenes import Reader, embedded, heavy_top, slider_crank


def shown(thing: object) -> Reader:
    return Reader(thing._repr_html_())  # type: ignore[attr-defined]


def test_a_scene_is_a_picture_and_a_table():
    scene = slider_crank().scene
    reader = shown(scene)
    tags = [tag for tag, _ in reader.elements]
    assert tags.count("svg") == 1 and tags.count("tr") == 1 + len(scene.items)
    assert all(item.name in reader.text for item in scene.items) and "x [m]" in reader.text and "spring" in reader.text


def test_a_scene_in_space_is_a_picture_too():
    reader = shown(heavy_top().scene)
    assert [tag for tag, _ in reader.elements].count("svg") == 1 and "inertia = (0.469, 0.469, 0.234) kg m²" in reader.text


def test_a_wrong_scene_shows_its_complaints():
    scene = mbd.Scene()
    scene.add(mbd.Particle(-1.0, (0, 0), name="<b>"))
    reader = shown(scene)
    assert "particle '<b>': mass: expected" in reader.text and "b" not in [tag for tag, _ in reader.elements]


def test_an_empty_scene_shows_why():
    assert "expected at least one item with mass" in shown(mbd.Scene()).text


def test_a_result_is_a_player_in_a_frame_that_reaches_nothing():
    run = slider_crank()
    reader = shown(run)
    ((tag, attributes),) = reader.elements
    assert tag == "iframe" and attributes["sandbox"] == "allow-scripts"
    inner = attributes["srcdoc"]
    assert inner and embedded(inner)["count"] > 10 and "Content-Security-Policy" in inner
    Reader(inner)


def test_a_result_of_a_scene_that_has_grown_says_so():
    scene, tip = double_pendulum()
    run = mbd.simulate(scene, 0.1)
    scene.add(mbd.Spring(tip, scene.ground.at(0, 0), stiffness=1.0))
    reader = shown(run)
    assert "expected the scene as it was in this run" in reader.text and "iframe" not in [tag for tag, _ in reader.elements]


def test_a_player_is_small():
    scene, *_ = flexible_pendulum()
    assert 100_000 < len(mbd.simulate(scene, 0.6, rtol=1e-5)._repr_html_()) < 1_200_000


def test_reports_are_tables():
    run = slider_crank()
    structure = mbd.check(run.scene)
    assert f"{structure.freedoms} by rank" in shown(structure).text and "ground, bearing, crank" in shown(structure).text
    assert f"within {run.audit.position_drift:.1e} of the length" in shown(run.audit).text
    reader = shown(run.stats)
    assert run.stats["solver"] in reader.text and "wall time [s]" in reader.text
    assert run.stats == dict(run.stats) and isinstance(run.stats, dict)


def test_modes_are_a_table():
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=4, E=2e11, A=1e-4, I=8e-10, rho=7800))
    found = mbd.modes(scene, n=5)
    reader = shown(found)
    assert reader.text.count("rigid") == 3 and f"{found.hertz[4]:.6g}" in reader.text and beam.name == "cable 1"


@pytest.mark.parametrize("items", [0, 350])
def test_long_tables_are_cut(items):
    scene = mbd.Scene()
    for k in range(items + 1):
        scene.add(mbd.Particle(1.0, (k, 0)))
    assert ("51 more items are not listed" in shown(scene).text) == (items == 350)
