"""The families, a module for each group: what is swept, and how a result is checked."""

from __future__ import annotations

from ..family import Family
from . import frames, loads, ratios, settings, singular, sizes

FAMILIES: tuple[Family, ...] = (
    *ratios.FAMILIES,
    *frames.FAMILIES,
    *settings.FAMILIES,
    *singular.FAMILIES,
    *loads.FAMILIES,
    *sizes.FAMILIES,
)
