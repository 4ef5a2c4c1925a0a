"""Geometrically exact beam, the large rotation vector of the plane: positions and angles interpolated apart, shear allowed.

    r(x) = N_a r_a,   theta(x) = N_a theta_a,   theta_a the angle of the director d_a        N_a Lagrangian, degree p = 2
    (1 + e, g) = r' seen from the frame at theta,   k = theta'                              axial, shear and bending strain
    U = 1/2 int EA e^2 + GA g^2 + EI k^2 dx,     T = 1/2 int rho A |r_t|^2 + rho I theta_t^2 dx

Simo and Vu-Quoc (1986), J. Appl. Mech. 53, of Reissner's beam (1972). Strains at p Gauss points (no locking); the rotary inertia is
taken at the nodes by their weights (Simpson's, of order 4), so the mass matrix is constant with d_a for coordinate.
Angles enter as differences within an element, which must stay below half a turn: nothing is singular, and turns need no count.
Nodes move with order 2 p = 4 in the length of the elements; where the moment is constant angles are exact.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array
from mbd.fields import Number

from .lengthwise import Lengthwise
from .measure import Measure, angle_between, turn, turn_curve
from .shapes import gauss
from .straight_beam import StraightBeam, nodes_of, unit_axes

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

DEGREE = 2
NODE_WEIGHT = np.array([1.0, 4.0, 1.0]) / 6.0
"""Simpson's rule on [0, 1]: Lobatto's for three points."""
SHEAR = 5.0 / 6.0 / (2.0 * (1.0 + 0.3))
"""GA / EA of a rectangular section, shear factor 5/6 and Poisson's ratio 0.3."""


def lagrange(xi: Array | float) -> Array:
    """N [3, n_xi] through xi = 0, 1/2, 1."""
    x = np.asarray(xi, dtype=float)
    return np.array([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)])


def lagrange_slope(xi: Array | float) -> Array:
    """dN/dxi [3, n_xi]."""
    x = np.asarray(xi, dtype=float)
    return np.array([4 * x - 3, 4 - 8 * x, 4 * x - 1])


@cache
def _mass() -> tuple[Array, Array]:
    """int N N' dxi and int N dxi."""
    xi, weight = gauss(DEGREE + 1)
    n = lagrange(xi)
    return (n * weight) @ n.T, n @ weight


@dataclass(frozen=True, eq=False)
class GeometricallyExactBeam(StraightBeam):
    """A planar beam that bends, stretches and shears by any amount, of quadratic elements, straight from start to end.

    start, end         [2] positions [m]; straight and free of stress between them
    n_elements         number of elements of three nodes, equally long
    E, A, I, rho       Young's modulus [Pa], area [m^2], second moment of area [m^4], density [kg/m^3]
    GA                 shear stiffness [N]; None: 5/6 E A / 2.6
    rotary_inertia     of the sections, for a unit of length [kg m]; None: rho I
    damping            Kelvin-Voigt relaxation time [s]: stress = E (strain + damping strain rate)

    Markers: ``start``, ``end``, ``at(s)`` with the fraction s of the length. At nodes (s a multiple of 1 / (2 n_elements)) they carry the
    section's normal, between them no axis. Simo and Vu-Quoc (1986): the large rotation vector formulation.
    """

    GA: Number = field(default=None, kw_only=True)
    rotary_inertia: Number = field(default=None, kw_only=True)

    OPTIONAL: ClassVar[tuple[str, ...]] = ("GA", "rotary_inertia")

    def place(self, site: Site) -> GeometricallyExactItem:
        return GeometricallyExactItem(self, site)


class GeometricallyExactItem(Lengthwise):
    """A geometrically exact beam in a scene."""

    def __init__(self, description: GeometricallyExactBeam, site: Site):
        b, n = description, int(description.n_elements)
        super().__init__(b, site, b.lengths)
        line = float(b.rho * b.A)
        self.rotary = float(b.rho * b.I if b.rotary_inertia is None else b.rotary_inertia)
        self.rows = nodes_of(b, site, DEGREE * n + 1, np.sqrt(self.rotary / line))
        self.elements = DEGREE * np.arange(n)[:, None] + np.arange(DEGREE + 1)

    def locate(self, s: float) -> tuple[Affine, tuple[Affine, ...]]:
        n = len(self.lengths)
        element = min(int(s * n), n - 1)
        weights = lagrange(s * n - element)
        rows, node = self.rows[self.elements[element]], s * DEGREE * n
        near = round(node)
        if abs(node - near) < 1e-9:
            return Affine.of([self.rows[near, 0]], [1.0], 2), (Affine.of([self.rows[near, 1]], [1.0], 2),)
        return Affine.of(rows[:, 0], weights, 2), ()

    def assemble(self, model: Model) -> None:
        b, n, (mass, weight) = self.description, len(self.lengths), _mass()
        line, rows = float(b.rho * b.A) * self.lengths, self.rows[self.elements]
        model.mass(rows[..., 0], line[:, None, None] * mass)
        model.weight(rows[..., 0], line[:, None] * weight)
        model.mass(rows[..., 1], (self.rotary * self.lengths)[:, None, None] * np.diag(NODE_WEIGHT))
        unit_axes(model, self.name, self.rows[:, 1])
        ea = float(b.E * b.A)
        numbers = {"EA": ea, "GA": SHEAR * ea if b.GA is None else float(b.GA), "EI": float(b.E * b.I), "damping": float(b.damping)}
        labels = [f"{self.name}: element {k}" for k in range(n)]
        nodes = 2 * rows[..., None] + np.arange(2)
        model.strain(GeometricallyExact, (), labels, nodes=nodes, length=self.lengths, **{k: np.full(n, x) for k, x in numbers.items()})


