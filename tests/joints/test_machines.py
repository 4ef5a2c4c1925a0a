"""Machines modelled in two ways, or against closed forms: shafts, gears, racks, rolling discs, couplings of measures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mbd

TWO_WAYS = 1e-9
"""Asked for two models of one machine; runs at rtol 1e-11 differ by some 1e-10."""
G = 9.81


def run(scene: mbd.Scene, t_end: float) -> Any:
    return mbd.simulate(scene, t_end, rtol=1e-11, t_eval=np.linspace(0.0, t_end, 9))


# In space: a body on a driven one, by a joint or by what the joint means.

N = np.array((1.0, -2.0, 2.0)) / 3.0
ACROSS = (np.array((2.0, 1.0, 0.0)), np.array((-2.0, 4.0, 5.0)) / 3.0)
HERE = np.array((-0.2, -0.1, 0.1))


def _held(scene: Any, body: Any, carrier: Any, points: list[Any], directions: list[Any]) -> None:
    """Each point of the body keeps its displacement along a direction of the carrier."""
    for point, axis in zip(points, directions):
        scene.add(mbd.Coupling([(1.0, scene.add(mbd.Displacement(body.at(*point), carrier.at(0.2, 0.1, 0.1), axis=axis)))]))


def _ball_and_axes(s: Any, a: Any, b: Any) -> None:
    """The axes are perpendicular: no displacement of the tip of the one along the other."""
    s.add(mbd.Ball(a.at(*HERE), b.at(0.2, 0.1, 0.1)))
    _held(s, a, b, [HERE + ACROSS[0]], [N])


def _cylinder(s: Any, a: Any, b: Any) -> None:
    for point in (HERE, HERE - 0.5 * N):
        s.add(mbd.PointOnLine(a.at(*point), b.at(0.2, 0.1, 0.1), axis=N))


def _slider(s: Any, a: Any, b: Any) -> None:
    _cylinder(s, a, b)
    s.add(mbd.Coupling([(1.0, s.add(mbd.Angle(a, b, axis=N)))], value=0.0))


WAYS: dict[str, tuple[Callable[[Any, Any], Any], Callable[[Any, Any, Any], None]]] = {
    "universal": (lambda a, b: mbd.Universal(a, b, axes=[ACROSS[0], N]), _ball_and_axes),
    "cylindrical": (lambda a, b: mbd.Cylindrical(a, b, axis=N), _cylinder),
    "planar": (lambda a, b: mbd.Planar(a, b, normal=N), lambda s, a, b: _held(s, a, b, [HERE, HERE + ACROSS[0], HERE + ACROSS[1]], [N] * 3)),
    "slider": (lambda a, b: mbd.Slider(a, b, axis=N), _slider),
}


@pytest.mark.parametrize("name", WAYS)
def test_a_spatial_joint_and_what_it_means(name: str) -> None:
    found = []
    for way in (0, 1):
        scene, spin = mbd.Scene(gravity=(0.0, 1.0, -G)), np.array((0.0, 0.0, 2.0))
        carrier = scene.add(mbd.RigidBody(mass=3.0, inertia=(1.0, 1.2, 0.9), position=(0, 0, 0), angular_velocity=spin))
        scene.add(mbd.Pin(carrier.at(), scene.ground.at(), axis=(0, 0, 1)))
        scene.add(mbd.Motor(carrier, scene.ground, axis=(0, 0, 1), angle=lambda t: 2.0 * t + t**2))
        centre = np.array((0.2, 0.1, 0.1)) - HERE
        body = scene.add(
            mbd.RigidBody(mass=1.5, inertia=(0.3, 0.4, 0.5), position=centre, velocity=np.cross(spin, centre), angular_velocity=spin, name="body")
        )
        if way:
            WAYS[name][1](scene, body, carrier)
        else:
            scene.add(WAYS[name][0](body.at(*HERE), carrier.at(0.2, 0.1, 0.1)))
        result = run(scene, 0.5)
        found.append([result.position(body.at()), result.velocity(body.at()), result.rotation(body)])
    for x, y in zip(*found):
        assert np.abs(x - y).max() < TWO_WAYS


def test_cardan_shaft() -> None:
    """tan(out) = tan(in) cos(bend) for the two shafts, joined by a universal joint, the driven one at constant speed."""
    bend, scene = 0.5, mbd.Scene(gravity=(0, 0, 0))
    out = np.array((np.cos(bend), np.sin(bend), 0.0))
    frame = np.column_stack((out, (-np.sin(bend), np.cos(bend), 0.0), (0, 0, 1)))
    first = scene.add(mbd.RigidBody(mass=1.0, inertia=(0.1, 0.2, 0.2), position=(-0.5, 0, 0)))
    second = scene.add(mbd.RigidBody(mass=1.0, inertia=(0.1, 0.2, 0.2), position=0.5 * out, rotation=frame))
    scene.add(mbd.Pin(first.at(), scene.ground.at(-0.5, 0, 0), axis=(1, 0, 0)))
    scene.add(mbd.Motor(first, scene.ground, axis=(1, 0, 0), speed=3.0))
    scene.add(mbd.Universal(first.at(0.5, 0, 0), second.at(-0.5, 0, 0), axes=[(0, 0, 1), frame[:, 1]]))
    scene.add(mbd.PointOnLine(second.at(0.5, 0, 0), scene.ground.at(), axis=out))
    turn = scene.add(mbd.Angle(second, scene.ground, axis=out))
    result = mbd.simulate(scene, 3.0, rtol=1e-9)
    phi, psi = 3.0 * result.t, result.q[:, turn.coordinate]
    assert np.abs(np.sin(psi) * np.cos(phi) - np.cos(psi) * np.sin(phi) * np.cos(bend)).max() < 1e-9
    assert np.abs(psi - phi).max() > 0.05, "it does not turn evenly"
    assert psi[-1] == pytest.approx(phi[-1], abs=0.2), "turns are counted"


def two_links(space: bool) -> tuple[np.ndarray, np.ndarray]:
    """Two links of 2 kg, the first driven at a speed, the second by a torque: their relative turn, and the moment of the first motor.
    In the plane, or in the plane xz of space with axes along -y."""
    lift: Callable[..., Any] = (lambda x, y: (x, 0.0, y)) if space else (lambda x, y: (x, y))
    words = {"axis": (0, -1, 0)} if space else {}
    scene = mbd.Scene(gravity=lift(0, -G))
    inertia = (0.01, 0.2, 0.2) if space else 0.2
    links = [scene.add(mbd.RigidBody(mass=2.0, inertia=inertia, position=lift(k + 0.5, 0))) for k in range(2)]
    scene.add(mbd.Pin(links[0].at(*lift(-0.5, 0)), scene.ground.at(), **words))
    scene.add(mbd.Pin(links[1].at(*lift(-0.5, 0)), links[0].at(*lift(0.5, 0)), **words))
    motor = scene.add(mbd.Motor(links[0], scene.ground, speed=lambda t: 2.0 + np.sin(t), **words))
    scene.add(mbd.Motor(links[1], links[0], torque=lambda t: 3.0 * np.cos(t), **words))
    turn = scene.add(mbd.Angle(links[1], links[0], **words))
    result = run(scene, 1.5)
    moment = result.reaction(motor)
    return result.q[:, turn.coordinate], -moment[:, 4] if space else moment[:, 2]


def test_motors_in_space_as_in_the_plane() -> None:
    (turn, moment), (twin, expected) = two_links(True), two_links(False)
    assert np.abs(turn - twin).max() < TWO_WAYS and np.abs(turn).max() > 2.0
    assert np.abs(moment - expected).max() < TWO_WAYS * np.abs(expected).max() * 10.0


# Gears, racks, wheels.


@pytest.mark.parametrize("space", [False, True], ids=["planar", "spatial"])
def test_gear_pair_is_one_inertia(space: bool) -> None:
    """J_a + J_b (r_a / r_b)^2 behind a torque; the moment of the mesh is the inertial balance of the second wheel."""
    d, axis = (3, {"axis": (0, 0, 1)}) if space else (2, {})
    scene = mbd.Scene(gravity=np.zeros(d))
    wheels = []
    for k, moment in enumerate((0.4, 1.1)):
        inertia = (moment, moment, moment) if space else moment
        wheels.append(scene.add(mbd.RigidBody(mass=1.0, inertia=inertia, position=k * np.eye(d)[0])))
        scene.add(mbd.Pin(wheels[-1].at(), scene.ground.at(*(k * np.eye(d)[0])), **axis))
    gear = scene.add(mbd.Gear(*wheels, radii=(0.2, 0.5), **axis))
    scene.add(mbd.Motor(wheels[0], scene.ground, torque=lambda t: 2.0 + t, **axis))
    result = run(scene, 2.0)
    whole, t = 0.4 + 1.1 * 0.4**2, result.t
    turns = [result.q[:, scalar] for scalar in gear.scalars]
    assert np.abs(turns[0] - (t**2 + t**3 / 6.0) / whole).max() < TWO_WAYS
    assert np.abs(turns[1] + 0.4 * turns[0]).max() < TWO_WAYS
    mesh = result.reaction(gear)[:, -1]
    assert np.abs(mesh + 0.4**2 * 1.1 * (2.0 + t) / whole).max() < TWO_WAYS


def test_gear_on_a_moving_carrier() -> None:
    """Planetary train, ring held, sun driven: the carrier turns by r_s / (r_s + r_r); its moment of inertia includes planet and all."""
    sun_r, planet_r, scene = 0.2, 0.3, mbd.Scene(gravity=(0, 0))
    ring_r, arm_r = sun_r + 2.0 * planet_r, sun_r + planet_r
    sun = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0)))
    arm = scene.add(mbd.RigidBody(mass=1.0, inertia=0.3, position=(0, 0)))
    planet = scene.add(mbd.RigidBody(mass=2.0, inertia=0.2, position=(arm_r, 0)))
    for body in (sun, arm):
        scene.add(mbd.Pin(body.at(), scene.ground.at()))
    scene.add(mbd.Pin(planet.at(), arm.at(arm_r, 0)))
    scene.add(mbd.Gear(sun, planet, radii=(sun_r, planet_r), carrier=arm))
    scene.add(mbd.Gear(planet, scene.ground, radii=(planet_r, -ring_r), carrier=arm))
    scene.add(mbd.Motor(sun, scene.ground, torque=1.5))
    result = run(scene, 1.5)
    share = sun_r / (sun_r + ring_r)
    spin = 1.0 - ring_r / planet_r  # turn of the planet for one of the carrier
    whole = 0.1 + share**2 * (0.3 + 2.0 * arm_r**2 + 0.2 * spin**2)
    turn = 0.75 * result.t**2 / whole
    for body, factor in ((sun, 1.0), (arm, share), (planet, share * spin)):
        assert np.abs(result.angle(body) - factor * turn).max() < TWO_WAYS


def test_bevel_gear() -> None:
    """Shafts along x and y: turns about each in the ratio of the teeth, and the drive feels J_a + J_b (z_a / z_b)^2."""
    scene = mbd.Scene(gravity=(0, 0, 0))
    a, b = (scene.add(mbd.RigidBody(mass=1.0, inertia=(0.3, 0.4, 0.5), position=x)) for x in ((1, 0, 0), (0, 1, 0)))
    scene.add(mbd.Pin(a.at(), scene.ground.at(1, 0, 0), axis=(1, 0, 0)))
    scene.add(mbd.Pin(b.at(), scene.ground.at(0, 1, 0), axis=(0, 1, 0)))
    gear = scene.add(mbd.Gear(a, b, teeth=(20, 40), axis=[(1, 0, 0), (0, 1, 0)]))
    scene.add(mbd.Torque(a.at(), (2.0, 0.0, 0.0)))
    result = run(scene, 2.0)
    turn = result.t**2 / (0.3 + 0.4 / 4.0)
    assert np.abs(result.q[:, gear.scalars[0]] - turn).max() < TWO_WAYS
    assert np.abs(result.angular_velocity(b)[:, 1] + result.t / 0.4).max() < TWO_WAYS
    assert result.reaction(gear)[:, 3] == pytest.approx(-2.0 * 0.1 / 0.4, abs=1e-9)


@pytest.mark.parametrize("carried", [False, True], ids=["on the ground", "on a cart"])
def test_rack_and_pinion(carried: bool) -> None:
    """The rack falls and turns the pinion: a = m g / (m + J / r^2), also on a cart that is pushed sideways."""
    scene, radius = mbd.Scene(), -0.25
    base: Any = scene.ground
    if carried:
        base = scene.add(mbd.RigidBody(mass=5.0, inertia=1.0, position=(0, 0)))
        scene.add(mbd.Slider(base.at(), scene.ground.at(), axis=(1, 0)))
        scene.add(mbd.Force(base.at(), (20.0, 0.0)))
    pinion = scene.add(mbd.RigidBody(mass=1.0, inertia=0.2, position=(0.25, 0)))
    rack = scene.add(mbd.RigidBody(mass=3.0, inertia=0.1, position=(0, 0.3)))
    scene.add(mbd.Pin(pinion.at(), base.at(0.25, 0)))
    scene.add(mbd.Slider(rack.at(), base.at(0, 0), axis=(0, 1)))
    mesh = scene.add(mbd.Rack(pinion, rack, axis=(0, 1), radius=radius, carrier=base if carried else None))
    result = run(scene, 1.0)
    fall = 3.0 * G / (3.0 + 0.2 / radius**2)
    assert np.abs(result.position(rack.at())[:, 1] - 0.3 + 0.5 * fall * result.t**2).max() < TWO_WAYS
    assert np.abs(result.angle(pinion) + 0.5 * fall * result.t**2 / radius).max() < TWO_WAYS
    assert result.reaction(mesh)[:, 2] == pytest.approx(-0.2 * fall / radius, abs=1e-9)
    if carried:
        assert np.abs(result.position(base.at())[:, 0] - 0.5 * 20.0 / 9.0 * result.t**2).max() < TWO_WAYS


@pytest.mark.parametrize("below", [False, True], ids=["above the line", "below it"])
def test_disc_rolls_down_an_incline(below: bool) -> None:
    """a = g sin(slope) / (1 + J / m r^2); the line pushes with m g cos(slope) and holds with J a / r^2. The disc starts where it rolls."""
    scene, radius, slope = mbd.Scene(), 0.4, 0.3
    down, up = np.array((np.cos(slope), -np.sin(slope))), np.array((np.sin(slope), np.cos(slope)))
    side = -1.0 if below else 1.0
    disc = scene.add(mbd.RigidBody(mass=2.0, inertia=0.15, position=(1, 2) + side * radius * up))
    line = scene.add(mbd.Rolling(disc, scene.ground.at(1, 2), axis=3.0 * down, radius=radius))
    result = run(scene, 1.0)
    a = G * np.sin(slope) / (1.0 + 0.15 / (2.0 * radius**2))
    way = 0.5 * a * result.t**2
    assert np.abs(result.position(disc.at()) - (1, 2) - side * radius * up - way[:, None] * down).max() < TWO_WAYS
    assert np.abs(result.angle(disc) + side * way / radius).max() < TWO_WAYS
    force = 2.0 * G * np.cos(slope) * up - 0.15 * a / radius**2 * down
    expected = np.tile((*force, -side * 0.15 * a / radius), (9, 1))
    assert np.abs(result.reaction(line) - expected).max() < 1e-9
    contact = disc.at(*(-side * radius * up))  # the material point that touches the line at the start
    assert np.abs(result.velocity(contact)[0]).max() < 1e-15
    assert result.acceleration(contact)[0] == pytest.approx(np.zeros(2), abs=1e-12)


def test_disc_rolls_on_a_swinging_plank() -> None:
    """On a body that moves, the contact point of the disc has the velocity of the plank there, at every instant."""
    scene = mbd.Scene()
    plank = scene.add(mbd.RigidBody.rod((-1, 0), (1, 0), mass=3.0))
    scene.add(mbd.Pin(plank.at(0, 0), scene.ground.at()))
    disc = scene.add(mbd.RigidBody(mass=1.0, inertia=0.02, position=(0.2, 0.2)))
    scene.add(mbd.Rolling(disc, plank.at(), axis=(1, 0), radius=0.2))
    result = run(scene, 0.6)
    tilt = result.angle(plank)
    up = np.stack((-np.sin(tilt), np.cos(tilt)), axis=1)
    arm = -0.2 * up
    spin = result.angular_velocity(disc)[:, None]
    contact = result.velocity(disc.at()) + spin * np.stack((-arm[:, 1], arm[:, 0]), axis=1)
    point = result.position(disc.at()) + arm
    plank_there = result.angular_velocity(plank)[:, None] * np.stack((-point[:, 1], point[:, 0]), axis=1)
    assert np.abs(contact - plank_there).max() < 1e-10 and np.ptp(tilt) > 0.1
    assert np.abs(np.sum(point * up, axis=1)).max() < 1e-12, "it touches"


def test_coupling_of_a_length_is_a_distance() -> None:
    """A rod as a coupled length and as Distance; then a pulley: two lengths whose sum is constant (Atwood's machine)."""
    swings = []
    for coupled in (False, True):
        scene = mbd.Scene()
        bob = scene.add(mbd.Particle(1.0, (1, 0)))
        if coupled:
            length = scene.add(mbd.Length(bob, scene.ground))
            scene.add(mbd.Coupling([(2.0, length)], value=2.0))
        else:
            length = scene.add(mbd.Distance(bob.at(), scene.ground.at()))
        result = run(scene, 1.5)
        swings.append((result.position(bob.at()), result.reaction(length)))
    assert all(np.abs(x - y).max() < 1e-8 for x, y in zip(*swings)) and np.abs(swings[0][0] - swings[1][0]).max() < TWO_WAYS
    scene = mbd.Scene()
    masses = [scene.add(mbd.Particle(m, (x, -1))) for m, x in ((1.0, -0.2), (3.0, 0.2))]
    ropes = [scene.add(mbd.Length(body.at(), scene.ground.at(x, 0))) for body, x in zip(masses, (-0.2, 0.2))]
    scene.add(mbd.Coupling([(1.0, ropes[0]), (1.0, ropes[1])], name="rope"))
    result = run(scene, 0.5)
    assert np.abs(result.position(masses[1].at())[:, 1] + 1.0 + 0.25 * G * result.t**2).max() < TWO_WAYS
    assert result.reaction(ropes[0])[:, 1] == pytest.approx(1.5 * G, abs=1e-9)


def test_driven_coupling() -> None:
    """A length that follows a function of t: a crane's rope hauled in, against the inertial balance."""
    scene = mbd.Scene()
    load = scene.add(mbd.Particle(2.0, (0, -3)))
    rope = scene.add(mbd.Length(load, scene.ground))
    scene.add(mbd.Coupling([(1.0, rope)], value=lambda t: 3.0 - 0.5 * t**2))
    result = mbd.simulate(scene, 1.0)
    assert np.abs(result.position(load.at())[:, 1] + 3.0 - 0.5 * result.t**2).max() < 1e-12
    assert result.reaction(rope)[:, 1] == pytest.approx(2.0 * (G + 1.0), abs=1e-8)


def test_rope_of_stiff_springs_tends_to_one_of_distances() -> None:
    """Three particles in series, started with the tensions of the distances: the difference falls as 1 / stiffness."""

    def swing(stiffness: float | None) -> np.ndarray:
        scene = mbd.Scene()
        before = scene.ground.at()
        for k in range(3):
            body = scene.add(mbd.Particle(1.0, (0.0, -1.0 - k), (0.2 * (k + 1.0), 0.0)))
            if stiffness is None:
                scene.add(mbd.Distance(body.at(), before))
            else:  # the tension at rest, and that of the turning rope, stretch the springs to a metre
                tension = sum(G + 0.04 * (j + 1.0) for j in range(k, 3))
                scene.add(mbd.Spring(body.at(), before, stiffness=stiffness, length=1.0 - tension / stiffness))
            before = body.at()
        return mbd.simulate(scene, 0.5, rtol=1e-11, solver=mbd.Radau(7)).position(before)[-1]

    true = swing(None)
    errors = [np.abs(swing(stiffness) - true).max() for stiffness in (1e4, 1e5, 1e6)]
    assert errors[-1] < 3e-6 and np.log10(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.2)
    assert np.log10(errors[1] / errors[2]) == pytest.approx(1.0, abs=0.2)


def test_pictures_of_transmissions() -> None:
    """Measures and couplings draw nothing of their own; a sleeve on the ground is a pivot."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    plt = pytest.importorskip("matplotlib.pyplot")
    scene = mbd.Scene()
    cable = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=1000))
    scene.add(mbd.BeamSlider(scene.ground.at(0.5, 0), cable))
    apart = scene.add(mbd.Length(cable.end, scene.ground.at(2, 3)))
    scene.add(mbd.Coupling([(1.0, apart)]))
    ax = mbd.simulate(scene, 0.05, rtol=1e-4).plot()
    pivots = [line for line in ax.lines if line.get_marker() == "^"]
    assert [point for line in pivots for point in zip(*line.get_data())] == [(0.5, 0.0)]
    plt.close("all")
