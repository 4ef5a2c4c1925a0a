"""Every example runs, tells the number it promises and leaves the picture it promises."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
image = pytest.importorskip("matplotlib.image")

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = json.loads((ROOT / "tests" / "data" / "pendulum.json").read_text(encoding="utf-8"))
EXAMPLES = sorted(path.stem for path in (ROOT / "examples").glob("*.py"))
WORST = {"flexible_pendulum": 2e-8}
"""What the main functions may return at most: of the pendulum half a unit of the last printed decimal, 5e-9 m, and the errors of time."""


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
    assert example(name).main(str(tmp_path / "picture.png")) < WORST[name]
    assert 0.02 < painted(tmp_path / "picture.png") < 0.5
    text = capsys.readouterr().out
    assert "energy: balanced" in text and "newton iterations" in text and str(tmp_path / "picture.png") in text


def test_the_references_in_the_example_are_those_of_the_tests():
    pendulum = example("flexible_pendulum")
    for elasticity, tips in pendulum.REFERENCE.items():
        np.testing.assert_array_equal(tips, REFERENCE[elasticity]["tip"])
        np.testing.assert_allclose(pendulum.TIMES, REFERENCE[elasticity]["t"])
