"""Modes about a steady rotation against published frequencies, closed forms, a Rayleigh-Ritz computation and the full simulation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

import mbd

WRIGHT = {2.0: 4.1373, 4.0: 5.5850, 8.0: 9.2568, 12.0: 13.1702}
"""Omega T -> first flapping omega T of a cantilever, hub radius 0, T^2 = rho A L^4 / EI (Wright, Smith, Thresher and Wang 1982, J. Appl.
Mech. 49)."""


def ritz(spin: float, count: int = 12) -> float:
    """First flapping omega T: w = sum c_k x^(k+2), strain energy w''^2 and tension spin^2 (1 - x^2) / 2 times w'^2, by Gauss' rule."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    square = np.polynomial.Polynomial([0, 0, 1])
    shapes = [square * np.polynomial.Legendre.basis(k, domain=[0, 1]).convert(kind=np.polynomial.Polynomial) for k in range(count)]
    w, slope, bend = (np.array([shape.deriv(d)(x) for shape in shapes]) for d in (0, 1, 2))
    stiffness = (bend * weights) @ bend.T + spin**2 * (slope * weights * (1.0 - x**2) / 2.0) @ slope.T
    return float(np.sqrt(eigh(stiffness, (w * weights) @ w.T, eigvals_only=True)[0]))


def blade(d: int, speed: float | None, n: int = 12, damping: float = 0.0, gravity: tuple[float, ...] | None = None) -> tuple[mbd.Scene, Any]:
    """A beam with EI = rho A = L = 1, hardly extensible, clamped to a hub on the axis that a motor turns (None: turns freely)."""
    scene = mbd.Scene(gravity=gravity or (0.0,) * d)
    tip = np.eye(d)[0]
    mass: dict[str, Any] = {"inertia": 1.0} if d == 2 else {"inertia": (1.0, 1.0, 1.0)}
    hub = scene.add(mbd.RigidBody(mass=1.0, position=0.0 * tip, name="hub", **mass))
    cable = scene.add(mbd.AncfCable(0.0 * tip, tip, n_elements=n, E=1e8, A=1.0, I=1e-8, rho=1.0, damping=damping, name="blade"))
    axis = {} if d == 2 else {"axis": (0, 0, 1)}
    scene.add(mbd.Clamp(cable.start, hub.at(*(0.0 * tip))))
    scene.add(mbd.Pin(hub.at(*(0.0 * tip)), scene.ground.at(*(0.0 * tip)), name="bearing", **axis))
    if speed is not None:
        scene.add(mbd.Motor(hub.at(*(0.0 * tip)), scene.ground.at(*(0.0 * tip)), speed=speed, name="motor", **axis))
    return scene, cable


@pytest.mark.parametrize("speed", WRIGHT)
def test_rotating_cantilever(speed: float) -> None:
    """Out of plane the published and the Ritz frequency, in plane omega^2 - Omega^2."""
    flap = ritz(speed)
    assert flap == pytest.approx(WRIGHT[speed], abs=6e-5)
    flat = mbd.modes(blade(2, speed)[0], 1, spin=speed)
    space = mbd.modes(blade(3, speed)[0], 2, spin=(0, 0, speed))
    assert np.sqrt(flat.frequencies[0] ** 2 + speed**2) == pytest.approx(flap, rel=2e-5)
    assert space.frequencies == pytest.approx([flat.frequencies[0], flap], rel=2e-5)
    assert flat.unstable == space.unstable == flat.rigid == space.rigid == 0 and not space.eigenvalues.real.any()


def test_the_mesh_converges_at_order_four() -> None:
    errors = [mbd.modes(blade(3, 8.0, n)[0], 2, spin=(0, 0, 8.0)).frequencies[1] / ritz(8.0) - 1.0 for n in (3, 6, 12)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.5) and np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize("d", [2, 3])
