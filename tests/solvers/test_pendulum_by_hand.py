"""The integrators on a pendulum written by hand, against its closed solution: they need no mechanics but the ``System`` protocol."""

import numpy as np
import pytest

import mbd
from mbd.solvers import GeneralizedAlpha, Radau, generalized_alpha
from mbd.solvers.start import accelerations, mass_factor

from .by_hand import GRAVITY, LENGTH, MASS, begin, exact, motion, run

SPEED = np.sqrt(2.0 * GRAVITY * LENGTH)


@pytest.mark.parametrize("stages", [3, 5, 7])
def test_radau_follows_the_closed_solution(stages):
    rtol = 1e-8
    _, _, record = run(Radau(stages).integrator(rtol), 3.0, rtol * LENGTH)
    t, q, v = motion(record)
    true_q, true_v = exact(t)
    assert record.failure == "" and t[-1] == 3.0
    # Local errors of 1e-8 at each of some tens of steps, more than one of them unlucky: 100 times the tolerance.
    assert np.abs(q - true_q).max() < 100 * rtol * LENGTH
    assert np.abs(v - true_v).max() < 100 * rtol * SPEED


@pytest.mark.parametrize("index", [2, 3])
def test_generalized_alpha_follows_the_closed_solution(index):
    errors = []
    for step in (4e-3, 2e-3):
        _, _, record = run(GeneralizedAlpha(step, index=index).integrator(1e-6), 1.0)
        t, q, v = motion(record)
        true_q, true_v = exact(t)
        assert np.allclose(t, step * np.arange(len(t)), rtol=0, atol=1e-12)
        errors.append([np.abs(q - true_q).max(), np.abs(v - true_v).max()])
    orders = np.log2(np.divide(*errors))
    # Largest errors of the whole run, not at one time only; 0.2 leaves room for terms of third order at these steps.
    assert np.abs(orders - 2.0).max() < 0.2
    assert max(errors[1]) < 1e-3


@pytest.mark.parametrize("solver", [Radau(3), Radau(5), GeneralizedAlpha(5e-3)], ids=lambda solver: type(solver).__name__)
def test_joints_hold_to_rounding(solver):
    system, _, record = run(solver.integrator(1e-6), 2.0, 1e-6 * LENGTH)
    _, q, v = motion(record)
    joints = system.joints.at(q)
    assert np.abs(joints.value).max() < 1e-12 * LENGTH**2
    assert np.abs(joints.push(v)).max() < 1e-12 * LENGTH * SPEED


def test_index_3_holds_positions_only():
    system, _, record = run(GeneralizedAlpha(5e-3, index=3).integrator(1e-6), 2.0)
    _, q, v = motion(record)
    joints = system.joints.at(q)
    assert np.abs(joints.value).max() < 1e-12 * LENGTH**2
    # What index 3 leaves of G v is of second order, about (omega h)^2; were it rounding, index 2 would not be worth its price.
    assert 1e-8 < np.abs(joints.push(v)).max() / (LENGTH * SPEED) < 1e-3


@pytest.mark.parametrize("solver", [Radau(5), GeneralizedAlpha(5e-3)], ids=lambda solver: type(solver).__name__)
def test_values_inside_of_steps(solver):
    method = solver.integrator(1e-8)
    system, linear, record = run(method, 1.0, 1e-8 * LENGTH)
    t, q, v = motion(record)
    at_steps = max(np.abs(q - exact(t)[0]).max() / LENGTH, np.abs(v - exact(t)[1]).max() / SPEED)
    for before, after in zip(record.states[:-1], record.states[1:]):
        times = before.t + (after.t - before.t) * np.array([0.1, 0.5, 0.9])
        q, v = method.inside(system, linear, before, after, times)
        true_q, true_v = exact(times)
        # The promise of api.md: within ten times the error at the steps.
        assert np.abs(q - true_q).max() / LENGTH < 10 * at_steps
        assert np.abs(v - true_v).max() / SPEED < 10 * at_steps
        assert np.abs(system.joints.at(q).value).max() < 1e-12 * LENGTH**2


