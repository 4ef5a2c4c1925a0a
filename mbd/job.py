"""A scene with how to run it, as a scene file or a Python file says."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .marker import Marker
from .scene import Scene


@dataclass(frozen=True)
class Job:
    """A scene, the values of its file's parameters, and how the file says that it be run; None where it says nothing."""

    scene: Scene
    parameters: dict[str, float] = field(default_factory=dict)
    t_end: float | None = None
    rtol: float | None = None
    solver: Any = None
    outputs: dict[str, Marker] = field(default_factory=dict)
