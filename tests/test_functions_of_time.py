"""Functions of time: how often a run asks them, what is made of their values once for a step, and what they see beside a jump."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import trapezoid

import mbd
from mbd.elements.force import DeadForces
from mbd.signal import BESIDE, SAME, Samples, Signal

CABLE: dict[str, Any] = {"n_elements": 2, "E": 1e6, "A": 1e-4, "I": 1e-8, "rho": 1000.0}


class Counted:
    """A force that counts its calls and is not called in search of jumps."""

    discontinuities = ()

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, t: float) -> tuple[float, float]:
        self.calls += 1
        return 0.01 * np.sin(3.0 * t), 0.0


def test_a_run_asks_a_force_at_the_stages_and_the_start_of_each_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the iterations: what depends on time alone is summed once for the stages and once for the error; its work asks nothing."""
    sums, force = [], DeadForces.force
    monkeypatch.setattr(DeadForces, "force", lambda kernel, q, inputs: sums.append(inputs.shape) or force(kernel, q, inputs))
    push, scene = Counted(), mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.0, 0.0), **CABLE))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0.0, 0.0)))
    scene.add(mbd.Force(rod.end, push))
    result = mbd.simulate(scene, 0.05, rtol=1e-10, solver=mbd.Radau(3, step=0.005))
    steps = result.stats["steps"]
    assert steps == 10 and result.stats["failed"] == 0 and result.stats["newton iterations"] >= 2 * steps
    assert push.calls == 1 + steps * (3 + 1)
    assert sums.count((3, 1, 2)) == steps and sums.count((1, 2)) == 1 + steps
    assert result.audit.energy_error < 1e-6 * result.audit.energy_scale
    t = np.linspace(0.0, 0.05, 501)
    assert result.audit.work == pytest.approx(trapezoid(0.01 * np.sin(3.0 * t) * result.velocity(rod.end, t)[:, 0], t), rel=1e-3)


def test_a_function_may_return_the_same_array_each_time() -> None:
    out = np.zeros(2)

    def force(t: float) -> np.ndarray:
        out[:] = t, 2.0 * t
        return out

    times = np.array([[0.1, 0.2], [0.4, 0.8]])
    assert np.array_equal(Signal(force, (2,), "wind", "[N]").sample(times), np.stack((times, 2.0 * times), axis=-1))


def test_constants_beside_functions() -> None:
    signals = [Signal(2.0, (), "a", ""), Signal(lambda t: t, (), "b", ""), Signal(3.0, (), "c", "")]
    times = np.linspace(0.0, 1.0, 4).reshape(2, 2)
    assert np.array_equal(Samples(signals)(times), np.stack((np.full((2, 2), 2.0), times, np.full((2, 2), 3.0)), axis=-1))
    assert np.array_equal(Samples(signals)(np.asarray(0.5)), [2.0, 0.5, 3.0])
    assert np.array_equal(Samples(signals[::2])(times), [2.0, 3.0])


def test_a_constant_load_beside_one_of_time() -> None:
    """At several times and one configuration: a kernel of constants has no axis of times, and the sum has."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0.0, 0.0)))
    scene.add(mbd.Torque(body.at(0.0, 0.0), 2.0))
    scene.add(mbd.Force(body.at(0.0, 0.0), lambda t: (t, 0.0)))
    system, times = scene.build(), np.array([0.0, 0.5, 1.0])
    found = system.load(system.q0, np.zeros(system.n), system.inputs(times))
    assert found.shape == (3, system.n)
    for k, t in enumerate(times):
        assert found[k] == pytest.approx(system.load(system.q0, np.zeros(system.n), system.inputs(t)), abs=1e-15)
    power = found @ np.array([1.0, 0.0, 0.0, 1.0])  # moving along x and turning with unit speeds
    assert power == pytest.approx(times + 2.0, abs=1e-14)


def test_times_beside_jumps_are_seen_from_the_right() -> None:
    """Against all differences at once."""
    rng = np.random.default_rng(1)
    jumps = np.sort(np.concatenate(([0.0, 1.0, 2.0], rng.uniform(-3.0, 3.0, 20))))
    step = lambda t: 0.0  # noqa: E731
    step.discontinuities = jumps  # type: ignore[attr-defined]
    ulps = rng.integers(-2 * int(SAME), 2 * int(SAME), (jumps.size, 8))
    times = np.concatenate(((jumps[:, None] + ulps * np.spacing(np.abs(jumps))[:, None]).ravel(), rng.uniform(-4.0, 4.0, 40))).reshape(-1, 2)
    at = np.any(np.abs(times[..., None] - jumps) <= SAME * np.spacing(np.abs(jumps)), axis=-1)
    assert 50 < np.count_nonzero(at) < at.size - 50
    assert np.array_equal(Signal(step, (), "pulse", "").seen(times), np.where(at, times + BESIDE * np.spacing(np.abs(times)), times))
