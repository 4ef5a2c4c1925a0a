"""Linear equations between measures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from mbd import validate
from mbd.affine import Scalar
from mbd.fields import Function, Terms
from mbd.measured import measure_faults
from mbd.rows import Row
from mbd.signal import Signal

from .drives import target_of

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Coupling:
    """A linear equation between measures: sum of coefficient times measure = value.

    terms   pairs (coefficient, measure), measures as ``scene.add(mbd.Angle(...))`` returned them; sums of different units are the user's own
    value   a number or callable of t (with derivatives as for ``Motor``); None: the sum at the start

    What it does to the bodies is in the reactions of its measures.
    """

    terms: Terms
    value: Function = None
    name: str | None = field(default=None, kw_only=True)

    kind = "coupling"

    def _items(self) -> list[Any]:
        return [term[1] for term in self.terms if np.ndim(term) == 1 and len(term) == 2] if isinstance(self.terms, (list, tuple)) else []

    def faults(self, dimension: int) -> list[str]:
        items = self._items()
        if not items or len(items) != len(self.terms):
            return [f"terms: expected pairs (coefficient, measure), found {self.terms!r}; give terms=[(2.0, phi), (-1.0, psi)]"]
        found = [line for item in items for line in measure_faults("terms", item)]
        for coefficient, _ in self.terms:
            wrong = validate.number("terms: coefficient", validate.floats(coefficient))
            found += wrong or ([] if float(coefficient) else ["terms: coefficient: expected a number other than 0, found 0; leave the term out"])
        return found + ([] if self.value is None else Signal(self.value, (), "", "").faults("value"))

    def place(self, site: Site) -> PlacedCoupling:
        return PlacedCoupling(self, site)


class PlacedCoupling:
    """A coupling in a scene."""

    def __init__(self, description: Coupling, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        c = self.description
        columns = np.array([item.coordinate for _, item in c.terms])
        coefficients = np.array([float(coefficient) for coefficient, _ in c.terms])
        row = Row(Scalar(columns, coefficients, 0.0))
        value = float(coefficients @ model.q0[columns]) if c.value is None else c.value
        model.drive(self.name, [("coupling", row)], target_of(value, (), self.name, "[]"))
