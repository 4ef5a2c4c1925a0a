"""What the planar beams beside ``AncfCable`` share: their arguments and checks, nodes with an axis.

A node is a position and a director of unit length, as a small rigid body has them: its angle is the director's, it can turn any
number of times, and points and axes stay affine in the coordinates, so that every joint and load takes them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Affine
from mbd.fields import Count, Number, Vector
from mbd.rows import dot

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StraightBeam:
    """The arguments of a uniform planar beam, straight and free of stress from start to end [2] [m]; units as of ``AncfCable``."""

    start: Vector
    end: Vector
    n_elements: Count = field(kw_only=True)
    E: Number = field(kw_only=True)
    A: Number = field(kw_only=True)
    I: Number = field(kw_only=True)  # noqa: E741
    rho: Number = field(kw_only=True)
    damping: Number = field(default=0.0, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "beam"
    NUMBERS: ClassVar[tuple[str, ...]] = ("E", "A", "I", "rho")
    OPTIONAL: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        for name in ("start", "end", "damping", *self.NUMBERS, *self.OPTIONAL):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        given = [*self.NUMBERS, *(name for name in self.OPTIONAL if getattr(self, name) is not None)]
        found = [line for name in given for line in validate.number(name, getattr(self, name), positive=True)]
        found += validate.number("damping", self.damping, negative_allowed=False) + validate.count("n_elements", self.n_elements)
        if dimension != 2:
            what = f"scene: expected a planar one for a {type(self).__name__}, found a spatial one"
            return [*found, f"{what}; use an AncfCable, or give gravity two components"]
        ends = validate.vector("start", self.start, 2) + validate.vector("end", self.end, 2)
        if not ends and not np.linalg.norm(self.end - self.start) > 1e-12 * np.max(np.abs([self.start, self.end])):
            ends = [f"length: expected a beam longer than zero, found both ends at {validate.show(self.start)}; move them apart"]
        return found + ends

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    @property
    def lengths(self) -> Array:
        """[n_elements]: all equal."""
        return np.full(int(self.n_elements), self.length / int(self.n_elements))

    @property
    def direction(self) -> Array:
        """[2]: unit vector from start to end."""
        return (self.end - self.start) / self.length


def nodes_of(beam: StraightBeam, site: Site, count: int, lever: float) -> NDArray[np.intp]:
    """Rows [count, 2] of evenly spaced nodes with position and axis."""
    fraction = np.linspace(0.0, 1.0, count)[:, None]
    points = (1.0 - fraction) * beam.start + fraction * beam.end
    values = np.stack((points, np.tile(beam.direction, (count, 1))), axis=1)
    labels = [f"node {k} {what}" for k in range(count) for what in ("position", "axis")]
    return site.rows(values, np.zeros_like(values), [1.0, lever] * count, labels).reshape(-1, 2)


def unit_axes(model: Model, name: str, rows: NDArray[np.intp]) -> None:
    """One equation for each director: |d| = 1."""
    for k, row in enumerate(rows):
        axis = Affine.of([row], [1.0], 2)
        model.equation(name, f"axis {k}", dot(axis, axis, 1.0, 0.5), internal=True)
