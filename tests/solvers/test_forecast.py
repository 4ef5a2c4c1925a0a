"""What the last step tells of the next one: polynomials of every degree, and which degree is taken."""

from types import SimpleNamespace

import numpy as np
import pytest

import mbd
from mbd.solvers.coefficients import tableau
from mbd.solvers.forecast import POWERS, Fits, Memory, forecast
from mbd.solvers.protocol import State
from mbd.solvers.stages import Stages

STAGES = (3, 5, 7)
AHEAD = np.array([0.2, 0.7, 1.0, 1.5])


def nodes_of(stages, with_start):
    c = tableau(stages).c
    return np.concatenate(([0.0], c)) if with_start else c


@pytest.mark.parametrize("with_start", (True, False))
@pytest.mark.parametrize("stages", STAGES)
def test_a_fit_of_degree_d_continues_and_integrates_polynomials_of_degree_d(stages, with_start):
    nodes = nodes_of(stages, with_start)
    fits = Fits(nodes)
    for degree in range(1, len(nodes)):
        rounding = 1e-13 * np.abs(fits.changes(AHEAD[:, None] ** POWERS, degree)).sum()
        for k in range(1, degree + 1):
            values = (nodes - 1.0) ** k
            assert np.allclose(fits.changes(AHEAD[:, None] ** POWERS, degree) @ values, AHEAD**k, rtol=0, atol=rounding)
            assert np.allclose(fits.integrals(AHEAD[:, None] ** POWERS, degree) @ values, AHEAD ** (k + 1) / (k + 1), rtol=0, atol=rounding)
        assert np.allclose(fits.changes(AHEAD[:, None] ** POWERS, degree).sum(axis=1), 0.0, atol=rounding), "a constant changes nothing"


@pytest.mark.parametrize("noise", (0.0, 1e-10, 1e-6, 1e-3))
@pytest.mark.parametrize("rate", (0.1, 0.5, 1.5, 4.0))
@pytest.mark.parametrize("stages", STAGES)
def test_the_degree_taken_is_nearly_the_best_there_is(stages, rate, noise):
    """Vibrations of a rate (times the step) with noise in the stages, many phases: the error is at most a few times that of the degree which
    would have been best, and over long steps never far above a straight line's."""
    nodes, random = nodes_of(stages, True), np.random.default_rng(3)
    fits, phases = Fits(nodes), np.linspace(0.0, 6.0, 9)
    x = np.array([1.0])
    kept, best, straight = [], [], []
    for phase in phases:
        values = np.cos(rate * (nodes - 1.0)[:, None] + phase + np.array((0.0, 1.2, 2.1))) + noise * random.standard_normal((len(nodes), 3))
        truth = np.cos(rate * x + phase + np.array((0.0, 1.2, 2.1)))
        errors = [float(np.abs(fits.changes(x[:, None] ** POWERS, d) @ values + values[-1] - truth).max()) for d in range(1, len(nodes))]
        kept.append(errors[fits.best(1.0**POWERS, values) - 1])
        best.append(min(errors))
        straight.append(errors[0])
    assert np.median(kept) <= 8.0 * max(np.median(best), noise)
    assert max(kept) <= 1.5 * max(straight) + 10.0 * noise


@pytest.mark.parametrize("stages", STAGES)
def test_a_uniformly_accelerated_motion_is_foretold_exactly(stages):
    c, h, g = tableau(stages).c, 0.3, np.array([0.2, -9.81, 1.0])
    q0, v0, stress, force = np.array([1.0, 2.0, -1.0]), np.array([0.5, -1.0, 3.0]), np.array([7.0]), np.array([2.0, -5.0])

    def at(t):
        return q0 + v0 * t + 0.5 * g * t**2, v0 + g * t, stress + 3.0 * t, force - 2.0 * t

    q, v, sigma, multipliers = at((c * h)[:, None])
    memory = Memory(h, v0, stress, Stages(q - q0, v, multipliers, np.zeros_like(multipliers), sigma), stages, 0.1)
    state = State(h, q[-1], v[-1], multipliers[-1], sigma[-1], memory)
    system = SimpleNamespace(levers=np.ones(3), m=2)
    longer = 1.6 * h
    found, middle = forecast(system, state, tableau(5).c, longer)
    q, v, sigma, multipliers = at(h + (tableau(5).c * longer)[:, None])
    for name, expected in (("dq", q - state.q), ("v", v), ("stress", sigma), ("multipliers", multipliers)):
        assert np.allclose(getattr(found, name), expected, rtol=1e-11, atol=1e-11), name
    assert found.drift.shape == (5, 2) and not found.drift.any()
    for name, expected in zip(("q", "v", "stress", "multipliers"), at(h + 0.5 * longer)):
        assert np.allclose(getattr(middle, name), expected, rtol=1e-11, atol=1e-11), name


def test_from_a_start_velocity_and_stress_go_on_as_they_are():
    state = State(0.0, np.array([1.0, 2.0]), np.array([3.0, -1.0]), np.array([4.0]), np.array([5.0]))
    found, middle = forecast(SimpleNamespace(levers=np.ones(2), m=1), state, tableau(3).c, 0.2)
    assert np.allclose(found.dq, np.outer(tableau(3).c, 0.2 * state.v)) and np.array_equal(found.v, np.tile(state.v, (3, 1)))
    assert np.allclose(middle.q, state.q + 0.1 * state.v) and np.array_equal(middle.stress, state.stress)
    assert np.array_equal(found.multipliers, np.full((3, 1), 4.0)) and np.array_equal(found.stress, np.full((3, 1), 5.0))


@pytest.mark.parametrize("stages", STAGES)
def test_goals_next_to_rounding_are_reached(stages):
    """A pendulum at the tightest tolerance: what iterations may leave falls with it, but not to where rounding keeps them."""
    scene = mbd.Scene()
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 2.0, rtol=1e-12, solver=mbd.Radau(stages))
    assert result.stats["failed"] == 0 and result.stats["newton iterations"] < 12 * result.stats["steps"]
    assert result.audit.energy_error < 1e-10 * result.audit.energy_scale
