"""The command line: usage, what each command prints, writes and refuses, and its exit codes."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mbd
import mbd.files.model
from mbd.__main__ import COMMANDS, main
from mbd.commands import examples, scenes

ROOT = Path(__file__).resolve().parents[1]

PENDULUM = """
gravity = [0, -9.81]
[parameters]
L = 1
[[items]]
kind = "RigidBody.rod"
name = "rod"
start = [0, 0]
end = ["L", 0]
mass = 1
[[items]]
kind = "Pin"
name = "pivot"
a = "rod.at(-L / 2, 0)"
b = "ground"
[simulate]
t_end = 0.2
outputs = { tip = "rod.at(L / 2, 0)" }
"""
PYTHON = """
import mbd
scene = mbd.Scene()
rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1))
scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at()))
outputs, t_end = {"tip": rod.at(0.5, 0)}, 0.2
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where commands run, with a scene in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pendulum.toml").write_text(PENDULUM, encoding="utf-8")
    return tmp_path


def program(*words: str, cwd: Path) -> subprocess.Popen[str]:
    """mbd in a process of its own, of this very tree."""
    environment = os.environ | {"PYTHONPATH": str(Path(mbd.__file__ or "").parents[1])}
    command = [sys.executable, "-m", "mbd", *words]
    return subprocess.Popen(command, cwd=cwd, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@pytest.mark.parametrize(("words", "told"), [([], "COMMAND"), (["dance"], "invalid choice: 'dance'"), (["derive", "pinn"], "found pinn")])
def test_other_words_give_usage(words: list[str], told: str, capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(words)
    said = capsys.readouterr().err
    assert stopped.value.code == 2 and said.startswith("usage: mbd") and told in said


def test_help_names_every_command_and_the_exit_codes(capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    said = capsys.readouterr().out
    assert all(f"    {name}" in said for name in COMMANDS) and "130 stopped from the keyboard" in " ".join(said.split())


def test_the_module_runs_as_a_program() -> None:
    process = program("derive", "--list", cwd=ROOT)
    said, _ = process.communicate()
    assert process.returncode == 0 and {"ancf_cable", "local_frame", "rigid_body", "pin"} <= set(said.split())


# Scenes: run, check, statics, modes, verify, work-precision.


def tip(seconds: float, length: float = 1.0) -> np.ndarray:
    """The tip of a falling rod, by a Runge-Kutta of order 4 on its angle alone."""
    x, h = np.array([0.0, 0.0]), seconds / 2000

    def f(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -1.5 * 9.81 / length * np.cos(y[0])])

    for _ in range(2000):
        a = f(x)
        b = f(x + 0.5 * h * a)
        c = f(x + 0.5 * h * b)
        x = x + h / 6 * (a + 2 * b + 2 * c + f(x + h * c))
    return length * np.array([np.cos(x[0]), np.sin(x[0])])


def told(said: str, name: str = "tip") -> np.ndarray:
    line = next(line for line in said.splitlines() if line.startswith(name))
    return np.array([float(word) for word in re.findall(r"-?\d[\d.e-]*", line.removeprefix(name))])


def test_run_says_where_it_went(folder: Path, capsys) -> None:
    assert main(["run", "pendulum.toml"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("t = 0.2 s\n") and "energy: balanced within" in said and "steps" in said
    np.testing.assert_allclose(told(said), tip(0.2), atol=1e-5)


def test_the_command_line_goes_before_the_file(folder: Path, capsys) -> None:
    words = ["run", "pendulum.toml", "--t-end", "0.3", "--set", "L=2", "--set", "rod.mass=L / 2", "--solver", "Radau(stages=3)", "--rtol", "1e-9"]
    assert main([*words, "--out", "run.npz"]) == 0
    said = capsys.readouterr().out
    np.testing.assert_allclose(told(said), tip(0.3, 2.0), atol=2e-6)
    assert "written: run.npz" in said and "rtol 1e-09" in said
    back = mbd.load("run.npz")
    assert back.t[-1] == 0.3 and back.trajectory.pieces()[0].solver == mbd.Radau(3)
    assert float(back.scene["rod"].description.mass) == 1.0 and back.scene["rod"].length == 2.0


def test_run_draws_a_picture(folder: Path) -> None:
    assert main(["run", "pendulum.toml", "--plot", "run.png"]) == 0
    assert (folder / "run.png").read_bytes().startswith(b"\x89PNG")


def test_run_writes_a_report_with_the_outputs(folder: Path, capsys) -> None:
    assert main(["run", "pendulum.toml", "--report", "run.html"]) == 0
    page = (folder / "run.html").read_text(encoding="utf-8")
    assert page.lower().startswith("<!doctype html>") and "tip" in page and "written: run.html" in capsys.readouterr().out


def test_a_python_file_defines_a_scene(folder: Path, capsys) -> None:
    (folder / "pendulum.py").write_text(PYTHON, encoding="utf-8")
    assert main(["run", "pendulum.py"]) == 0
    np.testing.assert_allclose(told(capsys.readouterr().out), tip(0.2), atol=1e-5)
    assert main(["run", "pendulum.py", "--set", "L=2"]) == 2 and "expected a scene file" in capsys.readouterr().err
    (folder / "empty.py").write_text("x = 1", encoding="utf-8")
    assert main(["run", "empty.py"]) == 2 and "defines 'scene'" in capsys.readouterr().err


def test_a_run_that_stops_keeps_what_it_reached(folder: Path, capsys) -> None:
    """A function that ends before the run does."""
    text = PENDULUM + '[[items]]\nkind = "Torque"\nmarker = "rod"\nvalue = { kind = "Table", times = [0, 0.1], values = [0, 1] }\n'
    (folder / "short.toml").write_text(text, encoding="utf-8")
    assert main(["run", "short.toml", "--out", "part.npz"]) == 1
    said = capsys.readouterr()
    assert "outside of the table, which goes from 0 to 0.1 s" in said.err and "Traceback" not in said.err and "written: part.npz" in said.out
    assert 0.05 < mbd.load("part.npz").t[-1] <= 0.1 + 1e-9


@pytest.mark.skipif(os.name == "nt", reason="SIGINT is sent as POSIX has it")
def test_ctrl_c_leaves_the_partial_result(folder: Path) -> None:
    stop = "import os, signal\npull = lambda t: os.kill(os.getpid(), signal.SIGINT) or 0.0 if t > 0.1 else 0.0\n"
    stop += "pull.discontinuities = ()  # else it would be looked at before the run\nscene.add(mbd.Torque(rod.at(), pull))\n"
    (folder / "stopped.py").write_text(PYTHON + stop, encoding="utf-8")
    process = program("run", "stopped.py", "--out", "part.npz", "--progress", cwd=folder)
    said, err = process.communicate(timeout=100)
    assert process.returncode == 130, err
    assert "stopped from the keyboard at t = " in err and "Traceback" not in err
    assert "s/s" not in err and "%|" not in err, "no bar where there is no terminal"
    reached = mbd.load(folder / "part.npz").t[-1]
    assert 0.0 < reached <= 0.1 and f"t = {reached:g} s" in said


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["pendulum.toml", "--set", "l=2"], "pendulum.toml: overrides: expected a parameter, .*found 'l'"),
        (["pendulum.toml", "--set", "rod.mas=2"], "pendulum.toml, line 5, items.0..mas of 'rod': .*did you mean 'mass'"),
        (["pendulum.toml", "--set", "rod.mass=-2"], "items.0..mass of 'rod': expected a number not below zero, found -2.0"),
        (["nowhere.toml"], "mbd: nowhere.toml: No such file"),
        (["scene.txt"], "scene.txt: expected a file that ends in .toml or .json"),
        (["pendulum.toml", "--t-end", "-1"], "t_end: expected a finite time after the start"),
    ],
)
def test_what_cannot_run_is_said_without_a_traceback(words: list[str], told: str, folder: Path, capsys) -> None:
    assert main(["run", *words]) == 2
    said = capsys.readouterr()
    assert re.search(told, said.err) and said.err.startswith("mbd: ") and "Traceback" not in said.err and not said.out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--solver", "Radau(stages=4)"], "expected 3, 5, 7 or None"),
        (["--solver", "Euler"], "expected one of Automatic"),
        (["--solver", "__import__('os')"], "expected one of Automatic"),
        (["--solver", "Radau(stages=open('x'))"], "malformed node|found"),
        (["--set", "L"], "expected NAME=VALUE"),
        (["--rtol", "small"], "expected a number"),
    ],
)
def test_wrong_words_are_usage_errors(words: list[str], told: str, folder: Path, capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["run", "pendulum.toml", *words])
    assert stopped.value.code == 2 and re.search(told, capsys.readouterr().err)


