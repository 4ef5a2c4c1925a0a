"""What a picture of a scene shows, for everything that draws: points, affine in q like markers, and shapes that join them.

A shape has a form, which says how its points are meant:

    beam             a smooth curve, densely sampled            rod, arm    a line of a rigid body; arms lead to where something is attached
    hull             the outline of a planar body's points      axes        lines that show how a body without a length turns
    centre, particle a dot                                      disc        a circle that turns, with a spoke
    spring, link     a line between two points                  guide       the straight line along which a joint slides
    force            the point where it acts                    ground      a fixed point that something is attached to
    pin, ball ...    the symbol of a joint, drive or torque: its point and a second one that shows its direction
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .affine import Affine, Array
from .drawn import DRAWN
from .elements.lengthwise import Lengthwise
from .elements.particle import PlacedParticle
from .elements.rigid import Body
from .joints.lines import fixed_axis
from .marker import Marker

if TYPE_CHECKING:
    from .scene import Scene

FINE = 400
"""About the most points along a beam of few elements; of one of more, its nodes and one between."""
ROUND = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 33))

Line = Sequence[Affine]


class Shape(NamedTuple):
    """An item's name, the form, and the indices of its points."""

    item: str
    form: str
    points: tuple[int, ...]


class Drawing:
    """The shapes of a scene over points that they share, fit for configurations q [n_t, n]: guides reach as far as their joints slide."""

    def __init__(self, scene: Scene, q: Array, items: Sequence[Any] | None = None, *, fine: int = FINE):
        self.scene, self.fine, self._q = scene, fine, np.atleast_2d(q)
        self.extent = scene.build().length
        self.shapes: list[Shape] = []
        self.points: list[Affine] = []
        self._known: dict[tuple[tuple[complex, ...], ...], int] = {}
        for item in scene.items if items is None else items:
            self._draw(item)

    def add(self, item: str, form: str, points: Line) -> Shape:
        shape = Shape(item, form, tuple(self._index(point) for point in points))
        self.shapes.append(shape)
        return shape

    def _index(self, point: Affine) -> int:
        """Of a point, the same for equal ones."""
        key = tuple(tuple(part.tolist()) for part in (point.rows, point.weights, point.constant))
        if key not in self._known:
            self._known[key] = len(self.points)
            self.points.append(point)
        return self._known[key]

    def at(self, q: Array) -> Array:
        """[n_t, n_points, d] from q [n_t, n]."""
        return np.stack([point.value(q) for point in self.points], axis=1) if self.points else np.zeros((len(q), 0, self.scene.dimension))

    def rates(self, v: Array) -> Array:
        """The points' velocities [n_t, n_points, d] from v [n_t, n]."""
        return np.stack([point.rate(v) for point in self.points], axis=1) if self.points else np.zeros((len(v), 0, self.scene.dimension))

    def _draw(self, item: Any) -> None:
        if isinstance(item, Lengthwise):
            self.add(item.name, "beam", _curve(item, self.fine))
        elif isinstance(item, Body):
            self._body(item)
        elif isinstance(item, PlacedParticle):
            self.add(item.name, "particle", [item.at().point])
        else:
            draw = DRAWN.get(type(item.description))
            if draw:
                draw(self, item.name, item.description)

    def _body(self, body: Body) -> None:
        centre, arms = body.at().point, self._arms(body)
        before = len(self.shapes)
        if body.length is not None:
            ends = 0.5 * float(body.length) * np.array([[-1.0], [1.0]]) * np.eye(self.scene.dimension)[0]
            self.add(body.name, "rod", [body.at(*end).point for end in ends.tolist()])
        if self.scene.dimension == 2 and (around := _hull(arms)):
            self.add(body.name, "hull", around)
        for arm in arms:
            if not (body.length is not None and _along_rod(arm, float(body.length))):
                self.add(body.name, "arm", [centre, arm])
        if len(self.shapes) == before or (self.scene.dimension == 3 and body.length is None):
            for axis in [body.axes[0], body.axes[0].scaled(1j)] if len(body.axes) == 1 else body.axes:
                self.add(body.name, "axes", [centre, centre + axis.scaled(0.05 * self.extent)])
        self.add(body.name, "centre", [centre])

    def _arms(self, body: Body) -> list[Affine]:
        """Where something is attached away from the mass centre."""
        markers = [m for item in self.scene.items for m in getattr(item.description, "markers", ()) if m.item == body.name]
        return [marker.point for marker in markers if np.any(marker.point.weights[1:])]

    def ground(self, name: str, markers: Sequence[Marker]) -> None:
        for marker in markers:
            if marker.fixed:
                self.add(name, "ground", [marker.point])

    def symbol(self, name: str, form: str, marker: Marker, direction: Affine | None = None) -> None:
        """A symbol at a marker, along a direction or the marker's own axis."""
        own = marker.axes[0] if marker.turns() else Affine.fixed(np.eye(marker.dimension)[0])
        ahead = (direction or own).scaled(0.02 * self.extent)
        self.add(name, form, [marker.point, marker.point + ahead])

    def guide(self, name: str, a: Marker, b: Marker, axis: Any) -> Affine:
        """The line through b, as far as a gets, and a little further; its direction."""
        along = fixed_axis(b, np.asarray(axis) / np.linalg.norm(axis))
        places = np.sum((a.point - b.point).value(self._q) * along.value(self._q), axis=-1)
        room = 0.06 * self.extent
        self.add(name, "guide", [b.point + along.scaled(float(end)) for end in (min(places.min(), 0.0) - room, max(places.max(), 0.0) + room)])
        return along

    def wheel(self, name: str, marker: Marker, radius: float) -> None:
        """A disc in the plane."""
        if marker.turns() and not marker.fixed and marker.rigid:
            spoke = marker.axes[0].scaled(abs(radius))
            self.add(name, "disc", [marker.point, *(marker.point + spoke.scaled(turn) for turn in ROUND)])


def _curve(beam: Lengthwise, fine: int) -> Line:
    n = len(beam.lengths)
    ends = np.concatenate(([0.0], np.cumsum(beam.lengths))) / beam.lengths.sum()
    points = max(2, min(24, fine // n))
    inner = (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(points) / points).ravel()
    if inner.size > max(fine, 2 * 48):
        inner = np.linspace(0.0, 1.0, max(fine, 2 * 48), endpoint=False)
    return [beam.at(float(s)).point for s in (*inner, 1.0)]


def _along_rod(arm: Affine, length: float) -> bool:
    """Whether a body's point lies on its rod."""
    along, *across = (arm.weights[1].real, arm.weights[1].imag) if arm.dimension == 2 else arm.weights[1:]
    return bool(abs(along) <= 0.5 * length * (1.0 + 1e-9) and np.max(np.abs(across)) <= 1e-9 * length)


def _hull(arms: Line) -> Line:
    """The corners around a planar body's points, closed; none where they are in line. Andrew's monotone chain (1979)."""
    at = {complex(arm.weights[1]): arm for arm in arms}
    order = sorted(at, key=lambda w: (w.real, w.imag))
    size = max((abs(w) for w in order), default=0.0)

    def half(points: Sequence[complex]) -> list[complex]:
        corners: list[complex] = []
        for point in points:
            while len(corners) > 1 and ((corners[-1] - corners[-2]).conjugate() * (point - corners[-1])).imag <= 1e-9 * size**2:
                corners.pop()
            corners.append(point)
        return corners

    around = half(order)[:-1] + half(order[::-1])[:-1]
    return [at[w] for w in (*around, around[0])] if len(around) > 2 else []
