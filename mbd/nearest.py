"""Known names, and the one nearest to a misspelt name, for messages."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

LISTED, COMPARED = 16, 500
"""Names that a message lists, and names among which a near one is looked for: it takes time."""


def listed(known: Collection[str]) -> str:
    """The names, or the first of many."""
    names = [*known]
    return ", ".join(names[:LISTED]) + (f", ... ({len(names)} names)" if len(names) > LISTED else "")


def nearest(word: str, known: Collection[str]) -> str:
    """'; did you mean ...?', or nothing where no name is near."""
    if len(known) > COMPARED:
        return ""
    small = {name.lower(): name for name in known}
    found = get_close_matches(word[:100].lower(), list(small), n=1)
    return f"; did you mean {small[found[0]]!r}?" if found else ""
