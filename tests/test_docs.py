"""The documentation tells the truth: its Python blocks run, its links lead somewhere, nothing public is missing, and it builds without a warning."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
import warnings
from importlib import import_module
from pathlib import Path

import pytest

import mbd

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if "generated" not in path.parts)
FILE = re.compile(r"^```toml\n# (\S+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
"""A block that is a file, with its name in the first line."""
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
WITH_CODE = [path for path in PAGES if BLOCK.search(path.read_text(encoding="utf-8"))]
LINK = re.compile(r"\]\(([^)\s]+)\)")
TREE = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)


def name(path: Path) -> str:
    return str(path.relative_to(DOCS))


def code(path: Path) -> str:
    """The blocks of a page, each at its line, so that tracebacks point there."""
    text, lines = path.read_text(encoding="utf-8"), [""]
    for match in BLOCK.finditer(text):
        lines += [""] * (text[: match.start(1)].count("\n") - len(lines) + 1)
        lines += match[1].splitlines()
    return "\n".join(lines[1:])


@pytest.mark.parametrize("path", WITH_CODE, ids=name)
def test_blocks_run(path, tmp_path, monkeypatch):
    """All blocks of a page in one namespace, in a folder of their own with the page's files; what they claim they assert."""
    source = code(path)
    for module in re.findall(r"^import (exudyn|matplotlib)", source, re.MULTILINE):
        pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    for file, text in FILE.findall(path.read_text(encoding="utf-8")):
        (tmp_path / file).write_text(text, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error", mbd.SceneWarning)
        exec(compile(source, path, "exec"), {"__name__": "page"})


def test_there_are_pages_with_code():
    assert {"index.md", "guide/modelling.md", "guide/solvers.md", "guide/exudyn.md"} <= set(map(name, WITH_CODE))


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_local_links_lead_somewhere(path):
    """Pages that the build makes are checked where it is run."""
    for target in LINK.findall(re.sub(r"`[^`]*`", "", path.read_text(encoding="utf-8"))):
        place = target.partition("#")[0]
        if place and not re.match(r"[a-z]+:", place) and not place.startswith("generated/"):
            assert (path.parent / place).exists(), target


def test_every_page_is_in_a_table_of_contents():
    listed = set()
    for path in PAGES:
        entries = "\n".join(TREE.findall(path.read_text(encoding="utf-8"))).split()
        listed |= {found for entry in entries if not entry.startswith(":") for found in path.parent.glob(f"{entry}.md")}
    assert not {name(path) for path in PAGES if path not in listed} - {"index.md"}


def test_included_parts_exist():
    """An include takes what stands between two headings of another page."""
    for path in PAGES:
        for file, start, end in re.findall(r"```\{include\} (\S+)\n:start-after: \"(.+)\"\n:end-before: \"(.+)\"", path.read_text(encoding="utf-8")):
            text = (path.parent / file).read_text(encoding="utf-8")
            assert "|" in text.partition(start)[2].partition(end)[0] and end in text.partition(start)[2], f"{name(path)}: {file}: {start}"


@pytest.fixture
def made(monkeypatch):
    """The modules that write pages at build time, none of which needs Sphinx."""
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    yield import_module
    for module in ("pages", "reference", "theory"):
        sys.modules.pop(module, None)


def test_the_reference_has_every_name_once(made):
    groups = made("reference").groups()
    assert sorted(name for names in groups.values() for name in names) == sorted(name for name in mbd.__all__ if not name.startswith("__"))
    assert "Scene" in groups["scenes, results and messages"] and "Pin" in groups["joints"]


def test_lists_in_docstrings_become_definitions(made):
    lines = [*inspect.cleandoc(mbd.Radau.__doc__ or "").splitlines(), "", "Some *stars* and ``code``."]
    made("reference").process(None, "class", "mbd.Radau", mbd.Radau, None, lines)
    assert lines[lines.index("``stages``") + 1].startswith("    3, 5 or 7")
    assert "Some \\*stars\\* and ``code``." in lines


def test_a_theory_page_has_every_step(made):
    theory = made("theory")
    steps, text = theory.subjects.steps("local_frame"), theory.page("local_frame", "Title", "First line.")
    assert re.findall(r"^## (\d+)\.", text, re.MULTILINE) == [str(k) for k in range(1, len(steps) + 1)]
    assert all(step.latex[0] in text and step.kernel in text for step in steps)


@pytest.mark.slow
def test_it_builds_without_a_warning(tmp_path):
    for module in ("sphinx", "myst_parser", "sphinx_gallery", "furo", "sphinx-mathjax-offline"):
        pytest.importorskip(module)
    site = tmp_path / "site"
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", str(DOCS), str(site)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    reference = "".join(path.read_text(encoding="utf-8") for path in (site / "generated" / "reference").glob("*.html"))
    assert not [name for name in mbd.__all__ if not name.startswith("__") and f'id="mbd.{name}"' not in reference]
    gallery = {path.stem for path in (site / "generated" / "gallery").glob("*.html")}
    assert {path.stem for path in (ROOT / "examples").glob("*.py")} | {"escalona_1998"} <= gallery
    assert (site / "_static" / "mathjax" / "tex-chtml.js").exists() and "_static/mathjax/" in (site / "index.html").read_text(encoding="utf-8")
