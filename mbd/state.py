"""A state to start from: your own, or ``result.final``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .affine import Array
from .errors import SceneError
from .system import System


@dataclass(frozen=True, eq=False)
class State:
    """Coordinates q [n] and velocities v [n], in order of ``scene.coordinates()``, at time t [s]."""

    q: Array
    v: Array
    t: float = 0.0

    def __post_init__(self) -> None:
        for name in ("q", "v"):
            object.__setattr__(self, name, np.array(getattr(self, name), dtype=float))

    def check(self, system: System) -> None:
        """Raises SceneError unless it fits the system."""
        found = []
        for name in ("q", "v"):
            value = getattr(self, name)
            if value.shape != (system.n,):
                found.append(f"start: {name}: expected {system.n} numbers in order of scene.coordinates(), found shape {value.shape}; correct it")
            elif not np.isfinite(value).all():
                where = ", ".join(system.coordinate(int(k)) for k in np.flatnonzero(~np.isfinite(value))[:3])
                found.append(f"start: {name}: expected finite numbers, found NaN or infinity at {where}; correct it")
        if found:
            raise SceneError(found)
