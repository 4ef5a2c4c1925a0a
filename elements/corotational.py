"""Corotational beam: the linear element, carried along by the frame of its chord. Planar, thin, two nodes an element.

    c = r_2 - r_1,  stretch = |c| - l,  t_a = angle from c to the director d_a
    U = 1/2 [ EA/l stretch^2 + EI/l ((t_2 - t_1)^2 + 3 (t_1 + t_2)^2) ]         EI/l (4 t_1^2 + 4 t_1 t_2 + 4 t_2^2), the linear beam's

Incremental formulations follow the same frame in small steps of a rotation vector; written with the chord and the nodes' directors no
step enters, rigid motion is exact and free of strain. Belytschko and Hsieh (1973), Int. J. Numer. Meth. Engng 7. The mass matrix is eq. 8
of Escalona et al. (1998), cubic functions with the unit directors for slopes: constant. Limits: t_a below half a turn and small
(several elements to a bend); stretch is small in the mass. Order 2 in the length of the elements.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array

from .lengthwise import Lengthwise
from .measure import Measure, angle_between, turn, turn_curve
from .shapes import MASS, WEIGHT, hermite, hermite_slope
from .straight_beam import StraightBeam, nodes_of, unit_axes

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class CorotationalBeam(StraightBeam):
    """A thin planar beam of linear elements in corotated frames, straight from start to end.

    start, end         [2] positions [m]; straight and free of stress between them
    n_elements         number of elements, equally long
    E, A, I, rho       Young's modulus [Pa], area [m^2], second moment of area [m^4], density [kg/m^3]
    damping            Kelvin-Voigt relaxation time [s]: stress = E (strain + damping strain rate)

    Markers: ``start``, ``end``, ``at(s)`` with the fraction s of the length; they carry the director or, within an element, the tangent.
    Rigid motion is exact; second order in the element's length. Belytschko and Hsieh (1973).
    """

    def place(self, site: Site) -> CorotationalItem:
        return CorotationalItem(self, site)


class CorotationalItem(Lengthwise):
    """A corotational beam in a scene."""

    def __init__(self, description: CorotationalBeam, site: Site):
        n = int(description.n_elements)
        super().__init__(description, site, description.lengths)
        lever = np.sqrt(MASS[1, 1] / MASS[0, 0]) * float(self.lengths[0])
        self.rows = nodes_of(description, site, n + 1, lever)

    def locate(self, s: float) -> tuple[Affine, tuple[Affine, ...]]:
        n, length = len(self.lengths), float(self.lengths[0])
        element = min(int(s * n), n - 1)
        scale = np.array([1.0, length, 1.0, length])
        rows, xi = self.rows[element : element + 2].ravel(), s * n - element
        point, slope = hermite(xi) * scale, hermite_slope(xi) * scale / length
        keep, bend = point != 0.0, slope != 0.0
        return Affine.of(rows[keep], point[keep], 2), (Affine.of(rows[bend], slope[bend], 2),)

    def assemble(self, model: Model) -> None:
        b, n = self.description, len(self.lengths)
        rows = np.concatenate((self.rows[:-1], self.rows[1:]), axis=1)
        mass = float(b.rho * b.A) * self.lengths
        scale = np.stack((np.ones(n), self.lengths, np.ones(n), self.lengths), axis=1)
        model.mass(rows, mass[:, None, None] * MASS * scale[:, :, None] * scale[:, None, :])
        model.weight(rows, mass[:, None] * WEIGHT * scale)
        unit_axes(model, self.name, self.rows[:, 1])
        numbers = {"EA": np.full(n, float(b.E * b.A)), "EI": np.full(n, float(b.E * b.I)), "damping": np.full(n, float(b.damping))}
        labels = [f"{self.name}: element {k}" for k in range(n)]
        model.strain(Corotational, (), labels, nodes=2 * rows[..., None] + np.arange(2), length=self.lengths, **numbers)


class Corotational:
    """The kernel of all corotational elements. nodes [n, 4, 2] indices of (r_1, d_1, r_2, d_2), length, EA, EI, damping [n]."""

    def __init__(self, *, nodes: NDArray[np.intp], length: Array, EA: Array, EI: Array, damping: Array):
        self.nodes, self.dofs, self.length = nodes, nodes.reshape(len(nodes), -1), length
        self.modulus = np.stack((EA / length, EI / length, 3.0 * EI / length), axis=1)
        self.viscosity = damping[:, None] * self.modulus

    def at(self, q: Array) -> CorotationalAt:
        return CorotationalAt(self, q[..., self.nodes])


class CorotationalAt(Measure):
    """The elements at configurations [...]: stretch [m], difference and sum of the end angles."""

    def __init__(self, kernel: Corotational, nodal: Array):
        self.kernel = kernel
        self.chord, self.first, self.second = nodal[..., 2, :] - nodal[..., 0, :], nodal[..., 1, :], nodal[..., 3, :]
        self.size = np.sqrt(np.sum(self.chord**2, axis=-1))
        a, b = angle_between(self.chord, self.first), angle_between(self.chord, self.second)
        self.value = np.stack((self.size - kernel.length, b - a, a + b), axis=-1)
        along, side = self.chord / self.size[..., None], turn(self.chord)
        none, one, two = np.zeros_like(side), turn(self.first), turn(self.second)
        rows = ((-along, none, along, none), (none, -one, none, two), (2.0 * side, one, -2.0 * side, two))
        self.gradient = np.stack([np.concatenate(row, axis=-1) for row in rows], axis=-2)

    def curve(self, stress: Array) -> Array:
        force, difference, total = (stress[..., k, None, None] for k in range(3))
        along = self.chord / self.size[..., None]
        across = (np.eye(2) - along[..., :, None] * along[..., None, :]) / self.size[..., None, None]
        on_chord = force * across - 2.0 * total * turn_curve(self.chord)
        out = np.zeros((*on_chord.shape[:-2], 4, 2, 4, 2))
        for i, j, sign in ((0, 0, 1.0), (2, 2, 1.0), (0, 2, -1.0), (2, 0, -1.0)):
            out[..., i, :, j, :] = sign * on_chord
        out[..., 1, :, 1, :] = (total - difference) * turn_curve(self.first)
        out[..., 3, :, 3, :] = (total + difference) * turn_curve(self.second)
        return out.reshape(*out.shape[:-4], 8, 8)
