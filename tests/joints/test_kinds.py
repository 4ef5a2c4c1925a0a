"""Joints, measures and couplings of several markers: derivatives by sympy and differences, kinematics and balance along a trajectory."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

import mbd

from ..kinds import MARKERS, ZERO, derivative, rotation
from ..test_joints import DIFFERENCED, EXACT, Polynomials, numeric, random_state, same

Add = Callable[[Any, tuple[Any, Any, Any], np.ndarray], Any]


class Kind(NamedTuple):
    """A description between three markers, of which it uses two or three; ``second`` [d, d] is the frame of the second, in which its axes are."""

    name: str
    dimension: int
    markers: tuple[str, str, str]
    add: Add

    def __str__(self) -> str:
        return self.name

    def build(self, rng: np.random.Generator) -> tuple[Any, Any, Any]:
        scene, d = mbd.Scene(gravity=ZERO[self.dimension]), self.dimension
        point, frames = rng.standard_normal(d), [rotation(rng, d) for _ in range(3)]
        if any(kind in ("node", "span") for kind in self.markers):
            frames[0][:, :] = np.eye(d)  # the tangents of cables along x
        places = [point, point + 0.3 * rng.standard_normal(d), point + rng.standard_normal(d)]
        markers = [MARKERS[kind](scene, at, frame, name) for kind, at, frame, name in zip(self.markers, places, frames, "abc")]
        item = scene.add(self.add(scene, tuple(markers), frames[1]))
        return scene, scene.build(), item


def _coupling(scene: Any, m: Any, frame: Any) -> Any:
    turn, apart = scene.add(mbd.Angle(m[0], m[1])), scene.add(mbd.Length(m[0], m[2]))
    slid = scene.add(mbd.Displacement(m[2], m[1], axis=(1, 2)))
    return mbd.Coupling([(2.0, turn), (-1.0, apart), (0.5, slid)])


Z = (0.0, 0.0, 1.0)
TWO, THREE = ("body", "body", "ground"), ("body", "body", "body")
KINDS = [
    Kind("universal", 3, TWO, lambda s, m, f: mbd.Universal(m[0], m[1], axes=[(1, 0, 0), (0, 2, 1)])),
    Kind("cylindrical", 3, TWO, lambda s, m, f: mbd.Cylindrical(m[0], m[1], axis=(1, -2, 3))),
    Kind("planar", 3, TWO, lambda s, m, f: mbd.Planar(m[0], m[1], normal=(1, -2, 3))),
    Kind("angle", 2, ("span", "body", "ground"), lambda s, m, f: mbd.Angle(m[0], m[1])),
    Kind("angle in space", 3, TWO, lambda s, m, f: mbd.Angle(m[0], m[1], axis=(1, -2, 3))),
    Kind("angle of a cable", 3, ("node", "body", "ground"), lambda s, m, f: mbd.Angle(m[0], m[1], axis=Z)),
    Kind("angle to a cable", 3, ("node", "body", "ground"), lambda s, m, f: mbd.Angle(m[1], m[0], axis=Z)),
    Kind("displacement", 2, ("span", "body", "ground"), lambda s, m, f: mbd.Displacement(m[0], m[1], axis=(2, 1))),
    Kind("displacement in space", 3, ("particle", "body", "ground"), lambda s, m, f: mbd.Displacement(m[0], m[1], axis=(1, -2, 3))),
    Kind("length", 2, ("span", "body", "ground"), lambda s, m, f: mbd.Length(m[0], m[1])),
    Kind("length in space", 3, ("node", "particle", "ground"), lambda s, m, f: mbd.Length(m[0], m[1])),
    Kind("coupling", 2, THREE, _coupling),
    Kind("motor in space", 3, TWO, lambda s, m, f: mbd.Motor(m[0], m[1], axis=(1, -2, 3), angle=0.0)),
    Kind("gear", 2, THREE, lambda s, m, f: mbd.Gear(m[0], m[1], ratio=-2.5)),
    Kind("gear on a carrier", 2, THREE, lambda s, m, f: mbd.Gear(m[0], m[1], radii=(0.2, 0.3), carrier=m[2])),
    Kind("bevel gear", 3, THREE, lambda s, m, f: mbd.Gear(m[0], m[1], teeth=(20, 31), carrier=m[2], axis=[(1, 0, 0), (0, 1, 1)])),
    Kind("rack", 2, THREE, lambda s, m, f: mbd.Rack(m[0], m[1], axis=(1, 2), radius=-0.2, carrier=m[2])),
    Kind("rack in space", 3, THREE, lambda s, m, f: mbd.Rack(m[0], m[1], axis=(1, 2, 0), radius=0.2, carrier=m[2], shaft=Z)),
    Kind("rolling disc", 2, TWO, lambda s, m, f: mbd.Rolling(m[0], m[1], axis=(1, 2), radius=0.2)),
]
each = pytest.mark.parametrize("kind", KINDS, ids=str)


@each
def test_equations_agree_with_sympy(kind: Kind) -> None:
    rng = np.random.default_rng(1)
    scene, system, _ = kind.build(rng)
    q, v, _, multipliers = random_state(system, rng)
    same(numeric(system, q, v, multipliers), Polynomials(scene).at(q, v, multipliers))


@each
def test_equations_agree_with_differences(kind: Kind) -> None:
    rng = np.random.default_rng(2)
    _, system, _ = kind.build(rng)
    q, v, dq, multipliers = random_state(system, rng)
    joints, found = system.joints, numeric(system, q, v, multipliers)
    for name, f in {
        "gradient": lambda x: joints.at(x).value,
        "swirl": lambda x: joints.at(x).push(v),
        "curvature": lambda x: joints.at(x).pull(multipliers),
    }.items():
        expected = derivative(f, q, dq)
        assert np.max(np.abs(found[name] @ dq - expected)) <= DIFFERENCED * max(1.0, np.max(np.abs(expected))), name
    assert found["bias"] == pytest.approx(found["swirl"] @ v, rel=EXACT, abs=EXACT)


# Along a trajectory: a body behind the joint, on another one that turns and accelerates. Directions of bodies are differences of their points.


class Path(NamedTuple):
    """A vector along a run, with its first two derivatives [n_t, d]."""

    value: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray

    def __sub__(self, other: Path) -> Path:
        return Path(*(x - y for x, y in zip(self, other)))

    def dot(self, other: Path) -> list[np.ndarray]:
        """The product and its first two derivatives."""
        (a, da, dda), (b, db, ddb) = self, other
        sums = (a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb)
        return [np.sum(x, axis=-1) for x in sums]


def path(result: Any, marker: Any) -> Path:
    return Path(result.position(marker), result.velocity(marker), result.acceleration(marker))


def arrow(result: Any, body: Any, direction: Any) -> Path:
    return path(result, body.at(*direction)) - path(result, body.at())


J = np.array((0.3, 0.4, 0.5))
N = np.array((1.0, -2.0, 2.0)) / 3.0
ACROSS = np.array([(2.0, 1.0, 0.0), (-2.0, 4.0, 5.0)])
SPATIAL: dict[str, Callable[[Any, Any], Any]] = {
    "universal": lambda a, b: mbd.Universal(a, b, axes=[(2, 1, 0), N]),
    "cylindrical": lambda a, b: mbd.Cylindrical(a, b, axis=N),
    "planar": lambda a, b: mbd.Planar(a, b, normal=N),
    "pin": lambda a, b: mbd.Pin(a, b, axis=N),
    "slider": lambda a, b: mbd.Slider(a, b, axis=N),
}


@pytest.fixture(scope="module", params=SPATIAL, ids=str)
def hung(request: pytest.FixtureRequest) -> tuple[str, Any, Any, Any, Any]:
    """A body of 1.5 kg (axes along the inertial ones at the start) on a tumbling one: name, result, both, the joint. It is not driven."""
    scene = mbd.Scene(gravity=(0.0, 1.0, -9.81))
    spin = np.array((1.0, 2.0, -1.5))
    poses = [{"position": x, "velocity": np.cross(spin, x), "angular_velocity": spin} for x in ((0.4, 0, 0), (0.8, 0.3, 0))]
    carrier = scene.add(mbd.RigidBody(mass=3.0, inertia=(1.0, 1.2, 0.9), **poses[0]))
    scene.add(mbd.Ball(carrier.at(-0.4, 0, 0), scene.ground.at()))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=J, **poses[1]))
    joint = scene.add(SPATIAL[request.param](body.at(-0.2, -0.2, 0.1), carrier.at(0.2, 0.1, 0.1)))
    return request.param, mbd.simulate(scene, 0.5, rtol=1e-9), body, carrier, joint


def test_kinematics_along_a_trajectory(hung: tuple[str, Any, Any, Any, Any]) -> None:
    """The constraint, its rate and its acceleration, from positions, velocities and accelerations of points alone."""
    name, result, body, carrier, _ = hung
    gap = path(result, body.at(-0.2, -0.2, 0.1)) - path(result, carrier.at(0.2, 0.1, 0.1))
    own, other = (lambda x: arrow(result, body, x)), (lambda x: arrow(result, carrier, x))
    coincide = [gap.dot(other(e)) for e in np.eye(3)]
    parallel = [own(N).dot(other(x)) for x in ACROSS]
    aligned = parallel + [own(ACROSS[0]).dot(other(np.cross(N, ACROSS[0])))]
    on_line = [gap.dot(other(x)) for x in ACROSS]
    held = {
        "universal": [*coincide, own((2, 1, 0)).dot(other(N))],
        "cylindrical": on_line + parallel,
        "planar": [gap.dot(other(N)), *parallel],
        "pin": coincide + parallel,
        "slider": on_line + aligned,
    }[name]
    moved = np.ptp(gap.value, axis=0).max() + np.ptp(np.concatenate([own(e).dot(other(e))[0] for e in np.eye(3)]))
    assert moved > 0.02, "the joint moves"
    for value, rate, acceleration in held:
        assert max(np.abs(value).max(), np.abs(rate).max() / 10.0, np.abs(acceleration).max() / 100.0) < 1e-12


def test_reaction_is_the_inertial_balance(hung: tuple[str, Any, Any, Any, Any]) -> None:
    """Force and moment about the marker on the body cut free: m (a - g), and J alpha + omega x J omega + arm x force."""
    _, result, body, _, joint = hung
    force = 1.5 * (result.acceleration(body.at()) - (0.0, 1.0, -9.81))
    axes = [arrow(result, body, e) for e in np.eye(3)]
    spread = 0.5 * J.sum() - J  # int x_i^2 dm
    momentum = sum(e * np.cross(x.value, x.acceleration) for e, x in zip(spread, axes))
    arm = result.position(body.at()) - result.position(body.at(-0.2, -0.2, 0.1))
    expected = np.concatenate((force, momentum + np.cross(arm, force)), axis=1)
    assert np.abs(result.reaction(joint) - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("dimension", [2, 3])
def test_mistakes_are_named(dimension: int) -> None:
    d, scene = dimension, mbd.Scene(gravity=ZERO[dimension])
    inertia = {2: 1.0, 3: (1, 1, 1)}[d]
    a, b = (scene.add(mbd.RigidBody(mass=1.0, inertia=inertia, position=np.ones(d) * k, name=f"body {k}")) for k in range(2))
    bead = scene.add(mbd.Particle(1.0, np.zeros(d), name="bead"))
    x, axis = np.eye(d)[0], None if d == 2 else Z
    expected = {
        "flat": (mbd.Universal(a.at(), b.at(), axes=[(1, 0, 0), (1, 1, 0)]), {2: "expected a spatial one", 3: "two perpendicular directions"}),
        "bead on a": (mbd.Cylindrical(bead.at(), b.at(), axis=np.eye(3)[0]), {2: "use a Slider", 3: "expected a body or the ground"}),
        "plane": (mbd.Planar(a.at(), b.at(), normal=np.zeros(3)), {2: "leave the joint out", 3: "zero vector"}),
        "turn": (mbd.Angle(bead, b, axis=axis), "expected one that carries an axis"),
        "line": (mbd.Displacement(a, bead, axis=x), "expected the line on a body"),
        "none": (mbd.Gear(a, b, axis=axis), "expected exactly one of ratio=, radii= and teeth=, found none"),
        "zero": (mbd.Gear(a, b, radii=(1.0, 0.0), axis=axis), "radii: expected two numbers other than 0"),
        "own": (mbd.Gear(a, b, ratio=1.0, carrier=a, axis=axis), "which is the carrier"),
        "rack": (mbd.Rack(a, b, axis=x, radius=0.0, shaft=axis), "radius: expected a number other than 0"),
        "terms": (mbd.Coupling([(1.0, a)]), "expected a measure"),
        "pairs": (mbd.Coupling([1.0, 2.0]), "expected pairs"),
        "disc": (mbd.Rolling(a, b, axis=x, radius=-1.0), {2: "radius: expected a positive number", 3: "expected a planar one"}),
    }
    for name, (description, _) in expected.items():
        object.__setattr__(description, "name", name)
        scene.add(description)
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    for name, (description, words) in expected.items():
        line = next(line for line in error.value.complaints if line.startswith(f"{description.kind} {name!r}:"))
        assert (words if isinstance(words, str) else words[d]) in line
    assert len(error.value.complaints) == len(expected)


def test_a_refused_measure_is_complained_of_once() -> None:
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    turn = scene.add(mbd.Angle(body, scene.ground, axis=(0, 0, 1), name="turn"))
    scene.add(mbd.Coupling([(1.0, turn)], value=0.0))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    assert len(error.value.complaints) == 1 and "angle 'turn': axis: expected none" in error.value.complaints[0]


def test_points_without_direction_are_refused() -> None:
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    scene.add(mbd.Length(body, scene.ground, name="nothing"))
    scene.add(mbd.Rolling(body, scene.ground, axis=(1, 0), radius=1.0, name="inside"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    assert "length 'nothing': markers: expected points apart" in error.value.complaints[0]
    assert "rolling disc 'inside': markers: expected the disc on one side" in error.value.complaints[1]
