"""``python -m mbd``: usage, and what the command derive prints, writes and refuses."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import mbd
from mbd.__main__ import COMMANDS, main


@pytest.mark.parametrize(("words", "told"), [([], "COMMAND"), (["dance"], "invalid choice: 'dance'"), (["derive", "pinn"], "found pinn")])
def test_other_words_give_usage(words: list[str], told: str, capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(words)
    said = capsys.readouterr().err
    assert stopped.value.code == 2 and said.startswith("usage: python -m mbd") and told in said


def test_help_names_every_command(capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    said = capsys.readouterr().out
    assert all(f"    {name} " in said for name in COMMANDS)


def test_the_module_runs_as_a_program() -> None:
    done = subprocess.run([sys.executable, "-m", "mbd", "derive", "--list"], cwd=Path(mbd.__file__).parents[1], capture_output=True, text=True)
    assert done.returncode == 0 and {"ancf_cable", "local_frame", "rigid_body", "pin"} <= set(done.stdout.split())


def test_steps_are_printed_with_their_sources(capsys) -> None:
    assert main(["derive", "local_frame", "pin"]) == 0
    said = capsys.readouterr().out
    assert "8. Force" in said and "[Escalona, Hussien and Shabana (1998), eq. 25]" in said
    assert "A.mass.centre.x" in said and max(map(len, said.splitlines())) < 200


def test_steps_are_written_as_latex(tmp_path: Path) -> None:
    file = tmp_path / "steps.tex"
    assert main(["derive", "rigid_body", "clamp", "--latex", str(file)]) == 0
    text = file.read_text(encoding="utf-8")
    assert text.startswith(r"\documentclass") and text.rstrip().endswith(r"\end{document}")
    assert text.count("{") == text.count("}") and r"\section*{rigid\_body}" in text
    assert text.count(r"\begin{matrix}") == text.count(r"\end{matrix}") > 10
    assert r"x_{\text{A mass centre}}" in text


def test_a_check_that_agrees_exits_with_zero_and_prints_a_table(capsys) -> None:
    assert main(["derive", "particle", "--check"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].split()[:3] == ["subject", "worst", "kernel"] and "0 wrong" in said[-1]
