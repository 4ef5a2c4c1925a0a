"""Descriptions as JSON data and back: what a scene was made of, for files.

A description becomes {"class", "fields"}; numbers and texts stay, arrays become lists, an item of the scene its name, a marker its item
and what ``at(...)`` was given, a function of ``mbd.functions`` its kind and fields. Floats survive exactly. Any other function of t becomes
its value at t = 0, where scenes are assembled; asked for any other time, the function read back raises.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from . import elements, joints
from . import functions as library
from .marker import Marker
from .scene import Misfit, Scene

Data = dict[str, Any]

KINDS: dict[str, Any] = {
    name: kind
    for module in (elements, joints)
    for name in module.__all__
    if is_dataclass(kind := getattr(module, name))
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
    """Names of the items that were given functions which are no data."""
    return [item["fields"]["name"] for item in items if any(map(_is_function, item["fields"].values()))]


def missing(scene: Scene) -> list[str]:
    """Names of the items whose functions of t were not stored."""
    return [item.name for item in scene.items if any(isinstance(value, Missing) for value in vars(item.description).values())]


def _described(description: Any, name: str) -> Data:
    kind = type(description).__name__
    if KINDS.get(kind) is not type(description):
        raise ValueError(f"{kind} {name!r}: expected one of {', '.join(KINDS)}, found a kind of its own, which cannot be stored")
    for field in getattr(description, "essential", ()):
        if callable(function := getattr(description, field)) and not is_data(function):
            raise ValueError(f"{kind} {name!r}: {field}: expected an mbd.Expression, found {function!r}, which cannot be stored")
    data = {field.name: _encoded(getattr(description, field.name), f"{kind} {name!r}: {field.name}") for field in fields(description)}
    return {"class": kind, "fields": data | {"name": name}}


def _encoded(value: Any, where: str) -> Any:
    if isinstance(value, Marker):
        return {"marker": value.item, "at": arguments(value, where)}
    if is_data(value):
        data = {field.name: _encoded(getattr(value, field.name), where) for field in fields(value)}
        return {"function": type(value).__name__, "fields": data}
    if callable(value):
        return {"at zero": _value_at_zero(value)}
    if hasattr(value, "description"):
        return {"item": value.name}
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_encoded(part, where) for part in value]
    if isinstance(value, dict):
        return {name: _encoded(part, where) for name, part in value.items()}
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"{where}: expected numbers, texts, markers or functions of t, found {value!r}, which cannot be stored")


def arguments(marker: Marker, where: str) -> list[float]:
    if marker.arguments is None:
        raise ValueError(f"{where}: expected a marker such as rod.end or body.at(x, y), found one that was made otherwise, which cannot be stored")
    return [float(number) for number in marker.arguments]


def is_data(function: Any) -> bool:
    """Whether a function is one of ``mbd.functions``, down to the functions that it is made of."""
    if library.KINDS.get(type(function).__name__) is not type(function):
        return False
    return all(is_data(part) for field in fields(function) if callable(part := getattr(function, field.name)))


def _value_at_zero(function: Any) -> Any:
    try:
        value = np.asarray(function(0.0), dtype=float)
    except Exception:  # a run may start later, where the function is at home
        return None
    return value.tolist() if np.isfinite(value).all() else None


def _is_function(value: Any) -> bool:
    """Whether it stands for a function that could not be stored."""
    return isinstance(value, dict) and "at zero" in value


def rebuilt(gravity: Any, items: list[Data], n: int, most: int) -> Scene:
    """The scene of n coordinates made of described items, no count among them above ``most``. Raises ValueError for any other."""
    scene = Scene(gravity)
    for item in items:
        if item["class"] not in KINDS:
            raise ValueError(f"items: expected kinds among {', '.join(KINDS)}, found {item['class']!r}")
        data = {name: decoded(value, scene) for name, value in item["fields"].items()}
        if any((data.get(name) or 0) > most for name in COUNTS):
            raise ValueError(f"{data['name']}: expected counts that fit {n} coordinates, found larger ones")
        if isinstance(scene.add(KINDS[item["class"]](**data)), Misfit):
            scene.build()  # raises with the complaint
        if scene.layout.n > n:
            raise ValueError(f"items: expected a scene of {n} coordinates, found more at {data['name']!r}")
    return scene


def decoded(value: Any, scene: Scene) -> Any:
    """What a field of a described item was."""
    if isinstance(value, list):
        return [decoded(part, scene) for part in value]
    if not isinstance(value, dict):
        return value
    if "item" in value:
        return scene[value["item"]]
    if _is_function(value):
        return Missing(value["at zero"])
    if "function" in value:
        parts = {name: part if name == "constants" else decoded(part, scene) for name, part in value["fields"].items()}
        return library.KINDS[value["function"]](**parts)
    if not all(isinstance(number, (int, float)) for number in value["at"]):
        raise ValueError(f"marker of {value['marker']!r}: at: expected numbers, found {value['at']!r}")
    return scene[value["marker"]].at(*value["at"])
