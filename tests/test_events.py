"""Events and declared discontinuities: times against closed forms, what counts as a crossing, and what a jump does to accuracy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

import mbd
from mbd.crossings import crossings
from mbd.solvers.projected import ProjectedExplicit
from mbd.solvers.radau import RadauIIA

G = 9.81
PERIOD = 4.0 * float(ellipk(0.5)) / np.sqrt(G)
"""Of a pendulum of 1 m released from the horizontal [s]."""
SOLVERS = [(mbd.Radau(), 1e-10), (mbd.Radau(5), 1e-10), (mbd.DormandPrince(), 1e-9), (mbd.GeneralizedAlpha(4e-3), 2e-4)]
"""And the error of an event's time after one period, with rtol 1e-10 [s]: generalized-alpha's own is 1.1e-4."""
each_solver = pytest.mark.parametrize(("solver", "bound"), SOLVERS, ids=["Radau", "Radau 5", "DormandPrince", "GeneralizedAlpha"])


def pendulum(**force: Any) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, -G))
    bob = scene.add(mbd.Particle(1.0, (1.0, 0.0)))
    scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0)))
    return scene, bob.at()


def ball(height: float = 1.0, **options: Any) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, -G))
    item = scene.add(mbd.Particle(1.0, (0.0, height), **options))
    return scene, item.at()


# Times and states.


@each_solver
def test_lowest_points_of_a_pendulum(solver: Any, bound: float) -> None:
    """Quarter periods by the elliptic integral, each direction for itself; two events of one motion do not disturb each other."""
    scene, bob = pendulum()
    both = mbd.Event(lambda state: state.position(bob)[0])
    left = mbd.Event(lambda state: state.position(bob)[0], direction=-1, name="to the left")
    right = mbd.Event(lambda state: state.position(bob)[0], direction=1, name="to the right")
    top = mbd.Event(lambda state: state.velocity(bob)[1], direction=-1)
    result = mbd.simulate(scene, 1.3 * PERIOD, rtol=1e-10, solver=solver, events=[both, left, right, top])
    assert result.events[both].t == pytest.approx(PERIOD * np.array([0.25, 0.75, 1.25]), abs=bound)
    assert result.events[left].t == pytest.approx(PERIOD * np.array([0.25, 1.25]), abs=bound)
    assert result.events["to the right"].t == pytest.approx(PERIOD * np.array([0.75]), abs=bound)
    assert result.events[top].t == pytest.approx(PERIOD * np.array([0.5, 1.0]), abs=bound)
    assert list(result.events) == ["event 1", "to the left", "to the right", "event 4"]
    # The states are those of the dense output, on the joint, and at zero as near as 1e-10 of a step (0.1 s at most, 4.4 m/s).
    times = result.events[both]
    assert times.q.shape == times.v.shape == (3, 2)
    assert np.abs(times.q[:, 0]).max() < 1e-10
    assert np.linalg.norm(times.q, axis=1) == pytest.approx(1.0, abs=1e-12)
    assert result.position(bob, t=times.t) == pytest.approx(times.q, abs=1e-9)
    assert result.stats["ended by"] is None


@each_solver
def test_a_terminal_event_ends_the_run(solver: Any, bound: float) -> None:
    """Exactly there: the last state is a projected one whose function is zero to rounding; later events of the step are not reported."""
    scene, bob = pendulum()
    low = mbd.Event(lambda state: state.position(bob)[0], terminal=True, name="low")
    before = mbd.Event(lambda state: state.position(bob)[0] - 1e-3)
    after = mbd.Event(lambda state: state.position(bob)[0] + 1e-6)
    result = mbd.simulate(scene, 2.0, rtol=1e-10, solver=solver, events=[after, low, before])
    assert result.t[-1] == result.final.t == result.events[low].t[0] == pytest.approx(0.25 * PERIOD, abs=bound)
    assert np.array_equal(result.q[-1], result.events[low].q[0])
    assert abs(result.q[-1, 0]) < 1e-13
    assert abs(np.linalg.norm(result.q[-1]) - 1.0) < 1e-13
    assert abs(result.q[-1] @ result.v[-1]) < 1e-12
    assert len(result.events[before].t) == 1 and len(result.events[after].t) == 0
    assert result.stats["ended by"] == "low"
    assert result.audit.balanced and result.stats["steps"] == len(result.t) - 1


@each_solver
def test_a_bouncing_ball(solver: Any, bound: float) -> None:
    """Restarts at the event with the velocity turned round: the zero of the start is no crossing, and bounces come at their times."""
    scene, point = ball()
    floor = mbd.Event(lambda state: state.position(point)[1], terminal=True)
    fall, start, times = np.sqrt(2.0 / G), None, []
    for _ in range(4):
        result = mbd.simulate(scene, 10.0, rtol=1e-10, solver=solver, start=start, events=[floor])
        times.append(result.t[-1])
        start = mbd.State(result.final.q, -result.final.v, result.final.t)
    assert times == pytest.approx(fall * np.array([1, 3, 5, 7]), abs=bound)


@pytest.mark.parametrize("terminal", [False, True])
def test_an_event_at_the_end_of_the_run(terminal: bool) -> None:
    """Arriving at zero counts, if by rounding or not: v = 1 - t at t = 1, and a fall that ends on the floor."""
    scene = mbd.Scene(gravity=(-1.0, 0.0))
    point = scene.add(mbd.Particle(1.0, (0.0, 0.0), velocity=(1.0, 0.0))).at()
    clock = mbd.Event(lambda state: 1.0 - state.t, terminal=terminal)
    rest = mbd.Event(lambda state: 1e-12 + state.velocity(point)[0] if state.t < 0.9 else state.t - 1.0)
    result = mbd.simulate(scene, 1.0, events=[rest, clock])
    assert result.events[clock].t == pytest.approx([1.0], abs=1e-10)
    assert result.t[-1] == 1.0


@pytest.mark.parametrize("solver", [mbd.Radau(), mbd.DormandPrince(), mbd.GeneralizedAlpha(0.01)], ids=["Radau", "DormandPrince", "GeneralizedAlpha"])
@pytest.mark.parametrize("part", [1e-12, 1e-7, 1e-5, 1.0 - 1e-7, 1.0 - 1e-12])
def test_a_terminal_event_next_to_an_end_of_a_step(solver: Any, part: float) -> None:
    scene, _ = pendulum()
    before, after = mbd.simulate(scene, 1.0, solver=solver).t[4:6]
    time = before + part * (after - before)
    result = mbd.simulate(scene, 1.0, solver=solver, events=[mbd.Event(lambda state: state.t - time, terminal=True)])
    assert result.t[-1] == pytest.approx(time, abs=1e-10 * (after - before))
    assert result.audit.position_drift < 1e-12 and result.audit.balanced


def test_zero_at_the_start_is_no_crossing() -> None:
    scene, bob = pendulum()
    height, speed = mbd.Event(lambda state: state.position(bob)[1]), mbd.Event(lambda state: state.velocity(bob) @ state.velocity(bob))
    rounding = mbd.Event(lambda state: state.position(bob)[1] + 1e-17)
    result = mbd.simulate(scene, 0.4 * PERIOD, events=[height, speed, rounding])
    assert [len(times.t) for times in result.events.values()] == [0, 0, 0]


@pytest.mark.parametrize("solver", [mbd.Radau(7, step=0.25), mbd.DormandPrince(), mbd.GeneralizedAlpha(0.25)], ids=str)
@pytest.mark.parametrize("depth", [0.3, 1e-3, 1e-6])
def test_two_crossings_inside_one_step(solver: Any, depth: float) -> None:
    """A throw whose top is above a level by 0.3 m, 1 mm, 1 um; a throw is exact in every method, whatever its step."""
    scene, point = ball(0.0, velocity=(0.0, 0.7 * G))
    top = 0.5 * G * 0.7**2
    level = mbd.Event(lambda state: state.position(point)[1] - (top - depth))
    below = mbd.Event(lambda state: state.position(point)[1] - (top + depth))
    result = mbd.simulate(scene, 1.5, rtol=1e-4, solver=solver, events=[level, below])
    half = np.sqrt(2.0 * depth / G)
    found = result.events[level].t
    assert found == pytest.approx([0.7 - half, 0.7 + half], abs=1e-10 + 1e-15 / half)
    assert len(result.events[below].t) == 0
    if depth < 0.1:
        assert np.searchsorted(result.t, found[0]) == np.searchsorted(result.t, found[1]), "one step holds both"


def test_angles_and_their_wraps() -> None:
    """A disc at 7 rad/s: its angle passes 1 rad once a turn; the jump from pi to -pi passes zero without being there."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    disc = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), angular_velocity=7.0))
    result = mbd.simulate(
        scene, 2.0, rtol=1e-9, events=[mbd.Event(lambda s: s.angle(disc) - 1.0), mbd.Event(lambda s: s.angle(disc.at(1, 0)), direction=-1)]
    )
    turn = 2.0 * np.pi / 7.0
    assert result.events["event 1"].t == pytest.approx([1 / 7, 1 / 7 + turn, 1 / 7 + 2 * turn], abs=1e-7)
    assert len(result.events["event 2"].t) == 0


