"""Runs across singular positions: the aligned four-bars (IFToMM A02), whose bars all come into line twice a turn.

On the parallelogram branch the machine has one freedom: psi'' = w sin(psi), psi(0) = 0, psi'(0) = 1, for the angle of the links from
upright. An explicit method of another library solves that.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mbd
from mbd.assembly import consistent
from mbd.solvers import newton
from mbd.solvers.coefficients import tableau
from mbd.solvers.dop853 import NODES
from mbd.solvers.formats import Singular
from mbd.solvers.leap import DIVISIONS
from mbd.solvers.reduced import reduced
from mbd.state import State


def four_bar(windows, speed=1.0):
    """The scene and the upper ends of its links, which turn at a speed."""
    scene, rod = mbd.Scene(gravity=(0.0, -9.81)), mbd.RigidBody.rod
    links = [scene.add(rod((k, 0), (k, 1), mass=1.0, velocity=(0.5 * speed, 0.0), angular_velocity=-speed)) for k in range(windows + 1)]
    for k, link in enumerate(links):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(k, 0)))
    for k in range(windows):
        coupler = scene.add(rod((k, 1), (k + 1, 1), mass=1.0, velocity=(speed, 0.0)))
        scene.add(mbd.Pin(coupler.at(-0.5, 0), links[k].at(0.5, 0)))
        scene.add(mbd.Pin(coupler.at(0.5, 0), links[k + 1].at(0.5, 0)))
    return scene, [link.at(0.5, 0) for link in links]


def turning(windows, t_end, speed=1.0):
    """psi as a function of time."""
    w = ((windows + 1) / 2 + windows) * 9.81 / ((windows + 1) / 3 + windows)
    exact = solve_ivp(lambda t, y: (y[1], w * np.sin(y[0])), (0.0, t_end), (0.0, speed), method="DOP853", rtol=1e-13, atol=1e-14, dense_output=True)
    return lambda t: exact.sol(t)[0]


def aligned(windows):
    """The first time at which all bars lie in line."""
    psi, low, high = turning(windows, 1.0), 0.0, 1.0
    while high - low > 1e-13:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if psi(middle) < np.pi / 2 else (low, middle)
    return low


def check(windows, result, tips, rtol, speed=1.0):
    """On the parallelogram at the end: every link where the exact solution has it, and the energy kept."""
    psi = turning(windows, result.t[-1], speed)(result.t[-1])
    length = windows + 2.0  # the scene reaches from the first link's circle to the last one's
    for k, tip in enumerate(tips):
        error = np.linalg.norm(result.position(tip)[-1] - (k + np.sin(psi), np.cos(psi)))
        # Errors of a turn are as large as the tolerance, and the run adds up to six of them.
        assert error < 100.0 * rtol * length, f"link {k}: {error:.1e} m"
    assert result.audit.energy_error < rtol * length * result.audit.energy_scale


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-10, 1e-12])
@pytest.mark.parametrize("windows", [1, 2])
def test_turns_of_the_aligned_four_bar(windows, rtol):
    scene, tips = four_bar(windows)
    check(windows, mbd.simulate(scene, 10.0, rtol=rtol, solver=mbd.Radau()), tips, rtol)


@pytest.mark.slow
@pytest.mark.parametrize("rtol", 10.0 ** -np.arange(3.0, 13.0))
def test_turns_of_forty_windows(rtol):
    scene, tips = four_bar(40)
    check(40, mbd.simulate(scene, 10.0, rtol=rtol, solver=mbd.Radau()), tips, rtol)


@pytest.mark.parametrize("before", [0.1, 0.03, 1e-3, 1e-5])
@pytest.mark.parametrize("windows", [1, 2])
def test_starts_shortly_before_the_singular_position(windows, before):
    scene, tips = four_bar(windows)
    t = aligned(windows)
    near = mbd.simulate(scene, t - before, rtol=1e-10, solver=mbd.Radau()).final
    for rtol in (1e-4, 1e-7, 1e-10):
        check(windows, mbd.simulate(scene, t + 1.0, rtol=rtol, solver=mbd.Radau(), start=near), tips, rtol)


def test_explicit_run_is_continued_across_the_singular_position():
    scene, tips = four_bar(1)
    t = aligned(1)
    near = mbd.simulate(scene, t - 0.02, rtol=1e-10, solver=mbd.DormandPrince()).final
    check(1, mbd.simulate(scene, t + 1.0, rtol=1e-9, solver=mbd.Radau(), start=near), tips, 1e-9)


def test_a_run_may_end_at_the_singular_position():
    scene, tips = four_bar(1)
    result = mbd.simulate(scene, aligned(1), rtol=1e-8, solver=mbd.Radau())
    assert np.linalg.norm(result.position(tips[0])[-1] - (1.0, 0.0)) < 1e-7


def damped(scene):
    a, b = scene.add(mbd.Particle(1.0, (1, 0))), scene.add(mbd.Particle(0.7, (1.5, 0.6)))
    scene.add(mbd.Distance(a.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Spring(a.at(), b.at(), stiffness=200.0, length=0.7, damping=1.0))


def twice_pinned(scene):
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    for _ in range(2):
        scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))


@pytest.mark.filterwarnings("ignore:redundant")
@pytest.mark.parametrize("build", [damped, twice_pinned])
def test_both_matrices_lead_to_the_same_step(build, monkeypatch):
    """The stage equations have one solution, whatever the matrix of the iteration: with each stage's own G, or the middle's."""
    scene = mbd.Scene(gravity=(0, -9.81))
    build(scene)
    usual = mbd.simulate(scene, 0.3, rtol=1e-12, solver=mbd.Radau(5, step=0.02))

    def refuse(*_):
        raise Singular("as if")

    monkeypatch.setattr(newton, "Linearised", refuse)
    coupled = mbd.simulate(scene, 0.3, rtol=1e-12, solver=mbd.Radau(5, step=0.02))
    assert usual.stats["steps"] == coupled.stats["steps"] and coupled.stats["failed"] == 0
    assert np.abs(usual.final.q - coupled.final.q).max() < 1e-11
    assert np.abs(usual.final.v - coupled.final.v).max() < 1e-10


@pytest.mark.parametrize("stages", [3, 5, 7])
def test_what_newton_leaves_shows_in_the_estimate_by_the_noise(stages):
    """A free particle at rest, its stages in error by signs times d: the estimate of h v, from its formula (IV.8.19), is noise times d."""
    table, h, d = tableau(stages), 0.37, 1e-3
    gamma, start = table.gamma / h, table.start / h

    def estimate(dq):
        gap, rate = -start @ dq, table.inverse @ dq / h
        return h * (gamma * (gamma * gap - start @ rate) / gamma**2 - gap)

    largest = sum(abs(estimate(d * row)) for row in np.eye(stages))
    assert largest == pytest.approx(table.noise * d, rel=1e-12)


def test_a_tolerance_above_the_links_of_a_chain():
    """A tenth of a chain is more than a link: such a tolerance means what a small turn of a link means, and costs no more than a tight one."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    before = scene.ground.at(0, 0)
    for k in range(100):
        body = scene.add(mbd.RigidBody.rod((0.1 * k, 0), (0.1 * (k + 1), 0), mass=1.0))
        scene.add(mbd.Pin(body.at(-0.05, 0), before))
        before = body.at(0.05, 0)
    loose, tight = (mbd.simulate(scene, 0.3, rtol=rtol, solver=mbd.Radau()).stats for rtol in (1e-1, 1e-4))
    assert loose["newton iterations"] <= 1.2 * tight["newton iterations"]


