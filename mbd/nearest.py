"""Known names, and the one nearest to a misspelt name, for messages."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

LISTED = 16


def listed(known: Collection[str]) -> str:
    """The names, or the first of many."""
    names = [*known]
    return ", ".join(names[:LISTED]) + (f", ... ({len(names)} names)" if len(names) > LISTED else "")


def nearest(word: str, known: Collection[str]) -> str:
    """'; did you mean ...?', or nothing where no name is near."""
    found = get_close_matches(word[:100], list(known), n=1)
    return f"; did you mean {found[0]!r}?" if found else ""
