"""The time loop: what it does with attempts that fail or err, and steps of generalized-alpha that have to be divided."""

import numpy as np
import pytest

import mbd
from mbd.solvers import GeneralizedAlpha
from mbd.solvers.generalized_alpha import ChungHulbert
from mbd.solvers.pace import Pace, Rhythm
from mbd.solvers.protocol import Attempt, State

from . import by_hand
from .by_hand import LENGTH, begin, exact, motion, run


class Scripted:
    """An exact method with an error of h^4, which contracts the worse the nearer a step is to the length at which it fails."""

    name = "scripted"

    def __init__(self, fails_above=np.inf, fails_after=np.inf, error_at_one=0.0, fixed=None, warns=True):
        self.fails_above, self.fails_after, self.error_at_one, self.fixed = fails_above, fails_after, error_at_one, fixed
        self.warns, self.tried = warns, []

    def kept(self, memory):
        return None

    def step(self, system, linear, state, h, tolerance):
        self.tried.append(h)
        if h > self.fails_above or state.t + h > self.fails_after:
            return Attempt(None, np.inf, 1.0, 1.0, 3, "it is told to", 0)
        q, v = exact([state.t + h])
        contraction = max(0.01, h / self.fails_above if self.warns else 0.0)
        return Attempt(State(state.t + h, q[0], v[0], state.multipliers, state.stress), self.error_at_one * h**4, 4.0, contraction, 2)


def marched(method, t_end=1.0, first_step=0.5):
    system, linear, record, _ = begin()
    by_hand.marched(system, linear, method, record, t_end, 1e-6, first_step)
    return record


def test_failed_steps_shrink_and_are_counted():
    method = Scripted(fails_above=0.1)
    record = marched(method)
    t, *_ = motion(record)
    assert record.failure == "" and t[-1] == 1.0
    assert np.diff(t).max() <= 0.1
    assert record.counts.failed == sum(h > 0.1 for h in method.tried) > 0
    assert record.counts.steps == len(t) - 1
    assert record.counts.solves == 3 * record.counts.failed + 2 * record.counts.steps
    # From 0.5 it takes three to get below 0.1. The contraction then says how near the wall is: no step need run into it again.
    assert record.counts.failed == 3


def test_a_failure_that_nothing_announces_is_remembered():
    record = marched(Scripted(fails_above=0.1, warns=False), t_end=20.0)
    assert record.failure == ""
    # Steps come back to the length that failed only slowly. At once, more of them would fail than pass.
    assert record.counts.failed < record.counts.steps / 2


def test_a_wall_in_time_stops_the_run_with_what_was_reached():
    record = marched(Scripted(fails_after=0.6))
    t, *_ = motion(record)
    assert record.failure == "it is told to" and record.worst == 0
    assert 0.6 - 1e-9 < t[-1] <= 0.6, "it goes as far as steps of 1e-12 of the span can"


def test_steps_follow_the_error():
    record = marched(Scripted(error_at_one=1e4), first_step=1.0)
    steps = np.diff(motion(record)[0])
    assert record.counts.rejected > 0 and record.failure == ""
    # The error is 1 at h = 0.1, and steps aim a little below; the last two share what remains.
    assert np.all(steps <= 0.1) and np.median(steps) > 0.06


def test_fixed_steps_ignore_the_error_and_end_on_time():
    record = marched(Scripted(error_at_one=1e9, fixed=0.3))
    assert np.allclose(motion(record)[0], [0.0, 0.3, 0.6, 0.9, 1.0], rtol=0, atol=1e-15)
    assert record.counts.rejected == 0


class Stubborn(ChungHulbert):
    """Generalized-alpha that refuses steps longer than a limit."""

    limit = np.inf

    def _whole(self, system, linear, state, h):
        if h > self.limit:
            return Attempt(None, np.inf, 1.0, 1.0, 5, "too long")
        return super()._whole(system, linear, state, h)