def test_shares_fall_with_the_square_of_the_distance_from_a_singular_position():
    """At the start, upright, and at two places before the bars are in line, one ten times nearer than the other."""
    system = four_bar(1)[0].build()
    linear = consistent(system, State(system.q0, system.v0)).linear
    form = reduced(system, linear)
    near = [mbd.simulate(four_bar(1)[0], aligned(1) - before, rtol=1e-10, solver=mbd.Radau()).final for before in (1e-2, 1e-3)]
    states = np.stack([form.enter(system.q0, system.v0), *(form.enter(state.q, state.v) for state in near)])
    places = form.places(states, np.zeros((3, form.width)))
    for place in range(3):
        places.rates(system, place, 0.0)
    start, far, close = places.shares(slice(0, 3))
    assert start > 0.01 and far / close == pytest.approx(100.0, rel=0.05)


@pytest.mark.parametrize("place", range(3, 11))
def test_a_step_in_two_parts_keeps_its_stages_away(place):
    """As shares of the step: from the place of the stage that came too near to the nearest stage of either part."""
    first, nodes = DIVISIONS[place], np.append(NODES, 1.0)
    stages = np.concatenate((first * nodes, first + (1.0 - first) * nodes))
    assert np.abs(stages - NODES[place]).min() > 0.03


def default_passes(windows, rtol):
    """On the parallelogram, with energy errors below the tolerance; most singular positions are crossed by explicit steps."""
    scene, tips = four_bar(windows)
    result = mbd.simulate(scene, 10.0, rtol=rtol)
    check(windows, result, tips, rtol)
    assert result.audit.energy_error < rtol * result.audit.energy_scale
    return result


@pytest.mark.parametrize("rtol", 10.0 ** -np.arange(3.0, 11.0))
@pytest.mark.parametrize("windows", [1, 2, 40])
def test_energy_errors_of_the_default_are_below_the_tolerance(windows, rtol):
    default_passes(windows, rtol)


@pytest.mark.slow
@pytest.mark.parametrize("speed", np.geomspace(0.5, 2.0, 7))
@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
@pytest.mark.parametrize("windows", [1, 2, 40])
def test_the_default_stays_on_the_parallelogram_at_any_speed(windows, rtol, speed):
    scene, tips = four_bar(windows, speed)
    check(windows, mbd.simulate(scene, 10.0, rtol=rtol), tips, rtol, speed)


@pytest.mark.parametrize("rtol", [1e-4, 1e-9])
def test_values_next_to_a_singular_position(rtol):
    """At the position itself and on both sides of it, inside of steps of any kind."""
    scene, tips = four_bar(1)
    t = np.linspace(-0.02, 0.02, 9) + aligned(1)
    result = mbd.simulate(scene, 1.0, rtol=rtol, t_eval=t)
    psi = turning(1, 1.0)(t)
    error = np.linalg.norm(result.position(tips[0]) - np.column_stack((np.sin(psi), np.cos(psi))), axis=1)
    assert error.max() < 20.0 * rtol


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_an_event_at_the_singular_position_ends_a_run_there(rtol):
    scene, tips = four_bar(1)
    result = mbd.simulate(scene, 1.0, rtol=rtol, events=[mbd.Event(lambda now: now.position(tips[0])[1], terminal=True)])
    assert result.t[-1] == pytest.approx(aligned(1), abs=10.0 * rtol)
    assert np.linalg.norm(result.position(tips[0])[-1] - (1.0, 0.0)) < 10.0 * rtol
