"""The steady rotation of all rows of the table about an axis through the origin."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import validate
from .affine import Array
from .errors import SceneError

if TYPE_CHECKING:
    from .system import System


def spin_of(spin: Any, dimension: int) -> Array:
    """[] or [3] [rad/s] as given; raises SceneError."""
    value, shape = validate.floats(spin), () if dimension == 2 else (3,)
    if isinstance(spin, bool) or not isinstance(value, np.ndarray) or value.shape != shape or not np.isfinite(value).all():
        expected = "a finite number" if dimension == 2 else "three finite numbers"
        raise SceneError([f"spin: expected {expected} [rad/s], found {spin!r}; correct it"])
    return value


def generator_of(system: System, spin: Array) -> Array:
    """S [n, n]: x -> spin x x on every row of the table, nothing on scalar coordinates."""
    if system.dimension == 2:
        block = float(spin) * np.array([[0.0, -1.0], [1.0, 0.0]])
    else:
        x, y, z = spin
        block = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    out = np.zeros((system.n, system.n))
    out[: system.n_table, : system.n_table] = np.kron(np.eye(system.n_table // system.dimension), block)
    return out


def turn_by(generator: Array, speed: float, angle: float) -> Array:
    """R [n, n], by Rodrigues' formula: S^3 = -speed^2 S."""
    unit = generator / speed
    return np.eye(len(unit)) + np.sin(angle) * unit + (1.0 - np.cos(angle)) * unit @ unit
