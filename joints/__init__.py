"""Joints and drives between markers, as tables of quadratic rows. Import it as ``mbd.joints``."""

if __name__ != "mbd.joints":
    raise ImportError(f"import mbd.joints, not {__name__}: loaded twice, every class would exist twice")

from .drives import Motor, Prescribed
from .lines import PointOnLine, Slider
from .pairs import Ball, Clamp, Distance, Pin

__all__ = ["Ball", "Clamp", "Distance", "Motor", "Pin", "PointOnLine", "Prescribed", "Slider"]
