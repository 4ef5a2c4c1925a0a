"""mbd: multibody dynamics with large deformations.

Flexible beams in the absolute nodal coordinate formulation, rigid bodies and joints, solved as Lagrange-multiplier DAEs by
index-reduced implicit integration. Start with ``Scene``, ``add``, ``simulate``; nothing is imported before it is used.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if __name__ != "mbd":
    raise ImportError(f"import mbd, not {__name__}: loaded twice, every class would exist twice")

_here = Path(__file__).parent
if not (_here / "elements").is_dir():
    # In the source tree the sub-packages lie beside this folder: let a local ./mbd find them, as an installed one does inside itself.
    __path__.append(str(_here.parent))

if TYPE_CHECKING:
    from .archive import load
    from .assembly import assemble
    from .elements import (
        AncfCable,
        CorotationalBeam,
        FloatingFrameBeam,
        Force,
        GeometricallyExactBeam,
        Particle,
        RigidBody,
        Spring,
        Torque,
        TorsionSpring,
    )
    from .errors import SceneError, SceneWarning, SimulationError
    from .event import Event
    from .joints import Ball, Clamp, Distance, Motor, Pin, PointOnLine, Prescribed, Slider
    from .marker import Marker
    from .precision import WorkPrecision, work_precision
    from .result import Result
    from .run import simulate
    from .scene import Scene
    from .signal import piecewise
    from .solvers import Automatic, DormandPrince, Gauss, GeneralizedAlpha, Radau
    from .state import State
    from .target import Motion

_HOMES = {
    "elements": (
        "AncfCable",
        "CorotationalBeam",
        "FloatingFrameBeam",
        "Force",
        "GeometricallyExactBeam",
        "Particle",
        "RigidBody",
        "Spring",
        "TorsionSpring",
        "Torque",
    ),
    "joints": ("Ball", "Clamp", "Distance", "Motor", "Pin", "PointOnLine", "Prescribed", "Slider"),
    "solvers": ("Automatic", "DormandPrince", "Gauss", "GeneralizedAlpha", "Radau"),
    "errors": ("SceneError", "SceneWarning", "SimulationError"),
    "event": ("Event",),
    "signal": ("piecewise",),
    "marker": ("Marker",),
    "archive": ("load",),
    "result": ("Result",),
    "scene": ("Scene",),
    "assembly": ("assemble",),
    "run": ("simulate",),
    "state": ("State",),
    "precision": ("WorkPrecision", "work_precision"),
    "target": ("Motion",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = [
    "AncfCable",
    "Automatic",
    "Ball",
    "Clamp",
    "CorotationalBeam",
    "Distance",
    "DormandPrince",
    "Event",
    "FloatingFrameBeam",
    "Force",
    "Gauss",
    "GeneralizedAlpha",
    "GeometricallyExactBeam",
    "Marker",
    "Motion",
    "Motor",
    "Particle",
    "Pin",
    "PointOnLine",
    "Prescribed",
    "Radau",
    "Result",
    "RigidBody",
    "Scene",
    "SceneError",
    "SceneWarning",
    "SimulationError",
    "Slider",
    "Spring",
    "State",
    "Torque",
    "TorsionSpring",
    "WorkPrecision",
    "__version__",
    "assemble",
    "load",
    "piecewise",
    "simulate",
    "work_precision",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'mbd' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"mbd.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
