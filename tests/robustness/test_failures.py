"""Every way in which a run or a search for balance stops: what, when, where, the last good state, three things to try, a usable result."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import mbd
from mbd.called import called
from mbd.failures import STEPS, undetermined, unknown_between

ROOT = Path(mbd.__file__ or "").parents[1]


def pendulum(torque: Any = None) -> mbd.Scene:
    scene = mbd.Scene()
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="rod"))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    if torque is not None:
        scene.add(mbd.Torque(rod.at(), torque, name="push"))
    return scene


def late(value: Any) -> Callable[[float], Any]:
    return lambda t: 0.0 if t < 0.3 else value() if callable(value) else value


def divides() -> float:
    return 1.0 / np.float64(0.0).item()


def blown() -> mbd.Result:
    """v' = v^3 is infinite after half a second: no step is short enough."""
    scene = mbd.Scene((0.0, 0.0))
    cart = scene.add(mbd.Particle(1.0, (0.0, 0.0), velocity=(1.0, 0.0), name="cart"))
    scene.add(mbd.PointOnLine(cart.at(), scene.ground.at(0, 0), axis=(1, 0), name="rail"))
    scene.add(mbd.ForceLaw(scene.add(mbd.Displacement(cart, scene.ground, axis=(1, 0))), lambda t, x, v: v**3, rates=True))
    return mbd.simulate(scene, 1.0)


def slid() -> mbd.Result:
    scene = mbd.Scene()
    cable = scene.add(mbd.AncfCable((0, 0), (1, -1), n_elements=4, E=1e7, A=1e-3, I=1e-8, rho=1000, name="cable"))
    for end in (cable.start, cable.end):
        scene.add(mbd.Clamp(end, scene.ground.at(*((0, 0) if end is cable.start else (1, -1)))))
    scene.add(mbd.BeamSlider(scene.add(mbd.Particle(0.1, (0.5, -0.5))), cable, name="slider"))
    return mbd.simulate(scene, 3.0, rtol=1e-4)


def unreachable() -> mbd.Scene:
    """A crank driven to where its short rod no longer reaches the guide, at asin(0.5) s."""
    scene = mbd.Scene()
    crank = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="crank"))
    rod = scene.add(mbd.RigidBody.rod((1, 0), (1.5, 0.0), mass=1.0, name="short rod"))
    scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0), name="foot"))
    scene.add(mbd.Pin(crank.at(0.5, 0), rod.at(-0.25, 0), name="knee"))
    scene.add(mbd.PointOnLine(rod.at(0.25, 0), scene.ground.at(0, 0), axis=(1, 0), name="guide"))
    scene.add(mbd.Motor(crank, scene.ground, angle=lambda t: t, name="motor"))
    return scene


def loose() -> mbd.Scene:
    scene = mbd.Scene()
    scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), name="falling"))
    return scene


def column() -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene((0, 0))
    beam = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=4, E=1e6, A=1e-3, I=1e-8, rho=2000, name="column"))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0)))
    return scene, scene.add(mbd.Force(beam.end, (-0.05, 0.0), name="push"))


def unfastened() -> Any:
    scene = mbd.Scene((0, 0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), name="adrift"))
    return mbd.continuation(scene, scene.add(mbd.Force(body.at(), (1.0, 0.0), name="push")))


def without_a_start() -> Any:
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), name="adrift"))
    return mbd.continuation(scene, scene.add(mbd.Force(body.at(), (1.0, 0.0), name="push")))


def broken_event() -> mbd.Event:
    return mbd.Event(lambda x: 1.0 / 0.0, name="bad")


def storm() -> Any:
    scene = mbd.Scene()
    scene.add(mbd.Particle(1.0, (0.0, 0.0), name="ball"))
    return mbd.simulate(scene, 2.0, solver=mbd.GeneralizedAlpha(0.01), events=[mbd.Event(lambda x: np.sin(2000.0 * x.t), name="buzz")])


