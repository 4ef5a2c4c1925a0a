"""The page as data and text: complete, self-contained, harmless, and right in its numbers."""

from __future__ import annotations

import re
import sys
import warnings
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.report.page import page

from ..machines import chain, double_pendulum
from .scenes import Reader, embedded, heavy_top, main_job, numbers, slider_crank

EVIL = "</script><script>alert('x')</script><img src=x onerror=alert(1)>\"'&\u2028<!--title-->"


@pytest.fixture(scope="module")
def run() -> mbd.Result:
    return slider_crank()


@pytest.fixture(scope="module")
def reader(run) -> Reader:
    outputs = {"tip": run.scene["rod"].end, "bearing": run.scene["bearing"], "turn": run.scene["crank"], "twice": lambda r: 2.0 * r.q[:, :2]}
    return Reader(page(run, "A crank", outputs))


def plots(reader: Reader, group: str) -> dict[str, dict[str, Any]]:
    return {plot["title"]: plot for plot in reader.data["plots"] if plot["group"] == group}


def curves(plot: dict[str, Any]) -> dict[str, np.ndarray]:
    return {label: numbers(text) for label, text in plot["curves"]}


def test_it_loads_nothing(reader, run):
    """No address but the name of SVG's language, no element or style that fetches, and a policy that would forbid it."""
    text = page(run, "A crank")
    assert set(re.findall(r"https?://[^\s\"'<>]*", text)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"url\(|@import|fetch\(|XMLHttpRequest|WebSocket|import\(", text)
    fetching = [(tag, attributes) for tag, attributes in reader.elements if {"src", "href", "srcset", "data"} & attributes.keys()]
    assert fetching == [("link", {"rel": "icon", "href": "data:,"})]
    policy = next(attributes["content"] for tag, attributes in reader.elements if attributes.get("http-equiv") == "Content-Security-Policy")
    assert policy and policy.startswith("default-src 'none'")


def test_the_main_job_takes_less_than_three_megabytes():
    _, text = main_job()
    assert 100_000 < len(text.encode()) < 3_000_000
    assert "<title>flexible pendulum</title>" in text and len(numbers(embedded(text)["times"], "<f8")) > 400


