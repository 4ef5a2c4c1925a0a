"""Actuators on measures: a motion that they follow, or a force."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd.affine import Scalar
from mbd.fields import Function, Measured
from mbd.measured import measure_faults
from mbd.rows import Row, shifted
from mbd.signal import Signal
from mbd.target import Integral

from .drives import Couples, target_of

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

CHOICES = ("value", "rate", "force")


@dataclass(frozen=True, eq=False)
class Actuator:
    """Drives a measure: a hydraulic cylinder on a Length, a spindle on a Displacement, a servo on an Angle. Exactly one of

    value   of the measure [m] or [rad]
    rate    its rate [m/s] or [rad/s]; the value is that at assembly and the integral from t = 0
    force   [N] or [N m], in the direction in which the measure grows

    Numbers, or functions of t [s], with derivatives as for ``Motor``. What it does to bodies is in ``result.reaction(measure)``.
    """

    measure: Measured
    value: Function = field(default=None, kw_only=True)
    rate: Function = field(default=None, kw_only=True)
    force: Function = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "actuator"

    def faults(self, dimension: int) -> list[str]:
        given = [name for name in CHOICES if getattr(self, name) is not None]
        if len(given) != 1:
            return [f"expected exactly one of value=, rate= and force=, found {' and '.join(given) or 'none'}; give one"]
        return measure_faults("measure", self.measure) + Signal(getattr(self, given[0]), (), "", "").faults(given[0])

    def place(self, site: Site) -> PlacedActuator:
        return PlacedActuator(self, site)


class PlacedActuator:
    """An actuator in a scene."""

    def __init__(self, description: Actuator, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        d, at = self.description, self.description.measure.coordinate
        if d.force is not None:
            model.load(Couples, (), turns=np.array([at]), signals=[Signal(d.force, (), self.name, "[N]")])
            return
        row = Row(Scalar.coordinate(at))
        if d.value is not None:
            model.drive(self.name, [("value", row)], target_of(d.value, (), self.name, "[]"))
        else:
            model.drive(self.name, [("value", shifted(row, -float(model.q0[at])))], Integral(d.rate, self.name, "[1/s]"))
