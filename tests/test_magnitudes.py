"""Hints at slips of units: every slip provoked is caught, no scene of this repository is suspected."""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.magnitudes import hints

from . import machines
from .references import squeezer, test_crank, test_four_bars
from .structure import mechanisms

ROOT = Path(__file__).resolve().parents[1]
STEEL: dict[str, Any] = {"E": 2.1e11, "A": 1e-4, "I": 8.3e-10, "rho": 7850}


class Built(Exception):
    """A scene was built."""


@pytest.fixture
def stopping(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[mbd.Scene]]:
    """What runs ends when its first scene has been built."""
    seen: list[mbd.Scene] = []
    build = mbd.Scene.build

    def record(scene: mbd.Scene) -> Any:
        build(scene)
        seen.append(scene)
        monkeypatch.setattr(mbd.Scene, "build", build)
        raise Built

    monkeypatch.setattr(mbd.Scene, "build", record)
    yield seen


def unsuspected(scene: mbd.Scene) -> None:
    assert [str(hint) for hint in hints(scene)] == []


PAPER = ("table_1", "figure_2", "figure_8", "figures_4_5", "figures_9_10")
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples(path, stopping, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with pytest.raises(Built):
        module.main(str(tmp_path))
    unsuspected(stopping[0])


@pytest.mark.parametrize("name", PAPER)
def test_parts_of_the_paper(name, stopping, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "examples" / "escalona_1998"))
    module = importlib.import_module(name)
    with pytest.raises(Built):
        module.run(tmp_path)
    unsuspected(stopping[0])
    for loaded in (*PAPER, "lines"):
        sys.modules.pop(loaded, None)


BLOCKS = re.findall(r"^```python\n(.*?)^```", (ROOT / "README.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("block", BLOCKS, ids=range(len(BLOCKS)))
def test_blocks_of_the_readme(block, stopping):
    with pytest.raises(Built):
        exec(block, {})
    unsuspected(stopping[0])


REFERENCES: dict[str, Callable[[], Any]] = {
    "flexible pendulum": machines.flexible_pendulum,
    "steel pendulum": lambda: machines.flexible_pendulum(E=0.7e9),
    "double pendulum": machines.double_pendulum,
    "simple pendulum": machines.simple_pendulum,
    "chain": lambda: machines.chain(20),
    "heavy top": machines.heavy_top,
    "squeezer": squeezer.squeezer,
    "flexible crank": lambda: test_crank.crank(4),
    "windows": lambda: test_four_bars.windows(3),
    "four-bar": lambda: mechanisms.four_bar(3),
    "slider-crank": mechanisms.slider_crank,
    "bricard": mechanisms.bricard,
}


@pytest.mark.parametrize("name", REFERENCES)
def test_reference_cases(name):
    unsuspected(REFERENCES[name]()[0])


def test_benchmarks(monkeypatch):
    """All their scenes, and the steps that they start with."""
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.scenes import CASES

    for case in CASES:
        if case.chain < 1000:
            scene, _ = case.build()
            assert [str(hint) for hint in hints(scene, case.t_end / case.steps)] == [], case.name
    sys.modules.pop("benchmarks.scenes", None)


# Slips: what is described, and the item and words of the hint.


def beam(gravity: float = 9.81, length: float = 1.0, **changes: float) -> mbd.Scene:
    scene = mbd.Scene(gravity=(0, -gravity))
    rod = scene.add(mbd.AncfCable((0, 0), (length, 0), n_elements=4, name="rod", **STEEL | changes))
    scene.add(mbd.Clamp(rod.start, scene.ground.at(0, 0)))
    return scene


def rod(length: float = 1.0, gravity: float = 9.81, body: dict[str, Any] | None = None, **motion: Any) -> mbd.Scene:
    scene = mbd.Scene(gravity=(0, -gravity))
    whole = mbd.RigidBody.rod((0, 0), (length, 0), mass=1.0, name="arm", **motion)
    numbers = {"mass": 1.0, "inertia": whole.inertia, "position": whole.position, "angular_velocity": whole.angular_velocity, "name": "arm"}
    arm = scene.add(mbd.RigidBody(**numbers | (body or {})))
    scene.add(mbd.Pin(arm.at(-0.5 * length, 0), scene.ground.at(0, 0)))
    return scene


def particle(position: float, *, mass: float = 1.0, stiffness: float | None = None, heavy: float | None = None) -> mbd.Scene:
    scene = mbd.Scene()
    bob = scene.add(mbd.Particle(mass, (position, 0), name="bob"))
    if stiffness is None:
        scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0)))
    else:
        scene.add(mbd.Spring(bob.at(), scene.ground.at(0, 0), stiffness=stiffness, name="spring"))
    if heavy is not None:
        scene.add(mbd.Distance(scene.add(mbd.Particle(heavy, (position, 1), name="block")).at(), bob.at()))
    return scene


def motor(speed: float) -> mbd.Scene:
    scene = rod()
    scene.add(mbd.Motor(scene["arm"], scene.ground, speed=speed, name="drive"))
    return scene


