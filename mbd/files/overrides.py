"""Values that replace those of a file before it is read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..nearest import nearest

SECTIONS = ("gravity", "simulate")


def override(data: dict[str, Any], key: str, value: Any) -> None:
    """Puts a value in the place of a parameter ("L"), an item's field ("rod.E") or another key ("gravity", "simulate.t_end") of a file's
    data. Raises ValueError where there is no such place."""
    value = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else list(value) if isinstance(value, tuple) else value
    home, _, name = key.rpartition(".")
    named = {item["name"]: item for item in _items(data) if isinstance(item.get("name"), str)}
    given = data.get("parameters", {})
    if key in given or key == "gravity":
        (given if key in given else data)[key] = value
    elif home == "simulate":
        data.setdefault("simulate", {})[name] = value
    elif home in named:
        named[home][name] = value
    else:
        known = [*given, *SECTIONS, *(f"{item}.{field}" for item, fields in named.items() for field in fields if field not in ("kind", "name"))]
        raise ValueError(f"overrides: expected a parameter, or the field of a named item such as 'rod.E'; found {key!r}{nearest(key, known)}")


def _items(data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    items = data.get("items")
    return (item for item in (items if isinstance(items, list) else []) if isinstance(item, dict))
