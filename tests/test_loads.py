"""Forces and torques: virtual work, tangents, functions of time that fail, and what they do to bodies and beams."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

import mbd

from .kinds import MARKERS, ZERO, dense, derivative, point_map, rotation

DIFFERENCED = 1e-10
"""Central differences of order 6 over 5e-4 of functions of order one: rounding 1e-12."""


class Case(NamedTuple):
    """A load of a kind on a marker of a kind."""

    load: str
    marker: str
    dimension: int
    follower: bool

    def __str__(self) -> str:
        return f"{'follower' if self.follower else 'dead'} {self.load.lower()} on {self.marker} {self.dimension}D"

    @property
    def thin(self) -> bool:
        return self.marker in ("node", "span")


def _admitted(case: Case) -> bool:
    if case.marker == "particle":
        return case.load == "Force" and not case.follower
    return not (case.load == "Torque" and case.thin and case.dimension == 3 and case.follower)


CASES = [
    case
    for load, marker, d, follower in itertools.product(("Force", "Torque"), ("body", "node", "span", "particle"), (2, 3), (False, True))
    if _admitted(case := Case(load, marker, d, follower))
]
each_case = pytest.mark.parametrize("case", CASES, ids=str)


class Loaded(NamedTuple):
    scene: Any
    system: Any
    marker: Any
    value: Any

    def force(self, q: np.ndarray) -> np.ndarray:
        """The generalised force [..., n] of the load: there is no gravity. (The system leaves out leading axes where it is constant.)"""
        return np.broadcast_to(self.system.load(q, np.zeros_like(q), self.system.inputs(0.7)), q.shape)


def loaded(case: Case, rng: np.random.Generator, wrap: Callable[[Any], Any] = lambda value: value) -> Loaded:
    """One marker with one random load that suits it, given as ``wrap(value)``."""
    d, frame = case.dimension, rotation(rng, case.dimension)
    scene = mbd.Scene(gravity=ZERO[d])
    marker = MARKERS[case.marker](scene, rng.standard_normal(d), frame, "it")
    value: Any = rng.standard_normal(d if case.load == "Force" else (3 if d == 3 else ()))
    if d == 3 and case.thin and case.load == "Torque":
        value = value - value @ frame[:, 0] * frame[:, 0]  # a thin cable takes no torque along itself
    if d == 3 and case.thin and case.follower:
        value = np.array([value[0], 0.0, 0.0])  # and carries no axis but its tangent
    scene.add(getattr(mbd, case.load)(marker, wrap(value), follower=case.follower, name="load"))
    return Loaded(scene, scene.build(), marker, value)


def unit_axes(case: Case, marker: Any, q: np.ndarray) -> np.ndarray:
    """The marker's axes as unit vectors [a, d]; in the plane both."""
    axes = np.array([axis.value(q) for axis in marker.axes])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return np.vstack((axes, [-axes[0, 1], axes[0, 0]])) if case.dimension == 2 else axes


