"""Checks of measures, items with a ``coordinate``, where a description asks for one."""

from __future__ import annotations

from typing import Any


def measured(item: Any) -> bool:
    return hasattr(item, "coordinate")


def measure_faults(field: str, item: Any) -> list[str]:
    """Complaints about what should be a measure; one that was refused is complained of already."""
    if measured(item) or hasattr(getattr(item, "description", None), "unit"):
        return []
    return [f"{field}: expected a measure as scene.add(mbd.Angle(...)) returned it, found {item!r}; add one"]
