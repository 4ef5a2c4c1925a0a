"""Quantities of descriptions in words: numbers, arrays, markers, units."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..marker import Marker

UNITS = {
    "E": "Pa", "A": "m²", "I": "m⁴", "rho": "kg/m³", "GA": "N", "rotary_inertia": "kg m", "damping": "s", "mass": "kg", "inertia": "kg m²",
    "position": "m", "angle": "rad", "velocity": "m/s", "angular_velocity": "rad/s", "length": "m", "start": "m", "end": "m", "radius": "m",
    "radii": "m", "speed": "rad/s", "torque": "N m", "vector": "N",
}  # fmt: skip
"""By field; SI by convention."""
SPECIAL = {
    "Spring": {"stiffness": "N/m", "damping": "N s/m"},
    "TorsionSpring": {"stiffness": "N m/rad", "damping": "N m s/rad"},
    "Torque": {"value": "N m"},
    "Friction": {"speed": ""},
    "Stop": {"damping": ""},
    "PD": {"derivative": ""},
}
"""Where a field of this kind has another unit, or one that depends on what it acts on."""
LONGEST = 12
"""Numbers of an array, or parts of a list, that are shown."""


def unit_of(kind: str, name: str) -> str:
    """Of a field of a kind."""
    return SPECIAL.get(kind, {}).get(name, UNITS.get(name, ""))


def number(value: float) -> str:
    """To twelve digits, as short as they can be said."""
    return f"{value:.12g}"


def shown(value: Any) -> str:
    """A field of a description, in words."""
    if isinstance(value, Marker):
        return place(value)
    if callable(value):
        return f"a function of t ({getattr(value, '__name__', type(value).__name__)})"
    if hasattr(value, "description"):
        return str(value.name)
    if isinstance(value, np.ndarray | np.generic):
        return array(np.asarray(value))
    if isinstance(value, list | tuple):
        return "(" + ", ".join(shown(part) for part in value[:LONGEST]) + (", …" if len(value) > LONGEST else "") + ")"
    return number(value) if isinstance(value, float) else str(value)


def array(value: np.ndarray) -> str:
    if value.ndim == 0:
        return number(float(value))
    if value.size > LONGEST:
        return f"{' by '.join(map(str, value.shape))} numbers from {value.min():.6g} to {value.max():.6g}"
    return "(" + ", ".join(array(part) for part in value) + ")"


def place(marker: Marker) -> str:
    """A marker's item, and where it is at the start."""
    scene: Any = marker.scene
    return f"{marker.item} at {array(marker.point.value(scene.layout.start()[0]).round(12))}"