def test_flexible_and_spatial_scenes() -> None:
    scene = mbd.Scene(gravity=(0.0, 0.0, -G))
    cable = scene.add(mbd.AncfCable((0, 0, 0), (1, 0, 0), n_elements=3, E=1e6, A=1e-3, I=1e-8, rho=1000))
    scene.add(mbd.Ball(cable.start, scene.ground.at(0, 0, 0)))
    tip = cable.end
    hit = mbd.Event(lambda state: state.position(tip)[2] + 0.5, terminal=True, direction=-1)
    result = mbd.simulate(scene, 2.0, events=[hit])
    assert result.position(tip)[-1, 2] == pytest.approx(-0.5, abs=1e-13)
    finer = mbd.simulate(scene, result.t[-1], rtol=1e-8)
    assert finer.position(tip)[-1, 2] == pytest.approx(-0.5, abs=1e-5)


def test_chosen_times_stay_exact() -> None:
    """t_eval holds, with and without a terminal event, and no value there changes by being watched."""
    scene, bob = pendulum()
    chosen = [0.0, 0.1, 0.4, 0.5, 0.9]
    low = mbd.Event(lambda state: state.position(bob)[0])
    plain = mbd.simulate(scene, 1.0, t_eval=chosen)
    watched = mbd.simulate(scene, 1.0, t_eval=chosen, events=[low])
    assert watched.t.tolist() == chosen and np.array_equal(watched.q, plain.q)
    stopped = mbd.simulate(scene, 1.0, t_eval=chosen, events=[mbd.Event(low.function, terminal=True)])
    assert stopped.t.tolist() == [0.0, 0.1, 0.4, 0.5] and stopped.final.t == pytest.approx(watched.events[low].t[0], abs=1e-8)
    assert stopped.q[:3] == pytest.approx(plain.q[:3], abs=1e-12)


