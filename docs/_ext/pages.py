"""Generated files: written only where they change, so that a second build has little to do."""

from __future__ import annotations

from pathlib import Path


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def rid(folder: Path, wanted: set[str]) -> None:
    """Removes what an earlier build wrote and this one does not."""
    for path in folder.glob("*.*"):
        if path.name not in wanted:
            path.unlink()
