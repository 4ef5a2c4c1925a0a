"""Sphinx: ``python -m pip install ".[docs]" && python -m sphinx -W docs build/docs``.

What can be made is made at build time, into ``docs/generated``: theory pages from the derivations, the reference from docstrings, the gallery by
running the examples. The rest is text, whose code runs in the tests.
"""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

import gallery
import reference
import theory

import mbd

project, author, release = "mbd", "the mbd maintainers", mbd.__version__
copyright = "the mbd maintainers, BSD-3-Clause"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx-mathjax-offline", "sphinx_gallery.gen_gallery"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["generated/sources/**", "_ext"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
suppress_warnings = ["config.cache"]  # functions in sphinx_gallery_conf

autodoc_typehints = "none"  # most are Any: shapes and units are in the text
autodoc_member_order = "bysource"
smartquotes = False
python_use_unqualified_type_names = True

html_theme, html_title = "furo", "mbd"
html_static_path, html_css_files = ["_static"], ["site.css"]
html_theme_options = {"navigation_with_keys": True}

sphinx_gallery_conf = gallery.CONFIGURATION


def setup(app: Any) -> None:
    place = Path(app.srcdir) / "generated"
    gallery.prepare(place / "sources")
    theory.write(place / "theory")
    reference.write(place / "reference")
    app.connect("autodoc-process-docstring", reference.process)
