"""Measures that a user's function makes of other measures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mbd.errors import SimulationError
from mbd.fields import Law, Measures
from mbd.formula import Formula
from mbd.measured import measure_faults, measured
from mbd.relation import Relation

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class UserMeasure:
    """A measure s = f(s_1, ..., s_k) of other measures: a cam's profile, a transmission that is not linear.

    measures   a measure or a list of them, as ``scene.add(mbd.Angle(...))`` returned them
    function   of k numbers, to a number; twice differentiable
    gradient   of k numbers, to the first derivatives [k]; None: by differences
    hessian    of k numbers, to the second derivatives [k, k]; None: by differences

    Given derivatives are checked at the start. Differences are good to about 1e-12 (first) and 1e-10 (second), at 0.1 to 0.3 ms each.
    """

    measures: Measures
    function: Law
    gradient: Law = field(default=None, kw_only=True)
    hessian: Law = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind, unit = "user measure", ""
    essential = ("function", "gradient", "hessian")  # without them there are no equations

    def __post_init__(self) -> None:
        object.__setattr__(self, "measures", list(self.measures) if isinstance(self.measures, (list, tuple)) else [self.measures])

    def faults(self, dimension: int) -> list[str]:
        found = [line for item in self.measures for line in measure_faults("measures", item)]
        for name in ("function", "gradient", "hessian"):
            given = getattr(self, name)
            if not callable(given) and (given is not None or name == "function"):
                found.append(f"{name}: expected a function of {len(self.measures)} numbers, found {given!r}; correct it")
        return found

    def place(self, site: Site) -> PlacedUserMeasure:
        return PlacedUserMeasure(self, site)


class PlacedUserMeasure:
    """A user's measure in a scene."""

    def __init__(self, description: UserMeasure, site: Site):
        self.description, self.name, self.site = description, site.name, site
        d = description
        self.formula = Formula(d.function, d.gradient, d.hessian, (1, len(d.measures)), site.name)
        self.inputs = np.array([item.coordinate for item in d.measures if measured(item)], dtype=np.intp)
        whole = self.inputs.size == len(d.measures) > 0
        self.coordinate = site.scalar(*(self._start(site) if whole else (0.0, 0.0)), "value")

    def _start(self, site: Site) -> tuple[float, float]:
        q, v = site.scene.layout.start()
        x = q[self.inputs]
        try:
            return float(self.formula.value(x)[0]), float(self.formula.gradient(x)[0] @ v[self.inputs])
        except SimulationError:  # the run that calls it says so
            return 0.0, 0.0

    def assemble(self, model: Model) -> None:
        for complaint in self.formula.faults(model.q0[self.inputs]):
            model.complain(self, complaint)
        model.relation(self.name, Relation(self.inputs, self.coordinate, self.formula))
