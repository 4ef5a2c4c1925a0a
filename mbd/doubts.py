"""What items know of the limits of their own formulation."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from .affine import Array
from .errors import SceneWarning

if TYPE_CHECKING:
    from .scene import Scene


def doubts(scene: Scene, q: Array) -> list[str]:
    """A line for each reason not to believe coordinates q [n_t, n] of a scene."""
    return [doubt for item in scene.items if hasattr(item, "doubts") for doubt in item.doubts(q)]


def warn_of_doubts(scene: Scene, q: Array, stacklevel: int) -> None:
    for doubt in doubts(scene, q):
        warnings.warn(doubt, SceneWarning, stacklevel=stacklevel + 1)
