"""Motors and prescribed motions against closed forms, derivatives of targets, orders, inverse runs, mistakes by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.differences import derivative, integral

from .machines import data

G = 9.81
SOLVERS = [mbd.Radau(7), mbd.GeneralizedAlpha(0.01), mbd.DormandPrince()]
by_solver = pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: type(solver).__name__)


def crank(**drive: Any) -> tuple[mbd.Scene, Any, Any, Any]:
    """A rod of 2 kg and 1 m on a motor, horizontal at the start: scene, body, pin, motor."""
    scene = mbd.Scene(gravity=(0, -G))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=2.0, name="rod"))
    pin = scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    return scene, rod, pin, scene.add(mbd.Motor(rod, scene.ground, name="motor", **drive))


@by_solver
@pytest.mark.parametrize("drive", [{"angle": lambda t: 2.0 * t}, {"speed": 2.0}, {"speed": lambda t: 2.0}], ids=["angle", "speed", "function"])
@pytest.mark.filterwarnings("ignore:the energy is off")
def test_crank_at_constant_speed(solver: Any, drive: dict[str, Any]) -> None:
    """Torque and bearing force are the inertial balance, over three turns, which are counted."""
    scene, rod, pin, motor = crank(**drive)
    result = mbd.simulate(scene, 10.0, rtol=1e-6, solver=solver)
    phi = 2.0 * result.t
    assert result.angle(rod) == pytest.approx(phi, abs=1e-11) and result.angular_velocity(rod) == pytest.approx(2.0, abs=1e-11)
    torque = result.reaction(motor)
    assert torque[:, 2] == pytest.approx(2.0 * G * 0.5 * np.cos(phi), abs=1e-9) and not torque[:, :2].any()
    expected = np.stack((-4.0 * np.cos(phi), -4.0 * np.sin(phi) + 2.0 * G), axis=-1)
    assert result.reaction(pin)[:, :2] == pytest.approx(expected, abs=1e-9)
    between = np.linspace(0.05, 9.95, 7)
    assert result.angle(rod, t=between) == pytest.approx(2.0 * between, abs=1e-10)


@pytest.mark.filterwarnings("ignore:the energy is off")
def test_crank_carries_a_free_rod() -> None:
    """Two-link: the torque of the motor and the forces of the pins equal the inertial balance of both rods."""
    scene, rod, pin, motor = crank(angle=lambda t: 3.0 * t)
    second = scene.add(mbd.RigidBody.rod((1, 0), (1.8, 0), mass=1.0))
    scene.add(mbd.Pin(second.at(-0.4, 0), rod.at(0.5, 0)))
    result = mbd.simulate(scene, 1.0, rtol=1e-8)
    bodies = ((rod, 2.0, 2.0 / 12.0), (second, 1.0, 0.64 / 12.0))
    force, moment = 0.0, 0.0
    for body, mass, inertia in bodies:
        r, inertial = result.position(body.at()), mass * (result.acceleration(body.at()) + (0, G))
        first, tip = (result.acceleration(body.at(x, 0)) for x in (0.0, 0.1))
        angle = result.angle(body)
        alpha = (np.cos(angle) * (tip - first)[:, 1] - np.sin(angle) * (tip - first)[:, 0]) / 0.1
        force, moment = force + inertial, moment + r[:, 0] * inertial[:, 1] - r[:, 1] * inertial[:, 0] + inertia * alpha
    size = np.abs(force).max()
    assert np.abs(result.reaction(pin)[:, :2] - force).max() < 1e-9 * size
    assert np.abs(result.reaction(motor)[:, 2] - moment).max() < 1e-9 * size


@by_solver
@pytest.mark.filterwarnings("ignore:the energy is off")
def test_mass_on_a_shaken_base(solver: Any) -> None:
    """x'' + w^2 x = w^2 b sin(p t): base prescribed, a spring of natural frequency w. The reaction is the force of the spring and the base."""
    scene, w, p, b = mbd.Scene(gravity=(0, 0)), 5.0, 3.0, 0.2
    base, mass = scene.add(mbd.Particle(1.5, (0, 0))), scene.add(mbd.Particle(2.0, (1, 0)))
    shaker = scene.add(mbd.Prescribed(base.at(), lambda t: (b * np.sin(p * t), 0.0)))
    scene.add(mbd.Spring(mass.at(), base.at(), stiffness=2.0 * w**2))
    result = mbd.simulate(scene, 3.0, rtol=1e-9, solver=solver)
    t, forced = result.t, b * w**2 / (w**2 - p**2)
    x = forced * (np.sin(p * t) - p / w * np.sin(w * t))
    accuracy = 1e-3 if isinstance(solver, mbd.GeneralizedAlpha) else 1e-8
    assert np.abs(result.position(mass.at())[:, 0] - 1.0 - x).max() < accuracy
    assert np.abs(result.position(base.at())[:, 0] - b * np.sin(p * t)).max() < 1e-13
    assert np.abs(result.velocity(base.at())[:, 0] - b * p * np.cos(p * t)).max() < 1e-12
    expected = -1.5 * b * p**2 * np.sin(p * t) - 2.0 * w**2 * (x - b * np.sin(p * t))
    assert np.abs(result.reaction(shaker)[:, 0] - expected).max() < 100 * accuracy


def test_prescribed_pose_of_a_body_and_constants() -> None:
    """Angle and position are absolute: a body that starts turned by 0.4 stays where numbers put it, and turns as functions say."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(1, 2), angle=0.4))
    hold = scene.add(mbd.Prescribed(body.at(), (1, 2), angle=lambda t: 0.4 + 6.5 * t + t**2))
    other = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(3, 2), angle=-1.0))
    fixed = scene.add(mbd.Prescribed(other.at(0.5, 0), other.at(0.5, 0).point.value(scene.layout.start()[0]), angle=-1.0 + 4.0 * np.pi))
    assert not scene.build().joints.linear and len(scene.build().joints.drives) == 1
    result = mbd.simulate(scene, 2.0)
    assert result.angle(body) == pytest.approx(0.4 + 6.5 * result.t + result.t**2, abs=1e-10)
    assert result.reaction(hold) == pytest.approx(np.tile((0.0, G, 0.5 * 2.0), (len(result.t), 1)), abs=1e-9)
    assert result.reaction(fixed) == pytest.approx(np.tile((0.0, G, -0.5 * np.cos(1.0) * G), (len(result.t), 1)), abs=1e-9)