# What it costs.


def counted(monkeypatch: pytest.MonkeyPatch, owner: type) -> list[int]:
    sizes: list[int] = []
    original = owner.inside

    def inside(self: Any, system: Any, linear: Any, before: Any, after: Any, t: Any) -> Any:
        sizes.append(len(t))
        return original(self, system, linear, before, after, t)

    monkeypatch.setattr(owner, "inside", inside)
    return sizes


@pytest.mark.parametrize(("solver", "owner"), [(mbd.Radau(), RadauIIA), (mbd.DormandPrince(), ProjectedExplicit)], ids=["Radau", "DormandPrince"])
def test_dense_output_only_where_something_happens(solver: Any, owner: type, monkeypatch: pytest.MonkeyPatch) -> None:
    """Never without events or far from them; a few batches for a crossing."""
    scene, bob = pendulum()
    sizes = counted(monkeypatch, owner)
    mbd.simulate(scene, 1.0, solver=solver)
    mbd.simulate(scene, 1.0, solver=solver, events=[])
    mbd.simulate(scene, 1.0, solver=solver, events=[mbd.Event(lambda state: state.position(bob)[0] + 2.0)])
    assert not sizes
    result = mbd.simulate(scene, 1.0, solver=solver, events=[mbd.Event(lambda state: state.position(bob)[0])])
    assert len(result.events["event 1"].t) == 1
    assert len(sizes) <= 4 and sum(sizes) <= 40


