"""What a user may ask of a run by name: the position of a marker, the reaction of a joint, the value of a measure, the turn of a body.

One vocabulary for tables, reports and estimates of errors: ``{"tip": rod.end, "hinge": pivot, "crank": crank, "power": function of the result}``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .errors import SceneError
from .marker import Marker
from .measured import measured

if TYPE_CHECKING:
    from .result import Result
    from .scene import Scene

Output = Any
"""A marker, joint, measure or body of the scene, or a function of the result that returns values [n_t] or [n_t, n]."""


class Series(NamedTuple):
    """A named quantity over time: what it is of, its unit (SI), names of its components, and values [n_t, n_components]."""

    name: str
    what: str
    unit: str
    components: tuple[str, ...]
    values: Array


def series(result: Result, outputs: Mapping[str, Output]) -> Iterable[Series]:
    """The series of every output at ``result.t``; of a joint two, force and moment. Raises SceneError where ``check`` complains."""
    check(result.scene, outputs)
    for name, item in outputs.items():
        yield from _series(result, name, item)


def check(scene: Scene, outputs: Any) -> None:
    """Raises SceneError, all at once, for what is not a name with a marker, joint, measure or body of the scene, or a function."""
    if not isinstance(outputs, Mapping) or not outputs:
        raise SceneError([f"outputs: expected names, such as {{'tip': rod.end}}, found {outputs!r}"])
    found = []
    for name, item in outputs.items():
        if not (isinstance(name, str) and name):
            found.append(f"outputs: expected a text for a name, found {name!r}")
        if not (isinstance(item, Marker) or joint(item) or measured(item) or body(item) or callable(item)):
            found.append(f"outputs: {name!r}: expected a marker, joint, measure or body, or a function of the result, found {item!r}")
        elif not callable(item) and owner(item) is not scene:
            found.append(f"outputs: {name!r}: expected something of this scene, found {item!r} of another")
    if found:
        raise SceneError(found)


def owner(item: Any) -> Any:
    return item.scene if isinstance(item, Marker) else item.site.scene


def joint(item: Any) -> bool:
    """Whether it exerts reactions."""
    return hasattr(getattr(item, "description", None), "rows") and hasattr(item, "pose")


def body(item: Any) -> bool:
    return not isinstance(item, Marker) and hasattr(item, "axes")


def _series(result: Result, name: str, item: Output) -> list[Series]:
    axes = ("x", "y", "z")[: result.system.dimension]
    if isinstance(item, Marker):
        return [Series(name, "position", "m", axes, result.position(item))]
    if measured(item):
        return [Series(name, item.description.kind, getattr(item.description, "unit", ""), ("",), result.q[:, [item.coordinate]])]
    if joint(item):
        return _reaction(name, axes, result.reaction(item))
    if body(item) and result.system.dimension == 2:
        return [Series(name, "angle", "rad", ("",), result.angle(item)[:, None])]
    if body(item):
        return [Series(name, "angular velocity", "rad/s", axes, result.angular_velocity(item))]
    return [_of_function(result, name, item)]


def _reaction(name: str, axes: tuple[str, ...], values: Array) -> list[Series]:
    d = len(axes)
    turning = ("z",) if d == 2 else axes
    return [Series(name, "force", "N", axes, values[:, :d]), Series(name, "moment", "N m", turning, values[:, d:])]


def _of_function(result: Result, name: str, function: Callable[[Result], ArrayLike]) -> Series:
    values = np.asarray(function(result), dtype=float)
    if values.ndim not in (1, 2) or len(values) != len(result.t):
        raise SceneError([f"outputs: {name!r}: expected a function that returns {len(result.t)} values, one for each time, found {values.shape}"])
    table = values.reshape(len(values), -1)
    return Series(name, "", "", tuple(map(str, range(table.shape[1]))) if values.ndim == 2 else ("",), table)
