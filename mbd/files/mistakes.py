"""What does not fit the model of scene files, in words: pydantic's findings as complaints with their places."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from .. import validate
from ..nearest import listed, nearest
from .kinds import FUNCTIONS, ITEMS, SOLVERS
from .model import ValidationError, document
from .text import Key


def mistakes(data: dict[str, Any], most: int) -> list[tuple[Key, str]]:
    """(key, what is wrong) of everything that does not fit the model, but not of more than ``most``."""
    try:
        document().model_validate(data)
    except ValidationError as error:
        return list(_in_words(data, error.errors(include_url=False, include_input=False)[:most]))
    return []


def _in_words(data: Any, errors: Sequence[Any]) -> Iterator[tuple[Key, str]]:
    for one in errors:
        key, found = _key(data, one["loc"], one["type"])
        yield key, _sentence(one, key, found, one["loc"])


def _key(data: Any, loc: tuple[int | str, ...], what: str) -> tuple[Key, Any]:
    """The key in the file, and what is there: pydantic's path without the names of alternatives."""
    key: Key = ()
    for part in loc:
        inside = part in data if isinstance(data, dict) else isinstance(data, list) and isinstance(part, int)
        if inside:
            key, data = (*key, part), data[part]
    return ((*key, loc[-1]) if what == "missing" else key), data


def _sentence(one: Any, key: Key, found: Any, loc: tuple[int | str, ...]) -> str:
    shown, context = validate.show(found), one.get("ctx", {})
    if one["type"] == "missing":
        return "expected a value, found none; give one"
    if one["type"] == "extra_forbidden":
        known = _fields_at(loc)
        return f"expected one of {listed(known)}; found {validate.show(key[-1])}{nearest(str(key[-1]), known)}"
    if one["type"] in ("union_tag_invalid", "union_tag_not_found"):
        known = _kinds_at(loc)
        kind = found.get("kind") if isinstance(found, dict) else None
        shown = validate.show(kind) if kind is not None else "none" if isinstance(found, dict) else shown
        return f"kind: expected one of {listed(known)}; found {shown}{nearest(kind, known) if isinstance(kind, str) else ''}"
    if one["type"] == "expected":
        return f"expected {context['expected']}; found {shown}"
    if one["type"] in ("too_short", "too_long"):
        limit = f"at least {context['min_length']}" if one["type"] == "too_short" else f"at most {context['max_length']}"
        return f"expected {limit}; found {len(found) if isinstance(found, (list, dict)) else 'others'}"
    what = {"list_type": "a list", "dict_type": "a table", "model_type": "a table", "model_attributes_type": "a table"}.get(one["type"])
    return f"expected {what or 'other data (' + one['msg'] + ')'}; found {shown}"


def _kinds_at(loc: tuple[int | str, ...]) -> list[str]:
    if loc[0] == "simulate":
        return list(SOLVERS)
    return list(ITEMS) if len(loc) == 2 else list(FUNCTIONS)


def _fields_at(loc: tuple[int | str, ...]) -> list[str]:
    """The names known beside an unknown one: those of the innermost kind on the way to it, else of the section or the file."""
    for part in reversed(loc[:-1]):
        for kinds in (FUNCTIONS, ITEMS, SOLVERS):
            if part in kinds:
                return ["kind", *kinds[str(part)].fields]
    home: Any = document() if len(loc) == 1 else document().model_fields["simulate"].annotation
    return list(home.model_fields)