def test_a_divided_step_is_its_parts():
    whole = Stubborn(0.02, 0.8, 2)
    whole.limit = 0.006
    _, _, fine = run(GeneralizedAlpha(0.005).integrator(1e-6), 0.5)
    system, linear, coarse = run(whole, 0.5)
    t, q, v = motion(coarse)
    assert np.allclose(t, 0.02 * np.arange(26), rtol=0, atol=1e-12), "the user's grid"
    assert coarse.counts.failed == 0
    # The same 100 small steps in both runs, but for rounding of their lengths.
    _, fine_q, fine_v = motion(fine)
    assert np.abs(q - fine_q[::4]).max() < 1e-12 and np.abs(v - fine_v[::4]).max() < 1e-11
    for k in range(25):
        states = fine.states[4 * k : 4 * k + 5]
        found_q, found_v = whole.inside(system, linear, *coarse.states[k : k + 2], np.array([state.t for state in states]))
        assert np.abs(found_q - [state.q for state in states]).max() < 1e-11
        assert np.abs(found_v - [state.v for state in states]).max() < 1e-10


def test_a_divided_step_keeps_its_quadrature_and_its_count():
    system, linear, record, _ = begin()
    method = Stubborn(0.02, 0.8, 2)
    method.limit = 0.012
    attempt = method.step(system, linear, record.states[0], 0.02, 1e-6)
    t, q, v, weights = attempt.nodes
    assert np.allclose(t, [0.0, 0.01, 0.01, 0.02]) and np.allclose(weights, 0.005)
    assert np.array_equal(q[1], q[2]) and np.array_equal(v[-1], attempt.state.v)
    assert attempt.solves > 5, "what the refused step cost counts too"


def test_a_step_that_cannot_be_divided_far_enough_fails():
    system, linear, record, _ = begin()
    method = Stubborn(0.02, 0.8, 2)
    method.limit = 0.02 / 2**9
    attempt = method.step(system, linear, record.states[0], 0.02, 1e-6)
    assert attempt.state is None and attempt.failure == "too long"


def test_newton_that_cannot_converge_divides_the_step():
    # A half to a whole swing (1.5 s) in one step: often outside of Newton's reach from any prediction.
    runs = [run(GeneralizedAlpha(step).integrator(1e-6), 3.0)[2] for step in (0.75, 1.0, 1.5)]
    assert any(state.memory and state.memory.inner for record in runs for state in record.states)
    for record in runs:
        assert record.failure == "" and record.counts.failed == 0 and record.states[-1].t == 3.0
        assert all(abs(np.linalg.norm(state.q) - LENGTH) < 1e-12 * LENGTH for state in record.states)


@pytest.mark.parametrize("index", [2, 3])
def test_steel_pendulum(index):
    """EA / EI is 1.5e5 1/m^2: an error across the beam is an axial force 1e5 times too large, which displacement-only Newton cannot undo."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=10, E=2.07e11, A=1.8e-3, I=1.215e-8, rho=5540))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 0.1, solver=GeneralizedAlpha(1e-3, index=index))
    assert result.stats["failed"] == 0 and len(result.t) == 101
    # Second order: (h times the rigid pendulum's frequency, 3.5 1/s)^2 = 1e-5 of the exchanged energy; more would be vibrations fed.
    assert result.audit.energy_error < 1e-5 * result.audit.energy_scale
    # So stiff a beam swings as a rigid rod: angle'' = 3 g / (2 L) cos(angle), 12.26 1/s^2; here integrated by its energy's series.
    angle = 0.5 * 12.2625 * 0.1**2 * (1.0 - (12.2625 * 0.1**2) ** 2 / 40.0)
    tip = result.position(rod.end)[-1]
    # The rod itself bends by 8e-5 of its length under its weight while it is released.
    assert np.arctan2(-tip[1], tip[0]) == pytest.approx(angle, rel=5e-3)
    assert np.linalg.norm(tip) == pytest.approx(1.2, rel=1e-4)


@pytest.mark.parametrize(("corrections", "grows"), [(2, True), (3, True), (4, False), (8, False)])
def test_a_slow_rate_shortens_steps_only_where_corrections_were_many(corrections, grows):
    pace = Pace(Rhythm(0.0, 1.0), [10.0], None)
    pace.accepted(1.0, 1.0, Attempt(None, 1e-6, 4.0, 0.6, corrections))
    assert (pace.h > 1.0) == grows