def test_without_a_time_to_end_it_asks_for_one(folder: Path, capsys) -> None:
    (folder / "open.toml").write_text(PENDULUM.partition("[simulate]")[0], encoding="utf-8")
    assert main(["run", "open.toml"]) == 2 and "give --t-end" in capsys.readouterr().err
    assert main(["verify", "open.toml"]) == 2 and "expected what to verify" in capsys.readouterr().err


def test_settings_are_values_as_in_toml() -> None:
    for text, value in (("E=1e6", 1e6), ("a.b=[0, 7]", [0, 7]), ("a.c=local_frame", "local_frame"), ("n=2 * L", "2 * L"), ("x=true", True)):
        assert scenes.setting(text) == (text.partition("=")[0], value)
    assert scenes.solver("Radau") == mbd.Radau() and scenes.solver("Gauss(step=0.1, stages=3)") == mbd.Gauss(0.1, stages=3)
    assert scenes.listed(scenes.solver)("Radau(stages=3), Gauss(step=1, stages=2)") == [mbd.Radau(3), mbd.Gauss(1, stages=2)]


def test_check_exits_with_one_where_a_joint_is_redundant(folder: Path, capsys) -> None:
    assert main(["check", "pendulum.toml"]) == 0
    assert "degrees of freedom: 1 by rank, 1 by count" in capsys.readouterr().out
    twice = PENDULUM.replace("[simulate]", '[[items]]\nkind = "Pin"\nname = "twin"\na = "rod.at(-L / 2, 0)"\nb = "ground"\n[simulate]')
    (folder / "twice.toml").write_text(twice, encoding="utf-8")
    assert main(["check", "twice.toml"]) == 1
    assert "'twin'" in capsys.readouterr().out