def test_motor_starts_away_from_its_assembly() -> None:
    """By more than half a turn: the turn is followed, and the start is announced as corrected."""
    scene, rod, *_ = crank(angle=lambda t: 4.0 + t)
    with pytest.warns(mbd.SceneWarning, match="'motor'"):
        result = mbd.simulate(scene, 1e-3)
    assert result.angle(rod)[0] % (2.0 * np.pi) == pytest.approx(4.0, abs=1e-12)


@pytest.mark.filterwarnings("error::mbd.SceneWarning")
def test_a_drive_that_starts_a_resting_mechanism_is_no_correction() -> None:
    assert mbd.assemble(crank(speed=3.0)[0]).corrections == ()


def test_torque_and_its_inverse() -> None:
    """A torque turns two bodies against each other; prescribing the angle that it gives takes the same torque."""

    def scene_of(**drive: Any) -> tuple[mbd.Scene, Any, Any]:
        scene = mbd.Scene(gravity=(0, 0))
        a, b = (scene.add(mbd.RigidBody(mass=1.0, inertia=j, position=(0, 0))) for j in (0.5, 2.0))
        scene.add(mbd.Pin(a.at(), b.at()))
        return scene, (a, b), scene.add(mbd.Motor(a, b, **drive))

    scene, (a, b), motor = scene_of(torque=lambda t: 6.0 * t)
    result = mbd.simulate(scene, 2.0, rtol=1e-9)
    assert result.angle(a) == pytest.approx(result.t**3 / 0.5, abs=1e-7) and result.angle(b) == pytest.approx(-(result.t**3) / 2.0, abs=1e-7)
    assert result.reaction(motor)[:, 2] == pytest.approx(6.0 * result.t, abs=1e-12)
    scene, (a, b), motor = scene_of(angle=mbd.Motion(lambda t: 2.5 * t**3, rate=lambda t: 7.5 * t**2, acceleration=lambda t: 15.0 * t))
    inverse = mbd.simulate(scene, 2.0, rtol=1e-9)
    assert inverse.reaction(motor)[:, 2] == pytest.approx(6.0 * inverse.t, abs=1e-9)


def driven_pendulum(derivatives: bool) -> mbd.Scene:
    """A free rod behind a crank whose angle swings."""
    angle: Callable[[float], float] = lambda t: 0.8 * np.sin(3.0 * t)  # noqa: E731
    given = mbd.Motion(angle, lambda t: 2.4 * np.cos(3.0 * t), lambda t: -7.2 * np.sin(3.0 * t)) if derivatives else angle
    scene, rod, *_ = crank(angle=given)
    second = scene.add(mbd.RigidBody.rod((1, 0), (1.8, 0), mass=1.0))
    scene.add(mbd.Pin(second.at(-0.4, 0), rod.at(0.5, 0)))
    return scene


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("solver, counts, order", [(lambda h: mbd.Radau(3, step=h), (30, 40, 60), 5), (mbd.GeneralizedAlpha, (200, 400, 800), 2)])
def test_orders_of_a_driven_scene(solver: Any, counts: tuple[int, ...], order: int) -> None:
    scene = driven_pendulum(True)
    true = mbd.simulate(scene, 1.0, rtol=1e-12, solver=mbd.Radau(7)).final
    errors = []
    for count in counts:
        found = mbd.simulate(scene, 1.0, rtol=1e-12, solver=solver(1.0 / count)).final
        errors.append([np.abs(found.q - true.q).max(), np.abs(found.v - true.v).max()])
    slopes = -np.diff(np.log(errors), axis=0) / np.diff(np.log(counts))[:, None]
    assert np.abs(slopes - order).max() < 0.3, slopes