def test_searches_on_functions() -> None:
    """Steep, flat and touching functions, from rough samples: batches of exact values, and times."""

    def found(f: Callable[[Any], Any], noise: float = 0.0) -> tuple[list[tuple[float, int]], int]:
        calls = []
        t = np.linspace(0.0, 1.0, 8)
        g = f(t) + noise * np.concatenate(([0.0], np.random.default_rng(1).standard_normal(6), [0.0]))

        def look(times: Any) -> Any:
            calls.append(len(times))
            return f(times)

        return crossings(t, g, look, 1e-10), len(calls)

    assert found(lambda t: t + 1.0) == ([], 0)
    for noise in (0.0, 1e-3):
        times, calls = found(lambda t: np.cos(3.0 * t), noise)
        assert times == [(pytest.approx(np.pi / 6, abs=1e-10), -1)] and calls <= 4
    assert found(lambda t: np.tanh(1e4 * (t - 0.3)))[0] == [(pytest.approx(0.3, abs=1e-10), 1)]
    assert found(lambda t: (t - 0.3) ** 3)[0] == [(pytest.approx(0.3, abs=1e-9), 1)]
    assert found(lambda t: (t - 0.52) ** 2 - 1e-8)[0] == [(pytest.approx(0.5199, abs=1e-10), -1), (pytest.approx(0.5201, abs=1e-10), 1)]
    assert found(lambda t: (t - 0.52) ** 2 + 1e-8)[0] == []
    assert found(lambda t: t - 1e-13)[0] == [(pytest.approx(1e-13, abs=1e-10), 1)]
    assert found(lambda t: t * (t - 0.01))[0] == [(pytest.approx(0.01, abs=1e-10), 1)]
    assert found(lambda t: np.where(t < 0.3, 1.0, -1.0))[0] == []


# Files and errors.


def test_events_are_stored(tmp_path: Any) -> None:
    scene, bob = pendulum()
    low, never = mbd.Event(lambda state: state.position(bob)[0], name="low"), mbd.Event(lambda state: 1.0)
    result = mbd.simulate(scene, PERIOD, events=[never, low])
    result.save(tmp_path / "run.npz")
    loaded = mbd.load(tmp_path / "run.npz")
    assert list(loaded.events) == ["event 1", "low"] and len(loaded.events["event 1"].t) == 0
    for part in range(3):
        assert np.array_equal(loaded.events[low][part], result.events[low][part])
        assert loaded.events["event 1"][part].shape == result.events[never][part].shape
    with pytest.raises(KeyError, match="low"):
        loaded.events[never]
    loaded.save(tmp_path / "again.npz")
    assert np.array_equal(mbd.load(tmp_path / "again.npz").events["low"].q, result.events[low].q)


@pytest.mark.parametrize(("change", "message"), [(lambda e: e[:-1], "found 1"), (lambda e: np.full_like(e, np.nan), "finite"), (None, "event_t")])
def test_damaged_events_are_refused(tmp_path: Any, change: Any, message: str) -> None:
    scene, bob = pendulum()
    mbd.simulate(scene, PERIOD, events=[mbd.Event(lambda state: state.position(bob)[0])]).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as stored:
        arrays = dict(stored)
    for name in ("event_t", "event_q", "event_v"):
        if change is None:
            del arrays[name]
        else:
            arrays[name] = change(arrays[name])
    np.savez(tmp_path / "run.npz", **arrays)
    with pytest.raises(ValueError, match=message):
        mbd.load(tmp_path / "run.npz")