def test_names_do_no_harm():
    """Names of items, outputs, events and of the page stay text, wherever they appear."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name=EVIL))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0), name="pin " + EVIL))
    event = mbd.Event(lambda state: state.q[0] - 0.4, name="event " + EVIL)
    result = mbd.simulate(scene, 0.3, events=[event])
    found = Reader(page(result, EVIL, {"tip " + EVIL: body.at(0.5, 0)}))
    harmless = Reader(page(mbd.simulate(*double_pendulum()[:1], 0.1), "x"))
    scripts = [tag for tag, _ in found.elements if tag == "script"]
    assert scripts == ["script", "script"] and not [tag for tag, _ in found.elements if tag == "img"]
    assert not [name for _, attributes in found.elements for name in attributes if name.startswith("on")]
    assert found.scripts[1] == harmless.scripts[1]  # nothing of the user's in what runs
    assert found.text.count(EVIL) >= 4 and found.data["events"] == {"event " + EVIL: result.events[event].t.tolist()}
    assert {item for item, *_ in found.data["shapes"]} == {EVIL, "pin " + EVIL, "tip " + EVIL}


def test_points_and_outputs_are_the_motion(run, reader):
    data = reader.data
    times, origin = numbers(data["times"], "<f8"), np.array(data["origin"])
    points = numbers(data["points"]).reshape(len(times), data["count"], 2) + origin
    (output,) = [shape for shape in data["shapes"] if shape[2] == "output"]
    tip = run.position(run.scene["rod"].end, t=times)
    assert output[0] == "tip" and np.max(np.abs(points[:, output[3][0]] - tip)) < 1e-6
    found = plots(reader, "outputs")
    assert [(plot["title"], plot["unit"]) for plot in found.values()] == [("tip", "m"), ("turn", "rad"), ("twice", "")]
    np.testing.assert_allclose(curves(found["tip"])["y"], tip[:, 1], atol=1e-6)
    np.testing.assert_allclose(curves(found["turn"])["angle"], run.angle(run.scene["crank"], t=times), rtol=1e-6, atol=1e-6)
    assert list(curves(found["twice"])) == ["twice 0", "twice 1"]


def test_far_from_the_origin_nothing_is_lost():
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((1e6, -2e6), (1e6 + 1, -2e6), mass=1.0))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(1e6, -2e6)))
    run = mbd.simulate(scene, 0.3)
    data = embedded(page(run, "x", {"end": body.at(0.5, 0)}))
    times = numbers(data["times"], "<f8")
    points = numbers(data["points"]).reshape(len(times), data["count"], 2) + data["origin"]
    (index,) = next(shape[3] for shape in data["shapes"] if shape[2] == "output")
    assert np.max(np.abs(points[:, index] - run.position(body.at(0.5, 0), t=times))) < 1e-6


def test_energies_and_reactions_are_those_of_the_result(run, reader):
    times = numbers(reader.data["times"], "<f8")
    energy = curves(plots(reader, "energy")["Energy"])
    np.testing.assert_allclose(energy["kinetic"] + energy["elastic"] + energy["potential"], energy["total"], rtol=1e-5, atol=1e-5)
    near = np.interp(run.t, times, energy["kinetic"])
    np.testing.assert_allclose(near, run.energy.kinetic, atol=0.02 * np.ptp(run.energy.kinetic))
    reactions = plots(reader, "reactions")
    assert list(reactions) == ["bearing: force"] and reactions["bearing: force"]["unit"] == "N"  # a pin has no moment, and it was chosen
    expected = run.reaction(run.scene["bearing"], t=times)
    np.testing.assert_allclose(curves(reactions["bearing: force"])["force x"], expected[:, 0], rtol=1e-5, atol=1e-4)


def test_the_drift_is_that_of_the_audit(run, reader):
    found = plots(reader, "audit")
    drift, energy = curves(found["Drift of the joints"]), curves(found["Imbalance of the energy"])
    assert max(drift["|g| / length"]) == pytest.approx(run.audit.position_drift, rel=1e-6)
    assert max(drift["|G v| / speed"]) == pytest.approx(run.audit.velocity_drift, rel=1e-6)
    assert max(energy["|energy - start - work|"]) == pytest.approx(run.audit.energy_error, rel=1e-6)
    assert all(plot["log"] for plot in found.values())


def test_sections_say_what_the_objects_say(run, reader):
    structure = mbd.check(run.scene)
    for said in (
        f"{structure.freedoms} by rank",
        str(run.stats["steps"]),
        run.stats["solver"],
        f"{run.audit.work:.6g} J",
        "n_elements = 2",
        "E = 1000000 Pa",
        "speed = 8 rad/s",
        "stiffness = 20 N/m",
        "a function of t",
        "crank at (0, 0); ground at (0, 0)",
        f"mbd.simulate(scene, t_end=0.2, rtol=1e-05, solver=mbd.{run.trajectory.solver!r})",
        mbd.__version__,
        np.__version__,
    ):
        assert said in reader.text, said


def test_what_moves_is_followed_where_nothing_is_chosen(run):
    data = embedded(page(run, "x"))
    assert [item for item, _, form, _ in data["shapes"] if form == "output"] == ["crank", "rod.end", "block"]
    joints = {plot["title"].split(":")[0] for plot in data["plots"] if plot["group"] == "reactions"}
    assert joints == {"bearing", "crank pin", "block pin", "slide", "motor"}


def test_the_times_of_a_result_do_not_matter():
    """The animation is of the whole run, whatever t_eval asked for."""
    run = mbd.simulate(double_pendulum()[0], 0.3, t_eval=[0.3])
    data = embedded(page(run, "x"))
    assert numbers(data["times"], "<f8")[[0, -1]].tolist() == [0.0, 0.3] and len(run.t) == 1
    assert [shape[0] for shape in data["shapes"] if shape[2] == "output"] == ["particle 1", "particle 2"]


def test_space(tmp_path):
    run = heavy_top()
    reader = Reader(page(run, "top", {"top": run.scene["top"], "rim": run.scene["top"].at(0.1, 0, 0), "tip": run.scene["tip"]}))
    data = reader.data
    assert data["dimension"] == 3 and data["up"] == 2
    assert set(curves(plots(reader, "outputs")["top"])) == {f"angular velocity {axis}" for axis in "xyz"}
    assert set(curves(plots(reader, "outputs")["rim"])) == {"x", "y", "z"}
    assert set(plots(reader, "reactions")) == {"tip: force"}


def test_errors_of_a_verification():
    scene = mbd.Scene()
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    found = mbd.verify(scene, 0.5, outputs={"tip": rod.at(0.5, 0), "turn": rod})
    reader = Reader(page(found.result, "x", verification=found))
    assert all(line in reader.text for line in found.remarks()) and {"tip", "turn", "ok"} <= set(reader.texts)
    plots = {plot["unit"]: curves(plot) for plot in reader.data["plots"] if plot["group"] == "errors"}
    np.testing.assert_allclose(plots["rad"]["turn"], found.errors["turn"], rtol=1e-6)
    np.testing.assert_allclose(plots["m"]["tip"], found.errors["tip"], rtol=1e-6)


def test_indeterminate_reactions_are_named_and_no_warning_is_raised():
    scene = mbd.Scene(gravity=(0.0, 0.0))
    plate = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    for k, x in enumerate((-1.0, 1.0)):
        scene.add(mbd.Pin(plate.at(x, 0), scene.ground.at(x, 0), name=f"nail {k}"))
    with pytest.warns(mbd.SceneWarning, match="redundant"):
        run = mbd.simulate(scene, 0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        reader = Reader(page(run, "x"))
    assert "redundant joints: nail 0, nail 1" in reader.text
    assert all("Indeterminate" in plot["note"] for plot in reader.data["plots"] if plot["group"] == "reactions")


def test_independent_parts_and_many_joints():
    scene, *_ = chain(9)
    scene.add(mbd.AncfCable((0, 5), (1, 5), n_elements=2, E=1e6, A=1e-3, I=1e-7, rho=1000))
    run = mbd.simulate(scene, 0.05)
    reader = Reader(page(run, "x"))
    drift = curves(plots(reader, "audit")["Drift of the joints"])
    assert max(drift["|g| / length"]) == pytest.approx(run.audit.position_drift, rel=1e-6)
    notes = [plot["note"] for plot in reader.data["plots"] if plot["group"] == "reactions"]
    assert "3 more joints are not shown" in notes[-1] and len(notes) == 6
    assert "independent parts" in reader.text and all(part["solver"] in reader.text for part in run.stats["parts"])


def test_a_result_from_a_file_says_what_it_lost(run, tmp_path):
    with pytest.warns(mbd.SceneWarning):
        run.save(tmp_path / "run.npz")
    mbd.load(tmp_path / "run.npz").report(tmp_path / "run.html")
    reader = Reader((tmp_path / "run.html").read_text(encoding="utf-8"))
    assert not reader.data["between"] and len(numbers(reader.data["times"], "<f8")) == len(run.t)
    assert "not to be had" in str(reader.data["plots"])


def test_kinematics_have_a_report_too():
    """With the work that the audit accounts for, and the call that it was."""
    scene = mbd.Scene()
    crank = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Motor(crank, scene.ground, angle=lambda t: t**2))
    run = mbd.kinematics(scene, np.linspace(0.0, 1.0, 9))
    reader = Reader(page(run, "x"))
    assert "mbd.kinematics(scene, times)  # 9 from 0 to 1 s" in reader.text
    imbalance = curves(plots(reader, "audit")["Imbalance of the energy"])["|energy - start - work|"]
    assert max(imbalance) == pytest.approx(run.audit.energy_error, rel=1e-6) and run.audit.work > 1.0 and run.audit.energy_error < 1e-9


def test_a_run_that_stopped_has_a_report():
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Force(body.at(0, 0), lambda t: (1.0, 0.0) if t < 0.1 else (np.nan, 0.0), name="broken"))
    with pytest.raises(mbd.SimulationError) as caught:
        mbd.simulate(scene, 1.0)
    data = embedded(page(caught.value.result, "x"))
    assert 0.0 < numbers(data["times"], "<f8")[-1] <= 0.1


@pytest.mark.parametrize(
    ("outputs", "complaint"),
    [
        (["tip"], "outputs: expected names"),
        ({"": None}, r"expected a text for a name, found ''\noutputs: '': expected a marker"),
        ({"tip": 3}, "'tip': expected a marker, joint, measure or body, or a function of the result, found 3"),
        ({"f": lambda r: np.zeros(2)}, r"'f': expected a function that returns \d+ values, one for each time, found \(2,\)"),
        ({"other": mbd.Scene().ground.at(0, 0)}, "'other': expected something of this scene"),
    ],
)
def test_bad_outputs(run, outputs, complaint):
    with pytest.raises(mbd.SceneError, match=complaint):
        page(run, "x", outputs)


def test_a_scene_that_has_grown():
    scene, _ = double_pendulum()
    run = mbd.simulate(scene, 0.1)
    scene.add(mbd.Particle(1.0, (5, 5)))
    with pytest.raises(ValueError, match="report: expected the scene as it was in this run"):
        page(run, "x")


def test_it_needs_no_matplotlib(run, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    run.report(tmp_path / "run.html")
    assert (tmp_path / "run.html").stat().st_size > 50_000
