"""The reference: every public name, grouped as in the README's table of what there is; its docstrings as they are written."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import pages

import mbd

README = Path(__file__).resolve().parents[2] / "README.md"
GAP = re.compile(r"(?<=[^\s;.]) {2,}(?=\S)")
"""Between a name and what it means; after a semicolon or full stop it is only a wide space."""
REST = "scenes, results and messages"
"""The group of all names that the table does not have."""


def groups() -> dict[str, list[str]]:
    """Names by the first row of the README's table that has them; what is in none, at the end."""
    table = README.read_text(encoding="utf-8").partition("## What there is")[2].partition("\n## ")[0]
    left, found = [name for name in mbd.__all__ if not name.startswith("__")], {}
    for label, text in re.findall(r"^\| ([^|]+?) \| (.+) \|$", table, re.MULTILINE):
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
    about = "Every public name of `mbd`, with shapes, units and errors. `help(mbd.AncfCable)` shows the same."
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
    return re.sub(r"\W+", "_", label)


def process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text: lists aligned by spaces become definition lists, what is indented stays as it is, the rest are paragraphs."""
    text = inspect.cleandoc("\n".join(lines))
    lines[:] = [line for part in re.split(r"\n\s*\n", text) for line in (*_shown(part.splitlines()), "")]


def _shown(rows: list[str]) -> list[str]:
    """A paragraph, and what follows its last plain line: a list or a block of text."""
    first = next((k for k, row in enumerate(rows) if GAP.search(row) or row.startswith(" ")), len(rows))
    paragraph, rest = [_plain(row) for row in rows[:first]], rows[first:]
    if rest and all(GAP.search(row) or row.startswith(" ") for row in rest) and not rest[0].startswith(" "):
        return [*paragraph, "", *_definitions(rest)]
    return [*paragraph, "", ".. code-block:: text", "", *(f"    {row}" for row in rest)] if rest else paragraph


def _definitions(rows: list[str]) -> list[str]:
    out: list[str] = []
    for row in rows:
        if row.startswith(" "):
            out.append(f"    {_plain(row.strip())}")
        else:
            term, _, text = GAP.sub("\0", row, count=1).partition("\0")
            out += [f"``{term}``", f"    {_plain(text)}"]
    return out


def _plain(row: str) -> str:
    """Words for reStructuredText, with ``code`` left as it is."""
    pieces = re.split(r"(``.+?``)", row)
    return "".join(piece if k % 2 else re.sub(r"([\\*`|_])", r"\\\1", piece) for k, piece in enumerate(pieces))
