"""Equilibria of beams against the elastica's references, of mechanisms against formulas, and what is said where there is none."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from scipy.integrate import trapezoid

import mbd

from .. import machines

LENGTH, HEIGHT, E = 1.0, 0.01, 2.07e11
EI = E * HEIGHT**4 / 12


def cantilever(n: int, d: int = 2, height: float = HEIGHT, **options: Any) -> tuple[mbd.Scene, Any, Any]:
    """A steel beam of 1 m along x, clamped at the origin, of bending stiffness EI whatever its height: scene, beam, clamp."""
    scene = mbd.Scene(gravity=(0.0,) * d)
    modulus = EI * 12 / height**4
    tip = (LENGTH, *(0.0,) * (d - 1))
    section = {"E": modulus, "A": height**2, "I": height**4 / 12, "rho": 7800.0}
    beam = scene.add(mbd.AncfCable((0.0,) * d, tip, n_elements=n, name="beam", **section, **options))
    return scene, beam, scene.add(mbd.Clamp(beam.start, scene.ground.at(*(0.0,) * d), name="clamp"))


def rod(angle: float) -> tuple[mbd.Scene, Any, Any]:
    """A rigid rod of 1 m and 1 kg on a pin, turned by an angle from the x axis: scene, rod, pin."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (np.cos(angle), np.sin(angle)), mass=1.0, name="rod"))
    return scene, body, scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0), name="pin"))


def tip_errors(load: Any, exact: np.ndarray, **options: Any) -> np.ndarray:
    errors = []
    for n in (8, 16, 32):
        scene, beam, _ = cantilever(n, **options)
        scene.add(load(beam.end))
        errors.append(np.linalg.norm(mbd.equilibrium(scene).position(beam.end) - exact))
    return np.array(errors)


@pytest.mark.parametrize("turns", ["0.25", "0.5", "0.75", "1"])
def test_roll_up(turns: str) -> None:
    """Order 4 of the mesh; a full turn at most Exudyn's errors at 8, 16 and 32 elements (measured: 2.0e-3, 9.8e-5, 6.1e-6)."""
    exact = np.array(machines.data("rollup_end_moment")["reference"][turns], dtype=float)
    errors = tip_errors(lambda end: mbd.Torque(end, float(turns) * 2 * np.pi * EI / LENGTH), exact)
    assert (errors <= (3.1e-3, 1.2e-4, 7.5e-6)).all()
    assert np.log2(errors[:-1] / errors[1:]).min() > 3.5


@pytest.mark.parametrize("turns", [1.0, 2.0])
def test_roll_up_takes_twenty_iterations_at_most(turns: float) -> None:
    scene, beam, clamp = cantilever(32)
    scene.add(mbd.Torque(beam.end, turns * 2 * np.pi * EI / LENGTH))
    found = mbd.equilibrium(scene)
    assert found.stats["iterations"] <= 20 and found.stable and not found.stats["falls"]
    assert found.reaction(clamp) == pytest.approx([0.0, 0.0, -turns * 2 * np.pi * EI], abs=1e-9 * EI)
    assert found.elastic_energy == pytest.approx(0.5 * (turns * 2 * np.pi) ** 2 * EI, rel=2e-4)


# Exudyn 1.13.6, ANCFCable2D as it comes, the same beam: tip errors at 8, 16 and 32 elements, measured 2026-11-21.
EXUDYN = {"1": (3.7918e-4, 1.0446e-5, 2.3252e-7), "10": (2.7930e-3, 3.6268e-4, 8.7684e-6)}


@pytest.mark.parametrize("load", ["1", "10"])
def test_elastica(load: str) -> None:
    """A height of 3 mm keeps the stretch, which the reference leaves out, at 2e-7 and 6e-6; the order is 5 above that. With 7 Gauss points
    the errors are Exudyn's within 1 %."""
    _, w, u = (float(x) for x in machines.data("elastica_tip_load")["reference"][load])
    errors = tip_errors(lambda end: mbd.Force(end, (0.0, float(load) * EI / LENGTH**2)), np.array([LENGTH - u, w]), height=3e-3, gauss_points=3)
    assert (errors <= EXUDYN[load]).all()
    assert np.log2(errors[0] / errors[2]) > 2 * 4.0


@pytest.mark.parametrize("load", [100.0, 1e4])
def test_loads_of_any_size(load: float) -> None:
    """Force and moment of the whole; the clamp's moment is that of the load about it."""
    scene, beam, clamp = cantilever(64)
    scene.add(mbd.Force(beam.end, (0.0, load * EI)))
    found = mbd.equilibrium(scene)
    x, y = found.position(beam.end)
    assert y > 0.9 * LENGTH
    assert found.reaction(clamp) == pytest.approx([0.0, -load * EI, -load * EI * x], rel=1e-9, abs=1e-9 * load * EI)


