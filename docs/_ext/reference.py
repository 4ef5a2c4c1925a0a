"""The reference: every public name, grouped as in the README's table of what there is; its docstrings as they are written."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import pages

import mbd

README = Path(__file__).resolve().parents[2] / "README.md"
REST = "what they return and raise"


def groups() -> dict[str, list[str]]:
    """Names by the first row of the README's table that has them; what is in none, at the end."""
    table = README.read_text(encoding="utf-8").partition("## What there is")[2].partition("\n## ")[0]
    left, found = [name for name in mbd.__all__ if not name.startswith("__")], {}
    for label, text in re.findall(r"^\| ([a-z ]+) \| (.+) \|$", table, re.MULTILINE):
        named = [name for name in dict.fromkeys(re.findall(r"`(\w+)", text)) if name in left]
        left = [name for name in left if name not in named]
        found[label] = named
    found[REST] = left
    return {label: names for label, names in found.items() if names}


def write(folder: Path) -> None:
    made = groups()
    for label, names in made.items():
        parts = [f"# {label.capitalize()}", "```{eval-rst}\n.. currentmodule:: mbd\n```"]
        parts += [f"```{{eval-rst}}\n{directive(name)}\n```" for name in names]
        pages.write(folder / f"{_file(label)}.md", "\n\n".join(parts) + "\n")
    listed = "\n".join(map(_file, made))
    about = "Every public name of `mbd`, with shapes, units and errors. Lists are aligned as in the source: `help(mbd.AncfCable)` shows the same."
    pages.write(folder / "index.md", f"# Reference\n\n{about}\n\n```{{toctree}}\n:maxdepth: 2\n\n{listed}\n```\n")
    pages.rid(folder, {f"{_file(label)}.md" for label in [*made, "index"]})


def directive(name: str) -> str:
    """Of descriptions only what makes them: their other methods are called by scenes and solvers."""
    thing = getattr(mbd, name)
    if not inspect.isclass(thing):
        return f".. autofunction:: mbd.{name}"
    described = thing.__module__.startswith(("mbd.elements", "mbd.joints", "mbd.solvers"))
    makers = ", ".join(word for word, method in vars(thing).items() if isinstance(method, classmethod) and not word.startswith("_"))
    members = f"   :members: {makers}" if described and makers else "" if described else "   :members:"
    return f".. autoclass:: mbd.{name}\n{members}"


def _file(label: str) -> str:
    return label.replace(" ", "_")


def process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text: lists that are aligned by spaces stay so, as literal blocks, the rest becomes paragraphs."""
    text = inspect.cleandoc("\n".join(lines))
    lines[:] = [line for part in re.split(r"\n\s*\n", text) for line in (*_shown(part), "")]


def _shown(part: str) -> list[str]:
    rows = part.splitlines()
    if re.search(r"\S {2,}\S|^ +\S", part, re.MULTILINE):
        lead = next(k for k, row in enumerate([*rows, " "]) if re.search(r"\S {2,}\S|^ +\S", row) or row == " ")
        return [*map(_plain, rows[:lead]), "", "::", "", *(f"    {row}" for row in rows[lead:])]
    return [_plain(row) for row in rows]


def _plain(row: str) -> str:
    """Words for reStructuredText, with ``code`` left as it is."""
    pieces = re.split(r"(``.+?``)", row)
    return "".join(piece if k % 2 else re.sub(r"([\\*`|_])", r"\\\1", piece) for k, piece in enumerate(pieces))