def test_without_spin_the_modes_are_the_ordinary_ones(d: int) -> None:
    """At zero by the same code, and nearly so at a small spin."""
    scene = blade(d, 0.0, 6)[0]
    still, zero = mbd.modes(scene, 4), mbd.modes(scene, 4, spin=0.0 if d == 2 else (0, 0, 0))
    assert (zero.eigenvalues == still.eigenvalues).all() and (zero.shapes == still.shapes).all()
    slow = mbd.modes(blade(d, 1e-5, 6)[0], 4, spin=1e-5 if d == 2 else (0, 0, 1e-5))
    assert slow.frequencies == pytest.approx(still.frequencies, rel=1e-9)


def test_a_small_disturbance_of_the_rotating_beam() -> None:
    """The full simulation from a mode's shape, small, follows R(t) (q + Re(shape exp(s t)))."""
    speed, size = 4.0, 1e-5
    scene, cable = blade(2, speed, 3)
    found = mbd.modes(scene, 1, spin=speed)
    s, tip = found.eigenvalues[0], found.displacement(cable.end)[0] * size
    motion = found.shapes[0] * size
    motion, change = motion.real, (motion * s).real

    def turned(q: Any) -> Any:
        out = np.zeros_like(q)
        table = slice(0, scene.build().n_table)
        out[table] = (speed * (q[table].reshape(-1, 2) @ np.array([[0.0, 1.0], [-1.0, 0.0]]))).ravel()
        return out

    q = found.q + motion
    times = np.linspace(0.1, 2.0, 12)
    start = mbd.assemble(scene, mbd.State(q, turned(q) + change)).state
    result = mbd.simulate(scene, 2.0, start=start, rtol=1e-10, t_eval=times)
    seen = (result.position(cable.end) @ [1, 1j]) * np.exp(-1j * speed * times) - cable.end.point.value(found.q) @ [1, 1j]
    expected = (tip * np.exp(s * times)[:, None]).real @ [1, 1j]
    assert np.abs(seen - expected).max() < 1e-3 * np.abs(expected).max()


