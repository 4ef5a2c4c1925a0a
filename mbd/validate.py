"""Checks of numbers in descriptions. Each returns its complaints as sentences: expected, found, how to mend."""

from __future__ import annotations

from typing import Any

import numpy as np


def floats(value: Any) -> Any:
    """A float64 array where the value can be one; otherwise the value itself, for the check to complain about."""
    if value is None:
        return None
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        return value


def vector(field: str, value: Any, dimension: int) -> list[str]:
    if not isinstance(value, np.ndarray) or value.shape != (dimension,):
        plane = "a planar" if dimension == 2 else "a spatial"
        return [f"{field}: expected {dimension} numbers in {plane} scene, found {show(value)}; give as many components as the scene's gravity has"]
    return finite(field, value)


def finite(field: str, value: np.ndarray) -> list[str]:
    return [] if np.isfinite(value).all() else [f"{field}: expected finite numbers, found {show(value)}; remove NaN and infinity"]


def number(field: str, value: Any, *, positive: bool = False, negative_allowed: bool = True) -> list[str]:
    expected = "a positive number" if positive else "a number" if negative_allowed else "a number not below zero"
    good = isinstance(value, np.ndarray) and value.shape == () and bool(np.isfinite(value))
    if good and ((positive and value <= 0) or (not negative_allowed and value < 0)):
        good = False
    return [] if good else [f"{field}: expected {expected}, found {show(value)}; correct the value"]


def count(field: str, value: Any, least: int = 1) -> list[str]:
    good = isinstance(value, (int, np.integer)) and not isinstance(value, bool) and value >= least
    return [] if good else [f"{field}: expected a whole number of at least {least}, found {show(value)}; correct the value"]


def show(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
