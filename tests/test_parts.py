"""Independent parts of a scene: what only the ground connects runs as if it were alone."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.parts import Part
from mbd.solvers.linear import Linear
from mbd.trajectory import Trajectory

from .test_archive import planar, spatial
from .test_damaged_files import refused, rewrite


def springy(scene: mbd.Scene, x: float, stiffness: float, name: str) -> Any:
    """A particle on a spring, beside its rest."""
    ball = scene.add(mbd.Particle(1.0, (x + 1.0, 0.2), name=name))
    scene.add(mbd.Spring(ball.at(), scene.ground.at(x, 0), stiffness=stiffness, length=1.0, name=f"{name} spring"))
    return ball


def double(scene: mbd.Scene, x: float, name: str, angle: float = 0.0, size: float = 1.0) -> Any:
    """A double pendulum of two rods; returns the lower one."""
    middle, end = (size * k * np.array((np.cos(angle), np.sin(angle))) + (x, 0) for k in (1, 2))
    upper = scene.add(mbd.RigidBody.rod((x, 0), middle, mass=1.0, name=f"{name} upper"))
    lower = scene.add(mbd.RigidBody.rod(middle, end, mass=1.0, name=name))
    scene.add(mbd.Pin(upper.at(-0.5 * size, 0), scene.ground.at(x, 0), name=f"{name} pivot"))
    scene.add(mbd.Pin(upper.at(0.5 * size, 0), lower.at(-0.5 * size, 0), name=f"{name} elbow"))
    return lower


def cable(scene: mbd.Scene, x: float, E: float, name: str) -> Any:
    rod = scene.add(mbd.AncfCable((x, 0), (x + 1.2, 0), n_elements=4, E=E, A=1.8e-3, I=1.215e-8, rho=5540, name=name))
    scene.add(mbd.Pin(rod.start, scene.ground.at(x, 0), name=f"{name} pivot"))
    return rod


def mixed() -> mbd.Scene:
    """Parts of every kind: elastic, rigid, driven, a free body and a particle on a line."""
    scene = mbd.Scene()
    springy(scene, 0.0, 50.0, "soft")
    double(scene, 5.0, "arm")
    wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(9, 0), name="wheel"))
    scene.add(mbd.Pin(wheel.at(0.1, 0), scene.ground.at(9.1, 0), name="hub"))
    scene.add(mbd.Motor(wheel, scene.ground, angle=lambda t: 0.5 * t**2, name="motor"))
    scene.add(mbd.RigidBody.box((1, 2), mass=1.0, position=(-3, 0), velocity=(1, 3), angular_velocity=2.0, name="free"))
    bead = scene.add(mbd.Particle(1.0, (-6, 0), name="bead"))
    scene.add(mbd.PointOnLine(bead.at(), scene.ground.at(-6, 0), axis=(1, -1), name="wire"))
    return scene


def as_one(scene: mbd.Scene, monkeypatch: pytest.MonkeyPatch) -> mbd.Scene:
    monkeypatch.setattr(scene, "parts", lambda: [Part.whole(scene)])
    return scene


# Who belongs together.


def test_what_only_the_ground_connects_is_apart():
    scene = mixed()
    names = [part.items for part in scene.parts()]
    assert names[0] == ("soft", "soft spring") and names[2] == ("wheel", "hub", "motor")
    assert names[1][-3:] == ("free", "bead", "wire") and "arm" in names[1], "rigid parts of similar pace share a system"
    assert len(names) == 3 and scene.parts() is scene.parts()
    scene.add(mbd.Spring(scene["soft"].at(), scene["wheel"].at(), stiffness=1.0))
    assert len(scene.parts()) == 2


@pytest.mark.parametrize("build", [mixed, planar, spatial])
def test_coordinates_and_equations_keep_their_order(build):
    scene = build()
    whole, parts = scene.build(), scene.parts()
    for what in ("columns", "rows"):
        together = np.concatenate([getattr(part, what) for part in parts])
        np.testing.assert_array_equal(np.sort(together), np.arange(whole.n if what == "columns" else whole.m))
    for part in parts:
        assert part.system.owners == [whole.owners[k] for k in part.columns]
        assert part.system.joints.labels == [whole.joints.labels[k] for k in part.rows]
        for name in ("q0", "v0", "weight", "levers"):
            np.testing.assert_array_equal(getattr(part.system, name), getattr(whole, name)[part.columns])


def test_a_scene_of_one_part_is_built_once():
    scene = mbd.Scene()
    double(scene, 0.0, "arm")
    (part,) = scene.parts()
    assert part.system is scene.build() and part.columns == slice(None)
    assert "parts" not in mbd.simulate(scene, 0.1).stats


# As if alone.


def test_a_soft_and_a_stiff_cable_cost_what_they_cost_alone():
    both = mbd.Scene()
    cable(both, 0.0, 0.7e6, "soft"), cable(both, 500.0, 1e9, "stiff")
    result = mbd.simulate(both, 0.05, rtol=1e-4)
    for k, (E, name) in enumerate(((0.7e6, "soft"), (1e9, "stiff"))):
        scene = mbd.Scene()
        cable(scene, 500.0 * k, E, name)
        alone, own, piece = mbd.simulate(scene, 0.05, rtol=1e-4), result.stats["parts"][k], result.trajectory.pieces()[k]
        counts = ("steps", "rejected", "failed", "newton iterations", "factorizations", "solver", "reason")
        assert [own[name] for name in counts] == [alone.stats[name] for name in counts]
        for name in ("t", "q", "v"):
            np.testing.assert_array_equal(getattr(piece, name), getattr(alone.trajectory, name))
    soft, stiff = result.stats["parts"]
    assert soft["steps"] < 0.7 * stiff["steps"], "or the test shows nothing"
    assert result.stats["newton iterations"] == soft["newton iterations"] + stiff["newton iterations"]
    assert len(result.t) == stiff["steps"] + 1


def test_each_part_has_a_solver_of_its_own():
    scene = mbd.Scene()
    cable(scene, 0.0, 0.7e6, "rod"), double(scene, 5.0, "arm")
    flexible, rigid = mbd.simulate(scene, 0.05).stats["parts"]
    assert flexible["solver"].startswith("Radau") and "elastic" in flexible["reason"]
    assert "explicit" in rigid["solver"] and rigid["items"] == ["arm upper", "arm", "arm pivot", "arm elbow"]


def test_parts_agree_with_the_scene_as_one(monkeypatch):
    times = np.linspace(0.0, 0.5, 6)
    apart, one = mixed(), as_one(mixed(), monkeypatch)
    a, b = (mbd.simulate(scene, 0.5, rtol=1e-12, t_eval=times) for scene in (apart, one))
    assert len(a.stats["parts"]) == 3 and "parts" not in b.stats
    np.testing.assert_array_equal(a.t, times)
    np.testing.assert_allclose(a.q, b.q, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(a.v, b.v, rtol=0.0, atol=1e-9)
    for joint in ("arm pivot", "arm elbow", "hub", "motor", "wire"):
        forces = [r.reaction(r.scene[joint]) for r in (a, b)]
        np.testing.assert_allclose(*forces, rtol=0.0, atol=1e-8 * np.abs(forces[1]).max())
        np.testing.assert_allclose(a.reaction(apart[joint], t=0.3), forces[1][3], rtol=0.0, atol=1e-8 * np.abs(forces[1]).max())
    for name in ("arm", "wheel", "free"):
        for ask in ("angle", "rotation", "angular_velocity"):
            np.testing.assert_allclose(*(getattr(r, ask)(r.scene[name]) for r in (a, b)), rtol=0.0, atol=1e-8)
    for ask in ("position", "velocity", "acceleration"):
        for t in (None, 0.2, [[0.1, 0.2]]):
            np.testing.assert_allclose(*(getattr(r, ask)(r.scene["soft"].at(), t=t) for r in (a, b)), rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(a.energy.total, b.energy.total, rtol=1e-10)
    assert a.audit.work == pytest.approx(b.audit.work, rel=1e-8) and a.audit.work != 0.0
    assert a.audit.position_drift < 1e-12 and a.audit.velocity_drift < 1e-10 and len(a.audit.parts) == 3
    assert a.audit.energy_error < 1e-9 and a.audit.energy_error == sum(part.energy_error for part in a.audit.parts)


def test_markers_on_the_ground_need_no_part():
    scene = mixed()
    result = mbd.simulate(scene, 0.1)
    assert np.all(result.position(scene.ground.at(1, 2)) == (1, 2)) and len(result.position(scene.ground.at())) == len(result.t)
    assert np.all(result.angle(scene.ground.at()) == 0.0)


def test_values_at_the_steps_are_those_asked_for(monkeypatch):
    """Of all parts, at the steps of the one that took most, and nothing is interpolated before it is asked for."""
    scene = mixed()
    calls: list[int] = []
    at = Trajectory.at
    monkeypatch.setattr(Trajectory, "at", lambda self, *args: calls.append(id(self)) or at(self, *args))
    result = mbd.simulate(scene, 0.3)
    assert not calls and len(result.audit.parts) == 3
    result.position(scene["soft"].at()), result.position(scene["soft"].at())
    assert calls == [id(result.trajectory.pieces()[0])]
    assert result.q.shape == (len(result.t), scene.build().n) and np.isfinite(result.q).all() and np.isfinite(result.v).all()
    np.testing.assert_array_equal(result.q[-1], result.final.q)
    np.testing.assert_allclose(result.position(scene["soft"].at(), t=result.t), result.position(scene["soft"].at()), atol=1e-14)


# Bundles.


def test_a_hundred_pendulums_take_the_steps_of_one(monkeypatch):
    """They share a system: evaluations do not grow with their number, unknowns and numbers in the factors linearly."""
    counts, unknowns = [], []
    for many in (1, 10, 100):
        scene = mbd.Scene()
        tips = [double(scene, 3.0 * k, f"arm {k}").at() for k in range(many)]
        result = mbd.simulate(scene, 1.0, rtol=1e-8)
        counts.append([result.stats[name] for name in ("steps", "newton iterations", "factorizations")])
        unknowns.append(result.trajectory.pieces()[0].linear.size)
        paths = [result.position(tip) - (3.0 * k, 0) for k, tip in enumerate(tips)]
        assert max(np.abs(path - paths[0]).max() for path in paths) < 1e-9
    assert counts[0] == counts[1] == counts[2] and unknowns == [14, 140, 1400]


def test_copies_of_an_elastic_part_share_a_system_and_others_do_not():
    scene = mbd.Scene()
    for k in range(4):
        springy(scene, 3.0 * k, 50.0 + (k == 3), f"ball {k}")
    cable(scene, 20.0, 0.7e6, "rod"), cable(scene, 30.0, 0.7e6, "twin"), cable(scene, 40.0, 0.7e7, "stiff")
    assert [part.items[::2] for part in scene.parts()] == [("ball 0", "ball 1", "ball 2"), ("ball 3",), ("rod", "twin"), ("stiff",)]
    result = mbd.simulate(scene, 0.1)
    for name, twin, apart in (("ball 0", "ball 1", 3.0), ("rod", "twin", 10.0)):
        a, b = (scene[x].at(1.0) if "ball" not in x else scene[x].at() for x in (name, twin))
        np.testing.assert_allclose(result.position(b) - (apart, 0), result.position(a), rtol=0.0, atol=1e-9)


def test_accuracy_does_not_depend_on_what_is_far_away():
    near, far = mbd.Scene(), mbd.Scene()
    for scene, x in ((near, 3.0), (far, 3000.0)):
        double(scene, 0.0, "arm"), double(scene, x, "twin")
    a, b = (mbd.simulate(scene, 1.0, rtol=1e-6) for scene in (near, far))
    assert a.stats["steps"] == b.stats["steps"]
    np.testing.assert_allclose(a.position(near["arm"].at()), b.position(far["arm"].at()), atol=1e-8)


def test_a_fast_part_is_not_bundled_with_a_slow_one():
    scene = mbd.Scene()
    double(scene, 0.0, "arm")
    scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(5, 0), angular_velocity=1000.0, name="gyro"))
    double(scene, 9.0, "twin")
    assert [len(part.items) for part in scene.parts()] == [8, 1]
    small = mbd.Scene()
    double(small, 0.0, "large", size=100.0), double(small, 0.0, "small", size=1e-3)
    assert len(small.parts()) == 2


def test_the_order_of_items_does_not_matter():
    def build(order: tuple[int, ...]) -> mbd.Scene:
        scene = mbd.Scene()
        add: list[Callable[[], Any]] = [
            lambda: springy(scene, 0.0, 50.0, "soft"),
            lambda: double(scene, 5.0, "arm", 0.3),
            lambda: springy(scene, 9.0, 5000.0, "stiff"),
        ]
        for k in order:
            add[k]()
        return scene

    first, second = (mbd.simulate(build(order), 0.3) for order in ((0, 1, 2), (2, 0, 1)))
    for name in ("soft", "arm", "stiff"):
        np.testing.assert_allclose(*(r.position(r.scene[name].at()) for r in (first, second)), rtol=0.0, atol=1e-13)


# Times.


def test_jumps_land_only_steps_of_their_part():
    scene = mbd.Scene()
    springy(scene, 0.0, 50.0, "still")
    pushed = springy(scene, 5.0, 50.0, "pushed")
    scene.add(mbd.Force(pushed.at(), mbd.piecewise(lambda t: (1.0, 0.0) if t > 0.123456 else (0.0, 0.0), at=[0.123456])))
    still, moved = mbd.simulate(scene, 0.3).trajectory.pieces()
    assert 0.123456 in moved.t and 0.123456 not in still.t


@pytest.mark.parametrize("solver", [mbd.GeneralizedAlpha(0.01), mbd.Gauss(0.01), mbd.Radau(3, step=0.01)], ids=lambda s: type(s).__name__)
def test_fixed_steps_are_common(solver):
    scene = mbd.Scene()
    springy(scene, 0.0, 50.0, "soft"), springy(scene, 5.0, 500.0, "stiff")
    result = mbd.simulate(scene, 0.1, solver=solver)
    first, second = result.trajectory.pieces()
    np.testing.assert_array_equal(first.t, second.t)
    np.testing.assert_array_equal(result.t, first.t)
    assert result.stats["steps"] == 20 and result.stats["reason"] == "chosen by the user"


def test_runs_continue():
    scene = mixed()
    there = mbd.simulate(scene, 0.2, rtol=1e-10)
    onward, straight = mbd.simulate(scene, 0.4, rtol=1e-10, start=there.final), mbd.simulate(scene, 0.4, rtol=1e-10)
    np.testing.assert_allclose(onward.final.q, straight.final.q, atol=1e-8)


def test_a_terminal_event_stops_all_parts():
    scene = mixed()
    low = mbd.Event(lambda state: state.position(scene["bead"].at())[1] + 0.05, terminal=True)
    result = mbd.simulate(scene, 1.0, rtol=1e-9, events=[low])
    fall = np.sqrt(2 * 0.05 / (0.5 * 9.81))
    assert result.t[-1] == pytest.approx(fall, abs=1e-8) and result.final.t == result.t[-1] and len(result.trajectory.pieces()) == 1
    free = mbd.simulate(scene, 1.0, rtol=1e-9)
    q, _ = free.trajectory.at(np.array([fall]))
    np.testing.assert_allclose(result.final.q, q[0], atol=1e-7)


def test_a_loaded_run_answers_as_the_saved_one(tmp_path):
    for chosen in (None, [0.0, 0.03, 0.1]):
        scene = mbd.Scene()
        springy(scene, 0.0, 50.0, "soft"), double(scene, 5.0, "arm"), springy(scene, 9.0, 5000.0, "stiff")
        saved = mbd.simulate(scene, 0.1, t_eval=chosen)
        saved.save(tmp_path / "run.npz")
        loaded = mbd.load(tmp_path / "run.npz")
        assert loaded.stats == saved.stats and len(loaded.trajectory.pieces()) == 3 and str(loaded.audit) == str(saved.audit)
        for a, b in zip(loaded.trajectory.pieces(), saved.trajectory.pieces()):
            assert type(a.solver) is type(b.solver) and all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("t", "q", "v", "work"))
        np.testing.assert_array_equal(loaded.t, saved.t)
        np.testing.assert_allclose(loaded.q, saved.q, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(loaded.reaction(loaded.scene["arm pivot"], t=0.05), saved.reaction(scene["arm pivot"], t=0.05), atol=1e-7)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda arrays, head: head["parts"].pop(), "parts: expected 2 of this scene, found 1"),
        (lambda arrays, head: head["parts"][0].update(steps=-1), "parts: expected counts of steps"),
        (lambda arrays, head: head["parts"][0].update(steps=1), "t: expected .* numbers in one row"),
        (lambda arrays, head: head["parts"][1]["solver"].update({"class": "System"}), "solver: expected one of"),
        (lambda arrays, head: arrays["q"].__setitem__(3, np.nan), "q: expected finite"),
        (lambda arrays, head: head.update(parts=[]), "expected finite numbers of shape|damaged|found more"),
    ],
)
def test_damaged_parts_are_refused(tmp_path, edit, message):
    scene = mbd.Scene()
    springy(scene, 0.0, 50.0, "soft"), springy(scene, 5.0, 5000.0, "stiff")
    mbd.simulate(scene, 0.1).save(tmp_path / "run.npz")
    rewrite(tmp_path / "run.npz", edit)
    refused(tmp_path / "run.npz", message)


# What goes wrong.


def test_a_part_that_stops_stops_the_run_at_its_time():
    def push(t: float) -> tuple[float, float]:
        return (1.0, 0.0) if t < 0.2 else (np.nan, 0.0)

    scene = mbd.Scene()
    springy(scene, 0.0, 40.0, "before")
    pushed = springy(scene, 5.0, 50.0, "pushed")
    scene.add(mbd.Force(pushed.at(), push, name="push"))
    springy(scene, 9.0, 50.0, "after")
    with pytest.raises(mbd.SimulationError, match="push") as trouble:
        mbd.simulate(scene, 1.0)
    result = trouble.value.result
    before, middle, after = result.trajectory.pieces()
    assert 0.05 < result.t[-1] == middle.t[-1] == result.final.t < 0.2
    assert all(other.t[-2] < result.t[-1] <= other.t[-1] for other in (before, after))
    assert np.isfinite(result.q).all() and len(result.q) == len(result.t) and result.audit.energy_error < 1e-4
    whole = mbd.Scene()
    springy(whole, 0.0, 40.0, "before")
    alone = mbd.simulate(whole, 1.0)
    np.testing.assert_allclose(result.final.q[:2], alone.position(whole["before"].at(), t=result.t[-1]), atol=1e-12)


def test_an_interrupted_run_keeps_what_all_parts_reached():
    scene, calls = mbd.Scene(), [0]

    def push(t: float) -> tuple[float, float]:
        calls[0] += 1
        if t > 0.2 and calls[0] > 50:
            raise KeyboardInterrupt
        return (0.0, 1.0)

    push.discontinuities = ()  # type: ignore[attr-defined]  # declared: it is not called in search of some
    ball = springy(scene, 0.0, 50.0, "pushed")
    scene.add(mbd.Force(ball.at(), push))
    springy(scene, 5.0, 50.0, "after")
    with pytest.raises(mbd.Interrupted, match="interrupted") as trouble:
        mbd.simulate(scene, 5.0)
    ends = [piece.t[-1] for piece in trouble.value.result.trajectory.pieces()]
    assert 0.1 < min(ends) == trouble.value.time == trouble.value.result.final.t


def test_bad_starts_of_all_parts_are_told_at_once():
    scene = mbd.Scene()
    for k in (0, 1):
        body = scene.add(mbd.RigidBody.rod((3 * k, 0), (3 * k + 1, 0), mass=1.0 + k))
        scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(3 * k, 0), name=f"left {k}"))
        scene.add(mbd.Pin(body.at(0.5, 0), scene.ground.at(3 * k + 2, 0), name=f"right {k}"))
        scene.add(mbd.Spring(body.at(), scene.ground.at(0, 5), stiffness=1.0))
    with pytest.raises(mbd.SceneError) as trouble:
        mbd.simulate(scene, 1.0)
    assert len(trouble.value.complaints) == 2 and "right 0" in str(trouble.value) and "right 1" in str(trouble.value)


def test_redundant_joints_are_named_in_their_part():
    scene = mbd.Scene()
    cable(scene, 0.0, 0.7e6, "rod")
    body = double(scene, 5.0, "arm")
    scene.add(mbd.Pin(scene["arm upper"].at(0.5, 0), body.at(-0.5, 0), name="twin"))
    with pytest.warns(mbd.SceneWarning, match="twin"):
        result = mbd.simulate(scene, 0.05)
    assert [piece.linear.softened for piece in result.trajectory.pieces()] == [False, True] and "twin" in result.assembly.redundant


def test_an_imbalance_names_its_part():
    scene = mbd.Scene()
    springy(scene, 0.0, 1.0, "soft"), cable(scene, 5.0, 0.7e6, "rod")
    with pytest.warns(mbd.SceneWarning, match="energy of 'rod', 'rod pivot' is off") as caught:
        mbd.simulate(scene, 2.0, solver=mbd.GeneralizedAlpha(0.02, rho_inf=1.0))
    assert caught[0].filename == __file__


def test_the_bar_ends_at_the_end():
    scene = mbd.Scene()
    springy(scene, 0.0, 50.0, "soft"), springy(scene, 5.0, 5000.0, "stiff")
    terminal, file = io.StringIO(), io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    for stream in (terminal, file):
        with contextlib.redirect_stderr(stream):
            mbd.simulate(scene, 0.5, progress=True)
    said = terminal.getvalue()
    assert "100%" in said and "0.5/0.5 s" in said and re.search(r"<00:\d\d, step \d\.\de-\d\d s\]", said)
    assert not file.getvalue()


def test_no_matrix_holds_parts_that_run_apart(monkeypatch):
    sizes, original = [], Linear.__init__

    def seen(self: Linear, system: Any, q: Any) -> None:
        sizes.append(system.n + system.m)
        original(self, system, q)

    monkeypatch.setattr(Linear, "__init__", seen)
    scene = mbd.Scene()
    for k in range(10):
        springy(scene, 3.0 * k, 50.0 + k, f"ball {k}")
    mbd.simulate(scene, 0.05)
    assert sizes == [2] * 10
