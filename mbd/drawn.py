"""How joints, springs and loads are drawn: a function for each description, which adds shapes to a drawing."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Affine
from .elements.force import Force
from .elements.spring import Spring, TorsionSpring
from .elements.torque import Torque
from .joints.beam_slider import BeamSlider
from .joints.drives import Motor, Prescribed
from .joints.gears import Gear, Rack
from .joints.knife_edge import KnifeEdge, Wheel
from .joints.lines import PointOnLine, Slider, fixed_axis
from .joints.pairs import Ball, Clamp, Distance, Pin
from .joints.placed import fixed_in
from .joints.rolling import Rolling
from .joints.spatial import Cylindrical, Planar, Universal
from .marker import frame

if TYPE_CHECKING:
    from .drawing import Drawing
    from .scene import Scene

Drawer = Callable[["Drawing", str, Any], None]


def _joint(form: str) -> Drawer:
    def draw(drawing: Drawing, name: str, joint: Any) -> None:
        drawing.ground(name, joint.markers)
        drawing.symbol(name, form, joint.markers[0], _turning_axis(drawing.scene, joint))

    return draw


def _turning_axis(scene: Scene, joint: Any) -> Affine | None:
    """Of a joint in space that turns about a direction given at the start: as it moves with one of its bodies."""
    carriers = [marker for marker in joint.markers if marker.rigid and len(marker.axes) == 3]
    if getattr(joint, "axis", None) is None or not carriers:
        return None
    return fixed_in(carriers[0], frame(carriers[0], scene.build().q0), joint.axis / np.linalg.norm(joint.axis))


def _line(form: str) -> Drawer:
    def draw(drawing: Drawing, name: str, joint: Any) -> None:
        a, b = joint.markers
        drawing.symbol(name, form, a, drawing.guide(name, a, b, joint.axis))

    return draw


def _pair(form: str) -> Drawer:
    def draw(drawing: Drawing, name: str, item: Any) -> None:
        drawing.ground(name, item.markers)
        drawing.add(name, form, [marker.point for marker in item.markers])

    return draw


def _mark(form: str) -> Drawer:
    return lambda drawing, name, item: drawing.symbol(name, form, item.markers[0])


def _motor(drawing: Drawing, name: str, motor: Any) -> None:
    """At the joint between the two that it turns, if there is one."""
    sides = {marker.item for marker in motor.markers}
    for item in drawing.scene.items:
        joint = item.description
        if isinstance(joint, Pin | Cylindrical) and {marker.item for marker in joint.markers} == sides:
            return drawing.symbol(name, "motor", joint.markers[0])
    drawing.symbol(name, "motor", motor.markers[0])


def _edge(drawing: Drawing, name: str, edge: Any) -> None:
    drawing.symbol(name, "edge", edge.a, fixed_axis(edge.a, edge.axis / np.linalg.norm(edge.axis)))


def _force(drawing: Drawing, name: str, force: Any) -> None:
    drawing.add(name, "force", [force.marker.point])


def _gear(drawing: Drawing, name: str, gear: Any) -> None:
    if gear.radii is not None and drawing.scene.dimension == 2:
        for marker, radius in zip((gear.a, gear.b), gear.radii):
            drawing.wheel(name, marker, float(radius))


def _rack(drawing: Drawing, name: str, rack: Any) -> None:
    if drawing.scene.dimension == 2:
        drawing.wheel(name, rack.pinion, float(rack.radius))


def _rolling(drawing: Drawing, name: str, joint: Any) -> None:
    drawing.guide(name, joint.a, joint.b, joint.axis)
    drawing.wheel(name, joint.a, float(joint.radius))


DRAWN: dict[type, Drawer] = {
    Pin: _joint("pin"),
    Ball: _joint("ball"),
    Clamp: _joint("clamp"),
    Universal: _joint("universal"),
    Planar: _joint("planar"),
    BeamSlider: _joint("sleeve"),
    Slider: _line("slider"),
    Cylindrical: _line("slider"),
    PointOnLine: _line("follower"),
    Distance: _pair("link"),
    Spring: _pair("spring"),
    TorsionSpring: _mark("torsion spring"),
    Motor: _motor,
    Prescribed: _mark("prescribed"),
    Torque: _mark("torque"),
    Force: _force,
    KnifeEdge: _edge,
    Wheel: _edge,
    Gear: _gear,
    Rack: _rack,
    Rolling: _rolling,
}
"""How the items of each description are drawn; what is not listed has no place of its own: measures, couplings, laws."""
