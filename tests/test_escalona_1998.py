"""The example of the 1998 paper: every line of its table keeps its limit, every picture is drawn, every formulation ranks where it should."""

from __future__ import annotations

import importlib
import runpy
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

FOLDER = Path(__file__).resolve().parents[1] / "examples" / "escalona_1998"
MODULES = tuple(path.stem for path in FOLDER.glob("*.py") if path.stem != "__main__")


@pytest.fixture
def part(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Imports a module of the example, and forgets all of them afterwards."""
    monkeypatch.syspath_prepend(str(FOLDER))

    def load(name: str) -> ModuleType:
        return importlib.import_module(name)

    import sys

    yield load
    for name in MODULES:
        sys.modules.pop(name, None)


@pytest.mark.parametrize(("name", "pictures", "count"), [("table_1", ["table_1"], 8), ("figure_2", ["figure_2"], 2), ("figure_8", ["figure_8"], 2)])
def test_part(part: Any, name: str, pictures: list[str], count: int, tmp_path: Path) -> None:
    lines = part(name).run(tmp_path)
    assert len(lines) == count
    assert [str(line) for line in lines if not line.difference <= line.limit] == []
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{picture}.png" for picture in pictures]


def test_a_number_too_far_off_is_told(part: Any) -> None:
    lines = part("lines")
    assert str(lines.number("x", "1", 1.0, 1.1, 0.05)).endswith("TOO FAR")
    assert not str(lines.number("x", "1", 1.0, 1.01, 0.05)).endswith("TOO FAR")
    assert lines.series("x", "1", [1.0, 2.0], [1.0, 2.5], 1.0).difference == 0.5


@pytest.mark.slow
def test_whole_example(tmp_path: Path, capsys: pytest.CaptureFixture[str], part: Any) -> None:
    assert runpy.run_path(str(FOLDER), run_name="escalona")["main"](str(tmp_path)) < 1.0
    text = capsys.readouterr().out
    assert "TOO FAR" not in text and "large rotation vector" in text
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["figure_10", "figure_2", "figure_4", "figure_5", "figure_8", "figure_9", "table_1"]


@pytest.mark.slow
def test_formulations_are_as_good_as_they_should_be(part: Any) -> None:
    """Errors on the finer mesh, from measurements: what suits a scene is near its continuum, what does not is far."""
    found = {key[:2]: numbers[-1] for key, numbers in part("formulations").compare((30,)).items()}
    scenes = ("soft pendulum", "stiff pendulum", "cantilever")
    limits = {
        "ANCF, continuum strains": (1e-3, 1e-6, 1e-4),
        "ANCF, local frame (1998)": (3e-2, 2e-6, 1e-3),
        "corotational (incremental)": (3e-2, 5e-6, 1e-3),
        "large rotation vector": (2e-3, 2e-4, 2e-4),
        "floating frame, stiffened": (None, 1e-4, None),
    }
    for name, bounds in limits.items():
        for scene, limit in zip(scenes, bounds):
            assert limit is None or found[scene, name] < limit, (scene, name)
    assert found["stiff pendulum", "floating frame, linear"] > 5.0 * found["stiff pendulum", "floating frame, stiffened"]
    assert min(found[scene, "floating frame, stiffened"] for scene in ("soft pendulum", "cantilever")) > 0.1