def _raises(state: Any) -> float:
    raise ZeroDivisionError("no event today")


FAULTS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "raises": (_raises, "raised ZeroDivisionError: no event today"),
    "NaN": (lambda state: float("nan"), "returned nan"),
    "vector": (lambda state: state.q, "returned an array of shape"),
    "text": (lambda state: "low", "raised ValueError"),
    "None": (lambda state: None, "expected a finite number"),
    "truth": (lambda state: state.t > 0.3, "expected a finite number that passes through zero"),
    "no marker": (lambda state: state.position("bob"), "expected a marker"),
    "no axis": (lambda state: state.angle("bob"), "expected a planar rigid body"),
}


@pytest.mark.parametrize("begin", [0.0, 0.2], ids=["at once", "later"])
@pytest.mark.parametrize("fault", FAULTS)
def test_a_function_that_fails_stops_the_run(fault: str, begin: float) -> None:
    bad, text = FAULTS[fault]
    scene, point = ball()
    low = mbd.Event(lambda state: state.position(point)[1] - 0.9)
    event = mbd.Event(lambda state: bad(state) if state.t >= begin else 1.0, name="touch")
    with pytest.raises(mbd.SimulationError) as caught:
        mbd.simulate(scene, 1.0, solver=mbd.GeneralizedAlpha(0.01), events=[low, event])
    error = caught.value
    assert error.item == "touch" and text in str(error)
    assert begin <= error.time <= begin + 0.01 + 1e-12
    assert error.result is not None and begin - 0.01 - 1e-12 <= error.result.t[-1] <= error.time
    assert len(error.result.events[low].t) == (begin > 0.0)


def test_a_storm_of_events_is_refused() -> None:
    """A function that oscillates faster than any step follows the motion."""
    scene, _ = ball()
    with pytest.raises(mbd.SimulationError, match=r"at buzz: .* times in \d+ steps") as caught:
        mbd.simulate(scene, 10.0, solver=mbd.GeneralizedAlpha(0.01), events=[mbd.Event(lambda state: np.sin(2000.0 * state.t), name="buzz")])
    assert caught.value.time < 2.0 and caught.value.result.t[-1] < 2.0


@pytest.mark.parametrize(
    ("events", "message"),
    [
        ([lambda state: 1.0], "expected mbd.Event"),
        (3.0, "expected mbd.Event"),
        ([mbd.Event(abs, name="a"), mbd.Event(abs, name="a")], "'a' more than once"),
        ([mbd.Event(abs), mbd.Event(abs, name="event 1")], "'event 1' more than once"),
    ],
    ids=["function", "number", "twice", "twice by number"],
)
def test_what_is_no_list_of_events(events: Any, message: str) -> None:
    with pytest.raises(mbd.SceneError, match=message):
        mbd.simulate(ball()[0], 1.0, events=events)


def test_what_is_no_event() -> None:
    for arguments in ({"direction": 2}, {"direction": True}, {"name": 3}, {"name": ""}):
        with pytest.raises(ValueError, match=f"Event\\({next(iter(arguments))}"):
            mbd.Event(abs, **arguments)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="expected a function"):
        mbd.Event(1.0)  # type: ignore[arg-type]


# Declared discontinuities.

JUMP = 0.37
Load = Callable[[float], float]


def before_and_after(t: float) -> float:
    return 4.0 * np.cos(3.0 * t) if t >= JUMP else 2.0 * t


def after_only_later(t: float) -> float:
    return 4.0 * np.cos(3.0 * t) if t > JUMP else 2.0 * t


def hidden(load: Load) -> Load:
    """The same, said to have no jumps: else they would be found before the run."""

    def said(t: float) -> float:
        return load(t)

    said.discontinuities = ()  # type: ignore[attr-defined]
    return said


def driven(torque: Any) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, -G))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Torque(rod.at(), torque, name="motor"))
    return scene, rod.at(0.5, 0)


