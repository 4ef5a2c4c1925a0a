"""Runs that were broken off, resumed: the same as runs that never were, to the last bit."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd

CABLE: dict[str, Any] = {"E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 2000}


def rigid(push: Any = (0.0, 1.0)) -> mbd.Scene:
    """Two bodies, hinged and sprung, and one apart that shares no step with them."""
    scene = mbd.Scene()
    a = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="a"))
    b = scene.add(mbd.RigidBody.rod((1, 0), (2, 0), mass=2.0, name="b"))
    scene.add(mbd.Pin(a.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(a.at(0.5, 0), b.at(-0.5, 0)))
    scene.add(mbd.Spring(b.at(0.5, 0), scene.ground.at(2, 1), stiffness=20.0, damping=0.2))
    scene.add(mbd.Force(b.at(), push, name="push"))
    ball = scene.add(mbd.Particle(1.0, (5, 0), name="ball"))
    scene.add(mbd.Spring(ball.at(), scene.ground.at(5, 2), stiffness=200.0))
    return scene


def flexible() -> mbd.Scene:
    scene = mbd.Scene()
    rod = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=3, damping=1e-3, **CABLE))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    bob = scene.add(mbd.RigidBody.rod((1, 0), (1.5, 0), mass=1.0, name="b"))
    scene.add(mbd.Clamp(bob.at(-0.25, 0), rod.end))
    return scene


def redundant() -> mbd.Scene:
    """Held twice."""
    scene = rigid()
    scene.add(mbd.Pin(scene["a"].at(-0.5, 0), scene.ground.at(0, 0)))
    return scene


def run(scene: mbd.Scene, t_end: float, **options: Any) -> mbd.Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbd.SceneWarning)
        return mbd.simulate(scene, t_end, **options)


def same(found: mbd.Result, expected: mbd.Result) -> None:
    """To the last bit: trajectory, work, events, and what it cost."""
    for name in ("t", "q", "v"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    for a, b in zip(found.trajectory.pieces(), expected.trajectory.pieces()):
        np.testing.assert_array_equal(a.t, b.t)
        np.testing.assert_array_equal(a.q, b.q)
        np.testing.assert_array_equal(a.work, b.work)
    assert set(found.events) == set(expected.events)
    for name in expected.events:
        for a, b in zip(found.events[name], expected.events[name]):
            np.testing.assert_array_equal(a, b)
    costs = ("solver", "linear algebra", "rtol", "steps", "rejected", "failed", "newton iterations", "factorizations", "reason")
    assert {name: found.stats[name] for name in costs} == {name: expected.stats[name] for name in costs}


SOLVERS: dict[str, tuple[Callable[[], mbd.Scene], Any]] = {
    "default, rigid": (rigid, None),
    "default, flexible": (flexible, None),
    "Radau 3": (flexible, mbd.Radau(3)),
    "Radau 5": (flexible, mbd.Radau(5)),
    "Radau 7": (flexible, mbd.Radau(7)),
    "Radau, fixed": (flexible, mbd.Radau(3, step=0.007)),
    "DormandPrince": (rigid, mbd.DormandPrince()),
    "Automatic, redundant": (redundant, mbd.Automatic()),
    "GeneralizedAlpha 2": (flexible, mbd.GeneralizedAlpha(0.007)),
    "GeneralizedAlpha 3": (rigid, mbd.GeneralizedAlpha(0.01, index=3)),
    "Gauss": (flexible, mbd.Gauss(0.01)),
    "Gauss, samples": (rigid, mbd.Gauss(0.01, stages=3, samples=5)),
}


@pytest.mark.parametrize("way", ["memory", "file"])
@pytest.mark.parametrize("name", SOLVERS)
def test_a_run_to_its_end_goes_on(name: str, way: str, tmp_path: Path) -> None:
    """As if the first end had never been: the steps that it bent are taken anew."""
    build, solver = SOLVERS[name]
    expected, half = run(build(), 0.5, solver=solver), run(build(), 0.23, solver=solver)
    if way == "file":
        half.save(tmp_path / "half.npz")
    same(mbd.resume(half if way == "memory" else tmp_path / "half.npz", 0.5), expected)


class Broken:
    """A load that breaks a run off once, at its so-many-th call, as Ctrl-C might."""

    discontinuities = ()  # declared: it is not called in search of some

    def __init__(self, after: int, how: type[BaseException] = KeyboardInterrupt):
        self.left, self.how = after, how

    def __call__(self, t: float) -> tuple[float, float]:
        self.left -= 1
        if self.left == 0:
            raise self.how
        return np.sin(3.0 * t).item(), 1.0


@pytest.mark.parametrize("solver", [None, mbd.Radau(5), mbd.GeneralizedAlpha(0.01), mbd.Gauss(0.01)], ids=str)
@pytest.mark.parametrize("after", [5, 40, 70])
def test_an_interrupted_run_goes_on(solver: Any, after: int, tmp_path: Path) -> None:
    """Wherever it was, also in parts, and with the times that were asked for; from memory and from the file."""
    options: dict[str, Any] = {"t_eval": np.linspace(0.0, 0.8, 9), "solver": solver}
    expected = run(rigid(Broken(10**9)), 0.8, **options)
    with pytest.raises(mbd.Interrupted) as stop:
        run(rigid(Broken(after)), 0.8, checkpoint=tmp_path / "run.npz", **options)
    assert stop.value.time < 0.8 and stop.value.time == stop.value.result.trajectory.t[-1]
    same(mbd.resume(stop.value.result), expected)
    same(mbd.resume(tmp_path / "run.npz", scene=rigid(Broken(10**9))), expected)


def test_a_run_is_broken_off_twice(tmp_path: Path) -> None:
    expected = run(rigid(Broken(10**9)), 1.0)
    with pytest.raises(mbd.Interrupted):
        run(rigid(Broken(100)), 1.0, checkpoint=tmp_path / "run.npz")
    with pytest.raises(mbd.Interrupted):
        mbd.resume(tmp_path / "run.npz", scene=rigid(Broken(150)), checkpoint=tmp_path / "run.npz")
    same(mbd.resume(tmp_path / "run.npz", scene=rigid(Broken(10**9)), checkpoint=tmp_path / "run.npz"), expected)
    same(mbd.resume(mbd.load(tmp_path / "run.npz"), scene=rigid(Broken(10**9))), expected)


def test_a_function_that_failed_is_replaced() -> None:
    expected = run(rigid(Broken(10**9)), 0.8)
    with pytest.raises(mbd.SimulationError, match="raised ValueError") as stop:
        run(rigid(Broken(200, ValueError)), 0.8)
    same(mbd.resume(stop.value.result, scene=rigid(Broken(10**9))), expected)


@pytest.mark.parametrize("way", ["memory", "file"])
def test_events_and_jumps(way: str, tmp_path: Path) -> None:
    def scene() -> mbd.Scene:
        return rigid(mbd.piecewise(lambda t: (0.0, 5.0 if t > 0.2 else -5.0), at=[0.2, 0.31]))

    def events(of: mbd.Scene) -> list[mbd.Event]:
        return [mbd.Event(lambda x: x.position(of["b"].at())[1], name="level"), mbd.Event(lambda x: x.velocity(of["ball"].at())[1], name="turn")]

    one, two, three = scene(), scene(), scene()
    expected = run(one, 1.5, events=events(one))
    assert sum(len(times.t) for times in expected.events.values()) > 3
    for t_end in (0.1, 0.31, 1.2):
        half: Any = run(two, t_end, events=events(two))
        given: dict[str, Any] = {}
        if way == "file":
            with pytest.warns(mbd.SceneWarning, match="functions of t"):
                half.save(tmp_path / "half.npz")
            half, given = tmp_path / "half.npz", {"scene": three, "events": events(three)}
        same(mbd.resume(half, 1.5, **given), expected)


def test_checkpoints_are_written_on_the_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Killed at any of them, a run goes on to the same end."""
    kept: list[bytes] = []
    replace = mbd.archive.os.replace  # type: ignore[attr-defined]

    def seen(source: Any, target: Any) -> None:
        kept.append(Path(source).read_bytes())
        replace(source, target)

    monkeypatch.setattr(mbd.archive.os, "replace", seen)  # type: ignore[attr-defined]
    monkeypatch.setattr("mbd.checkpoint.RARELY", 0.0)
    expected = run(flexible(), 0.2, checkpoint=tmp_path / "run.npz", every=0.0)
    assert len(kept) > expected.stats["steps"] / 2
    for k in (0, len(kept) // 2, len(kept) - 1):
        (tmp_path / "killed.npz").write_bytes(kept[k])
        same(mbd.resume(tmp_path / "killed.npz"), expected)


def test_what_cannot_be_resumed(tmp_path: Path) -> None:
    scene = rigid()
    result = run(scene, 0.3)
    other = rigid((0.0, 2.0))
    with pytest.raises(mbd.SceneError, match="'push' differs"):
        mbd.resume(result, 0.5, scene=other)
    with pytest.raises(mbd.SceneError, match="which was reached"):
        mbd.resume(result, 0.2)
    ended = run(scene, 3.0, events=[mbd.Event(lambda x: x.t - 0.1, terminal=True, name="over")])
    with pytest.raises(mbd.SceneError, match="ended by 'over'"):
        mbd.resume(ended, 4.0)
    pushed = run(rigid(lambda t: (0.0, t)), 0.1)
    with pytest.warns(mbd.SceneWarning):
        pushed.save(tmp_path / "run.npz")
    with pytest.raises(mbd.SceneError, match="functions of t of 'push'"):
        mbd.resume(tmp_path / "run.npz", 0.2)
    seen = run(scene, 0.1, events=[mbd.Event(lambda x: x.q[0], name="zero")])
    with pytest.raises(mbd.SceneError, match=r"by name \('zero'\), found 'one'"):
        mbd.resume(seen, 0.2, events=[mbd.Event(lambda x: x.q[0], name="one")])
    scene.add(mbd.Particle(1.0, (9.0, 9.0)))
    with pytest.raises(mbd.SceneError, match="items added since"):
        mbd.resume(result, 0.5)


def test_a_scene_that_cannot_be_stored_has_no_checkpoints(tmp_path: Path) -> None:
    scene = rigid()
    scene.add(mbd.UserMeasure(scene.add(mbd.Angle(scene["a"], scene.ground)), lambda x: 2.0 * x))
    with pytest.raises(ValueError, match="cannot be stored"):
        run(scene, 0.3, checkpoint=tmp_path / "run.npz")