def test_statics_gives_positions_and_reactions(folder: Path, capsys) -> None:
    assert main(["statics", "pendulum.toml"]) == 0
    said = capsys.readouterr()
    np.testing.assert_allclose(told(said.out), [0.0, -1.0], atol=1e-9)
    np.testing.assert_allclose(told(said.out, "reaction at 'pivot'")[:2], [0.0, 9.81], atol=1e-6)
    assert "equilibrium: stable" in said.out


def test_modes_about_the_equilibrium(folder: Path, capsys) -> None:
    assert main(["modes", "pendulum.toml", "--about", "equilibrium", "-n", "1"]) == 0
    row = capsys.readouterr().out.splitlines()[1].split()
    assert float(row[2]) == pytest.approx(np.sqrt(1.5 * 9.81), rel=1e-5) and float(row[1]) == pytest.approx(float(row[2]) / 2 / np.pi, rel=1e-5)


def test_work_precision_compares_solvers(folder: Path, capsys) -> None:
    words = ["work-precision", "pendulum.toml", "--solvers", "Radau(stages=3),Radau(stages=5)", "--rtols", "1e-3,1e-6", "--plot", "work.png"]
    assert main(words) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("Radau")]
    assert len(lines) == 4 and (folder / "work.png").exists()
    assert main(["work-precision", "pendulum.toml", "--output", "top"]) == 2 and "found 'top', there are 'tip'" in capsys.readouterr().err


def test_verify_estimates_the_error_of_each_output(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    assert main(["verify", "pendulum.toml", "--t-end", "2", "--rtol", "1e-5", "--report", "run.html"]) == 0
    row = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("tip")).split()
    assert row[1] == "m" and 0.0 < float(row[2]) < 1e-4 and (folder / "run.html").exists()
    monkeypatch.setattr(mbd.Verification, "ok", property(lambda self: False))
    assert main(["verify", "pendulum.toml"]) == 1, "no estimate for some output"


# Examples and the schema.


def test_a_newcomers_path(folder: Path, capsys) -> None:
    """Copy, run, change a number, run again."""
    assert main(["examples", "copy", "pendulum", "--to", "mine"]) == 0
    path = folder / "mine" / "pendulum.toml"
    assert main(["run", str(path), "--plot", "run.png"]) == 0
    soft = told(capsys.readouterr().out.partition("t = ")[2])
    np.testing.assert_allclose(soft, (-1.11881858, 0.01977834), atol=2e-5)  # of the example's reference, at 1.1 s
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("E = 0.7e6", "E = 0.7e11"), encoding="utf-8")
    assert main(["run", str(path), "--t-end", "0.2"]) == 0
    np.testing.assert_allclose(told(capsys.readouterr().out), tip(0.2, 1.2), atol=5e-3)  # nearly rigid
    assert main(["examples", "copy", "pendulum", "--to", "mine"]) == 2 and "is there already" in capsys.readouterr().err


def test_examples_are_listed_in_words_and_copied(folder: Path, capsys) -> None:
    assert main(["examples"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {"pendulum", "four_bar", "slider_crank", "heavy_top", "double_pendulum", "escalona_1998"} <= {line.split()[0] for line in lines}
    assert len(lines) == len(list((ROOT / "examples").glob("*.py"))) + len(list((ROOT / "examples" / "scenes").glob("*.toml"))) + 1
    assert all((len(line) < 180 and not line.endswith((".", ":"))) or line.endswith(" ...") for line in lines), lines
    assert main(["examples", "copy", "four_bar.py", "escalona_1998", "heavy_top.toml"]) == 0
    assert {path.name for path in folder.iterdir()} == {"four_bar.py", "escalona_1998", "heavy_top.toml", "pendulum.toml"}
    assert (folder / "escalona_1998" / "reference.json").exists()
    assert main(["examples", "copy", "pendulm"]) == 2 and "did you mean 'pendulum'?" in capsys.readouterr().err


def test_every_example_says_what_it_is() -> None:
    assert all(examples.headline(source) for source in examples.examples().values())


def test_schema_is_the_models(folder: Path, capsys) -> None:
    from mbd.files.model import schema

    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == schema()
    assert main(["schema", "--out", "scene.json"]) == 0 and json.loads((folder / "scene.json").read_text(encoding="utf-8"))


# Derivations.


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