@pytest.mark.parametrize("steps", [1, 4, 9])
def test_load_steps_do_not_matter(steps: int) -> None:
    scene, beam, _ = cantilever(16)
    scene.add(mbd.Torque(beam.end, np.pi * EI))
    scene.add(mbd.Force(beam.at(0.5), (2.0 * EI, 0.0)))
    assert mbd.equilibrium(scene, load_steps=steps).position(beam.end) == pytest.approx(mbd.equilibrium(scene).position(beam.end), abs=1e-9)


def test_plane_and_space_agree() -> None:
    tips = []
    for d in (2, 3):
        scene, beam, _ = cantilever(8, d)
        scene.add(mbd.Force(beam.end, (-EI, 3.0 * EI, 0.0)[:d]))
        tips.append(mbd.equilibrium(scene).position(beam.end)[:2])
    assert tips[0] == pytest.approx(tips[1], abs=1e-10)


def test_follower_force_keeps_its_angle() -> None:
    """The moment at the clamp and the force on it are those of a force that turned with the end."""
    scene, beam, clamp = cantilever(24)
    scene.add(mbd.Force(beam.end, (0.0, 5.0 * EI), follower=True))
    found = mbd.equilibrium(scene)
    angle = found.angle(beam.end)
    force = 5.0 * EI * np.array([-np.sin(angle), np.cos(angle)])
    x, y = found.position(beam.end)
    assert abs(angle) > 1.5
    assert found.reaction(clamp) == pytest.approx([*-force, -(x * force[1] - y * force[0])], rel=1e-8)


def test_an_equilibrium_stays_at_rest_in_a_simulation() -> None:
    """Prestressed, with constraints and gravity; and it starts another equilibrium without an iteration of motion."""
    scene = mbd.Scene()
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=8, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
    ends = [scene.add(mbd.Pin(beam.start, scene.ground.at(0, 0))), scene.add(mbd.Pin(beam.end, scene.ground.at(1, 0)))]
    found = mbd.equilibrium(scene)
    assert sum(found.reaction(end)[1] for end in ends) == pytest.approx(9.81 * 0.1, rel=1e-10)
    result = mbd.simulate(scene, 0.3, start=found.state)
    assert np.abs(result.q - found.q).max() < 1e-9
    assert np.array_equal(mbd.simulate(scene, 0.01, start=found).q[0], found.q)
    again = mbd.equilibrium(scene, start=found.state)
    assert again.stats["iterations"] <= 3 and again.q == pytest.approx(found.q, abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, -1.0, 3.0, np.pi / 2 + 0.1])
def test_a_pendulum_falls_until_it_hangs(angle: float) -> None:
    scene, body, pin = rod(angle)
    found = mbd.equilibrium(scene)
    assert found.position(body.at(0.5, 0)) == pytest.approx([0.0, -1.0], abs=1e-9)
    assert found.reaction(pin) == pytest.approx([0.0, 9.81, 0.0], abs=1e-8)
    assert found.stable and found.stats["falls"] == 1


def test_an_upright_pendulum_is_in_balance_and_unstable() -> None:
    found = mbd.equilibrium(rod(np.pi / 2)[0])
    assert found.unstable == 1 and found.kind == "unstable (1 ways)"


def test_catenary_of_links() -> None:
    """Ends of a chain of rigid rods: half its weight, and every pin in balance with what hangs below it."""
    scene, n, span = mbd.Scene(), 10, 6.0
    depth = np.sqrt((n / 2) ** 2 - (span / 2) ** 2)
    points = [np.array([span * k / n, -depth * min(k, n - k) / (n / 2)]) for k in range(n + 1)]
    pins, end = [], scene.ground.at(0, 0)
    for a, b in zip(points, points[1:]):
        link = scene.add(mbd.RigidBody.rod(a, b, mass=1.0))
        pins.append(scene.add(mbd.Pin(link.at(-0.5, 0), end)))
        end = link.at(0.5, 0)
    scene.add(mbd.Pin(end, scene.ground.at(span, 0)))
    found = mbd.equilibrium(scene)
    forces = np.array([found.reaction(pin)[:2] for pin in pins])
    assert found.stable
    assert forces[:, 1] == pytest.approx(9.81 * (n / 2 - np.arange(n)), abs=1e-8)
    assert np.ptp(forces[:, 0]) < 1e-8


