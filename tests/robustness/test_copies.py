"""The same scene gives the same bits: in other processes, in threads, from copies; and what goes between processes arrives whole."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd

ROOT = Path(mbd.__file__ or "").parents[1]
HERE = Path(__file__).parent


def push(t: float) -> tuple[float, float]:
    return 0.0, np.sin(5.0 * t).item()


def broken(t: float) -> tuple[float, float]:
    return (0.0, 0.0) if t < 0.05 else (np.nan, 0.0)


def scene(force: Any = push) -> mbd.Scene:
    """A beam and a body, joined, pushed and driven, and what is apart of them."""
    out = mbd.Scene()
    rod = out.add(mbd.AncfCable((0, 0), (1, 0), n_elements=3, damping=1e-3, elasticity="local_frame", E=1e6, A=1e-3, I=1e-8, rho=2000, name="rod"))
    crank = out.add(mbd.RigidBody.rod((-0.2, 0), (0, 0), mass=1.0, name="crank"))
    out.add(mbd.Pin(crank.at(-0.1, 0), out.ground.at(-0.2, 0), name="foot"))
    out.add(mbd.Clamp(rod.start, crank.at(0.1, 0)))
    out.add(mbd.Motor(crank, out.ground, speed=np.cos))
    out.add(mbd.Force(rod.end, force, name="push"))
    ball = out.add(mbd.Particle(1.0, (5, 0)))
    out.add(mbd.Spring(ball.at(), out.ground.at(5, 2), stiffness=200.0))
    return out


def run(of: mbd.Scene, t_end: float = 0.1) -> mbd.Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mbd.SceneWarning)
        return mbd.simulate(of, t_end, rtol=1e-4)


def ran(of: mbd.Scene) -> mbd.Result:
    return run(of)


def failed(_: int) -> None:
    run(scene(broken))


def bits(result: mbd.Result) -> bytes:
    return b"".join(np.ascontiguousarray(x).tobytes() for x in (result.t, result.q, result.v))


@pytest.fixture(scope="module")
def expected() -> mbd.Result:
    return run(scene())


def test_in_other_processes_whatever_the_hash_seed(expected: mbd.Result) -> None:
    code = "import sys; sys.path.insert(0, sys.argv[1]); import test_copies as t, hashlib; print(hashlib.sha256(t.bits(t.run(t.scene()))).digest())"
    found = set()
    for seed in ("0", "1", "4711"):
        environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONHASHSEED": seed}
        found.add(subprocess.run([sys.executable, "-c", code, str(HERE)], env=environment, capture_output=True, text=True, check=True).stdout)
    assert len(found) == 1


def test_again_and_again(expected: mbd.Result) -> None:
    """One scene and others of the same description, also after something else was asked of it."""
    same = scene()
    first = run(same)
    first.reaction(same["foot"], t=[0.01, 0.033])
    run(same, 0.05)
    assert {bits(first), bits(run(same)), bits(run(scene()))} == {bits(expected)}


@pytest.mark.filterwarnings("ignore::mbd.SceneWarning")
def test_in_threads(expected: mbd.Result) -> None:
    """Of one scene that nobody had built before, and of different ones, at the same time."""
    for scenes in ([scene()] * 6, [scene() for _ in range(6)]):
        with ThreadPoolExecutor(6) as pool:
            results = list(pool.map(lambda of: mbd.simulate(of, 0.1, rtol=1e-4), scenes))
        assert {bits(result) for result in results} == {bits(expected)}
        assert all(result.scene.build() is result.system for result in results)


def test_in_a_pool_of_processes(expected: mbd.Result) -> None:
    built = scene()
    built.build()
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
        for result in pool.map(ran, [scene(), built]):
            assert bits(result) == bits(expected)
            np.testing.assert_array_equal(result.reaction(result.scene["foot"]), expected.reaction(expected.scene["foot"]))
            assert bits(mbd.resume(result, 0.15)) == bits(run(scene(), 0.15))
        with pytest.raises(mbd.SimulationError, match=r"at push: .*returned") as stop:
            list(pool.map(failed, [1]))
    error = stop.value
    assert error.item == "push" and len(error.advice) == 3 and error.state is not None
    assert error.result is not None and error.result.t[-1] == error.state.t and np.isfinite(error.result.energy.total).all()


@pytest.mark.parametrize("way", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))], ids=["deepcopy", "pickle"])
def test_copies(way: Any, expected: mbd.Result) -> None:
    for built in (False, True):
        one = scene()
        if built:
            run(one)
        other = way(one)
        other.add(mbd.Particle(1.0, (9.0, 9.0), name="more"))
        assert "more" not in one._names and one.build().n == other.build().n - 2 and other["rod"].end.scene is other
        assert bits(run(way(one))) == bits(expected)
    result = way(expected)
    assert bits(result) == bits(expected) and result.stats == expected.stats and str(result.audit) == str(expected.audit)
    tip, t = result.scene["rod"].end, [0.013, 0.07]
    np.testing.assert_array_equal(result.position(tip, t=t), expected.position(expected.scene["rod"].end, t=t))


def column() -> tuple[mbd.Scene, Any, Any]:
    out = mbd.Scene((0, 0))
    beam = out.add(mbd.AncfCable((0, 0), (1, 0), n_elements=4, E=1e6, A=1e-3, I=1e-8, rho=2000))
    out.add(mbd.Clamp(beam.start, out.ground.at(0, 0)))
    return out, out.add(mbd.Force(beam.end, (-1e-3, 1e-3))), beam


REPORTS = {
    "equilibrium": lambda s, f, b: mbd.equilibrium(s),
    "continuation": lambda s, f, b: mbd.continuation(s, f),
    "modes": lambda s, f, b: mbd.modes(s),
    "linearize": lambda s, f, b: mbd.linearize(s, [f], [b.end]),
    "check": lambda s, f, b: mbd.check(s),
    "assemble": lambda s, f, b: mbd.assemble(s),
    "audit": lambda s, f, b: mbd.simulate(s, 0.01).audit,
    "SceneError": lambda s, f, b: mbd.SceneError(["one", "two"]),
    "Interrupted": lambda s, f, b: mbd.Interrupted(mbd.simulate(s, 0.01)),
}


@pytest.mark.filterwarnings("ignore::mbd.SceneWarning")
@pytest.mark.parametrize("name", REPORTS)
def test_reports_and_errors(name: str) -> None:
    one = REPORTS[name](*column())
    for other in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one)):
        assert repr(other)[:60] == repr(one)[:60] and type(other) is type(one)
        for field in ("q", "shapes", "stiffness", "complaints", "factor", "time"):
            np.testing.assert_array_equal(getattr(other, field, 0.0), getattr(one, field, 0.0))


def test_functions_that_cannot_go_are_named() -> None:
    with pytest.raises(TypeError, match="Force 'push': vector"):
        pickle.dumps(scene(lambda t: (0.0, t)))
    copy.deepcopy(scene(lambda t: (0.0, t))).build()


def test_an_error_goes_where_its_result_cannot() -> None:
    with pytest.raises(mbd.SimulationError) as stop:
        run(scene(lambda t: broken(t)))
    error = pickle.loads(pickle.dumps(stop.value))
    assert error.result is None and (error.what, error.item, error.time, error.advice) == tuple(
        getattr(stop.value, name) for name in ("what", "item", "time", "advice")
    )
    np.testing.assert_array_equal(error.state.q, stop.value.state.q)  # type: ignore[union-attr]
