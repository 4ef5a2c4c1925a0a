"""What commands share that take a scene: arguments, the scene behind them, words for solvers and numbers."""

from __future__ import annotations

import argparse
import ast
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import SceneError

if TYPE_CHECKING:
    from ..job import Job


def scene_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", type=Path, metavar="SCENE", help="a scene file (.toml, .json), or a Python file that defines 'scene' (it is run)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", type=setting, help="a parameter or a field, as E=1e6 or rod.E=1e6; several times"
    )


def run_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--t-end", type=number, metavar="T", help="end of the run [s]; default: what the scene file says")
    parser.add_argument("--rtol", type=number, metavar="R", help="error allowed in one step, relative; default: what the scene file says, or 1e-6")
    parser.add_argument("--solver", type=solver, metavar="SOLVER", help="such as Radau, 'Radau(stages=5)' or 'GeneralizedAlpha(step=1e-3)'")


def job_of(options: argparse.Namespace) -> Job:
    """The scene and how to run it: as its file says, but for what the command line says."""
    job = _from_python(options.scene, options.set) if options.scene.suffix == ".py" else _from_file(options.scene, options.set)
    told = {name: value for name in ("t_end", "rtol", "solver") if (value := getattr(options, name, None)) is not None}
    return replace(job, **told)


def end_of(job: Job) -> float:
    """The end of the run [s]. Raises SceneError where nothing says it."""
    if job.t_end is None:
        raise SceneError(["t_end: expected the end of the run, found none; give --t-end, or t_end under [simulate] in the scene file"])
    return job.t_end


def _from_file(path: Path, settings: list[tuple[str, Any]]) -> Job:
    from ..files import read

    return read(path, dict(settings))


def _from_python(path: Path, settings: list[tuple[str, Any]]) -> Job:
    """Runs the file. It may define outputs = {"tip": rod.end}, t_end, rtol and solver beside its scene."""
    from runpy import run_path

    from ..job import Job
    from ..scene import Scene

    if settings:
        raise SceneError([f"--set: expected a scene file, found {path.name}; parameters of a Python file are its own"])
    names = run_path(str(path), run_name="__mbd__")
    if not isinstance(names.get("scene"), Scene):
        raise SceneError([f"{path.name}: expected a Python file that defines 'scene', an mbd.Scene; found {names.get('scene')!r}"])
    return Job(names["scene"], **{name: names[name] for name in ("t_end", "rtol", "solver", "outputs") if name in names})


def setting(text: str) -> tuple[str, Any]:
    """NAME=VALUE; values as in TOML, anything else is a text."""
    name, sign, value = text.partition("=")
    if not sign or not name:
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE such as rod.E=1e6, found {text!r}")
    try:
        return name.strip(), tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name.strip(), value.strip()


def number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a number, found {text!r}") from None


def solver(text: str) -> Any:
    """A solver by name, with arguments as in Python; nothing is evaluated."""
    from .. import solvers

    try:
        call = ast.parse(text.strip(), mode="eval").body
        name, arguments = (call.func, call.keywords) if isinstance(call, ast.Call) and not call.args else (call, [])
        if not isinstance(name, ast.Name) or name.id not in solvers.__all__:
            raise ValueError(f"expected one of {', '.join(solvers.__all__)}")
        return getattr(solvers, name.id)(**{str(each.arg): ast.literal_eval(each.value) for each in arguments})
    except (SyntaxError, ValueError, TypeError) as error:
        raise argparse.ArgumentTypeError(f"{error}; found {text!r}, give it as Radau or 'Radau(stages=5)'") from None


def listed(one: Callable[[str], Any]) -> Callable[[str], list[Any]]:
    """Several of a kind between commas that are not in brackets."""

    def parse(text: str) -> list[Any]:
        from ..functions.language import arguments

        return [one(part) for part in arguments(text)]

    return parse
