"""Scenes written and read: the same descriptions, start and equations, for every kind; the same answers."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mbd
from mbd.descriptions import KINDS, described
from mbd.files import read
from mbd.files.kinds import ITEMS

from .. import test_archive
from ..joints import test_kinds
from ..kinds import ELASTIC
from .test_functions import MADE


def driven(function: Any) -> mbd.Scene:
    """A scene that takes one function of t in every way that its values allow."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), name="wheel"))
    if np.ndim(function(0.3)):
        scene.add(mbd.Force(wheel.at(0.1, 0.2), function))
        return scene
    scene.add(mbd.Pin(wheel.at(), scene.ground.at()))
    turn = scene.add(mbd.Angle(wheel, scene.ground, name="the turn"))
    scene.add(mbd.Torque(wheel.at(), function))
    scene.add(mbd.PD(turn, function, proportional=2.0))
    return scene


def speeds() -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    for k, words in enumerate(({"angle": "0.1 * t**2"}, {"speed": "sin(t)"}, {"torque": "3.0 if t > 0.1 else 0"})):
        wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(k, 0)))
        scene.add(mbd.Pin(wheel.at(), scene.ground.at(k, 0)))
        scene.add(mbd.Motor(wheel, scene.ground, **{name: mbd.Expression(text) for name, text in words.items()}))
    ball = scene.add(mbd.Particle(1.0, (5.0, 0.0), name='a "strange" name.at(3) \\ é\n\x7f'))
    scene.add(mbd.Prescribed(ball.at(), mbd.Expression(["5 + t", "t * k"], constants={"k": 2.0})))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(9, 0), name="b.end"))
    scene.add(mbd.Prescribed(body.at(), (9.0, 0.0), angle=mbd.Expression("t")))
    scene.add(mbd.Spring(body.at(1e-7, 0.1 + 0.2), ball.at(), stiffness=1 / 3))
    return scene


SCENES: dict[str, Callable[[], mbd.Scene]] = {
    "planar": test_archive.planar,
    "spatial": test_archive.spatial,
    "redundant": test_archive.redundant,
    "speeds": speeds,
    **{f"joint {kind.name}": lambda kind=kind: kind.build(np.random.default_rng(3))[0] for kind in test_kinds.KINDS},  # type: ignore[misc]
    **{f"elastic {kind.name}": lambda kind=kind: kind.scene(damping=0.1)[0] for kind in ELASTIC},  # type: ignore[misc]
    **{f"function {name}": lambda function=function: driven(function) for name, function in MADE.items() if np.shape(function(0.3)) != (3,)},  # type: ignore[misc]
}


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@pytest.mark.parametrize("name", SCENES)
def test_the_scene_comes_back_exactly(name: str, suffix: str, tmp_path: Path) -> None:
    scene, path = SCENES[name](), tmp_path / f"scene{suffix}"
    mbd.write_scene(scene, path)
    back = mbd.read_scene(path)
    assert described(back) == described(scene)
    assert back.coordinates() == scene.coordinates()
    ours, theirs = scene.build(), back.build()
    rng = np.random.default_rng(5)
    q, v = ours.q0 + 0.01 * rng.standard_normal(ours.n), rng.standard_normal(ours.n)
    for what in ("q0", "v0"):
        assert np.array_equal(getattr(ours, what), getattr(theirs, what))
    inputs = [system.inputs(np.array(0.3)) for system in (ours, theirs)]
    assert all(np.array_equal(a, b) for a, b in zip(*inputs))
    assert np.array_equal(ours.joints.at(q).push(v), theirs.joints.at(q).push(v))
    written = path.read_bytes()
    mbd.write_scene(back, path)
    assert path.read_bytes() == written


def test_every_kind_went_through() -> None:
    used = {type(item.description).__name__ for make in SCENES.values() for item in make().items}
    assert used == set(KINDS) and set(ITEMS) == {*KINDS, "RigidBody.rod", "RigidBody.box"}


