"""Dry friction of a measure, regularised: force on s = -force tanh((ds/dt) / speed)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Array
from mbd.fields import Measured, Number
from mbd.measured import measure_faults
from mbd.signal import Signal

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Friction:
    """Coulomb's friction of given size in a pin (on its Angle) or a slider (on its Displacement), smooth around rest.

    force   [N] or [N m], of sliding: the coefficient of friction times the normal load (times the radius of the pin)
    speed   [m/s] or [rad/s], of the transition: at twice this speed 96 % of the force act; at rest it creeps, it does not stick

    Its work is in the audit; what it does to bodies is in ``result.reaction(measure)``.
    """

    measure: Measured
    force: Number = field(kw_only=True)
    speed: Number = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "friction"

    def __post_init__(self) -> None:
        for name in ("force", "speed"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        found = measure_faults("measure", self.measure) + validate.number("force", self.force, negative_allowed=False)
        return found + validate.number("speed", self.speed, positive=True)

    def place(self, site: Site) -> PlacedFriction:
        return PlacedFriction(self, site)


class PlacedFriction:
    """Friction in a scene."""

    def __init__(self, description: Friction, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        f = self.description
        numbers = {"size": np.array([float(f.force)]), "speed": np.array([float(f.speed)])}
        model.load(Frictions, (), at=np.array([f.measure.coordinate]), signals=[], **numbers)


class Frictions:
    """The kernel of all friction."""

    constant_in_q, linear_in_q, depends_on_rate = True, False, True

    def __init__(self, *, at: NDArray[np.intp], size: Array, speed: Array, signals: Sequence[Signal]):
        self.dofs, self.size, self.speed, self.signals = at[:, None], size[:, None], speed[:, None], signals

    def inputs(self, times: Array) -> Array:
        """None: they do not depend on time."""
        return np.zeros(0)

    def force(self, q: Array, v: Array, inputs: Array) -> Array:
        return -self.size * np.tanh(v[..., self.dofs] / self.speed)

    def rate_gradient(self, q: Array, v: Array, inputs: Array) -> Array:
        """df/dv [n, 1, 1] at one state."""
        return (self.size / self.speed * (np.tanh(v[..., self.dofs] / self.speed) ** 2 - 1.0))[..., None]
