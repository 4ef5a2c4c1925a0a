"""The README tells the truth: its Python blocks run as they are, its commands are those of continuous integration."""

from __future__ import annotations

import re
import warnings
from importlib import import_module
from pathlib import Path

import pytest

import mbd

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[tuple[str, str]]:
    """(heading, code) of each block; the code is shifted to its line in the file, so that tracebacks point there."""
    found = []
    for match in re.finditer(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL):
        before = README[: match.start(1)]
        found.append((re.findall(r"^#+ (.+)$", before, re.MULTILINE)[-1], "\n" * before.count("\n") + match[1]))
    return found


BLOCKS = blocks("python")
COMMANDS = [line.partition("#")[0].strip() for _, code in blocks("sh") for line in code.strip().splitlines()]


@pytest.mark.parametrize("block", [pytest.param(code, id=heading) for heading, code in BLOCKS])
def test_block_runs(block, tmp_path, monkeypatch):
    """In a folder of its own, since it may save files; nothing in it needs a warning."""
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        exec(compile(block, ROOT / "README.md", "exec"), {})


def test_there_are_blocks_and_commands():
    assert len(BLOCKS) >= 3
    assert 'python -m pip install ".[plot]" && python examples/flexible_pendulum.py' in COMMANDS
    assert 'python -m pip install ".[test]" && python -m pytest' in COMMANDS


def test_continuous_integration_runs_the_commands_that_install():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    quick = [command for command in COMMANDS if "pip install" in command and "benchmarks" not in command]  # benchmarks are slow, and named so
    assert len(quick) == 2
    for command in quick:
        assert command in script


def test_files_it_names_exist():
    for name in set(re.findall(r"`((?:mbd|elements|joints|solvers|docs|examples|\.ci)/[\w./]*)`", README)):
        assert (ROOT / name).exists(), name


def test_every_class_is_named():
    homes = (import_module(f"mbd.{home}") for home in ("elements", "joints", "solvers"))
    assert not [name for home in homes for name in home.__all__ if f"`{name}" not in README]
