"""Theory pages: the steps of ``python -m mbd derive``, a page for each subject."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import pages

from mbd.derivations import subjects
from mbd.derivations.specimens import kinds

HEAD = "# The equations, derived\n\n"
ABOUT = """Each page is what `python -m mbd derive SUBJECT` prints: steps from a published equation, or from what the step before says, to a kernel of
the package, which is named with each. `python -m mbd derive --check` evaluates all of them with 30 digits at random states and compares
them with what the kernels return; the tests do the same. Long expressions have names $z_1, z_2, \\dots$ for what occurs in them more than once.
"""
SHORT = 200
"""Characters of LaTeX that fit a line of text."""
TITLES = {
    "local_frame": "The element of 1998: strains from the chord",
    "continuum": "Continuum strains of a cable",
    "rows": "What joints are made of",
}


def write(folder: Path) -> None:
    words = subjects.words()
    names = {subjects.word(name): (name, kind) for name, kind in kinds().items()}
    for word in words:
        title, first = (TITLES[word], _module_line(word)) if word in TITLES else (f"`{names[word][0]}`", _line(names[word][1].__doc__))
        pages.write(folder / f"{word}.md", page(word, title, first))
    kinds_of = [word for word in words if word not in subjects.PARTS]
    listed = [word for word in words if word in subjects.PARTS] + sorted(kinds_of, key=lambda word: word not in subjects.WRITTEN)
    toctree = "\n".join(["```{toctree}", ":maxdepth: 1", "", *listed, "```", ""])
    pages.write(folder / "index.md", f"{HEAD}{ABOUT}\n{toctree}")
    pages.rid(folder, {f"{word}.md" for word in [*words, "index"]})


def page(word: str, title: str, first: str) -> str:
    parts = [f"# {title}", plain(first), f"From `python -m mbd derive {word}`."]
    for k, step in enumerate(subjects.steps(word), 1):
        parts.append(f"## {k}. {plain(step.title)}")
        parts += equation(step.latex)
        parts.append(f"Source: {plain(step.source)}. Kernel: `{step.kernel}`.")
    return "\n\n".join(parts) + "\n"


def equation(lines: list[str]) -> list[str]:
    """The first line displayed; short definitions run on as text, long ones are displayed too."""
    short = [line for line in lines[1:] if len(line) < SHORT]
    shown = [f"```{{math}}\n{line}\n```" for line in lines if line == lines[0] or line not in short]
    return [*shown, "with " + ", ".join(f"${line}$" for line in short)] if short else shown


def _module_line(word: str) -> str:
    return _line(sys.modules[subjects.PARTS[word][1].__module__].__doc__)


def _line(text: Any) -> str:
    """The first sentence or line of a docstring."""
    return re.split(r"\n\s*\n|\n {4,}", str(text).strip())[0].replace("\n", " ")


def plain(text: str) -> str:
    """Words for Markdown: nothing in them is markup but ``code``."""
    pieces = re.split(r"``(.+?)``", text)
    return "".join(f"`{piece}`" if k % 2 else re.sub(r"([\\`*_{}\[\]<>|$#])", r"\\\1", piece) for k, piece in enumerate(pieces))