def rigid(system: Any, q: np.ndarray, spin: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """dq of a rigid motion of all: velocity of the origin and angular velocity [3]."""
    d = len(shift)
    table = q.reshape(-1, d)
    turned = np.cross(spin, table) if d == 3 else spin[2] * np.stack((-table[:, 1], table[:, 0]), axis=1)
    labels = [name for _, name in system.owners][::d]
    points = np.array([label.rsplit(" ", 1)[0].endswith(("position", "mass centre")) for label in labels])
    return (turned + points[:, None] * shift).ravel()


@each_case
def test_load_does_its_virtual_work(case: Case) -> None:
    """Force: F . dp for any dq. Torque: T . rotation, of the tangent of a cable for any dq, of a body for a rigid motion."""
    rng = np.random.default_rng(1)
    it = loaded(case, rng)
    q = it.system.q0
    if case.marker != "body":
        q = q + 0.2 * rng.standard_normal(q.size)
    for _ in range(3):
        dq = rng.standard_normal(q.size)
        if case.load == "Force":
            matrix, _ = point_map(case.marker, it.marker, q)
            total = it.value @ unit_axes(case, it.marker, q) if case.follower and not (case.thin and case.dimension == 3) else it.value
            if case.follower and case.thin and case.dimension == 3:
                total = it.value[0] * unit_axes(case, it.marker, q)[0]
            expected = total @ matrix @ dq
        elif case.marker == "body" and case.dimension == 3:
            spin = rng.standard_normal(3)
            dq = rigid(it.system, q, spin, rng.standard_normal(3))
            expected = (it.value @ unit_axes(case, it.marker, q) if case.follower else it.value) @ spin
        else:
            u = unit_axes(case, it.marker, q)[0]
            rate = derivative(lambda x: unit_axes(case, it.marker, x)[0], q, dq)
            expected = it.value @ np.cross(u, rate) if case.dimension == 3 else it.value * (u[0] * rate[1] - u[1] * rate[0])
        assert it.force(q) @ dq == pytest.approx(expected, rel=DIFFERENCED, abs=DIFFERENCED)


@each_case
def test_tangent_of_a_load(case: Case) -> None:
    """The part of K is -df/dq, at any configuration."""
    rng = np.random.default_rng(2)
    it = loaded(case, rng)
    system = it.system
    q, dq = system.q0 + 0.2 * rng.standard_normal(system.n), rng.standard_normal(system.n)
    still = np.zeros(system.n)
    values = system.stiffness(q, still, system.inputs(0.7), np.zeros(system.n_stresses), np.zeros(system.m))
    k = dense(system.stiffness_rows, system.stiffness_cols, values, (system.n, system.n))
    expected = derivative(it.force, q, dq)
    assert np.max(np.abs(-k @ dq - expected)) < DIFFERENCED
    assert (case.load == "Force" and not case.follower) == (np.max(np.abs(k)) < 1e-200)  # cables here have E = 1e-300


@each_case
def test_constants_and_functions_agree(case: Case) -> None:
    """Bitwise, or where a constant dead force is summed once in advance, to rounding; and for leading axes too."""
    constant = loaded(case, np.random.default_rng(3))
    if case.dimension == 3 and case.thin and case.follower:
        return  # a function could return other components: refused, see test_scene_errors
    varying = loaded(case, np.random.default_rng(3), lambda value: lambda t: value)
    assert not varying.system.steady
    q = constant.system.q0 + 0.2 * np.random.default_rng(4).standard_normal((2, 3, constant.system.n))
    force = constant.force(q)
    assert varying.force(q) == pytest.approx(force, rel=1e-15, abs=1e-16)
    for i in np.ndindex(2, 3):
        assert constant.force(q[i]) == pytest.approx(force[i], rel=1e-14, abs=1e-15)  # einsum orders its sums by the batch


def test_functions_see_the_stage_times() -> None:
    """inputs(t [...]) samples each time; other loads of the kind keep their own numbers."""
    scene = mbd.Scene(gravity=(0, 0))
    a, b = scene.add(mbd.Particle(1.0, (0, 0))), scene.add(mbd.Particle(1.0, (1, 0)))
    scene.add(mbd.Force(a.at(), lambda t: (t, 2 * t)))
    scene.add(mbd.Force(b.at(), lambda t: (0, np.sin(t))))
    scene.add(mbd.Force(b.at(), (5, 0)))
    system, times = scene.build(), np.array([0.1, 0.5, 0.9])
    q = np.zeros((3, 4))
    expected = np.stack((times, 2 * times, np.full(3, 5.0), np.sin(times)), axis=1)
    assert np.array_equal(system.load(q, np.zeros_like(q), system.inputs(times)), expected)


# Functions that fail.


def _raises(t: float) -> tuple[float, float]:
    raise ZeroDivisionError("no force today")


FAULTS: dict[str, tuple[Callable[[float], Any], str]] = {
    "NaN": (lambda t: (0.0, float("nan")), "nan"),
    "infinity": (lambda t: (0.0, float("inf")), "inf"),
    "raises": (_raises, "raised ZeroDivisionError: no force today"),
    "wrong shape": (lambda t: (0.0, 0.0, 1.0), "shape (3,)"),
    "a number": (lambda t: 1.0, "shape ()"),
    "text": (lambda t: "strong", "raised ValueError"),
    "None": (lambda t: None, "shape ()"),
}


@pytest.mark.parametrize("begin", [0.0, 0.2], ids=["at once", "later"])
@pytest.mark.parametrize("case", FAULTS)
def test_function_that_fails_stops_the_run(case: str, begin: float) -> None:
    """SimulationError with the time, the item, and the result up to there."""
    bad, text = FAULTS[case]
    scene = mbd.Scene(gravity=(0, -9.81))
    ball = scene.add(mbd.Particle(1.0, (0, 0), name="ball"))
    scene.add(mbd.Force(ball.at(), lambda t: bad(t) if t >= begin else (1.0, 0.0), name="wind"))
    with pytest.raises(mbd.SimulationError) as caught:
        mbd.simulate(scene, t_end=1.0)
    error = caught.value
    assert error.item == "wind"
    assert "wind" in str(error)
    assert text in str(error)
    assert begin <= error.time <= 1.0
    if begin == 0.0:  # before the first state was complete
        assert error.time == 0.0
        return
    assert error.result is not None
    last = error.result.t[-1]
    assert last <= error.time
    # What came before is good: a fall with a push of 1 N.
    assert error.result.position(ball.at())[-1] == pytest.approx([0.5 * last**2, -0.5 * 9.81 * last**2], abs=1e-9)


# What loads do.


def test_torque_turns_a_planar_body_by_its_inertia() -> None:
    """Angular acceleration T / J; the work of the torque is in the audit."""
    scene = mbd.Scene(gravity=(0, 0))
    disc = scene.add(mbd.RigidBody(mass=2.0, inertia=0.7, position=(1, 1), angle=0.3))
    scene.add(mbd.Torque(disc.at(0.2, 0.1), 1.4))
    result = mbd.simulate(scene, t_end=2.0, rtol=1e-9)
    assert result.angle(disc)[-1] == pytest.approx(0.3 + 0.5 * 2.0 * 2.0**2, abs=1e-8)
    arm = result.acceleration(disc.at(1, 0))[0] - result.acceleration(disc.at())[0]
    assert arm == pytest.approx(2.0 * np.array([-np.sin(0.3), np.cos(0.3)]), abs=1e-12)
    assert np.max(np.abs(result.position(disc.at()) - 1.0)) < 1e-10
    assert result.audit.work == pytest.approx(1.4 * 4.0, rel=1e-8)
    assert result.audit.energy_error < 1e-8


@pytest.mark.parametrize("follower", [False, True])
def test_torque_turns_a_spatial_body_by_eulers_equation(follower: bool) -> None:
    """J alpha + omega x J omega = T, from the accelerations of three points; T in body axes where it follows."""
    rng = np.random.default_rng(5)
    pose, omega, torque = rotation(rng, 3), rng.standard_normal(3), rng.standard_normal(3)
    a = rng.standard_normal((3, 3))
    inertia = np.trace(a @ a.T) * np.eye(3) - a @ a.T
    scene = mbd.Scene(gravity=(0, 0, 0))
    body = scene.add(mbd.RigidBody(mass=2.0, inertia=inertia, position=(1, 2, 3), rotation=pose, angular_velocity=omega))
    scene.add(mbd.Torque(body.at(0.3, 0, 0), torque, follower=follower))
    result = mbd.simulate(scene, t_end=1e-3)
    assert result.angular_velocity(body)[0] == pytest.approx(omega, abs=1e-13)
    about = pose @ inertia @ pose.T
    alpha = np.linalg.solve(about, (pose @ torque if follower else torque) - np.cross(omega, about @ omega))
    for arm in np.eye(3):
        r = pose @ arm
        expected = np.cross(alpha, r) + np.cross(omega, np.cross(omega, r))
        # The mass matrix with the joints' rows is solved in floats: condition about 1e2.
        assert result.acceleration(body.at(*arm))[0] - result.acceleration(body.at())[0] == pytest.approx(expected, abs=1e-11)


def tip_of_a_beam(load: Callable[[mbd.Scene, Any, Any], Any]) -> np.ndarray:
    """A cantilever with a rigid head on its end, under some load: the tip's path."""
    scene = mbd.Scene(gravity=(0, 0))
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e8, A=1e-3, I=1e-8, rho=1000))
    head = scene.add(mbd.RigidBody(mass=0.1, inertia=0.01, position=(1.1, 0)))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0)))
    scene.add(mbd.Clamp(beam.end, head.at(-0.1, 0)))
    load(scene, beam, head)
    result = mbd.simulate(scene, t_end=0.5, rtol=1e-9, t_eval=[0.25, 0.5])
    return result.position(beam.end)


