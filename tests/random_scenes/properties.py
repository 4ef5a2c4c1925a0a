"""What must hold of any scene: it runs, or says why not; and it does not matter how it is described."""

from __future__ import annotations

import re
import signal
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import event, reject

import mbd

from .plans import Plan, Scene, World

PATIENCE = 30.0
"""Seconds after which a scene is given up: counted, not judged."""

CLOSE = 1e-6
"""Of the size of a scene (and of how far it lies from the origin in units of rounding): what two descriptions of one motion may differ by."""


class TooLong(Exception):
    """A run that takes longer than a test has time for."""


@contextmanager
def patience() -> Iterator[None]:
    def alarm(*_: Any) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, alarm)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def outcome(plan: Plan, **words: Any) -> tuple[Scene | None, mbd.Result | None, list[str]]:
    """The scene, its result, and what warnings said; no result where it failed with a clear error, or took too long. NumPy's complaints and
    any other exception pass through, and fail the test."""
    scene = None
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        warnings.simplefilter("error", RuntimeWarning)
        try:
            with patience():
                scene = Scene(plan)
                result = scene.run(**words)
        except mbd.SceneError as error:
            judge_scene_error(error)
            event("SceneError")
            return scene, None, []
        except mbd.SimulationError as error:
            judge_simulation_error(scene, error)
            event("SimulationError")
            return scene, None, []
        except TooLong:
            event("took too long")
            return scene, None, []
    event("ran")
    return scene, result, [str(warning.message) for warning in told]


def judge_scene_error(error: mbd.SceneError) -> None:
    """Each complaint says which item, what was expected, what was found, and how to mend it."""
    assert error.complaints
    for line in error.complaints:
        assert re.search(r"expected .*found .*; \w+", line), line


def judge_simulation_error(scene: Scene | None, error: mbd.SimulationError) -> None:
    """It says when, at which item of the scene, what to do, and carries what was reached, free of NaN."""
    assert scene is not None and error.what and error.advice and np.isfinite(error.time)
    assert error.item in {entry.name for entry in scene.plan.entries}, error.item
    assert error.result is not None
    assert np.isfinite(error.result.q).all() and np.isfinite(error.result.v).all()
    assert error.result.t[-1] <= error.time * (1.0 + 1e-12) + 1e-300


def judge_result(plan: Plan, result: mbd.Result, told: list[str]) -> None:
    """It is finite, joints are closed, energy balances (or a warning says that it does not)."""
    world, audit = plan.world, result.audit
    assert np.isfinite(result.q).all() and np.isfinite(result.v).all()
    assert result.t[-1] == plan.t_end * world.units[2]
    offset = float(np.linalg.norm(world.shift)) * world.units[0] / result.system.length
    assert audit.position_drift < 1e-9 + 1e-13 * offset
    slip = audit.velocity_drift * float(np.max(np.abs(result.v) * result.system.levers, initial=0.0))
    assert slip < 1e-6 * result.system.length / world.units[2]
    imbalance = 0.0 if audit.still else audit.energy_error / max(audit.energy_scale, 1e-9 * audit.energy_level)
    adaptive = plan.solver is None or "step" not in plan.solver[1]
    event(f"energy balanced within 1e{int(np.ceil(np.log10(max(imbalance, 1e-12))))}, {'adaptive' if adaptive else 'fixed steps'}")
    assert audit.balanced or any("energy" in line for line in told)


def run(plan: Plan, **words: Any) -> tuple[Scene, mbd.Result]:
    """What has to run for a comparison."""
    scene, result, _ = outcome(plan, **words)
    if scene is None or result is None:
        reject()
    return scene, result


def judge_same(plan: Plan, one: np.ndarray, other: np.ndarray) -> None:
    """Watched points [n, d] (nominal) that should be the same, but for what a hundredth of the tolerance changes too: some scenes amplify all."""
    size = 1.0 + float(np.max(np.abs(one)))
    gap = float(np.max(np.abs(one - other)))
    if gap < CLOSE * size:
        return
    scene, looser = run(plan, rtol=3.0 * plan.rtol)
    tolerant = float(np.max(np.abs(scene.points(looser) - one)))
    event("sensitive")
    assert gap < CLOSE * size + 30.0 * tolerant, (gap, tolerant)


def compared(plan: Plan, other: Plan) -> None:
    """Two descriptions of one motion."""
    scene, result = run(plan)
    other_scene, other_result = run(other)
    judge_same(plan, scene.points(result), other_scene.points(other_result))


def in_plain_units(plan: Plan) -> None:
    compared(plan.moved(units=(1.0, 1.0, 1.0)), plan)


def unmoved(plan: Plan) -> None:
    """Not turned and not shifted."""
    plain = World.plain(plan.dimension)
    compared(plan.moved(turn=plain.turn, shift=plain.shift), plan)


def in_another_order(plan: Plan) -> None:
    compared(plan, plan.shuffled(np.random.default_rng(len(plan.entries)).random(len(plan.entries)).tolist()))


def in_two_parts(plan: Plan) -> None:
    """Half the time, then from where that ended."""
    scene, whole = run(plan)
    _, half = run(plan, t_end=0.4 * plan.t_end)
    other, rest = run(plan, start=half.final)
    judge_same(plan, scene.points(whole), other.points(rest))


def saved_and_loaded(plan: Plan) -> None:
    """To the last bit, and the audit with it, where the scene has no functions of time: these cannot be stored, and values of several parts at
    the steps of one of them ask for them."""
    _, result = run(plan)
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore", mbd.SceneWarning)
        path = Path(folder) / "run.npz"
        result.save(path)
        loaded = mbd.load(path)
    assert loaded.stats["solver"] == result.stats["solver"]
    if not _functions(plan):
        assert loaded.audit == result.audit
    if not _functions(plan) or "parts" not in result.stats:
        for name in ("t", "q", "v"):
            np.testing.assert_array_equal(getattr(loaded, name), getattr(result, name))
    np.testing.assert_array_equal(loaded.scene.coordinates(), result.scene.coordinates())


def _functions(plan: Plan) -> bool:
    return any(hasattr(word, "amplitude") for entry in plan.entries for word in entry.words.values())


def by_another_solver(plan: Plan) -> None:
    scene, result = run(plan)
    other, by_radau = run(replace(plan, solver=("Radau", {"stages": 3})), rtol=0.1 * plan.rtol)
    judge_same(plan, scene.points(result), other.points(by_radau))


PROPERTIES = (in_plain_units, unmoved, in_another_order, in_two_parts, saved_and_loaded, by_another_solver)
