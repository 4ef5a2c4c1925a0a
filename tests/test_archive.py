"""Results in files: what is loaded answers as what was saved."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.descriptions import KINDS

CABLE: dict[str, Any] = {"E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 2000}


def planar() -> mbd.Scene:
    """One of every kind that a plane has, with numbers given in every way."""
    scene = mbd.Scene(gravity=(0.5, -9.81))
    rod = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=np.int64(3), damping=1e-3, elasticity="local_frame", name="rod", **CABLE))
    arc = scene.add(mbd.AncfCable(nodes=[(1, 0), (1.5, 0.1), (2, 0)], gravity="lumped", gauss_points=5, **CABLE))
    body = scene.add(mbd.RigidBody.rod((2, 0), (2, -1), mass=1.0, name="body"))
    box = scene.add(mbd.RigidBody.box((0.4, 0.2), mass=2.0, position=(0.5, -1), angle=0.3))
    ball = scene.add(mbd.Particle(0.5, (0.4, -1.0), velocity=(0.1, 0.0)))
    scene.add(mbd.Clamp(rod.start, scene.ground.at(0, 0), name="joint"))
    scene.add(mbd.Pin(rod.end, arc.start))
    scene.add(mbd.Pin(arc.end, body.at(-0.5, 0)))
    scene.add(mbd.Distance(ball.at(), rod.at(0.4)))
    scene.add(mbd.Spring(box.at(0.2, 0.1), scene.ground.at(0.3, 0.2), stiffness=50.0, damping=1.0, length=0.3))
    scene.add(mbd.TorsionSpring(body.at(), arc.end, stiffness=1.0, angle=0.1))
    scene.add(mbd.Force(rod.at(0.35), (0, 7)))
    scene.add(mbd.Force(arc.at(0.5), [1.0, 2.0], follower=True))
    scene.add(mbd.Torque(box.at(), 1))
    slide = scene.add(mbd.Particle(0.5, (4, 0)))
    cart, wheel = (scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(x, 0))) for x in (5, 6))
    scene.add(mbd.PointOnLine(slide.at(), scene.ground.at(4, 0), axis=(1, 1)))
    scene.add(mbd.Slider(cart.at(), scene.ground.at(5, 0), axis=(1, 0)))
    scene.add(mbd.Prescribed(wheel.at(), (6, 0)))
    scene.add(mbd.Motor(wheel, scene.ground, speed=3.0))
    gear, rack = (scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(x, 3))) for x in (6, 7))
    scene.add(mbd.Pin(gear.at(), scene.ground.at(6, 3)))
    scene.add(mbd.Gear(gear, wheel, radii=(1, -2)))
    scene.add(mbd.Slider(rack.at(), scene.ground.at(7, 3), axis=(0, 1)))
    scene.add(mbd.Rack(gear, rack, axis=(0, 1), radius=0.1))
    disc = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(8, 0.5)))
    scene.add(mbd.Rolling(disc, scene.ground, axis=(1, 0), radius=0.5))
    scene.add(mbd.BeamSlider(scene.add(mbd.Particle(0.5, (0.55, 0.0))), rod))
    apart, turn = scene.add(mbd.Length(disc, scene.ground.at(8, 3))), scene.add(mbd.Angle(disc, rack))
    slid = scene.add(mbd.Displacement(disc, rack, axis=(1, 0)))
    bob = scene.add(mbd.Length(scene.add(mbd.Particle(1.0, (9, 0))), scene.ground.at(9, 1)))
    scene.add(mbd.Coupling([(1.0, bob), (0.1, apart), (0.1, turn), (0.1, slid)]))
    scene.add(mbd.PD(apart, 2.0, proportional=1.0, derivative=0.1))
    scene.add(mbd.Stop(slid, lower=0.0, upper=0.1, stiffness=10.0, width=0.1))
    scene.add(mbd.Actuator(turn, force=0.1))
    scene.add(mbd.Friction(turn, force=0.1, speed=0.1))
    square = scene.add(mbd.UserMeasure([apart, turn], mbd.Expression("s**2 + 0.1 * phi", ("s", "phi")), name="square"))
    scene.add(mbd.ForceLaw([square, slid], mbd.Expression(["-k * a", "-c * v * t"], ("t", "a", "b", "u", "v"), {"k": 0.1, "c": 0.2}), rates=True))
    scene.add(mbd.KnifeEdge(scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 4))), axis=(1, 0)))
    scene.add(mbd.Wheel(scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 5))), axis=(1, 0), radius=0.2))
    for k, kind in enumerate((mbd.CorotationalBeam, mbd.FloatingFrameBeam, mbd.GeometricallyExactBeam)):
        beam = scene.add(kind((7 + k, 0), (7 + k, -0.5), n_elements=2, damping=1e-3, **CABLE))
        scene.add(mbd.Pin(beam.start, scene.ground.at(7 + k, 0)))
    return scene


def spatial() -> mbd.Scene:
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    spin = {"velocity": (5, 0, 0), "angular_velocity": (0, 5, 150)}
    top = scene.add(mbd.RigidBody(mass=15.0, inertia=(0.469, 0.469, 0.234), position=(0, 0, 1), **spin, name="body"))
    scene.add(mbd.Ball(top.at(0, 0, -1), scene.ground.at(0, 0, 0), name="joint"))
    first = scene.add(mbd.AncfCable((1, 0, 0), (2, 0, 0), n_elements=2, **CABLE))
    second = scene.add(mbd.AncfCable((2, 0, 0), (3, 0, 0), n_elements=2, **CABLE))
    door = scene.add(mbd.RigidBody.rod((0, 2, 0), (1, 2, 0), mass=1.0, radius=0.05))
    scene.add(mbd.Clamp(first.start, scene.ground.at(1, 0, 0)))
    scene.add(mbd.Clamp(first.end, second.start))
    scene.add(mbd.Pin(door.at(-0.5, 0, 0), scene.ground.at(0, 2, 0), axis=(0, 0, 1)))
    scene.add(mbd.Torque(door.at(), (0.0, 0.0, 2.0), follower=True))
    a, b, c = (scene.add(mbd.RigidBody(mass=1.0, inertia=(0.1, 0.1, 0.1), position=(x, 5, 0))) for x in range(3))
    scene.add(mbd.Universal(a.at(), scene.ground.at(0, 5, 0), axes=[(1, 0, 0), (0, 1, 0)]))
    scene.add(mbd.Cylindrical(b.at(), scene.ground.at(1, 5, 0), axis=(1, 0, 1)))
    scene.add(mbd.Planar(c.at(), scene.ground.at(2, 5, 0), normal=(1, 0, 1)))
    return scene


def redundant() -> mbd.Scene:
    """A pendulum pinned twice at the same point, not quite where it was described."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="body"))
    for name in ("joint", "twin"):
        scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0.01), name=name))
    return scene


