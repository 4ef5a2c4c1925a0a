"""Reports: a run as one HTML file that needs nothing else. ``result.report("run.html")`` comes here."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..result import Result


def write(result: Result, path: str | os.PathLike[str], outputs: Any = None, verification: Any = None, title: str | None = None) -> None:
    """Writes the report of a result, see ``Result.report``."""
    from .page import page

    target = Path(path)
    target.write_text(page(result, target.stem if title is None else title, outputs, verification), encoding="utf-8")
