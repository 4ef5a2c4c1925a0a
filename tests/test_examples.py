"""Every example runs, tells the number it promises and leaves the picture it promises."""

from __future__ import annotations

import importlib.util
import json
import re
import runpy
import sys
import warnings
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import mbd

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
image = pytest.importorskip("matplotlib.image")
plt = pytest.importorskip("matplotlib.pyplot")

ROOT = Path(__file__).resolve().parents[1]
TUTORIALS = ROOT / "examples" / "tutorial"
REFERENCE = json.loads((ROOT / "tests" / "data" / "pendulum.json").read_text(encoding="utf-8"))
EXAMPLES = sorted(path.stem for path in (ROOT / "examples").glob("*.py"))
WORST = {
    "andrews_squeezer": 1e-10,
    "bricard": 1e-9,
    "cable_slider": 1e-5,
    "deep_arch": 1e-4,
    "flexible_pendulum": 2e-8,
    "four_bar": 1e-11,
    "quick_return": 1e-9,
    "slider_crank": 1e-6,
    "spin_up_beam": 3e-5,
}
"""What the main functions may return at most, as each one's head says: a difference from other solutions, or the energy not accounted for.
Of the pendulum half a unit of the last printed decimal, 5e-9 m, and the errors of time; of beams the errors of the mesh."""

PRINTED = {"flexible_pendulum": ("energy: balanced", "newton iterations"), "bricard": ("redundant joints 'hinge 0'",)}
"""Words that an example promises besides."""


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def painted(path: Path) -> float:
    """The share of pixels that are not white."""
    pixels = image.imread(path)
    return float(np.mean(np.any(pixels[..., :3] < 0.9, axis=-1)))


def test_every_example_has_a_limit():
    assert sorted(WORST) == EXAMPLES


@pytest.mark.parametrize("name", EXAMPLES)
def test_number_and_picture(name, tmp_path, capsys):
    assert example(name).main(str(tmp_path / "new" / "folder")) < WORST[name]
    picture = tmp_path / "new" / "folder" / f"{name}.png"
    assert list(picture.parent.iterdir()) == [picture] and 0.02 < painted(picture) < 0.5
    text = capsys.readouterr().out
    assert f"picture in {picture}" in text
    assert all(words in text for words in PRINTED.get(name, ()))


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_head_says_how_to_run_it(name):
    assert f"python examples/{name}.py [--out DIR]" in (example(name).__doc__ or "")


def test_the_references_in_the_example_are_those_of_the_tests():
    pendulum = example("flexible_pendulum")
    for elasticity, tips in pendulum.REFERENCE.items():
        np.testing.assert_array_equal(tips, REFERENCE[elasticity]["tip"])
        np.testing.assert_allclose(pendulum.TIMES, REFERENCE[elasticity]["t"])


def tutorial(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    """Runs a tutorial, which asserts what it claims, without any warning; returns its names."""
    monkeypatch.chdir(folder)
    with warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        return runpy.run_path(str(TUTORIALS / f"{name}.py"), run_name="__main__")


def test_every_tutorial_is_run():
    assert {path.stem for path in TUTORIALS.glob("*.py")} == {"ten_minutes", "twenty_steps"}


def test_twenty_steps(tmp_path, monkeypatch, capsys):
    names = tutorial("twenty_steps", tmp_path, monkeypatch)
    plt.close("all")
    text = capsys.readouterr().out
    assert [int(n) for n in re.findall(r"^(\d+)\. ", text, re.MULTILINE)] == list(range(1, 21))
    assert list(tmp_path.iterdir()) == [tmp_path / "twenty_steps.png"] and 0.02 < painted(tmp_path / "twenty_steps.png") < 0.5
    printed = [REFERENCE["continuum"]["t"].index(t) for t in names["TIMES"]]
    np.testing.assert_array_equal(names["TIPS"], np.array(REFERENCE["continuum"]["tip"])[printed])


@pytest.mark.slow
def test_twenty_steps_without_matplotlib(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    tutorial("twenty_steps", tmp_path, monkeypatch)
    assert "the picture needs matplotlib" in capsys.readouterr().out and not list(tmp_path.iterdir())


def test_ten_minutes(tmp_path, monkeypatch, capsys):
    before = len(plt.get_fignums())
    names = tutorial("ten_minutes", tmp_path, monkeypatch)
    assert len(plt.get_fignums()) == before + 2
    plt.close("all")
    assert "free motion: 'rod' turns" in capsys.readouterr().out
    assert all(names[run].audit.balanced for run in ("result", "fall", "run"))
