"""Springs with dampers: between two points, and between two axes. Their strains are in ``spring_strains.py``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd import validate
from mbd.fields import Number
from mbd.marker import Marker

from .spring_strains import Offset, Stretch, Twist

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Spring:
    """A spring and damper between two markers.

    stiffness [N/m], damping [N s/m], length [m]: unstretched; None: the distance at the start.
    """

    a: Marker
    b: Marker
    stiffness: Number = field(kw_only=True)
    damping: Number = field(default=0.0, kw_only=True)
    length: Number = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "spring"

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping", "length"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("stiffness", self.stiffness, negative_allowed=False)
        found += validate.number("damping", self.damping, negative_allowed=False)
        return found + (validate.number("length", self.length, negative_allowed=False) if self.length is not None else [])

    def place(self, site: Site) -> PlacedSpring:
        return PlacedSpring(self, site)


class PlacedSpring:
    """A spring in a scene."""

    def __init__(self, description: Spring, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        s = self.description
        apart = s.a.point - s.b.point
        now = float(np.linalg.norm(apart.value(model.q0)))
        length = now if s.length is None else float(s.length)
        numbers = {"stiffness": np.array([float(s.stiffness)]), "damping": np.array([float(s.damping)])}
        if length == 0.0:
            model.strain(Offset, (), [self.name], apart=[apart], **numbers)
        elif now == 0.0:
            model.complain(self, "expected ends apart at the start (the force of a spring of given length has no direction otherwise), "
                                 "found them at one point; move one, or give length=0")  # fmt: skip
        else:
            model.strain(Stretch, (), [self.name], apart=[apart], length=np.array([length]), **numbers)


@dataclass(frozen=True, eq=False)
class TorsionSpring:
    """A torsion spring and damper between two planar markers that carry an axis (bodies, cables, the ground).

    stiffness [N m/rad], damping [N m s/rad], angle [rad]: unstressed turn of the first relative to the second since assembly.
    """

    a: Marker
    b: Marker
    stiffness: Number = field(kw_only=True)
    damping: Number = field(default=0.0, kw_only=True)
    angle: Number = field(default=0.0, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "torsion spring"

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping", "angle"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("stiffness", self.stiffness, negative_allowed=False)
        found += validate.number("damping", self.damping, negative_allowed=False) + validate.number("angle", self.angle)
        if dimension != 2:
            found.append("scene: expected a planar one (a turn about no given axis is not defined in space), found a spatial one; use springs")
        found += [f"marker: expected one that carries an axis, found {m!r}; use a body, a cable or the ground" for m in self.markers if not m.turns()]
        return found

    def place(self, site: Site) -> PlacedTorsionSpring:
        return PlacedTorsionSpring(self, site)


class PlacedTorsionSpring:
    """A torsion spring in a scene, with its turn as a coordinate."""

    def __init__(self, description: TorsionSpring, site: Site):
        self.description, self.name, self.site = description, site.name, site
        self.turn = site.scalar(0.0, _turning(description.a, site) - _turning(description.b, site), "turn")

    def assemble(self, model: Model) -> None:
        s = self.description
        model.turn(self.name, s.a.axes[0], s.b.axes[0], self.turn)
        numbers = {"stiffness": np.array([float(s.stiffness)]), "damping": np.array([float(s.damping)])}
        model.strain(Twist, (), [self.name], turn=np.array([self.turn]), angle=np.array([float(s.angle)]), **numbers)


def _turning(marker: Marker, site: Site) -> float:
    """The angular velocity of a planar marker's axis at the start."""
    q, v = site.scene.layout.start()
    axis, rate = marker.axes[0].value(q), marker.axes[0].rate(v)
    return float((axis[0] * rate[1] - axis[1] * rate[0]) / (axis @ axis))
