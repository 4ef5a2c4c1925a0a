"""What has mass or pulls: cables, rigid bodies, particles, springs and loads. Import it as ``mbd.elements``."""

if __name__ != "mbd.elements":
    raise ImportError(f"import mbd.elements, not {__name__}: loaded twice, every class would exist twice")

from .ancf_cable import AncfCable
from .control import PD
from .corotational import CorotationalBeam
from .floating_frame import FloatingFrameBeam
from .force import Force
from .force_law import ForceLaw
from .friction import Friction
from .geometrically_exact import GeometricallyExactBeam
from .particle import Particle
from .rigid import RigidBody
from .spring import Spring, TorsionSpring
from .stop import Stop
from .torque import Torque

__all__ = [
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
]
