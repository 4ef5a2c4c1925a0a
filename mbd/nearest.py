"""The known name nearest to a misspelt one, for messages."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(word: str, known: Iterable[str]) -> str:
    """'; did you mean ...?', or nothing where no name is near."""
    found = get_close_matches(word[:100], list(known), n=1)
    return f"; did you mean {found[0]!r}?" if found else ""
