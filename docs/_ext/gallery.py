"""The gallery: examples run as they are, with their own heads for text, and the pictures that they write."""

from __future__ import annotations

import ast
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import pages
from sphinx_gallery.scrapers import figure_rst
from sphinx_gallery.sorting import FileNameSortKey

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PACKAGES = ("escalona_1998",)
"""Folders of examples/ that are programs of several files."""
TUTORIAL = ("ten_minutes.py", "twenty_steps.py")
FOLDER = tempfile.TemporaryDirectory(prefix="pictures")  # removed when the build ends
PICTURES = Path(FOLDER.name)

HEADS = {
    "gallery": "Examples\n========\n\nEach is a page of code that prints a few numbers and writes a picture, and each is a test.\n",
    "tutorial": "Tutorials\n=========\n\nBoth run in the tests: what they print here is what they print.\n",
}


def prepare(folder: Path) -> None:
    """Copies of the examples with a title over each head, since Sphinx wants one."""
    for path in sorted(EXAMPLES.glob("*.py")):
        pages.write(folder / "gallery" / path.name, titled(path, path.stem))
    for package in PACKAGES:
        sys.path.append(str(EXAMPLES / package))  # its main module imports the others
        pages.write(folder / "gallery" / f"{package}.py", titled(EXAMPLES / package / "__main__.py", package))
    for name in TUTORIAL:
        pages.write(folder / "tutorial" / name, (EXAMPLES / "tutorial" / name).read_text(encoding="utf-8"))
    for name, head in HEADS.items():
        pages.write(folder / name / "README.rst", head)


def titled(path: Path, name: str) -> str:
    """The source with its docstring as reStructuredText: a title, and indented commands as code."""
    source = path.read_text(encoding="utf-8")
    head = ast.parse(source).body[0]
    title = name.replace("_", " ").capitalize()
    text = ast.get_docstring(ast.parse(source), clean=True) or ""
    text = "\n".join(f".. code-block:: sh\n\n{line}" if line.startswith("    python") else line for line in text.splitlines())
    body = "\n".join(source.splitlines()[head.end_lineno :])
    return f'r"""\n{title}\n{"=" * len(title)}\n\n{text}\n"""\n{body}\n'


def arguments(configuration: Any, variables: dict[str, Any]) -> list[str]:
    """Of the command line: where pictures go."""
    name = Path(variables["src_file"]).stem
    if name in PACKAGES:
        return [str(PICTURES)]
    return [] if f"{name}.py" in TUTORIAL else ["--out", str(PICTURES)]


def pictures(block: Any, variables: dict[str, Any], configuration: Any) -> str:
    """Moves what the example wrote into the page."""
    shown = []
    for source, target in zip(sorted(PICTURES.glob("*.png"), key=os.path.getmtime), variables["image_path_iterator"], strict=False):
        shutil.move(source, target)
        shown.append(target)
    return figure_rst(shown, configuration["src_dir"])


CONFIGURATION = {
    "examples_dirs": ["generated/sources/tutorial", "generated/sources/gallery"],
    "gallery_dirs": ["generated/tutorial", "generated/gallery"],
    "filename_pattern": "",
    "within_subsection_order": FileNameSortKey,
    "image_scrapers": ("matplotlib", pictures),
    "reset_argv": arguments,
    "download_all_examples": False,
    "capture_repr": (),
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "show_signature": False,
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "plot_gallery": "True",
    "thumbnail_size": (480, 220),
    "copyfile_regex": "",
}
