"""Thin planar or spatial beam in the absolute nodal coordinate formulation: nodal positions and slopes, cubic in between.

Escalona, Hussien and Shabana (1998), J. Sound Vib. 214. The mass matrix (eq. 8) is constant and gravity too; the elastic forces come
from a strain kernel: ``planar_continuum.py``, ``spatial_continuum.py`` or, for the element of the paper, ``local_frame.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Affine
from mbd.fields import Count, Matrix, Number, Vector

from .lengthwise import Lengthwise
from .local_frame import LocalFrame
from .planar_continuum import PlanarContinuum
from .rest_shape import arc_parameter, backward, element_lengths, spline_tangents, straight
from .shapes import MASS, WEIGHT, WEIGHT_LUMPED, hermite, hermite_slope
from .spatial_continuum import SpatialContinuum

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

Array = NDArray[np.float64]
Elasticity = Literal["continuum", "local_frame"]
Weight = Literal["consistent", "lumped"]


@dataclass(frozen=True, eq=False)
class AncfCable:
    """A thin beam of cubic elements, straight from start to end, or through nodes with tangents.

    start, end         [d] positions [m]; or nodes [n + 1, d] [m] with tangents [n + 1, d] = dr/ds, of unit length on an unstretched
                       beam (without tangents: those of the smooth spline through the nodes). The given shape is free of stress.
    n_elements         number of elements, equally long on a straight beam
    E, A, I, rho       Young's modulus [Pa], area [m^2], second moment of area [m^4], density [kg/m^3]
    elasticity         "continuum": EA (|r'| - 1)^2 + EI curvature^2;  "local_frame": the chord frame of 1998, planar and straight
    gauss_points       of the continuum strains
    damping            Kelvin-Voigt relaxation time [s]: stress = E (strain + damping strain rate)
    gravity            "consistent", or "lumped": the weight of an element concentrated at midspan (eq. 28)

    Markers: ``start``, ``end``, ``at(s)`` with the fraction s of the total reference arc length. They carry the tangent.

    ``CorotationalBeam``, ``GeometricallyExactBeam`` and ``FloatingFrameBeam`` take the same arguments for a straight planar beam.
    """

    start: Vector = None
    end: Vector = None
    n_elements: Count = field(default=None, kw_only=True)
    E: Number = field(kw_only=True)
    A: Number = field(kw_only=True)
    I: Number = field(kw_only=True)  # noqa: E741
    rho: Number = field(kw_only=True)
    elasticity: Elasticity = field(default="continuum", kw_only=True)
    nodes: Matrix = field(default=None, kw_only=True)
    tangents: Matrix = field(default=None, kw_only=True)
    gauss_points: Count = field(default=7, kw_only=True)
    damping: Number = field(default=0.0, kw_only=True)
    gravity: Weight = field(default="consistent", kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "cable"

    def __post_init__(self) -> None:
        for name in ("start", "end", "E", "A", "I", "rho", "nodes", "tangents", "damping"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        found = [*self._faulty_numbers(), *self._faulty_words(dimension)]
        shape = self._faulty_shape(dimension)
        if not shape:
            nodes, tangents = self._curve()
            chords = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
            if np.any(chords <= 1e-12 * (np.max(np.abs(nodes - nodes[0])) + 1e-300)) or not chords.all():
                shape = [f"length: expected elements longer than zero, found {validate.show(chords)} [m]; move the nodes or ends apart"]
            elif np.any(np.linalg.norm(tangents, axis=1) == 0.0):
                shape = ["tangents: expected vectors dr/ds, found a zero one; give directions of unit length"]
            elif (back := np.flatnonzero(backward(nodes, tangents))).size:
                shape = [f"tangents: expected directions along the elements, found one against them at node {back[0]}; turn it, or give more nodes"]
            elif (dimension == 3 or self.elasticity == "local_frame") and not straight(nodes, tangents):
                spatial, chord = "a cable without torsion has no frame to carry its rest curvature", "the chord-frame element is straight at rest"
                why = spatial if dimension == 3 else chord
                shape = [f"nodes: expected a straight rest shape, found a curved one ({why}); use a planar 'continuum' cable or straight pieces"]
        return found + shape

    def _faulty_numbers(self) -> list[str]:
        found = [line for name in ("E", "A", "I", "rho") for line in validate.number(name, getattr(self, name), positive=True)]
        found += validate.number("damping", self.damping, negative_allowed=False)
        found += validate.count("gauss_points", self.gauss_points, least=3)
        return found

    def _faulty_words(self, dimension: int) -> list[str]:
        found = []
        for name, words in (("elasticity", get_args(Elasticity)), ("gravity", get_args(Weight))):
            if getattr(self, name) not in words:
                found.append(f"{name}: expected one of {', '.join(map(repr, words))}, found {getattr(self, name)!r}; choose one")
        if self.elasticity == "local_frame" and dimension == 3:
            found.append("elasticity: expected 'continuum' in a spatial scene, found 'local_frame', which is planar; change it")
        return found

    def _faulty_shape(self, dimension: int) -> list[str]:
        if self.nodes is None:
            if self.tangents is not None:
                return ["tangents: expected nodes beside them, found none; give nodes=[...]"]
            wrong = [validate.vector(name, getattr(self, name), dimension) for name in ("start", "end")]
            if all(np.shape(getattr(self, name)) == (5 - dimension,) for name in ("start", "end")):
                wrong.pop()  # planar in a spatial scene or the other way round
            return [line for lines in wrong for line in lines] + validate.count("n_elements", self.n_elements)
        if self.start is not None or self.end is not None:
            return ["nodes: expected either start and end or nodes, found both; leave one out"]
        nodes = self.nodes
        if not isinstance(nodes, np.ndarray) or nodes.ndim != 2 or nodes.shape[1] != dimension or len(nodes) < 2:
            return [f"nodes: expected at least two rows of {dimension} numbers, found {validate.show(nodes)}; correct the list"]
        if self.n_elements is not None and self.n_elements != len(nodes) - 1:
            return [f"n_elements: expected {len(nodes) - 1} for {len(nodes)} nodes, found {self.n_elements}; leave it out"]
        if self.tangents is not None and (not isinstance(self.tangents, np.ndarray) or self.tangents.shape != nodes.shape):
            return [f"tangents: expected one for each of the {len(nodes)} nodes, found {validate.show(self.tangents)}; correct the list"]
        return validate.finite("nodes", nodes) + (validate.finite("tangents", self.tangents) if self.tangents is not None else [])

    def _curve(self) -> tuple[Array, Array]:
        """Nodes and tangents [n + 1, d] at rest."""
        if self.nodes is None:
            fraction = np.linspace(0.0, 1.0, int(self.n_elements or 1) + 1)[:, None]
            nodes = (1.0 - fraction) * self.start + fraction * self.end
            axis = self.end - self.start
            return nodes, np.tile(axis / max(np.linalg.norm(axis), 1e-300), (len(nodes), 1))
        return self.nodes, spline_tangents(self.nodes) if self.tangents is None else self.tangents

    def place(self, site: Site) -> Cable:
        nodes, tangents = self._curve()
        lengths = element_lengths(nodes, tangents)
        around = np.concatenate((lengths[:1], lengths)), np.concatenate((lengths, lengths[-1:]))
        levers = np.stack((np.ones(len(nodes)), np.sqrt(MASS[1, 1] / MASS[0, 0]) * np.maximum(*around)), axis=1)
        values = np.stack((nodes, tangents), axis=1)
        labels = [f"node {k} {what}" for k in range(len(nodes)) for what in ("position", "slope")]
        rows = site.rows(values, np.zeros_like(values), levers.ravel(), labels)
        return Cable(self, site, rows.reshape(-1, 2), lengths, values)


class Cable(Lengthwise):
    """A cable in a scene."""

    word = "cable"

    def __init__(self, description: AncfCable, site: Site, rows: NDArray[np.intp], lengths: Array, rest: Array):
        super().__init__(description, site, lengths)
        self.rows, self.rest = rows, rest

    def locate(self, s: float) -> tuple[Affine, tuple[Affine, ...]]:
        ends = np.concatenate(([0.0], np.cumsum(self.lengths)))
        element = int(np.clip(np.searchsorted(ends, s * ends[-1], side="right") - 1, 0, len(self.lengths) - 1))
        length = self.lengths[element]
        xi = arc_parameter(self.rest[element : element + 2].reshape(4, -1), length, (s * ends[-1] - ends[element]) / length)
        scale = np.array([1.0, length, 1.0, length])
        rows, d = self.rows[element : element + 2].ravel(), self.rest.shape[-1]
        point, slope = hermite(xi) * scale, hermite_slope(xi) * scale / length
        keep, bend = point != 0.0, slope != 0.0
        return Affine.of(rows[keep], point[keep], d), (Affine.of(rows[bend], slope[bend], d),)

    def assemble(self, model: Model) -> None:
        c, n = self.description, len(self.lengths)
        rows = np.concatenate((self.rows[:-1], self.rows[1:]), axis=1)
        mass = c.rho * c.A * self.lengths
        scale = np.stack((np.ones(n), self.lengths, np.ones(n), self.lengths), axis=1)
        model.mass(rows, mass[:, None, None] * MASS * scale[:, :, None] * scale[:, None, :])
        weight = WEIGHT if c.gravity == "consistent" else WEIGHT_LUMPED
        model.weight(rows, mass[:, None] * weight * scale)
        d = self.rest.shape[-1]
        common = {
            "nodes": d * rows[:, None, :] + np.arange(d)[:, None],
            "length": self.lengths,
            "EA": np.full(n, float(c.E * c.A)),
            "EI": np.full(n, float(c.E * c.I)),
            "damping": np.full(n, float(c.damping)),
        }
        labels = [f"{self.name}: element {k}" for k in range(n)]
        if c.elasticity == "local_frame":
            model.strain(LocalFrame, (), labels, **common)
        else:
            rest = np.concatenate((self.rest[:-1], self.rest[1:]), axis=1)
            continuum = PlanarContinuum if d == 2 else SpatialContinuum
            model.strain(continuum, (c.gauss_points,), labels, rest=np.swapaxes(rest, 1, 2), **common)
