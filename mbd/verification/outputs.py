"""What ``verify`` watches: positions, angles, forces, or anything computed from a result, as numbers over time with a unit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..affine import Array
from ..marker import Marker
from ..measured import measured
from ..outputs import body, check, joint
from ..result import Result

if TYPE_CHECKING:
    from ..scene import Scene


@dataclass(frozen=True)
class Output:
    """Values [n_t, k] of a result at its times, whose distances are errors in ``unit``, and ``small``: changes below this share of ``size``
    are nothing to be lost in, however little the output moves."""

    name: str
    unit: str
    values: Callable[[Result], Array]
    size: Callable[[Array], float]
    optional: bool = False  # left out where it is zero all the time


def outputs_of(scene: Scene, wanted: Mapping[str, Any]) -> list[Output]:
    """A marker's position, a measure's value, a body's angle (in space its rotation), the force of a joint and, if it bears any, its moment,
    or what a function makes of a result. Raises SceneError, a line for each thing that is none of these."""
    check(scene, wanted)
    return [output for name, source in wanted.items() for output in _made(scene, name, source)]


def _made(scene: Scene, name: str, source: Any) -> list[Output]:
    d = scene.dimension
    if isinstance(source, Marker):
        return [Output(name, "m", lambda result: result.position(source), lambda values: scene.build().length)]
    if measured(source):
        return [Output(name, getattr(source.description, "unit", ""), lambda result: result.q[:, [source.coordinate]], _largest)]
    if joint(source):
        force = Output(name, "N", lambda result: result.reaction(source)[:, :d], _largest)
        moment = Output(f"{name}: moment", "N m", lambda result: result.reaction(source)[:, d:], _largest, optional=True)
        return [force, moment]
    if body(source):
        return [Output(name, "rad", lambda result: _turn(result, source), lambda values: 1.0)]
    return [Output(name, "", lambda result: _computed(name, source, result), _largest)]


def _turn(result: Result, body: Any) -> Array:
    """The angle [n_t, 1] in the plane; in space [n_t, 9]: the distance of two such rows is the angle between the rotations, where small."""
    if result.system.dimension == 2:
        return result.angle(body)[:, None]
    return result.rotation(body).reshape(-1, 9) / np.sqrt(2.0)


def _largest(values: Array) -> float:
    return float(np.max(np.linalg.norm(values, axis=1), initial=0.0))


def _computed(name: str, function: Callable[[Result], Any], result: Result) -> Array:
    values = np.asarray(function(result), dtype=float)
    if values.shape[:1] != result.t.shape or not np.isfinite(values).all():
        raise ValueError(f"outputs: {name}: expected finite numbers for each of the {result.t.size} times in result.t, found shape {values.shape}")
    return values.reshape(result.t.size, -1)
