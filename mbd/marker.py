"""Markers: where joints, springs and loads attach. A marker is a point and the axes it carries, all affine in q."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .affine import Affine, Array


@dataclass(frozen=True, eq=False)
class Marker:
    """A point of an item with the axes it carries.

    axes: of a planar body or the ground its first axis (the second is i times it), of a spatial body or the ground three
    (orthonormal), of a cable its tangent dr/ds (not a unit vector: it stretches with the beam), of a particle none.
    place: the numbers given to the item's ``at``, which find the same marker on another mesh; None where they are not known.
    """

    item: str
    scene: object
    point: Affine
    axes: tuple[Affine, ...]
    rigid: bool
    place: tuple[float, ...] | None = None

    def __repr__(self) -> str:
        return f"<marker of {self.item!r}>"

    @property
    def dimension(self) -> int:
        return self.point.dimension

    @property
    def fixed(self) -> bool:
        """On the ground."""
        return self.point.rows.size == 0

    def turns(self) -> bool:
        """Whether a rotation is defined: it carries an axis."""
        return bool(self.axes)


def frame(marker: Marker, q: Array) -> Array:
    """[..., d, n_axes]: the marker's axes as columns."""
    return np.stack([axis.value(q) for axis in marker.axes], axis=-1)
