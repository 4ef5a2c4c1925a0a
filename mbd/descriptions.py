"""Descriptions as JSON data and back: what a scene was made of, for files.

A description becomes {"class", "fields"}; numbers and texts stay, arrays become lists, an item of the scene its name, a marker its item
and its affine maps (rows, weights, constant), so that a scene built of the same descriptions in the same order gets the same markers.
Floats survive exactly. Functions of t become their value at t = 0, where scenes are assembled; asked for any other time, the function read
back raises.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from . import elements, joints
from .affine import Affine
from .marker import Marker
from .scene import Misfit, Scene

Data = dict[str, Any]

KINDS: dict[str, Any] = {
    name: kind
    for module in (elements, joints)
    for name in module.__all__
    if is_dataclass(kind := getattr(module, name)) and getattr(kind, "storable", True)
}
COUNTS = ("n_elements", "gauss_points")
"""Fields that size arrays: checked before anything is built from them."""


class Missing:
    """Stands for a function of t that is known only at t = 0, if there."""

    def __init__(self, at_zero: Any):
        self.at_zero = at_zero

    def __call__(self, t: float) -> Any:
        if t == 0.0 and self.at_zero is not None:
            return self.at_zero
        raise LookupError("a result from a file has no functions of t, only their values at t = 0")


def described(scene: Scene) -> list[Data]:
    """The items of a scene, in order of ``add``. Raises ValueError for kinds and values that have no data form."""
    return [_described(item.description, item.name) for item in scene.items]


def functions(items: list[Data]) -> list[str]:
    """Names of the items that were given functions of t."""
    return [item["fields"]["name"] for item in items if any(map(_is_function, item["fields"].values()))]


def missing(scene: Scene) -> list[str]:
    """Names of the items whose functions of t were not stored."""
    return [item.name for item in scene.items if any(isinstance(value, Missing) for value in vars(item.description).values())]


def _described(description: Any, name: str) -> Data:
    kind = type(description).__name__
    if KINDS.get(kind) is not type(description):
        raise ValueError(f"{kind} {name!r}: expected one of {', '.join(KINDS)}, found a kind of its own, which cannot be stored")
    data = {field.name: _encoded(getattr(description, field.name), f"{kind} {name!r}: {field.name}") for field in fields(description)}
    return {"class": kind, "fields": data | {"name": name}}


def _encoded(value: Any, where: str) -> Any:
    if isinstance(value, Marker):
        axes = [_encoded_map(axis) for axis in value.axes]
        return {"marker": value.item, "point": _encoded_map(value.point), "axes": axes, "rigid": value.rigid}
    if callable(value):
        return {"function": _value_at_zero(value)}
    if hasattr(value, "description"):
        return {"item": value.name}
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_encoded(part, where) for part in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"{where}: expected numbers, texts, markers or functions of t, found {value!r}, which cannot be stored")


def _encoded_map(x: Affine) -> Data:
    weights = np.stack((x.weights.real, x.weights.imag), axis=-1) if x.dimension == 2 else x.weights
    return {"rows": x.rows.tolist(), "weights": weights.tolist(), "constant": x.constant.tolist()}


def _value_at_zero(function: Any) -> Any:
    try:
        value = np.asarray(function(0.0), dtype=float)
    except Exception:  # a run may start later, where the function is at home
        return None
    return value.tolist() if np.isfinite(value).all() else None


def _is_function(value: Any) -> bool:
    return isinstance(value, dict) and "function" in value


def rebuilt(gravity: Any, items: list[Data], n: int, most: int) -> Scene:
    """The scene of n coordinates made of described items, no count among them above ``most``. Raises ValueError for any other."""
    scene = Scene(gravity)
    for item in items:
        if item["class"] not in KINDS:
            raise ValueError(f"items: expected kinds among {', '.join(KINDS)}, found {item['class']!r}")
        data = {name: _decoded(value, scene) for name, value in item["fields"].items()}
        if any((data.get(name) or 0) > most for name in COUNTS):
            raise ValueError(f"{data['name']}: expected counts that fit {n} coordinates, found larger ones")
        if isinstance(scene.add(KINDS[item["class"]](**data)), Misfit):
            scene.build()  # raises with the complaint
        if scene.layout.n > n:
            raise ValueError(f"items: expected a scene of {n} coordinates, found more at {data['name']!r}")
    return scene


def _decoded(value: Any, scene: Scene) -> Any:
    if isinstance(value, list):
        return [_decoded(part, scene) for part in value]
    if not isinstance(value, dict):
        return value
    if "item" in value:
        return scene[value["item"]]
    if _is_function(value):
        return Missing(value["function"])
    axes = tuple(_decoded_map(axis, scene) for axis in value["axes"])
    return Marker(value["marker"], scene, _decoded_map(value["point"], scene), axes, value["rigid"])


def _decoded_map(data: Data, scene: Scene) -> Affine:
    rows, weights = np.array(data["rows"], dtype=np.intp), np.array(data["weights"], dtype=float)
    if rows.size and not 0 <= rows.min() <= rows.max() < scene.layout.n_rows:
        raise ValueError(f"markers: expected rows of items added before, found {rows.tolist()}")
    if scene.dimension == 2:
        pairs = weights.reshape(-1, 2)
        weights = pairs[:, 0] + 1j * pairs[:, 1]
    return Affine(rows, weights, np.array(data["constant"], dtype=float))