def tip(torque: Any, **options: Any) -> np.ndarray:
    scene, marker = driven(torque)
    return mbd.simulate(scene, 1.0, **options).position(marker)[-1]


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    """Two smooth runs, one after the other."""
    first, _ = driven(lambda t: 2.0 * t)
    second, marker = driven(lambda t: 4.0 * np.cos(3.0 * t))
    half = mbd.simulate(first, JUMP, rtol=1e-13, solver=mbd.DormandPrince())
    return mbd.simulate(second, 1.0, rtol=1e-13, solver=mbd.DormandPrince(), start=half.final).position(marker)[-1]


@pytest.mark.parametrize("load", [before_and_after, after_only_later])
@pytest.mark.parametrize(
    ("make", "steps", "order", "rtol"),
    [(lambda h: mbd.Radau(3, step=h), (0.025, 0.0125), 4.9, 1e-11), (lambda h: mbd.GeneralizedAlpha(h), (5e-3, 2.5e-3), 1.9, 1e-6)],
    ids=["Radau 3", "GeneralizedAlpha"],
)
def test_order_across_a_declared_jump(reference: np.ndarray, load: Load, make: Any, steps: Sequence[float], order: float, rtol: float) -> None:
    """It stays, whichever value the function has at the jump itself, and where the jump is found. Hidden, inside of a step, it costs all of it."""
    declared, found, unseen = (
        [np.abs(tip(torque, solver=make(h), rtol=rtol) - reference).max() for h in steps]
        for torque in (mbd.piecewise(load, at=[JUMP]), load, hidden(load))
    )
    assert np.log2(declared[0] / declared[1]) > order
    np.testing.assert_allclose(found, declared, rtol=1e-3, atol=1e-11)
    assert unseen[1] > 3.0 * declared[1] and np.log2(unseen[0] / unseen[1]) < order - 0.5


@pytest.mark.parametrize("solver", [mbd.Radau(), mbd.DormandPrince()], ids=["Radau", "DormandPrince"])
@pytest.mark.parametrize("load", [before_and_after, after_only_later])
def test_adaptive_steps_across_a_jump(reference: np.ndarray, solver: Any, load: Load) -> None:
    """Declared: steps end on it, and errors are those of a smooth run. Hidden: it gets through, with rejected steps and less accuracy."""
    scene, marker = driven(mbd.piecewise(load, at=[JUMP]))
    declared = mbd.simulate(scene, 1.0, rtol=1e-10, solver=solver)
    assert JUMP in declared.t
    assert np.abs(declared.position(marker)[-1] - reference).max() < 1e-10
    unseen_scene, unseen_marker = driven(hidden(load))
    unseen = mbd.simulate(unseen_scene, 1.0, rtol=1e-10, solver=solver)
    assert 1e-10 < np.abs(unseen.position(unseen_marker)[-1] - reference).max() < 1e-4
    assert unseen.stats["steps"] + unseen.stats["rejected"] > declared.stats["steps"] + declared.stats["rejected"]


@pytest.mark.parametrize("solver", [mbd.Radau(), mbd.DormandPrince(), mbd.GeneralizedAlpha(4e-3)], ids=["Radau", "DormandPrince", "GeneralizedAlpha"])
@pytest.mark.parametrize("load", [before_and_after, after_only_later])
def test_sides_of_a_jump(solver: Any, load: Load) -> None:
    """At the jump the acceleration is the right one's; dense output of the step before it, and work, know nothing of what comes after."""
    scene, marker = driven(mbd.piecewise(load, at=[JUMP]))
    smooth_scene, smooth_marker = driven(lambda t: 2.0 * t)
    result = mbd.simulate(scene, 1.0, rtol=1e-9, solver=solver)
    smooth = mbd.simulate(smooth_scene, JUMP, rtol=1e-9, solver=solver)
    ulp = 1000 * np.spacing(JUMP)
    left, at, right = result.acceleration(marker, t=[JUMP - ulp, JUMP, JUMP + ulp])
    assert at == pytest.approx(right, abs=1e-9) and np.abs(at - left).max() > 1.0
    assert result.acceleration(marker)[result.t == JUMP][0] == pytest.approx(at, abs=1e-9)
    bound = 1e-3 if isinstance(solver, mbd.GeneralizedAlpha) else 1e-8
    for t in (0.2, 0.36, JUMP - 1e-5, JUMP):
        assert result.position(marker, t=t) == pytest.approx(smooth.position(smooth_marker, t=t), abs=1e-8)
    assert result.audit.energy_error < bound


