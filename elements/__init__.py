"""What has mass or pulls: cables, rigid bodies, particles, springs and loads. Import it as ``mbd.elements``."""

if __name__ != "mbd.elements":
    raise ImportError(f"import mbd.elements, not {__name__}: loaded twice, every class would exist twice")

from .ancf_cable import AncfCable
from .control import PD
from .force import Force
from .force_law import ForceLaw
from .friction import Friction
from .particle import Particle
from .rigid import RigidBody
from .spring import Spring, TorsionSpring
from .stop import Stop
from .torque import Torque

__all__ = ["PD", "AncfCable", "Force", "ForceLaw", "Friction", "Particle", "RigidBody", "Spring", "Stop", "Torque", "TorsionSpring"]