def driven_beam(angle: float) -> tuple[mbd.Scene, Any, Any]:
    scene = mbd.Scene()
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=8, E=1e9, A=1e-4, I=1e-9, rho=1000.0, name="beam"))
    hub = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="hub"))
    scene.add(mbd.Pin(hub.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Clamp(beam.start, hub.at()))
    return scene, beam, scene.add(mbd.Motor(hub, scene.ground, angle=lambda t: angle * t, name="motor"))


@pytest.mark.parametrize("turned", [0.4, 3.0])
def test_drives_stand_where_they_are_at_that_time(turned: float) -> None:
    """The motor's torque is the moment of the beam's weight about it."""
    scene, beam, motor = driven_beam(0.2)
    found = mbd.equilibrium(scene, t=turned / 0.2)
    points = np.array([found.position(beam.at(s)) for s in np.linspace(0, 1, 401)])
    lever = trapezoid(points[:, 0], dx=1 / 400)
    assert found.angle(beam.start) == pytest.approx(turned, abs=1e-9)
    assert found.reaction(motor)[2] == pytest.approx(9.81 * 0.1 * lever, rel=1e-6)
    assert found.state.t == turned / 0.2


def test_a_controller_with_a_target_that_moves() -> None:
    """The target and its rate pull as they do at that time: p (c - phi) + d c' = m g l / 2 cos(phi)."""
    scene, t, p, d = mbd.Scene(gravity=(0.0, -9.81)), 0.4, 100.0, 3.0
    bar = scene.add(mbd.RigidBody.rod((0.0, 0.0), (1.0, 0.0), mass=1.0))
    scene.add(mbd.Pin(bar.at(-0.5, 0.0), scene.ground.at(0.0, 0.0)))
    target = mbd.Motion(lambda t: 0.1 + t**2, rate=lambda t: 2.0 * t)
    scene.add(mbd.PD(scene.add(mbd.Angle(bar, scene.ground)), target, proportional=p, derivative=d))
    phi = mbd.equilibrium(scene, t=t).angle(bar)
    assert p * (0.1 + t**2 - phi) + d * 2.0 * t == pytest.approx(0.5 * 9.81 * np.cos(phi), rel=1e-9)


def test_a_taut_rope_sags() -> None:
    """Straight and without tension at the start, with next to no bending stiffness. A parabola: EA strain^3 = (w L)^2 / 24."""
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    rope = scene.add(mbd.AncfCable((0, 0, 0), (2, 0, 0), n_elements=16, E=1e9, A=1e-6, I=1e-15, rho=1000.0))
    pin = scene.add(mbd.Ball(rope.start, scene.ground.at(0, 0, 0)))
    scene.add(mbd.Ball(rope.end, scene.ground.at(2, 0, 0)))
    found = mbd.equilibrium(scene)
    weight = 9.81 * 1e-3 * 2
    assert found.reaction(pin)[2] == pytest.approx(weight / 2, rel=1e-9)
    assert -found.reaction(pin)[0] == pytest.approx(1e3 * (weight**2 / 24 / 1e6) ** (1 / 3), rel=2e-3)


def test_a_body_that_nothing_loads_stays_and_is_not_unique() -> None:
    scene = mbd.Scene(gravity=(0, 0))
    scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0.3, 0.0), name="block"))
    with pytest.warns(mbd.SceneWarning, match="not unique: 'block' can move without resistance"):
        found = mbd.equilibrium(scene)
    assert found.neutral == 3 and not found.stable and found.q == pytest.approx(scene.build().q0)


def _falling() -> mbd.Scene:
    scene = mbd.Scene()
    scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="block"))
    return scene


def _spun() -> mbd.Scene:
    """More torque than the weight at any angle balances."""
    scene, body, _ = rod(0.0)
    scene.add(mbd.Torque(body.at(0, 0), 9.81 * 0.5 * 1.5))
    return scene


def _dead_centre() -> mbd.Scene:
    """Two links in line between two pins, loaded across."""
    scene = mbd.Scene(gravity=(0, 0))
    a = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="a"))
    b = scene.add(mbd.RigidBody.rod((1, 0), (2, 0), mass=1.0, name="b"))
    scene.add(mbd.Pin(a.at(-0.5, 0), scene.ground.at(0, 0), name="left"))
    scene.add(mbd.Pin(a.at(0.5, 0), b.at(-0.5, 0), name="knee"))
    scene.add(mbd.Pin(b.at(0.5, 0), scene.ground.at(2, 0), name="right"))
    scene.add(mbd.Force(a.at(0.5, 0), (0, -10.0)))
    return scene