def _numbers() -> st.SearchStrategy[float]:
    return st.floats(-1e6, 1e6, allow_subnormal=True).filter(lambda x: x == 0.0 or abs(x) > 1e-300)


@settings(max_examples=30, deadline=None)
@given(x=_numbers(), y=_numbers(), s=st.floats(0, 1), name=st.text(min_size=1, max_size=20))
def test_numbers_and_names_of_all_sorts(tmp_path_factory: pytest.TempPathFactory, x: float, y: float, s: float, name: str) -> None:
    if name == "ground" or (not name.isprintable() and any(0xD800 <= ord(sign) < 0xE000 for sign in name)):
        return
    scene = mbd.Scene(gravity=(x, y))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(y, x), velocity=(x, 0.0), angle=math.pi / 7, name=name))
    cable = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=3, E=1e6, A=1e-3, I=1e-8, rho=1e3, name=f"{name}.at"))
    scene.add(mbd.Spring(body.at(y, -x), cable.at(s), stiffness=2.0, length=0.0))
    path = tmp_path_factory.mktemp("scenes") / "scene.toml"
    mbd.write_scene(scene, path)
    assert described(mbd.read_scene(path)) == described(scene)


def test_what_the_file_says_of_the_run_comes_back(tmp_path: Path) -> None:
    scene = SCENES["speeds"]()
    ball = next(item for item in scene.items if type(item.description) is mbd.Particle)
    for solver in (None, mbd.Radau(5, step=1e-3), mbd.GeneralizedAlpha(step=1e-3, rho_inf=0.5), mbd.Gauss(step=0.1, samples=3), mbd.DormandPrince()):
        outputs = {"ball's place": ball.at(), "b": scene["b.end"].at(1, 2)}
        mbd.write_scene(scene, tmp_path / "scene.toml", t_end=0.3, rtol=1e-8, solver=solver, outputs=outputs)
        job = read(tmp_path / "scene.toml")
        assert (job.t_end, job.rtol, job.solver) == (0.3, 1e-8, solver)
        assert {name: (marker.item, marker.arguments) for name, marker in job.outputs.items()} == {
            "ball's place": (ball.name, ()),
            "b": ("b.end", (1.0, 2.0)),
        }


def test_results_are_the_same(tmp_path: Path) -> None:
    scene = SCENES["speeds"]()
    mbd.write_scene(scene, tmp_path / "scene.json")
    ours, theirs = (mbd.simulate(each, 0.2) for each in (scene, mbd.read_scene(tmp_path / "scene.json")))
    assert np.array_equal(ours.q, theirs.q)


def test_results_keep_such_functions(tmp_path: Path) -> None:
    """A result loaded from a file answers what needs functions of t, where they are data."""
    scene = driven(MADE["Expression"])
    result = mbd.simulate(scene, 0.2)
    result.save(tmp_path / "run.npz")
    back = mbd.load(tmp_path / "run.npz")
    wheel, pin = scene["wheel"], scene["pin 1"]
    np.testing.assert_allclose(back.acceleration(wheel.at(0.1, 0)), result.acceleration(wheel.at(0.1, 0)), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(back.reaction(pin, t=[0.11]), result.reaction(pin, t=[0.11]), rtol=1e-9, atol=1e-9)


def test_functions_of_the_users_own_are_refused_by_name(tmp_path: Path) -> None:
    scene = SCENES["redundant"]()
    for name, function in (("push", lambda t: (t, 0.0)), ("pull", mbd.piecewise(lambda t: (t, 0.0), at=[0.1]))):
        scene.add(mbd.Force(scene["body"].at(), function, name=name))
    with pytest.raises(mbd.SceneError, match=r"'push': expected functions that can be written.* use mbd.Expression") as trouble:
        mbd.write_scene(scene, tmp_path / "scene.toml")
    assert len(trouble.value.complaints) == 2 and "'pull'" in trouble.value.complaints[1]
    assert not (tmp_path / "scene.toml").exists()
    with pytest.raises(ValueError, match=r"ends in .toml or .json, found 'scene.yaml'"):
        mbd.write_scene(scene, tmp_path / "scene.yaml")