def driven() -> mbd.Scene:
    """A pendulum pushed by a function of time."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="body"))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0), name="joint"))
    scene.add(mbd.Force(body.at(0.5, 0), lambda t: (1.0 + np.sin(20.0 * t), 0.0), name="push"))
    return scene


def run(scene: mbd.Scene, **options: Any) -> mbd.Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbd.SceneWarning)
        return mbd.simulate(scene, **{"t_end": 0.04, "rtol": 1e-6} | options)


def point(scene: mbd.Scene) -> mbd.Marker:
    return scene["body"].at(*[0.3] * scene.dimension)


INSIDE = [0.011, 0.02, 0.035]
Query = Callable[[mbd.Result, mbd.Scene], Any]
"""Asked of a result with the markers and items of a scene."""
EXACT: dict[str, Query] = {
    "arrays": lambda r, scene: np.concatenate((r.t[:, None], r.q, r.v), axis=1),
    "position": lambda r, scene: r.position(point(scene)),
    "velocity": lambda r, scene: r.velocity(point(scene)),
    "rotation": lambda r, scene: r.rotation(scene["body"]),
    "angular velocity": lambda r, scene: r.angular_velocity(scene["body"]),
    "energy": lambda r, scene: np.array([r.energy.kinetic, r.energy.elastic, r.energy.potential, r.energy.total]),
    "work": lambda r, scene: np.concatenate([part.work for part in r.trajectory.pieces()]),
    "stats": lambda r, scene: r.stats,
    "final": lambda r, scene: np.concatenate((r.final.q, r.final.v, [r.final.t])),
    "assembly": lambda r, scene: (str(r.assembly), r.assembly.redundant, *r.assembly.state.q, *r.assembly.state.v),
    "solver": lambda r, scene: [(part.method.name, part.method.fixed) for part in r.trajectory.pieces()],
    "coordinates": lambda r, scene: r.scene.coordinates(),
    "text": lambda r, scene: (repr(r), str(r.audit)),
}
ROUNDED: dict[str, Query] = {
    "acceleration": lambda r, scene: r.acceleration(point(scene)),
    "reaction": lambda r, scene: r.reaction(scene["joint"]),
    "position between": lambda r, scene: r.position(point(scene), t=INSIDE),
    "velocity between": lambda r, scene: r.velocity(point(scene), t=INSIDE),
    "reaction between": lambda r, scene: r.reaction(scene["joint"], t=INSIDE),
}
"""The same but for rounding in the linear algebra, and between steps for where iterations stop."""


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[mbd.Result, mbd.Result]]:
    """Each run, and what its file gives."""
    folder, out = tmp_path_factory.mktemp("archive"), {}
    for scene in (planar, spatial, redundant):
        result = run(scene())
        result.save(folder / scene.__name__)
        out[scene.__name__] = result, mbd.load(folder / scene.__name__)
    return out


@pytest.mark.parametrize("markers", ["of the file", "of memory"])
@pytest.mark.parametrize("query", EXACT)
@pytest.mark.parametrize("name", ["planar", "spatial", "redundant"])
def test_same_answers(pairs, name, query, markers):
    saved, loaded = pairs[name]
    scene = loaded.scene if markers == "of the file" else saved.scene
    np.testing.assert_equal(EXACT[query](loaded, scene), EXACT[query](saved, saved.scene))


@pytest.mark.filterwarnings("ignore:the reaction of 'joint' is indeterminate")
@pytest.mark.parametrize("query", ROUNDED)
@pytest.mark.parametrize("name", ["planar", "spatial", "redundant"])
def test_same_answers_but_for_rounding(pairs, name, query):
    saved, loaded = pairs[name]
    expected, found = ROUNDED[query](saved, saved.scene), ROUNDED[query](loaded, loaded.scene)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7 * np.max(np.abs(expected)))


def test_angles(pairs):
    saved, loaded = pairs["planar"]
    np.testing.assert_equal(loaded.angle(loaded.scene["rod"].at(0.7)), saved.angle(saved.scene["rod"].at(0.7)))


def test_the_scenes_have_every_kind(pairs):
    used = {type(item.description).__name__ for saved, _ in pairs.values() for item in saved.scene.items}
    assert used == set(KINDS)


def test_the_start_that_was_corrected_is_remembered(pairs):
    _, loaded = pairs["redundant"]
    assert "position" in str(loaded.assembly) and "joint" in str(loaded.assembly) and loaded.assembly.redundant
    assert loaded.trajectory.linear.softened


def test_a_loaded_run_is_continued_and_saved_again(pairs, tmp_path):
    saved, loaded = pairs["planar"]
    expected, found = (run(r.scene, t_end=0.05, start=r.final) for r in (saved, loaded))
    np.testing.assert_array_equal(found.q, expected.q)
    loaded.save(tmp_path / "again")
    np.testing.assert_array_equal(mbd.load(tmp_path / "again").q, saved.q)


@pytest.mark.parametrize("solver", [mbd.Radau(), mbd.Radau(3, step=0.01), mbd.Radau(7), mbd.GeneralizedAlpha(2e-3, rho_inf=0.6, index=3)], ids=str)
def test_chosen_times_and_solvers(tmp_path, solver):
    result = run(redundant(), t_eval=[0.0, 0.013, 0.04], solver=solver)
    result.save(tmp_path / "run.npz")
    loaded = mbd.load(tmp_path / "run.npz")
    assert loaded.t.tolist() == [0.0, 0.013, 0.04]
    assert len(loaded.trajectory.t) == len(result.trajectory.t)
    assert (loaded.trajectory.method.name, loaded.trajectory.method.fixed) == (result.trajectory.method.name, result.trajectory.method.fixed)
    np.testing.assert_array_equal(loaded.q, result.q)
    between = [r.position(point(r.scene), t=INSIDE) for r in (loaded, result)]
    np.testing.assert_allclose(*between, rtol=0.0, atol=1e-9)


def test_a_partial_result_is_kept(tmp_path):
    scene = driven()
    scene.add(mbd.Torque(scene["body"].at(), lambda t: 0.0 if t < 0.03 else np.nan, name="broken"))
    with pytest.raises(mbd.SimulationError) as stop:
        run(scene)
    with pytest.warns(mbd.SceneWarning, match="'push', 'broken'"):
        stop.value.result.save(tmp_path / "part.npz")
    assert 0.0 <= mbd.load(tmp_path / "part.npz").t[-1] < 0.04


def test_functions_are_missing_by_name(tmp_path):
    saved = run(driven())
    with pytest.warns(mbd.SceneWarning, match=r"'push'") as caught:
        saved.save(tmp_path / "run.npz")
    assert caught[0].filename == __file__
    loaded = mbd.load(tmp_path / "run.npz")
    for query in EXACT.values():
        np.testing.assert_equal(query(loaded, loaded.scene), query(saved, saved.scene))
    np.testing.assert_allclose(*(r.acceleration(point(r.scene), t=[0.0]) for r in (loaded, saved)), atol=1e-9)
    for query in ("acceleration", "reaction", "reaction between"):
        with pytest.raises(mbd.SimulationError, match=r"at push: .*no functions of t") as trouble:
            ROUNDED[query](loaded, loaded.scene)
        assert trouble.value.item == "push"


def test_a_kind_or_value_of_ones_own_is_refused(tmp_path):
    @dataclass(frozen=True)
    class Mine(mbd.Particle):
        pass

    for description, message in ((Mine(1.0, (0.0, 0.0)), "Mine"), (mbd.Particle(1.0, (0.0, 0.0)), "name")):
        scene = mbd.Scene()
        item = scene.add(description)
        result = run(scene)
        if message == "name":
            object.__setattr__(item.description, "velocity", object())
        with pytest.raises(ValueError, match="cannot be stored"):
            result.save(tmp_path / "run.npz")
    assert not list(tmp_path.iterdir())


def test_a_scene_that_has_grown_is_refused(tmp_path):
    result = run(redundant())
    result.scene.add(mbd.Particle(1.0, (0.0, 0.0)))
    with pytest.raises(ValueError, match="added since"):
        result.save(tmp_path / "run.npz")