def law(function: Any) -> mbd.Scene:
    scene = pendulum()
    scene.add(mbd.ForceLaw(scene.add(mbd.Angle(scene["rod"], scene.ground)), function, name="law"))
    return scene


def measure() -> mbd.Scene:
    scene = pendulum()
    turn = scene.add(mbd.Angle(scene["rod"], scene.ground))
    scene.add(mbd.UserMeasure(turn, lambda x: np.sqrt(x + 0.5).item() if x > -0.5 else float("nan"), name="cam"))
    return scene


class Case(NamedTuple):
    provoke: Callable[[], Any]
    what: str
    item: str | set[str]
    advice: tuple[str, str, str]  # a word of each
    partial: bool = True


FUNCTION = ("by itself", "wherever steps", "resume")
MECHANISM = {"foot", "knee", "guide", "motor"}
CASES: dict[str, Case] = {
    "load raises": Case(lambda: mbd.simulate(pendulum(late(divides)), 1.0), "raised ZeroDivisionError", "push", FUNCTION),
    "load NaN": Case(lambda: mbd.simulate(pendulum(late(np.nan)), 1.0), r"returned nan at 0\.", "push", ("division", "wherever", "resume")),
    "load shape": Case(
        lambda: mbd.simulate(pendulum(late((1.0, 2.0))), 1.0), r"shape \(2,\), expected a number", "push", ("return", "branch", "resume")
    ),
    "law raises": Case(lambda: mbd.simulate(law(lambda t, x: 0.0 if t < 0.3 else divides()), 1.0), "its function raised", "law", FUNCTION),
    "measure NaN": Case(lambda: mbd.simulate(measure(), 2.0), "its function returned", "cam", ("division", "wherever", "resume")),
    "event raises": Case(lambda: mbd.simulate(pendulum(), 1.0, events=[broken_event()]), "event's function raised", "bad", FUNCTION),
    "event storm": Case(storm, r"happened \d+ times in \d+ steps", "buzz", ("no faster", "threshold", "direction")),
    "step underflow": Case(blown, "steps became too short", "cart", ("smooth", "infinity", "rtol")),
    "singular": Case(lambda: mbd.simulate(unreachable(), 1.0), "next to a singular position", MECHANISM, ("check", "beside", "implicit")),
    "off the cable": Case(slid, "nothing left to slide on", "slider", ("Event", "Stop", "longer")),
    "kinematics": Case(
        lambda: mbd.kinematics(unreachable(), np.linspace(0, 2, 21)), "dead centre", MECHANISM, ("another joint", "lengths", "simulate")
    ),
    "no equilibrium": Case(lambda: mbd.equilibrium(loose()), "no equilibrium", "falling", ("nothing holds", "continuation", "dampers"), False),
    "no start": Case(without_a_start, "no equilibrium to start from", "adrift", ("loose", "start=", "load=None"), False),
    "no tangent": Case(unfastened, "no tangent", {"adrift", "push"}, ("stiffness", "beside", "equilibrium"), False),
    "path event": Case(lambda: mbd.continuation(*column(), events=[broken_event()]), "event's function raised", "bad", FUNCTION, False),
}


@pytest.mark.filterwarnings("ignore::mbd.SceneWarning")
@pytest.mark.parametrize("name", CASES)
def test_failures_say_what_when_where_and_what_to_try(name: str) -> None:
    case = CASES[name]
    with pytest.raises(mbd.SimulationError, match=case.what) as caught:
        case.provoke()
    error = caught.value
    assert error.item == case.item if isinstance(case.item, str) else error.item in case.item
    assert len(error.advice) == 3 and all(word in text for word, text in zip(case.advice, error.advice)), error.advice
    text = str(error)
    assert f"at {error.item}: {error.what}" in text and all(f"({k}) {advice}" in text for k, advice in enumerate(error.advice, 1))
    if case.partial:
        assert error.time is not None and error.result is not None and error.state is not None
        assert error.state.t <= error.time + 1e-9 and f"t = {error.time:.9g}" in text