def test_jumps_near_each_other_at_the_ends_and_of_several_loads() -> None:
    """Times apart by rounding are one; at the start the right side counts, at the end the left one."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    point = scene.add(mbd.Particle(1.0, (0.0, 0.0))).at()
    for direction, jump in (((1.0, 0.0), 0.1 + 0.2), ((0.0, 1.0), 0.3)):
        switch = mbd.piecewise(lambda t, d=direction, j=jump: np.array(d) * (0.0 < t <= 1.0) * (1.0 + (t > j)), at=[0.0, jump, 1.0])
        scene.add(mbd.Force(point, switch))
    result = mbd.simulate(scene, 1.0, rtol=1e-8, solver=mbd.Radau(3))
    assert np.sum(np.abs(result.t - 0.3) < 1e-9) == 1
    expected = 0.5 + 0.5 * 0.7**2
    assert result.position(point)[-1] == pytest.approx([expected, expected], abs=1e-12)
    assert result.velocity(point)[-1] == pytest.approx([1.7, 1.7], abs=1e-12)
    assert result.acceleration(point)[[0, -1]] == pytest.approx(np.array([[1.0, 1.0], [0.0, 0.0]]), abs=1e-12)
    assert result.audit.energy_error < 1e-9


def test_any_callable_may_declare() -> None:
    class Switch:
        discontinuities = (0.3,)

        def __call__(self, t: float) -> float:
            return float(t >= 0.3)

    scene, _ = driven(Switch())
    assert 0.3 in mbd.simulate(scene, 0.5).t
    for bad in ("soon", [np.nan], 0.3, [[0.1]]):
        with pytest.raises(mbd.SceneError, match="'motor': value: discontinuities: expected a sequence of finite times"):
            driven(mbd.piecewise(lambda t: t, at=bad))[0].build()  # type: ignore[arg-type]


def test_a_fixed_grid_goes_on_after_a_jump() -> None:
    scene, _ = driven(mbd.piecewise(before_and_after, at=[JUMP]))
    result = mbd.simulate(scene, 0.6, solver=mbd.GeneralizedAlpha(0.1))
    assert result.t == pytest.approx([0.0, 0.1, 0.2, 0.3, JUMP, 0.4, 0.5, 0.6], abs=1e-14)


def test_a_step_cut_short_by_a_jump_does_not_shorten_the_next() -> None:
    """Two declared times 1e-8 s apart cost two more steps, not the ten that growing from 1e-8 s would take."""
    scene, near = driven(mbd.piecewise(before_and_after, at=[JUMP]))[0], driven(mbd.piecewise(before_and_after, at=[JUMP, JUMP + 1e-8]))[0]
    once, twice = (mbd.simulate(it, 1.0, rtol=1e-9, solver=mbd.DormandPrince()).stats["steps"] for it in (scene, near))
    assert twice <= once + 3


def test_events_and_jumps_together() -> None:
    """A crossing in the step that ends at a jump, one at the jump itself, one after it."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    point = scene.add(mbd.Particle(1.0, (0.0, 0.0), velocity=(1.0, 0.0))).at()
    scene.add(mbd.Force(point, mbd.piecewise(lambda t: (0.0, 0.0) if t < 0.5 else (2.0, 0.0), at=[0.5])))
    events = [mbd.Event(lambda state, x=x: state.position(point)[0] - x) for x in (0.49, 0.5, 0.51)]
    result = mbd.simulate(scene, 1.0, events=events)
    after = 0.5 + (np.sqrt(1.0 + 4.0 * 0.01) - 1.0) / 2.0
    for event, expected in zip(events, (0.49, 0.5, after)):
        assert result.events[event].t == pytest.approx([expected], abs=1e-9)
