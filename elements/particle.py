"""Point masses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd import validate
from mbd.affine import Affine
from mbd.fields import Number, Vector
from mbd.marker import Marker

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Particle:
    """A point of mass [kg] at position [d] [m] with velocity [d] [m/s]. Marker: ``at()``. Without mass joints must tell where it is."""

    mass: Number = field()
    position: Vector = field()
    velocity: Vector = None
    name: str | None = field(default=None, kw_only=True)

    kind = "particle"

    def __post_init__(self) -> None:
        for name in ("mass", "position", "velocity"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("mass", self.mass, negative_allowed=False) + validate.vector("position", self.position, dimension)
        return found + (validate.vector("velocity", self.velocity, dimension) if self.velocity is not None else [])

    def place(self, site: Site) -> PlacedParticle:
        velocity = np.zeros_like(self.position) if self.velocity is None else self.velocity
        return PlacedParticle(self, site, int(site.rows([self.position], [velocity], [1.0], ["position"])[0]))


class PlacedParticle:
    """A particle in a scene."""

    def __init__(self, description: Particle, site: Site, row: int):
        self.description, self.name, self.site, self.row = description, site.name, site, row

    def at(self) -> Marker:
        point = Affine.of([self.row], [1.0], self.description.position.size)
        return Marker(self.name, self.site.scene, point, (), True, ())

    def assemble(self, model: Model) -> None:
        mass = np.array([[float(self.description.mass)]])
        model.mass(np.array([[self.row]]), mass[None])
        model.weight(np.array([[self.row]]), mass)