@pytest.mark.filterwarnings("ignore::mbd.SceneWarning")
@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.partial and name != "kinematics"])
def test_partial_results_can_be_used(name: str, tmp_path: Path) -> None:
    with pytest.raises(mbd.SimulationError) as caught:
        CASES[name].provoke()
    result: Any = caught.value.result
    item = result.scene.items[0]
    assert np.isfinite(result.q).all() and np.isfinite(result.energy.total).all() and len(result.t) == len(result.q)
    assert np.isfinite(result.audit.position_drift) and np.isfinite(result.position(item.start if hasattr(item, "start") else item.at())).all()
    joints = [item for item in result.scene.items if isinstance(item.description, (mbd.Pin, mbd.Clamp))]
    assert all(np.isfinite(result.reaction(joint, t=result.t[: len(result.t) // 2])).all() for joint in joints)
    if name != "measure NaN":  # a scene that cannot be stored
        result.save(tmp_path / "part.npz")
        np.testing.assert_array_equal(mbd.load(tmp_path / "part.npz").q, result.q)
    pytest.importorskip("matplotlib").use("agg")
    assert result.plot() is not None


def test_advice_differs_with_the_cause() -> None:
    said = set()
    for case in CASES.values():
        with pytest.raises(mbd.SimulationError) as caught, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            case.provoke()
        said.add(caught.value.advice)
    assert len(said) >= 10 and len(set(STEPS)) == 2


@pytest.mark.parametrize("wrong", [{"item": ""}, {"advice": ("one", "two")}, {"advice": ("one", "two", "")}])
def test_an_error_without_item_or_advice_cannot_be_made(wrong: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match="expected an item and three"):
        mbd.SimulationError("it failed", **{"item": "rod", "advice": ("a", "b", "c")} | wrong)


def calls(path: Path) -> Iterator[ast.Call]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "SimulationError":
            yield node


def test_every_error_raised_in_the_library_has_item_and_advice() -> None:
    """The constructor checks values; here, that every place gives both, and that none of the places is unknown to the table above."""
    found = {}
    for folder in ("mbd", "elements", "joints", "solvers"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for call in calls(path):
                found[f"{path.name}:{call.lineno}"] = {keyword.arg for keyword in call.keywords}
    assert len(found) >= 10
    assert not {place: names for place, names in found.items() if None not in names and not {"item", "advice"} <= names}


def test_keyboard_interrupts_pass_through_calls_of_functions() -> None:
    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        called(stop, fits=lambda *_: True, expected="", what="", item="x", time=None)


def test_nothing_in_the_library_swallows_interrupts() -> None:
    """No bare ``except``, and BaseException only where it is raised again."""
    for folder in ("mbd", "elements", "joints", "solvers"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ExceptHandler):
                    names = {getattr(x, "id", "") for x in ast.walk(node.type)} if node.type else {"BaseException"}
                    again = any(isinstance(x, ast.Raise) for x in ast.walk(node))
                    assert "BaseException" not in names or again, f"{path}:{node.lineno}"


def test_no_reactions_and_no_values_in_a_singular_position() -> None:
    """Asked for where equations are dependent, they are refused by name, not by an error of linear algebra."""
    scene = unreachable()
    with pytest.raises(mbd.SimulationError) as caught:
        mbd.kinematics(scene, np.linspace(0.0, np.arcsin(0.5), 5))
    trajectory = caught.value.result.trajectory  # type: ignore[union-attr]
    for error in (
        undetermined(scene.build(), trajectory.linear, trajectory.q[-1], 0.5, ArithmeticError("no inverse")),
        unknown_between(scene.build(), trajectory.linear, *trajectory.states[:2], ArithmeticError("no inverse")),
    ):
        assert error.item in MECHANISM and "no inverse" in str(error) and len(error.advice) == 3
