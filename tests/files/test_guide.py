"""The guide tells the truth: its files are read, its Python runs, its commands too, and its complaints are those that come."""

from __future__ import annotations

import re
import shlex
import warnings
from pathlib import Path

import pytest

import mbd
from mbd.__main__ import main
from mbd.files import model
from mbd.files.kinds import FUNCTIONS, ITEMS
from mbd.functions.translation import FUNCTIONS as WORDS

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "guide"
SCENES = (GUIDE / "scene_files.md").read_text(encoding="utf-8")
COMMANDS = (GUIDE / "command_line.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """With the files of the guide, by the names in their first lines."""
    monkeypatch.chdir(tmp_path)
    for text in blocks(SCENES, "toml"):
        (tmp_path / text.partition("\n")[0].removeprefix("# ")).write_text(text, encoding="utf-8")
    return tmp_path


def test_python_and_files_go_together(folder: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for code in blocks(SCENES, "python"):
            exec(compile(code, "scene_files.md", "exec"), {})
    assert (folder / "stiff.json").exists() and (folder / "driven.npz").exists()


def test_complaints_are_those_that_come(folder: Path) -> None:
    with pytest.raises(mbd.SceneError) as trouble:
        mbd.read_scene("wrong.toml")
    assert str(trouble.value) + "\n" == blocks(SCENES, "text")[0]


def test_limits_are_those_of_the_code() -> None:
    from mbd.files import kinds, text, values

    told = SCENES.rpartition("Files have limits: ")[2].replace("\n", " ")
    limits = [*(text.LARGEST[ending] // 10**6 for ending in (".toml", ".json")), model.MOST["items"], model.MOST["parameters"]]
    limits += [values.HUGE, kinds.MANY, values.ALL]
    assert [float(number) for number in re.findall(r"\d[\de]*", told.replace(" 000", "000"))] == limits


def test_every_kind_of_function_and_every_word_is_told() -> None:
    table = SCENES.partition("## Functions of t")[2]
    for name, kind in FUNCTIONS.items():
        row = re.search(rf"^`{name}` \| (.*)\|", table, re.MULTILINE)
        assert row, name
        assert set(re.findall(r"`(\w+)`", row[1].partition("|")[0])) <= set(kind.fields)
    assert set(re.findall(r"^    (sin cos .*)$", SCENES, re.MULTILINE)[0].split()) == set(WORDS)
    assert all(hasattr(mbd, name.partition(".")[0]) for name in ITEMS)


def test_commands_run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "pendulum.toml").unlink()
    monkeypatch.setenv("MPLBACKEND", "Agg")
    lines = [line.partition("  #")[0] for block in blocks(COMMANDS, "sh") for line in block.splitlines()]
    assert len(lines) == 8
    for line in lines:
        words = shlex.split(line)
        assert words[0] == "mbd" and main(words[1:]) == 0, line


def test_every_command_is_told() -> None:
    from mbd.__main__ import COMMANDS as NAMES

    assert all(f"`mbd {name} " in COMMANDS or f"`mbd {name}`" in COMMANDS for name in NAMES)