def test_a_blade_across_the_radius_bends_far_and_stays() -> None:
    """Clamped at radius 0.3 along the tangent, its tip is thrown out by more than 0.7 of its length: a simulation from there only turns."""
    speed, out = 12.0, (0.3, 0.0)
    scene = mbd.Scene(gravity=(0, 0))
    hub = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    cable = scene.add(mbd.AncfCable(out, (0.3, 1.0), n_elements=3, E=1e6, A=1.0, I=1e-6, rho=1.0))
    scene.add(mbd.Clamp(cable.start, hub.at(*out)))
    scene.add(mbd.Pin(hub.at(0, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Motor(hub.at(0, 0), scene.ground.at(0, 0), speed=speed))
    found = mbd.modes(scene, 2, spin=speed)
    table = scene.build().n_table
    v = np.zeros_like(found.q)
    v[:table] = (speed * (found.q[:table].reshape(-1, 2) @ np.array([[0.0, 1.0], [-1.0, 0.0]]))).ravel()
    start = mbd.assemble(scene, mbd.State(found.q, v)).state
    times = np.linspace(0.05, 0.3, 4)
    result = mbd.simulate(scene, 0.3, start=start, rtol=1e-10, t_eval=times)
    tip = cable.end.point.value(found.q) @ [1, 1j]
    assert tip.real > 1.0 and found.unstable == 0
    assert result.position(cable.end) @ [1, 1j] == pytest.approx(tip * np.exp(1j * speed * times), abs=1e-7)


@pytest.mark.parametrize("damping", [0.0, 3.0])
def test_a_particle_on_a_spring_about_the_axis(damping: float) -> None:
    """A free orbit, its radius from k (r - L) = m Omega^2 r: s^2 + c / m s + k / m + 3 Omega^2 = 0 radially, and drifting along the orbit."""
    mass, k, length, speed = 2.0, 50.0, 0.7, 3.0
    scene = mbd.Scene(gravity=(0, 0))
    bead = scene.add(mbd.Particle(mass, (0.6, 0.8)))
    scene.add(mbd.Spring(bead.at(), scene.ground.at(0, 0), stiffness=k, damping=damping, length=length))
    found = mbd.modes(scene, spin=speed)
    assert np.hypot(*found.q) == pytest.approx(k * length / (k - mass * speed**2), rel=1e-12)
    radial = np.roots([1, damping / mass, k / mass + 3 * speed**2])
    assert found.eigenvalues == pytest.approx([0.0, radial[radial.imag > 0][0]], rel=1e-9) and found.rigid == 1


def test_conical_pendulum() -> None:
    """omega^2 = Omega^2 (1 + 3 cos^2), found from beside the steady cone; gravity along the axis turns with the scene."""
    angle, length = 1.0, 0.8
    speed = np.sqrt(9.81 / (length * np.cos(angle)))
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    bead = scene.add(mbd.Particle(1.5, (length * np.sin(0.9), 0, -length * np.cos(0.9))))
    scene.add(mbd.Distance(bead.at(), scene.ground.at(0, 0, 0)))
    found = mbd.modes(scene, spin=(0, 0, speed))
    assert found.q[2] == pytest.approx(-length * np.cos(angle), rel=1e-12)
    assert found.rigid == 1 and found.unstable == 0
    assert found.frequencies[1] == pytest.approx(speed * np.sqrt(1 + 3 * np.cos(angle) ** 2), rel=1e-9)


def jeffcott(speed: float, kx: float, ky: float, damping: float = 0.0) -> mbd.Scene:
    """A particle in the middle of a ring that a motor turns, on springs along two diameters."""
    scene = mbd.Scene(gravity=(0, 0))
    ring = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="ring"))
    bead = scene.add(mbd.Particle(1.0, (0, 0)))
    for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        scene.add(mbd.Spring(bead.at(), ring.at(x, y), stiffness=0.5 * (kx if x else ky), damping=0.5 * damping))
    scene.add(mbd.Pin(ring.at(0, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Motor(ring.at(0, 0), scene.ground.at(0, 0), speed=speed))
    return scene


@pytest.mark.parametrize("speed", [1.0, 2.5, 4.0])
def test_unequal_stiffnesses_coupled_by_coriolis(speed: float) -> None:
    """(s^2 + kx - W^2)(s^2 + ky - W^2) + 4 W^2 s^2 = 0: unstable between the critical speeds 2 and 3, and held by Coriolis' force above."""
    a, b = 4.0 - speed**2, 9.0 - speed**2
    roots = np.roots([1, 0, a + b + 4 * speed**2, 0, a * b])
    expected = sorted((s for s in roots if s.imag > -1e-9), key=lambda s: (s.real < 1e-9, abs(s)))
    found = mbd.modes(jeffcott(speed, 4.0, 9.0), spin=speed)
    grows = 2.0 < speed < 3.0
    assert found.unstable == int(grows) and found.eigenvalues == pytest.approx(expected, rel=1e-8, abs=1e-9)
    assert grows or not found.eigenvalues.real.any()


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_damping_that_turns_with_the_shaft(speed: float) -> None:
    """z'' + (c + 2 i W) z' + (k - W^2) z = 0 and its conjugate: internal damping makes a shaft whirl above its critical speed 2."""
    damping = 0.1
    roots = np.roots([1, damping + 2j * speed, 4.0 - speed**2])
    every = np.concatenate((roots, roots.conj()))
    found = mbd.modes(jeffcott(speed, 4.0, 4.0, damping), spin=speed)
    assert found.unstable == int(speed > 2.0) and len(found.eigenvalues) == 2
    for s in found.eigenvalues:
        assert np.abs(every - s).min() < 1e-9


def test_skew_dampers_in_the_rotating_frame() -> None:
    """x'' + (C + 2 W J) x' + (K - W^2) x = 0 with C of one of two springs that are not perpendicular, as a matrix of numbers."""
    speed, first, second = 1.0, np.array([1.0, 0.0]), np.array([0.5, np.sqrt(0.75)])
    scene = mbd.Scene(gravity=(0, 0))
    ring = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0)))
    bead = scene.add(mbd.Particle(1.0, (0, 0)))
    for k, c, n in ((4.0, 0.0, first), (9.0, 2.0, second)):
        scene.add(mbd.Spring(bead.at(), ring.at(*n), stiffness=k, damping=c))
    scene.add(mbd.Pin(ring.at(0, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Motor(ring.at(0, 0), scene.ground.at(0, 0), speed=speed))
    stiffness = 4.0 * np.outer(first, first) + 9.0 * np.outer(second, second) - speed**2 * np.eye(2)
    damping = 2.0 * np.outer(second, second) + 2.0 * speed * np.array([[0.0, -1.0], [1.0, 0.0]])
    every = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]]))
    found = mbd.modes(scene, spin=speed).eigenvalues
    expected = sorted((s for s in every if s.imag >= 0.0), key=abs)
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_free_hub_turns_with_a_rigid_mode() -> None:
    driven, free = (mbd.modes(blade(2, speed, 6)[0], 3, spin=4.0) for speed in (4.0, None))
    assert (driven.rigid, free.rigid, free.unstable) == (0, 1, 0)
    assert free.frequencies[1] > driven.frequencies[0]  # the hub recoils
    scene, _ = blade(2, 4.0, 6)
    turn = scene.add(mbd.Angle(scene["hub"].at(0, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Friction(turn, force=1.0, speed=0.1))  # overcome by the motor: it turns steadily and changes nothing
    assert mbd.modes(scene, 3, spin=4.0).frequencies == pytest.approx(driven.frequencies, rel=1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_free_body_turns_steadily_about_its_extreme_axes_only(axis: int) -> None:
    """Euler: s^2 = -Omega^2 (I3 - I1)(I3 - I2) / (I1 I2). Seen from the body, drifting in space is a double s = i Omega, across and back."""
    inertia, speed = np.array([1.0, 2.0, 2.5]), 3.0
    scene = mbd.Scene(gravity=(0, 0, 0))
    scene.add(mbd.RigidBody(mass=1.0, inertia=inertia, position=(0, 0, 0)))
    found = mbd.modes(scene, 7, spin=speed * np.eye(3)[axis])
    own, others = inertia[axis], np.delete(inertia, axis)
    nutation = speed * np.sqrt(complex(-np.prod(own - others) / np.prod(others)))
    assert np.abs(found.eigenvalues - nutation).min() < 1e-9
    assert found.rigid == 2 and found.unstable == int(axis == 1)
    assert np.sum(np.abs(found.eigenvalues - 1j * speed) < 1e-5) == 3 and (axis == 1 or not found.eigenvalues.real.any())


def test_redundant_bearings_and_a_state_in_motion() -> None:
    """A body on two spatial pins has as many modes as on one; a spinning state is a start as good as one at rest."""

    def rotor(heights: tuple[float, ...]) -> mbd.Scene:
        scene = mbd.Scene(gravity=(0, 0, -9.81))
        hub = scene.add(mbd.RigidBody(mass=1.0, inertia=(1, 1, 1.5), position=(0, 0, 0), angular_velocity=(0, 0, 2.0)))
        for z in heights:
            scene.add(mbd.Pin(hub.at(0, 0, z), scene.ground.at(0, 0, z), axis=(0, 0, 1)))
        bead = scene.add(mbd.Particle(1.0, (1.0, 0, 0), velocity=(0, 2.0, 0)))
        for point in ((0.2, 0, 0), (0.5, 1, 0), (0.5, -1, 0), (0.5, 0, 1), (0.5, 0, -1)):
            scene.add(mbd.Spring(bead.at(), hub.at(*point), stiffness=100.0))
        return scene

    one, two = rotor((0.5,)), rotor((-0.5, 0.5))
    expected, found = (mbd.modes(scene, spin=(0, 0, 2.0)) for scene in (one, two))
    assert len(found.eigenvalues) == 4 and found.rigid == 1
    assert found.eigenvalues == pytest.approx(expected.eigenvalues, rel=1e-9)
    state = mbd.assemble(one).state
    assert state.v.any() and mbd.modes(one, spin=(0, 0, 2.0), about=state).eigenvalues == pytest.approx(expected.eigenvalues, rel=1e-9)
    with pytest.raises(mbd.SceneError, match="give modes the spin= of a steady rotation"):
        mbd.modes(one, about=state)


def refused(scene: mbd.Scene, spin: Any, words: str) -> None:
    with pytest.raises(mbd.SceneError, match=words):
        mbd.modes(scene, 2, spin=spin)


def test_what_does_not_turn_with_the_scene_is_named() -> None:
    refused(blade(2, 3.0, 4, gravity=(0.0, -9.81))[0], 3.0, "'(hub|blade)' feels another force.*gravity or a load across the axis")
    refused(blade(2, None, 4, gravity=(0.0, -9.81))[0], 3.0, "is not in balance")
    refused(blade(3, 3.0, 4, gravity=(0.0, -9.81, 0.0))[0], (0, 0, 3.0), "feels another force")
    refused(blade(2, 3.0, 4)[0], 2.0, "'motor', which would have to give way")
    refused(blade(3, 3.0, 4)[0], (3.0, 0, 0), "'(bearing|motor)'")
    scene, cable = blade(2, 3.0, 4)
    scene.add(mbd.Force(cable.end, lambda t: (np.sin(t), 0.0)))
    refused(scene, 3.0, "'blade' is not in balance")
    scene, cable = blade(2, 3.0, 4)
    scene.add(mbd.Pin(cable.end, scene.ground.at(1, 0), name="stay"))
    refused(scene, 3.0, "'(stay|bearing|motor)'")


def test_a_support_that_is_not_round_is_named() -> None:
    """A wheel on two springs across each other: as stiff in every direction, or not; and a guide that does not turn."""

    def wheel(kx: float, ky: float) -> tuple[mbd.Scene, Any]:
        scene = mbd.Scene(gravity=(0, 0))
        body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="wheel"))
        for k, point in ((kx, (1, 0)), (kx, (-1, 0)), (ky, (0, 1)), (ky, (0, -1))):
            scene.add(mbd.Spring(body.at(0, 0), scene.ground.at(*point), stiffness=0.5 * k))
        return scene, body

    found = mbd.modes(wheel(25.0, 25.0)[0], spin=1.0)
    assert found.frequencies == pytest.approx([0.0, 4.0, 6.0], rel=1e-7) and found.rigid == 1  # 5 -+ 1: forward and backward whirl
    refused(wheel(25.0, 36.0)[0], 1.0, "'wheel' feels another stiffness after a turn")
    scene, body = wheel(25.0, 25.0)
    scene.add(mbd.PointOnLine(body.at(0, 0), scene.ground.at(0, 0), axis=(1, 0), name="guide"))
    refused(scene, 1.0, "'guide', which holds a direction that does not turn")


def test_bad_spins_and_large_scenes() -> None:
    for spin in ("fast", (0, 0, 1), np.nan, True, 1j):
        refused(blade(2, 3.0, 2)[0], spin, "spin: expected a finite number")
    refused(blade(3, 3.0, 2)[0], 3.0, "spin: expected three finite numbers")
    refused(blade(2, 3.0, 150)[0], 3.0, "spin: expected at most 600 coordinates, found 6")
    scene = mbd.Scene(gravity=(0, 0))
    bead = scene.add(mbd.Particle(1.0, (1.0, 0)))
    scene.add(mbd.Spring(bead.at(), scene.ground.at(0, 0), stiffness=1.0))
    refused(scene, 2.0, "found none near this position, where 'particle 1' is set in motion")