def test_multiplier_is_the_tension():
    system, linear, record = run(Radau(5).integrator(1e-10), 1.3, 1e-10 * LENGTH)
    state = record.states[-1]
    _, multipliers = accelerations(system, mass_factor(system, linear, state.q), state.q, state.v, None)
    tension = MASS * (state.v @ state.v / LENGTH - GRAVITY * state.q[1] / LENGTH)
    # G' lambda = r lambda is the force along the rod: both sides are of this state, so only rounding is between them.
    assert multipliers[0] * LENGTH == pytest.approx(tension, rel=1e-12)


@pytest.mark.parametrize("index", [2, 3])
def test_steps_of_changing_length_keep_the_order(index):
    """The algorithmic acceleration belongs to a time that moves with h; unless it is moved along, such steps are of first order."""
    errors = []
    for count in (100, 200):
        system, linear, record, _ = begin()
        method, state = GeneralizedAlpha(1.0, index=index).integrator(1e-6), record.states[0]
        for k in range(2 * count):
            state = method.step(system, linear, state, (2.0 - k % 2) / (3.0 * count), 1e-6).state
        assert state.t == pytest.approx(1.0, abs=1e-12)
        errors.append([np.abs(state.q - exact([1.0])[0]).max(), np.abs(state.v - exact([1.0])[1]).max()])
    # From below only: index 3 starts with errors in v that fade faster than h^2.
    assert np.log2(np.divide(*errors)).min() > 1.8


@pytest.mark.parametrize("h", [0.02, 0.2, 0.6])
def test_steps_are_solved_however_newton_got_there(monkeypatch, h):
    """The longest step needs its derivatives renewed: the first change after that says nothing of the contraction."""
    ends, renewals = [], []
    for share in (generalized_alpha.NEWTON, 1e-13):
        monkeypatch.setattr(generalized_alpha, "NEWTON", share)
        system, linear, record, _ = begin()
        before = linear.factorizations
        ends.append(GeneralizedAlpha(h).integrator(1e-6).step(system, linear, record.states[0], h, 1e-6).state)
        renewals.append((linear.factorizations - before - 3) // 2)
    # Newton stops at 1e-11 of the length, and G v is a velocity: a ten times larger difference over h would be an iterate too early.
    assert np.abs(ends[0].q - ends[1].q).max() < 1e-10 * LENGTH
    assert np.abs(ends[0].v - ends[1].v).max() < 1e-10 * LENGTH / h
    assert not ends[0].memory.inner and (renewals[0] > 0) == (h == 0.6)


@pytest.mark.filterwarnings("ignore:the energy is off:mbd.SceneWarning")
@pytest.mark.parametrize("rho_inf", [0.3, 0.8, 0.95])
def test_infinitely_fast_vibrations_shrink_to_rho_inf(rho_inf):
    scene = mbd.Scene(gravity=(0, 0))
    ball = scene.add(mbd.Particle(1.0, (1.0, 0.0)))
    scene.add(mbd.Spring(ball.at(), scene.ground.at(0, 0), stiffness=1e12, length=0.0))
    result = mbd.simulate(scene, 300.0, solver=GeneralizedAlpha(1.0, rho_inf=rho_inf))
    size = np.abs(result.q[[200, 300], 0])
    # The three roots coincide at infinity: n^2 rho^n, so 100 steps from the 200th add at most 1.5^2 to rho^100.
    assert (size[1] / size[0]) ** 0.01 == pytest.approx(rho_inf, rel=0.02)


@pytest.mark.parametrize("wrong", [{"step": 0.0}, {"step": -1e-3}, {"step": np.nan}, {"step": "1"}, {"step": 1e-3, "rho_inf": 1.1}])
def test_generalized_alpha_checks_its_numbers(wrong):
    with pytest.raises(ValueError, match=r"GeneralizedAlpha\(\w+=.*expected"):
        GeneralizedAlpha(**wrong)
    with pytest.raises(ValueError, match="expected 2 or 3"):
        GeneralizedAlpha(1e-3, index=1)
