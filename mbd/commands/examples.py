"""Lists the examples that come with mbd, scene files and Python programs, and copies them for you to change."""

from __future__ import annotations

import argparse
import ast
import re
import shutil
import sys
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from pathlib import Path

from ..nearest import nearest

HELP = "list the examples, and copy them: mbd examples copy pendulum"


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", nargs="?", choices=("list", "copy"), default="list")
    parser.add_argument("names", nargs="*", metavar="NAME", help="which to copy")
    parser.add_argument("--to", type=Path, default=Path(), metavar="FOLDER", help="where to; default: here")


def run(options: argparse.Namespace) -> int:
    found = examples()
    if options.action == "list":
        width = max(map(len, found))
        for name, source in found.items():
            print(f"{name:<{width}}  {source.name:<22}  {headline(source)}")
        return 0
    if not options.names:
        options.parser.error(f"expected names of examples among {', '.join(found)}; found none")
    return max(_copy(name, found, options.to) for name in options.names)


def examples() -> dict[str, Traversable]:
    """Scene files by their name, then Python programs and folders by theirs."""
    home = files("mbd.examples")
    scenes = sorted((each for each in home.joinpath("scenes").iterdir() if each.name.endswith(".toml")), key=lambda each: each.name)
    programs = sorted((each for each in home.iterdir() if _runs(each)), key=lambda each: each.name)
    found = {scene.name.removesuffix(".toml"): scene for scene in scenes}
    return found | {program.name if program.name.removesuffix(".py") in found else program.name.removesuffix(".py"): program for program in programs}


def _runs(entry: Traversable) -> bool:
    return entry.joinpath("__main__.py").is_file() if entry.is_dir() else entry.name.endswith(".py") and not entry.name.startswith("__")


def headline(source: Traversable) -> str:
    """The first sentence of what an example says of itself."""
    if source.is_dir():
        return headline(source.joinpath("__main__.py"))
    text = source.read_text(encoding="utf-8")
    told = text.removeprefix("# ").replace("\n# ", " ") if source.name.endswith(".toml") else ast.get_docstring(ast.parse(text)) or ""
    return re.split(r"(?<=[a-z0-9)])\. |\n", told)[0].rstrip(".:")


def _copy(name: str, found: dict[str, Traversable], folder: Path) -> int:
    """Copies one; what is there already stays."""
    source = found.get(name) or next((each for each in found.values() if each.name == name), None)
    if source is None:
        print(f"mbd: expected an example among {', '.join(found)}; found {name!r}{nearest(name, found)}", file=sys.stderr)
        return 2
    target = folder / source.name
    if target.exists():
        print(f"mbd: {target} is there already and stays as it is; remove it, or copy --to another folder", file=sys.stderr)
        return 2
    folder.mkdir(parents=True, exist_ok=True)
    with as_file(source) as path:
        if path.is_dir():
            shutil.copytree(path, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copyfile(path, target)
    print(f"copied: {target}")
    return 0
