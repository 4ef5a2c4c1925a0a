"""Drives: a motor between two bodies, and the prescribed motion of a marker.

Angles are turning angles phi, coordinates of their own (``mbd/turn.py``), so that turns are counted. An angle or speed is the equation
phi = c(t), whose multiplier is the torque; a given torque is a force on phi, which the equation of the turn hands to both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Array, Scalar
from mbd.errors import SimulationError
from mbd.fields import Function, Place, Vector
from mbd.marker import Marker
from mbd.rows import Row, shifted
from mbd.signal import Samples, Signal
from mbd.target import Integral, Position, Target
from mbd.turn import Turning

from .placed import Joint, Placed, Pose, as_marker, points, with_ground
from .turns import across_cables, turn_scalar, turning, turning_faults

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

CHOICES = ("angle", "speed", "torque")
UNITS = {"angle": "[rad]", "speed": "[rad/s]", "torque": "[N m]"}


@dataclass(frozen=True, eq=False)
class Motor(Joint):
    """A motor between two bodies, markers that carry an axis, or the ground. Exactly one of (numbers, or callables of t [s]):

    angle    [rad], the counter-clockwise rotation of a relative to b since assembly, turns counted
    speed    [rad/s], its rate; the angle is the integral from t = 0
    torque   [N m], counter-clockwise on a, opposite on b

    axis     in space: [3], inertial components at the start, of the axis of rotation, which joints between a and b hold (a Pin, say)

    Angle and speed want derivatives: by differences, or the function's own, see ``mbd.Motion``. The torque that they take is the
    moment of ``result.reaction(motor)``; at the start the drive sets the mechanism in motion.
    """

    a: Place
    b: Place
    angle: Function = field(default=None, kw_only=True)
    speed: Function = field(default=None, kw_only=True)
    torque: Function = field(default=None, kw_only=True)
    axis: Vector = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "motor"

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", validate.floats(self.axis))
        for side in ("a", "b"):
            object.__setattr__(self, side, as_marker(getattr(self, side)))

    def faults(self, dimension: int) -> list[str]:
        given = [name for name in CHOICES if getattr(self, name) is not None]
        if len(given) != 1:
            return [f"expected exactly one of angle=, speed= and torque=, found {' and '.join(given) or 'none'}; give one"]
        found = turning_faults(self.a, self.b, self.axis, dimension)
        return found + Signal(getattr(self, given[0]), (), "", UNITS[given[0]]).faults(given[0])

    def place(self, site: Site) -> PlacedDrive:
        return PlacedDrive(self, site)

    def scalars(self, site: Site) -> list[int]:
        return [turn_scalar(self.a, self.b, self.axis, site)]

    def turns(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        return [turning(a, b, pose.axes, self.axis, scalars[0])]

    def misfits(self, pose: Pose) -> list[str]:
        return across_cables(self.markers, pose, self.axis)

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return [("angle", Row(Scalar.coordinate(scalars[0])))] if self.torque is None else []

    def act(self, model: Model, name: str, pose: Pose, scalars: list[int]) -> None:
        if self.torque is not None:
            model.load(Couples, (), turns=np.array(scalars), signals=[Signal(self.torque, (), name, UNITS["torque"])])
            return
        target = Integral(self.speed, name, UNITS["speed"]) if self.angle is None else target_of(self.angle, (), name, UNITS["angle"])
        model.drive(name, self.rows(self.a, self.b, pose, scalars), target)


@dataclass(frozen=True, eq=False)
class Prescribed(Joint):
    """A marker moves as given; numbers, or callables of t [s], with derivatives as for ``Motor``.

    position   [d] [m], of the marker's point; None: it is free
    angle      [rad], counter-clockwise from the x axis, of the body axis or tangent that the marker carries (planar); None: it turns freely
    """

    marker: Marker
    position: Function = None
    angle: Function = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "prescribed motion"

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.marker,)

    @property
    def sides(self) -> tuple[Marker, ...]:
        return with_ground(self.marker)

    def faults(self, dimension: int) -> list[str]:
        if self.position is None and self.angle is None:
            return ["expected position= or angle=, found none; give one or both"]
        found = Signal(self.position, (dimension,), "", "[m]").faults("position") if self.position is not None else []
        if self.angle is None:
            return found
        if dimension != 2:
            return [*found, "angle: expected none in space (rotations cannot be prescribed there yet), found one; leave it out"]
        marker, ground = self.sides
        return found + turning_faults(marker, ground, None, dimension) + Signal(self.angle, (), "", "[rad]").faults("angle")

    def place(self, site: Site) -> PlacedDrive:
        return PlacedDrive(self, site)

    def scalars(self, site: Site) -> list[int]:
        marker, ground = self.sides
        return [] if self.angle is None else [turn_scalar(marker, ground, None, site)]

    def turns(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[Turning]:  # type: ignore[override]
        return [turning(a, b, pose.axes, None, scalar) for scalar in scalars]

    def rows(self, a: Marker, b: Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        turns = [("angle", Row(Scalar.coordinate(scalar))) for scalar in scalars]
        return turns if self.position is None else points(a, b) + turns

    def act(self, model: Model, name: str, pose: Pose, scalars: list[int]) -> None:
        marker, ground = self.sides
        rows, d = self.rows(marker, ground, pose, scalars), model.dimension
        if self.position is not None:
            model.drive(name, rows[:d], target_of(self.position, (d,), name, "[m]"))
        if self.angle is not None:
            target, (label, turn) = target_of(self.angle, (), name, "[rad]"), rows[-1]
            start = float(np.angle(complex(*pose.axes[0][:, 0])))
            turns = round((_at_zero(target) - start) / (2.0 * np.pi))
            model.drive(name, [(label, shifted(turn, start + 2.0 * np.pi * turns))], target)


class PlacedDrive(Placed):
    """A drive in a scene; ``result.reaction(drive)`` is the force and moment that it exerts on its first marker."""

    def equations(self, model: Model, pose: Pose) -> None:
        self.description.act(model, self.name, pose, self.scalars)


class Couples:
    """The kernel of all given torques of motors: forces on their turning angles."""

    def __init__(self, *, turns: NDArray[np.intp], signals: Sequence[Signal]):
        self.dofs, self.signals, self._samples = turns[:, None], signals, Samples(signals)
        self.constant_in_q = self.linear_in_q = True

    def inputs(self, times: Array) -> Array:
        return self._samples(times)

    def force(self, q: Array, inputs: Array) -> Array:
        return inputs[..., None]


def target_of(value: Any, shape: tuple[int, ...], item: str, unit: str) -> Target | Array:
    return Position(value, shape, item, unit) if callable(value) else np.array(value, dtype=float)


def _at_zero(target: Target | Array) -> float:
    """At t = 0, where scenes are assembled; zero where a function fails there: the run that calls it says so."""
    try:
        return float(target) if isinstance(target, np.ndarray) else float(target.value(np.zeros(1))[0, 0])
    except SimulationError:
        return 0.0
