"""The families, a module for each group: what is swept, and how a result is checked."""

from __future__ import annotations

from ..family import Family
from . import ratios

FAMILIES: tuple[Family, ...] = (*ratios.FAMILIES,)
