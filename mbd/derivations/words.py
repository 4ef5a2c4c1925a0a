"""What the fields of descriptions are given in specimens: markers of small items, numbers, measures, users' functions, by the fields' names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import mbd
from mbd.scene import Scene

STEEL: dict[str, Any] = {"E": 10.0, "A": 0.2, "I": 0.03, "rho": 2.0}
POINTS = 3  # Gauss points: the fewest allowed keep the sums short


def _body(scene: Scene, place: Any, name: str) -> Any:
    inertia = 0.3 if scene.dimension == 2 else (0.3, 0.4, 0.5)
    position = np.array(place[: scene.dimension]) - np.array([0.5, 0.25, 0.0])[: scene.dimension]
    return scene.add(mbd.RigidBody(mass=1.5, inertia=inertia, position=position, name=name)).at(*(0.5, 0.25, 0.0)[: scene.dimension])


def _cable(scene: Scene, place: Any, name: str) -> Any:
    start = np.array(place[: scene.dimension])
    axis = np.array([1.0, 0.0, 0.0])[: scene.dimension]
    return scene.add(mbd.AncfCable(start, start + axis, n_elements=1, gauss_points=POINTS, name=name, **STEEL)).start


def _particle(scene: Scene, place: Any, name: str) -> Any:
    return scene.add(mbd.Particle(0.7, place[: scene.dimension], name=name)).at()


def _ground(scene: Scene, place: Any, name: str) -> Any:
    return scene.ground.at(*place[: scene.dimension])


ENDS = {"body": _body, "cable": _cable, "particle": _particle, "ground": _ground}
PAIRS = (
    *(("body", "body"), ("cable", "body"), ("body", "cable"), ("cable", "cable")),
    *(("particle", "cable"), ("body", "ground"), ("particle", "particle")),
)
PLACES = ((0.0, 0.0, 0.0), (0.0, 0.5, 1.5))
"""Of the markers; apart across the cables, which lie along x."""


def _wave(t: float) -> float:
    return float(np.sin(3.0 * t) + 2.0 * t)


def _waves(d: int) -> Callable[[float], tuple[float, ...]]:
    return lambda t: tuple(_wave(t + k) for k in range(d))


def _about(d: int) -> dict[str, Any]:
    """The axis of a turn in space."""
    return AXIS if d == 3 else {}


FIRST, SECOND = ("a", "marker", "point", "pinion"), ("b", "marker_on_line", "rack")


def _measures(scene: Scene) -> list[Any]:
    """Two measures between bodies."""
    here, there = _body(scene, (0.0, 0.0, 0.0), "C"), _body(scene, (0.3, 0.8, 1.2), "D")
    line = (3.0, -4.0, 0.0)[: scene.dimension]
    return [scene.add(mbd.Length(here, there, name="length")), scene.add(mbd.Displacement(here, there, axis=line, name="slid"))]


def _sleeve(scene: Scene) -> Any:
    """A cable of two elements whose middle is near the first end."""
    start, end = np.array([-0.9, 0.2, 0.1]), np.array([0.6, 0.2, 0.1])
    d = scene.dimension
    return scene.add(mbd.AncfCable(start[:d], end[:d], n_elements=2, gauss_points=POINTS, name="rope", **STEEL))


WORDS: dict[str, Callable[[Scene], Any]] = {
    "axis": lambda scene: (3.0, -4.0) if scene.dimension == 2 else (0.0, 3.0, -4.0),
    "axes": lambda scene: [(1.0, 0.0, 0.0), (0.0, 2.0, 1.0)],
    "normal": lambda scene: (0.0, 3.0, -4.0),
    "radius": lambda scene: 0.2,
    "stiffness": lambda scene: 3.0,
    "force": lambda scene: 1.5,
    "speed": lambda scene: 2.0,
    "damping": lambda scene: 0.5,
    "proportional": lambda scene: 3.0,
    "width": lambda scene: 0.4,
    "vector": lambda scene: (1.5, -2.0, 0.5)[: scene.dimension],
    "value": lambda scene: 1.5 if scene.dimension == 2 else (1.5, -2.0, 0.5),
    "measure": lambda scene: _measures(scene)[0],
    "measures": _measures,
    "terms": lambda scene: list(zip((2.0, -0.5), _measures(scene))),
    "function": lambda scene: None,
    "beam": _sleeve,
}
"""Required fields by name; those that a kind's variants give are taken from there."""

AXIS: dict[str, Any] = {"axis": (0.0, 3.0, -4.0)}
VARIANTS: dict[str, list[Any]] = {
    "Pin": [{}, AXIS],
    "Distance": [{}, {"length": 0.7}],
    "Spring": [{"damping": 0.5}, {"damping": 0.5, "length": 0.4}, {"damping": 0.5, "length": 0.0}],
    "TorsionSpring": [{"damping": 0.5, "angle": 0.2}],
    "Force": [{}, {"follower": True}, lambda d: {"vector": _waves(d)}, {"vector": (1.5, 0.0, 0.0), "follower": True}],
    "Torque": [{}, {"follower": True}, lambda d: {"value": _wave if d == 2 else _waves(3)}, {"value": (0.0, 1.5, -0.5)}],
    "Motor": [lambda d: {"angle": _wave} | _about(d), lambda d: {"speed": _wave} | _about(d), {"torque": _wave}],
    "Angle": [lambda d: _about(d)],
    "Gear": [lambda d: {"ratio": -2.5} | _about(d), lambda d: {"teeth": (20, 31)} | _about(d)],
    "Rack": [lambda d: {"shaft": AXIS["axis"]} if d == 3 else {}],
    "Actuator": [{"value": _wave}, {"rate": _wave}, {"force": _wave}],
    "PD": [{"target": _wave, "derivative": 0.5}],
    "Stop": [{"lower": 0.4, "upper": 0.6, "damping": 0.5}, {"upper": 0.1}, {"lower": 3.0, "damping": 0.5}],
    "Coupling": [{}, {"value": _wave}],
    "ForceLaw": [
        {"function": lambda t, x, y: (t * x + y**3, 2 * x * y), "gradient": lambda t, x, y: ((t, 3 * y**2), (2 * y, 2 * x))},
        {
            "rates": True,
            "function": lambda t, x, y, u, w: (t * x - u**3, y * w + u * x),
            "gradient": lambda t, x, y, u, w: ((t, 0, -3 * u**2, 0), (u, w, x, y)),
        },
    ],
    "UserMeasure": [
        {
            "function": lambda x, y: x**2 + x * y**3,
            "gradient": lambda x, y: (2 * x + y**3, 3 * x * y**2),
            "hessian": lambda x, y: ((2, 3 * y**2), (3 * y**2, 6 * x * y)),
        },
    ],
    "Prescribed": [lambda d: {"position": _waves(d)}, {"angle": _wave}, {"position": (1.0, 2.0), "angle": 0.2}],
}
"""Further fields that make a kind another one, or functions of the dimension to such fields."""