SLIPS = {
    "gigapascals": (lambda: beam(E=210.0), "rod", "E = 210"),
    "gigapascals of no known material": (lambda: beam(E=9.0, rho=600.0), "rod", "stretch by"),
    "megapascals": (lambda: beam(E=2.1e5), "rod", "E = 210000"),
    "tonnes per cubic millimetre": (lambda: beam(rho=7.85e-9), "rod", "rho = 7.85e-09"),
    "grams per cubic centimetre": (lambda: beam(rho=7.85), "rod", "rho = 7.85"),
    "millimetres, with gravity in metres": (lambda: beam(length=1e3, E=2.1e5, A=100.0, I=830.0, rho=7.85e-9), "rod", "gravity = 9.81"),
    "metres, with gravity in millimetres": (lambda: beam(gravity=9810.0), "rod", "gravity = 9810"),
    "an unknown material faster than diamond": (lambda: beam(E=9e9, rho=1.2), "rod", "sound travels"),
    "area in square millimetres": (lambda: beam(A=100.0), "rod", "I / A^2"),
    "moment in mm^4": (lambda: beam(I=830.0), "rod", "I / A^2"),
    "section in millimetres": (lambda: beam(A=100.0, I=830.0), "rod", "thickness of about"),
    "length in millimetres": (lambda: beam(length=2e3, A=1e-4, I=3e-11), "rod", "thicknesses"),
    "a beam shorter than its thickness": (lambda: beam(length=0.008), "rod", "thickness of about"),
    "a pendulum of 1200 m": (lambda: rod(1200.0), "arm", "mass / radius of gyration^3"),
    "a particle 1200 m away": (lambda: particle(1200.0), "bob", "1200 m long"),
    "inertia in kg mm^2": (lambda: rod(body={"inertia": 83333.0 * 100}), "arm", "radius of gyration sqrt"),
    "inertia too small": (lambda: rod(body={"inertia": 1e-6}), "arm", "mass / radius of gyration^3"),
    "masses far apart": (lambda: particle(1.0, mass=1e-6, heavy=1e4), "bob", "beside 1e+04 of 'block'"),
    "stiffness in N/mm": (lambda: particle(1.0, stiffness=1.0), "spring", "would stretch it"),
    "revolutions a minute": (lambda: rod(angular_velocity=6000.0), "arm", "rad/s it moves"),
    "a motor in revolutions a minute": (lambda: motor(3000.0), "arm", "by 'drive'"),
    "degrees": (lambda: rod(body={"angle": 90.0}), "arm", "angle = 90 rad"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_slips_are_caught(slip):
    """By a hint that names the item, what was found, what is usual and what to do; with the sound numbers there is none."""
    build, item, words = SLIPS[slip]
    told = mbd.check(build())
    assert any(hint.item == item and words in hint.found for hint in told.hints), told.hints
    assert all(hint.usual and hint.mend and f"unusual magnitude: {item!r}: " in str(told) for hint in told.hints if hint.item == item)


@pytest.mark.parametrize("build", [beam, rod, lambda: particle(1.0), lambda: particle(1.0, stiffness=1000.0), lambda: motor(30.0)])
def test_the_same_scenes_without_slips(build):
    assert mbd.check(build()).hints == ()


@pytest.mark.parametrize(
    "numbers",
    [
        {"gravity": 9810.0, "length": 1e3, "E": 2.1e5, "A": 100.0, "I": 830.0, "rho": 7.85e-9},
        {"gravity": 9810.0, "length": 1e3, "E": 2.1e8, "A": 100.0, "I": 830.0, "rho": 7.85e-6},
        {"gravity": 9.81e-3, "length": 1e3, "E": 210.0, "A": 100.0, "I": 830.0, "rho": 7.85e-6},
        {"gravity": 981.0, "length": 100.0, "E": 2.1e12, "A": 1.0, "I": 0.083, "rho": 7.85},
        {"gravity": 0.0, "length": 1.0, "E": 1.0, "A": 1.0, "I": 1.0 / 12.0 * 1e-2, "rho": 1.0},
    ],
    ids=["mm t s", "mm kg s", "mm kg ms", "cm g s", "of its own"],
)
def test_consistent_units_are_not_suspected(numbers):
    assert mbd.check(beam(**numbers)).hints == ()


def test_steps_too_long_for_what_moves():
    scene = particle(1.0, stiffness=1000.0)  # a period of 0.2 s
    assert mbd.check(scene, solver=mbd.GeneralizedAlpha(step=0.02)).hints == ()
    hint = mbd.check(scene, solver=mbd.GeneralizedAlpha(step=0.1)).hints[0]
    assert hint.item == "spring" and "period of 0.199" in hint.found
    assert mbd.check(scene, solver=mbd.Radau()).hints == mbd.check(scene).hints == ()


def test_hints_are_about_what_is_there_not_about_how_it_is_placed():
    """The scene far from the origin gives the same ones."""
    scene, far = particle(1.0, stiffness=1.0), mbd.Scene()
    bob = far.add(mbd.Particle(1.0, (1e6 + 1.0, 0), name="bob"))
    far.add(mbd.Spring(bob.at(), far.ground.at(1e6, 0), stiffness=1.0, name="spring"))
    assert [str(hint) for hint in hints(far)] == [str(hint) for hint in hints(scene)] and len(hints(far)) == 1
    assert np.isclose(mbd.check(far).hints[0].found.count("9.81"), 1)
