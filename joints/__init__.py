"""Joints, drives and measures between markers, as tables of quadratic rows. Import it as ``mbd.joints``."""

if __name__ != "mbd.joints":
    raise ImportError(f"import mbd.joints, not {__name__}: loaded twice, every class would exist twice")

from .actuator import Actuator
from .beam_slider import BeamSlider
from .couplings import Coupling
from .drives import Motor, Prescribed
from .gears import Gear, Rack
from .knife_edge import KnifeEdge, Wheel
from .lines import PointOnLine, Slider
from .measures import Angle, Displacement, Length
from .pairs import Ball, Clamp, Distance, Pin
from .rolling import Rolling
from .spatial import Cylindrical, Planar, Universal
from .user_measure import UserMeasure

__all__ = [
    "Actuator",
    "Angle",
    "Ball",
    "BeamSlider",
    "Clamp",
    "Coupling",
    "Cylindrical",
    "Displacement",
    "Distance",
    "Gear",
    "KnifeEdge",
    "Length",
    "Motor",
    "Pin",
    "Planar",
    "PointOnLine",
    "Prescribed",
    "Rack",
    "Rolling",
    "Slider",
    "Universal",
    "UserMeasure",
    "Wheel",
]
