"""Proportional-derivative control of a measure: a spring and damper between the measure and what it should be, both functions of time.

    force on s = -proportional (s - c(t)) - derivative (ds/dt - c'(t))

The part in s is a strain, so that it is as implicit as any damper; the part in c a load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Array
from mbd.fields import Function, Measured, Number
from mbd.measured import measure_faults
from mbd.signal import Signal
from mbd.target import Position

from .spring_strains import Twist

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class PD:
    """A controller that makes a measure follow a target with a force (or torque).

    target         a number or callable of t [m] or [rad], with derivatives as for ``Motor``
    proportional   gain [N/m] or [N m/rad]
    derivative     gain [N s/m] or [N m s/rad]

    Its force on bodies is in ``result.reaction(measure)``. The spring's energy, 1/2 proportional s^2, counts as elastic, the rest as work.
    """

    measure: Measured
    target: Function = 0.0
    proportional: Number = field(kw_only=True)
    derivative: Number = field(default=0.0, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "controller"

    def __post_init__(self) -> None:
        for name in ("proportional", "derivative"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        gains = [line for name in ("proportional", "derivative") for line in validate.number(name, getattr(self, name), negative_allowed=False)]
        return measure_faults("measure", self.measure) + gains + Signal(self.target, (), "", "").faults("target")

    def place(self, site: Site) -> PlacedPD:
        return PlacedPD(self, site)


class PlacedPD:
    """A controller in a scene."""

    def __init__(self, description: PD, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        d, at = self.description, np.array([self.description.measure.coordinate])
        gains = np.array([[float(d.proportional), float(d.derivative)]])
        model.strain(Twist, (), [self.name], turn=at, angle=np.zeros(1), stiffness=gains[:, 0], damping=gains[:, 1])
        target = Position(d.target, (), self.name, "[]")
        model.load(Pursuit, (), at=at, gains=gains, targets=[target], signals=list(target.signals))


class Pursuit:
    """The kernel of what controllers' targets pull with: proportional c + derivative c'."""

    constant_in_q = linear_in_q = True

    def __init__(self, *, at: NDArray[np.intp], gains: Array, targets: Sequence[Position], signals: Sequence[Signal]):
        self.dofs, self.gains, self.targets, self.signals = at[:, None], gains, targets, signals
        self.items = [target.signals[0].item for target in targets]

    def inputs(self, times: Array) -> Array:
        """[..., n]."""
        pulls = [p * c.value(times) + (d * c.rate(times) if d else 0.0) for (p, d), c in zip(self.gains, self.targets)]
        return np.concatenate(pulls, axis=-1)

    def force(self, q: Array, inputs: Array) -> Array:
        return inputs[..., None]
