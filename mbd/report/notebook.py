"""How notebooks show scenes, results and what is said of them: HTML that needs nothing but itself."""

from __future__ import annotations

from functools import singledispatch
from html import escape
from typing import Any

from ..audit import Audit
from ..diagnosis import Structure
from ..result import Result, Statistics
from ..scene import Scene
from ..verification.verification import Verification
from ..vibration import Modes
from . import words
from .page import page
from .picture import scene_picture

SIZE = 400_000
"""Bytes of an animation within a notebook, which keeps all of them."""
STYLE = "<style>.mbd td,.mbd th{text-align:left;vertical-align:top}.mbd .wide{overflow-x:auto}</style>"


@singledispatch
def html(thing: Any) -> str:
    """HTML of a thing of the library."""
    return f"<pre>{escape(str(thing))}</pre>"


def _framed(content: str) -> str:
    return f'<div class="mbd">{STYLE}{content}</div>'


for _kind, _table in (
    (Structure, words.structure),
    (Audit, words.audit),
    (Modes, words.modes),
    (Statistics, words.statistics),
    (Verification, words.verification),
):
    html.register(_kind, lambda thing, table=_table: _framed(table(thing)))


@html.register
def _(thing: Scene) -> str:
    """A picture and a table, or why the scene cannot be built."""
    from ..errors import SceneError

    try:
        return _framed(scene_picture(thing) + words.items(thing))
    except SceneError as error:
        return _framed("<ul>" + "".join(f"<li>{escape(line)}</li>" for line in error.complaints) + "</ul>")


@html.register
def _(thing: Result) -> str:
    """The page of a report in a frame that can reach nothing outside of itself."""
    try:
        inner = escape(page(thing, repr(thing).strip("<>"), size=SIZE))
    except ValueError as error:  # the scene has grown since
        return _framed(f"<p>{escape(repr(thing))}</p><p>{escape(str(error))}</p>")
    return f'<iframe sandbox="allow-scripts" style="width:100%;height:640px;border:1px solid #888" title="a run, animated" srcdoc="{inner}"></iframe>'