class GeometricallyExact:
    """The kernel of all geometrically exact elements. nodes [n, 3, 2, 2] indices of (r_a, d_a), length, EA, GA, EI, damping [n]."""

    def __init__(self, *, nodes: NDArray[np.intp], length: Array, EA: Array, GA: Array, EI: Array, damping: Array):
        self.nodes, self.dofs, self.length = nodes, nodes.reshape(len(nodes), -1), length
        xi, weight = gauss(DEGREE)
        self.by_node, self.by_x = lagrange(xi).T, lagrange_slope(xi).T / length[:, None, None]  # [g, a], [n, g, a]
        self.modulus = np.concatenate([(stiff * length)[:, None] * weight for stiff in (EA, GA, EI)], axis=1)
        self.viscosity = damping[:, None] * self.modulus

    def at(self, q: Array) -> GeometricallyExactAt:
        return GeometricallyExactAt(self, q[..., self.nodes])


class GeometricallyExactAt(Measure):
    """The elements at configurations [...]: axial, shear and bending strains at the Gauss points."""

    def __init__(self, kernel: GeometricallyExact, nodal: Array):
        self.kernel = kernel
        position, self.director = nodal[..., 0, :], nodal[..., 1, :]
        middle = self.director[..., 1:2, :]
        beta = angle_between(middle, self.director)
        angle = beta @ kernel.by_node.T + np.arctan2(middle[..., 1], middle[..., 0])
        self.cos, self.sin = np.cos(angle), np.sin(angle)
        slope = kernel.by_x @ position
        self.stretch = self.cos * slope[..., 0] + self.sin * slope[..., 1]
        self.shear = self.cos * slope[..., 1] - self.sin * slope[..., 0]
        bending = (kernel.by_x @ beta[..., None])[..., 0]
        self.value = np.concatenate((self.stretch - 1.0, self.shear, bending), axis=-1)
        self.turned = turn(self.director)
        self.gradient = self._gradient()

    def _gradient(self) -> Array:
        k, zero = self.kernel, np.zeros((*self.cos.shape, DEGREE + 1, 2))
        by_x, c, s = np.broadcast_to(k.by_x, zero.shape[:-1]), self.cos[..., None], self.sin[..., None]
        along, across = np.stack((c * by_x, s * by_x), axis=-1), np.stack((-s * by_x, c * by_x), axis=-1)
        turned = self.turned[..., None, :, :]
        by_node = k.by_node[..., None] * turned
        stretch, shear = self.stretch[..., None, None], self.shear[..., None, None]
        bands = ((along, shear * by_node), (across, -stretch * by_node), (zero, by_x[..., None] * turned))
        rows = [np.stack(band, axis=-2) for band in bands]
        return np.concatenate(rows, axis=-4).reshape(*self.value.shape, -1)

    def curve(self, stress: Array) -> Array:
        k, g = self.kernel, DEGREE
        n, s, m = stress[..., :g], stress[..., g : 2 * g], stress[..., 2 * g :]
        force = np.stack((-n * self.sin - s * self.cos, n * self.cos - s * self.sin), axis=-1)  # of the stresses, by the angle
        couple = np.einsum("...ngi,nga,gb->...naib", force, k.by_x, k.by_node)
        double = np.einsum("...ng,ga,gb->...nab", -n * self.stretch - s * self.shear, k.by_node, k.by_node)
        on_angle = (n * self.shear - s * self.stretch) @ k.by_node + (m[..., None, :] @ k.by_x)[..., 0, :]
        a = DEGREE + 1
        out = np.zeros((*on_angle.shape[:-1], a, 2, 2, a, 2, 2))
        mix = couple[..., None] * self.turned[..., None, None, :, :]  # a, i, b, j
        out[..., :, 0, :, :, 1, :] = mix
        out[..., :, 1, :, :, 0, :] = np.moveaxis(mix, (-4, -3), (-2, -1))
        out[..., :, 1, :, :, 1, :] = np.einsum("...ab,...ai,...bj->...aibj", double, self.turned, self.turned)
        own = on_angle[..., None, None] * turn_curve(self.director)
        for node in range(a):
            out[..., node, 1, :, node, 1, :] += own[..., node, :, :]
        size = 4 * a
        return out.reshape(*on_angle.shape[:-1], size, size)