@pytest.mark.parametrize(
    ("build", "item", "words"),
    [(_falling, "block", "nothing holds"), (_spun, "rod", "keeps turning"), (_dead_centre, "left", "'left', 'knee', 'right' depend on each other")],
)
def test_no_equilibrium_names_what_gives_way(build: Any, item: str, words: str) -> None:
    with pytest.raises(mbd.SimulationError, match=words) as raised, warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        mbd.equilibrium(build())
    assert raised.value.item == item and "no equilibrium found" in str(raised.value)


def test_joints_that_cannot_close_are_refused_by_name() -> None:
    scene, body, _ = rod(0.0)
    scene.add(mbd.Pin(body.at(0.5, 0), scene.ground.at(3, 0), name="too far"))
    with pytest.raises(mbd.SceneError, match="too far"):
        mbd.equilibrium(scene)


def test_joints_close_on_the_way() -> None:
    """A spring between a hook and an eye: it is stretched as the eye is hooked, and its force is the reaction."""
    scene = mbd.Scene(gravity=(0, 0))
    bead = scene.add(mbd.Particle(1.0, (1.0, 0.0)))
    scene.add(mbd.Spring(bead.at(), scene.ground.at(0, 0), stiffness=10.0))
    hook = scene.add(mbd.Pin(bead.at(), scene.ground.at(1.5, 0.0)))
    assert mbd.equilibrium(scene).reaction(hook)[:2] == pytest.approx([5.0, 0.0], abs=1e-12)


def test_bad_arguments_are_listed_together() -> None:
    with pytest.raises(mbd.SceneError) as raised:
        mbd.equilibrium(rod(0.0)[0], load_steps=0, t=np.nan)
    assert len(raised.value.complaints) == 2


def test_large_systems_count_the_same() -> None:
    """The inertia by sparse pivots is that by Bunch and Kaufman's, for stable, unstable and neutral states."""
    from mbd.assembly import prepare
    from mbd.solvers import kkt

    scene, *_ = cantilever(12)
    system = scene.build()
    linear, _ = prepare(system, system.q0)
    matrix = kkt.Kkt(system, linear)
    joints, still, thrust = system.joints.at(system.q0), np.zeros(system.n), np.zeros(system.n_stresses)
    for load in (0.0, -3.0, -30.0, -80.0):
        stretches = np.s_[:, 0]  # of each element the stretches come before the curvatures
        shape = system.measures[0].modulus.shape
        thrust.reshape(shape)[stretches] = load * EI * system.modulus.reshape(shape)[stretches] / (E * HEIGHT**2)
        tangent = linear.tangent(joints.gradient, system.stiffness(system.q0, still, system.inputs(0.0), thrust, np.zeros(system.m)))
        rows, cols, values = matrix.entries(matrix.buffer(tangent, 0.0)[0])
        dense = kkt._dense_negatives(rows, cols, values, linear.size)
        buffer, size = matrix.buffer(tangent, 0.0)
        buffer[matrix._corner] -= kkt.CORNER * size
        assert kkt._sparse_negatives(*matrix.entries(buffer), linear.size) == dense
        full = np.zeros((linear.size, linear.size))
        full[rows, cols] = values
        assert np.sum(np.linalg.eigvalsh(full) < 0.0) == dense
        assert dense - system.m == {0.0: 0, -3.0: 1, -30.0: 2, -80.0: 3}[load]


def test_follower_forces_are_judged_by_their_motion() -> None:
    """Beck's column is stable to 20.05 EI / L^2, although its energy alone would say otherwise."""
    for load, unstable in ((15.0, 0), (25.0, 1)):
        scene, beam, _ = cantilever(8)
        scene.add(mbd.Force(beam.end, (-load * EI, 0.0), follower=True))
        assert mbd.equilibrium(scene).unstable == unstable


def test_a_fine_mesh_is_not_taken_for_loose() -> None:
    """With 2000 elements the bending stiffness is lost in the rounding of the matrix, not in that of the strains; and it is fast."""
    scene, beam, _ = cantilever(2000)
    scene.add(mbd.Torque(beam.end, 2 * np.pi * EI))
    with warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        found = mbd.equilibrium(scene)
    assert found.stable and found.stats["iterations"] <= 20
    assert np.linalg.norm(found.position(beam.end)) < 1e-6


def test_redundant_joints_share_the_load() -> None:
    scene, body, pin = rod(0.0)
    twin = scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0), name="twin"))
    with pytest.warns(mbd.SceneWarning, match="redundant"):
        found = mbd.equilibrium(scene)
    assert found.stats["redundant"] == ("pin", "twin") and found.stable
    for joint in (pin, twin):
        assert found.reaction(joint) == pytest.approx([0.0, 9.81 / 2, 0.0], abs=1e-9)