def test_torque_at_a_beam_end_is_a_couple() -> None:
    """The same as on the head clamped to it, and as two opposite forces that turn with the head."""
    on_beam = tip_of_a_beam(lambda s, beam, head: s.add(mbd.Torque(beam.end, 1.0)))
    on_head = tip_of_a_beam(lambda s, beam, head: s.add(mbd.Torque(head.at(), 1.0)))
    couple = tip_of_a_beam(
        lambda s, beam, head: [s.add(mbd.Force(head.at(x, 0.0), (0.0, y), follower=True)) for x, y in ((0.25, 2.0), (-0.25, -2.0))]
    )
    assert np.linalg.norm(on_beam[-1] - [1.0, 0.0]) > 0.1
    # Runs at rtol 1e-9 of the same motion: their errors differ by the order of the tolerance times the number of steps.
    assert on_head == pytest.approx(on_beam, abs=1e-7)
    assert couple == pytest.approx(on_beam, abs=1e-7)


def test_spatial_torque_at_a_cable_end_is_the_planar_one() -> None:
    """A cable in a rotated plane under a torque about that plane's normal."""
    turn, tips = rotation(np.random.default_rng(6), 3), []
    numbers = {"n_elements": 2, "E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 1000}
    for d in (2, 3):
        scene = mbd.Scene(gravity=ZERO[d])
        end = (1.0, 0.0) if d == 2 else turn @ [1.0, 0.0, 0.0]
        cable = scene.add(mbd.AncfCable(ZERO[d], end, **numbers))
        scene.add(mbd.Clamp(cable.start, scene.ground.at(*ZERO[d])))
        scene.add(mbd.Torque(cable.end, 0.02 if d == 2 else 0.02 * turn[:, 2]))
        tip = mbd.simulate(scene, t_end=0.2, rtol=1e-9).position(cable.end)[-1]
        tips.append(np.append(tip, 0.0) if d == 2 else turn.T @ tip)
    assert np.linalg.norm(tips[0] - [1, 0, 0]) > 0.01
    assert tips[1] == pytest.approx(tips[0], abs=1e-8)
