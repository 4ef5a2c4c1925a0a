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
    from .balance import Equilibrium
    from .branches import continuation
    from .derivations.scene_equations import equations
    from .diagnosis import Structure
    from .driven import kinematics
    from .elements import (
        PD,
        AncfCable,
        CorotationalBeam,
        FloatingFrameBeam,
        Force,
        ForceLaw,
        Friction,
        GeometricallyExactBeam,
        Particle,
        RigidBody,
        Spring,
        Stop,
        Torque,
        TorsionSpring,
    )
    from .errors import Interrupted, SceneError, SceneWarning, SimulationError
    from .event import Event
    from .files.reading import read_scene
    from .files.writing import write_scene
    from .functions import Expression, Ramp, Sine, SmoothStep, Spline, Table
    from .joints import (
        Actuator,
        Angle,
        Ball,
        BeamSlider,
        Clamp,
        Coupling,
        Cylindrical,
        Displacement,
        Distance,
        Gear,
        KnifeEdge,
        Length,
        Motor,
        Pin,
        Planar,
        PointOnLine,
        Prescribed,
        Rack,
        Rolling,
        Slider,
        Universal,
        UserMeasure,
        Wheel,
    )
    from .linearisation import Linearization, linearize
    from .marker import Marker
    from .paths import Bifurcation, Branch
    from .precision import WorkPrecision, work_precision
    from .result import Result
    from .resumption import resume
    from .run import simulate
    from .scene import Scene
    from .signal import piecewise
    from .solvers import Automatic, DormandPrince, Gauss, GeneralizedAlpha, Radau
    from .state import State
    from .statics import equilibrium
    from .structure import check
    from .sweeps.sweep import sweep
    from .sweeps.table import Sweep
    from .target import Motion
    from .verification.verification import Verification, verify
    from .vibration import Modes, modes

_HOMES = {
    "elements": (
        "PD",
        "AncfCable",
        "CorotationalBeam",
        "FloatingFrameBeam",
        "Force",
        "ForceLaw",
        "Friction",
        "GeometricallyExactBeam",
        "Particle",
        "RigidBody",
        "Spring",
        "Stop",
        "Torque",
        "TorsionSpring",
    ),
    "joints": (
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
    ),
    "solvers": ("Automatic", "DormandPrince", "Gauss", "GeneralizedAlpha", "Radau"),
    "errors": ("Interrupted", "SceneError", "SceneWarning", "SimulationError"),
    "event": ("Event",),
    "functions": ("Expression", "Ramp", "Sine", "SmoothStep", "Spline", "Table"),
    "files.reading": ("read_scene",),
    "files.writing": ("write_scene",),
    "signal": ("piecewise",),
    "marker": ("Marker",),
    "archive": ("load",),
    "result": ("Result",),
    "scene": ("Scene",),
    "assembly": ("assemble",),
    "derivations.scene_equations": ("equations",),
    "resumption": ("resume",),
    "run": ("simulate",),
    "balance": ("Equilibrium",),
    "branches": ("continuation",),
    "paths": ("Bifurcation", "Branch"),
    "statics": ("equilibrium",),
    "state": ("State",),
    "structure": ("check",),
    "diagnosis": ("Structure",),
    "driven": ("kinematics",),
    "precision": ("WorkPrecision", "work_precision"),
    "target": ("Motion",),
    "linearisation": ("Linearization", "linearize"),
    "verification.verification": ("Verification", "verify"),
    "vibration": ("Modes", "modes"),
    "sweeps.sweep": ("sweep",),
    "sweeps.table": ("Sweep",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__version__ = "0.1.0"
__all__ = [
    "PD",
    "Actuator",
    "AncfCable",
    "Angle",
    "Automatic",
    "Ball",
    "BeamSlider",
    "Bifurcation",
    "Branch",
    "Clamp",
    "CorotationalBeam",
    "Coupling",
    "Cylindrical",
    "Displacement",
    "Distance",
    "DormandPrince",
    "Equilibrium",
    "Event",
    "Expression",
    "FloatingFrameBeam",
    "Force",
    "ForceLaw",
    "Friction",
    "Gauss",
    "Gear",
    "GeneralizedAlpha",
    "GeometricallyExactBeam",
    "Interrupted",
    "KnifeEdge",
    "Length",
    "Linearization",
    "Marker",
    "Modes",
    "Motion",
    "Motor",
    "Particle",
    "Pin",
    "Planar",
    "PointOnLine",
    "Prescribed",
    "Rack",
    "Radau",
    "Ramp",
    "Result",
    "RigidBody",
    "Rolling",
    "Scene",
    "SceneError",
    "SceneWarning",
    "SimulationError",
    "Sine",
    "Slider",
    "SmoothStep",
    "Spline",
    "Spring",
    "State",
    "Stop",
    "Structure",
    "Sweep",
    "Table",
    "Torque",
    "TorsionSpring",
    "Universal",
    "UserMeasure",
    "Verification",
    "Wheel",
    "WorkPrecision",
    "__version__",
    "assemble",
    "check",
    "continuation",
    "equations",
    "equilibrium",
    "kinematics",
    "linearize",
    "load",
    "modes",
    "piecewise",
    "read_scene",
    "resume",
    "simulate",
    "sweep",
    "verify",
    "work_precision",
    "write_scene",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'mbd' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"mbd.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