@pytest.mark.filterwarnings("ignore")
def test_differences_are_as_good_as_given_derivatives() -> None:
    given, found = (mbd.simulate(driven_pendulum(derivatives), 1.0, rtol=1e-9) for derivatives in (True, False))
    assert np.abs(given.final.q - found.final.q).max() < 1e-11 and np.abs(given.final.v - found.final.v).max() < 1e-10


def spin_up(t: float) -> float:
    return 0.4 * (t**2 / 2.0 + (7.5 / np.pi) ** 2 * (np.cos(2.0 * np.pi * t / 15.0) - 1.0))


@pytest.mark.filterwarnings("ignore:the energy is off")
def test_spin_up_beam() -> None:
    """Simo and Vu-Quoc (1986), a cable clamped to a hub; 8 elements: the error of the mesh, fourth order, is some 1e-6 of the length."""
    book = data("spinup_beam")
    p, area = book["parameters"], 1e-2
    scene = mbd.Scene(gravity=(0, 0))
    hub = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    beam = scene.add(mbd.AncfCable((0, 0), (p["L"], 0), n_elements=8, E=p["EA"] / area, A=area, I=p["EI"] * area / p["EA"], rho=p["rhoA"] / area))
    scene.add(mbd.Prescribed(hub.at(), (0, 0), angle=spin_up))
    scene.add(mbd.Clamp(beam.start, hub.at()))
    result = mbd.simulate(scene, 3.0, rtol=1e-7)
    for row in book["values"][:3]:
        assert result.position(beam.end, t=row["t"]) == pytest.approx(row["end1"], abs=2e-5)
        assert result.position(beam.at(0.5), t=row["t"]) == pytest.approx(row["mid"], abs=2e-5)


@pytest.mark.parametrize("scale", [1e-5, 1e-2, 1.0, 30.0])
def test_differences(scale: float) -> None:
    """sin(t / scale) at any scale; polynomials and both sides of a kink exactly."""
    for t in np.linspace(-2.0, 7.0, 19) * scale:
        assert derivative(lambda x: np.sin(x / scale), t, 1) * scale == pytest.approx(np.cos(t / scale), abs=1e-12)
        assert derivative(lambda x: np.sin(x / scale), t, 2) * scale**2 == pytest.approx(-np.sin(t / scale), abs=1e-9)
        assert derivative(lambda x: x**3 - x, t, 2) == pytest.approx(6.0 * t, rel=1e-11, abs=1e-12)
    assert derivative(lambda x: 3.0 * np.maximum(x, 0.0), 1e-3, 1) == pytest.approx(3.0, abs=1e-12)
    assert integral(lambda x: np.where(x < 1 / 3, 0.0, np.cos(x)), 0.0, 5.0) == pytest.approx(np.sin(5.0) - np.sin(1 / 3), abs=1e-13)


def test_mistakes_are_named() -> None:
    scene = mbd.Scene()
    rod, bead = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0)), scene.add(mbd.Particle(1.0, (0, 0)))
    for name, drive in {
        "none": mbd.Motor(rod, scene.ground, name="none"),
        "two": mbd.Motor(rod, scene.ground, angle=1.0, speed=2.0, name="two"),
        "bead": mbd.Motor(bead, rod, speed=2.0, name="bead"),
        "text": mbd.Motor(rod, scene.ground, speed="fast", name="text"),
        "nothing": mbd.Prescribed(rod.at(), name="nothing"),
        "flat": mbd.Prescribed(rod.at(), (1, 2, 3), name="flat"),
    }.items():
        assert scene.add(drive).name == name
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    text = "\n".join(error.value.complaints)
    for words in ("motor 'none': expected exactly one of angle=, speed= and torque=, found none", "'two': expected exactly one",
                  "'bead': marker: expected one that carries an axis", "'text': speed: expected a number [rad/s]",
                  "prescribed motion 'nothing': expected position= or angle=", "'flat': position: expected 2 numbers"):  # fmt: skip
        assert words in text
    space = mbd.Scene(gravity=(0, 0, 0))
    body = space.add(mbd.RigidBody(mass=1.0, inertia=(1, 1, 1), position=(0, 0, 0)))
    space.add(mbd.Motor(body, space.ground, speed=1.0, name="screw"))
    with pytest.raises(mbd.SceneError, match="motor 'screw': axis: expected a direction in space, found none"):
        space.build()


@pytest.mark.parametrize("kind", ["angle", "speed", "torque"])
def test_a_function_that_fails_names_its_motor(kind: str) -> None:
    scene, *_ = crank(**{kind: lambda t: np.nan if t > 0.1 else 0.3 * t})
    with pytest.raises(mbd.SimulationError, match="at motor") as error:
        mbd.simulate(scene, 1.0)
    assert error.value.item == "motor" and error.value.result is not None and error.value.result.t[-1] <= 0.1


def test_conflicting_drives_are_refused() -> None:
    scene, *_ = crank(speed=1.0)
    scene.add(mbd.Motor(scene["rod"], scene.ground, speed=2.0, name="second"))
    with pytest.raises(mbd.SceneError, match=r"'second'.* velocities cannot satisfy them together"):
        mbd.simulate(scene, 1.0)
