"""Floating frame of reference: a rigid frame that carries a beam deformed by a few bending modes. Planar, thin, axially rigid.

    r(x) = R + d x + sum_k w_k(x) p_k - d u(x)        |d| = 1,  d . p_k = 0:  p_k = q_k (i d),  q_k the modal coordinate
    u(x) = 1/2 int_0^x (sum_k w_k' q_k)^2 dx          shortening by bending: the axial displacement of an unstretched beam

The frame is that of the tangent at the start, the modes are those of a beam clamped there (bending_modes.py). Usually (Shabana, Dynamics
of Multibody Systems) q_k and the frame's angle are the coordinates, and the mass matrix depends on q. Turned with the frame,
p_k = q_k (i d) are absolute: the position is linear in (R, d, p) and the mass matrix constant, as in the component mode synthesis of
Pechstein, Reischl and Gerstmayr (2013), J. Comput. Nonlinear Dynam. 8. The rows d . p_k = 0 leave the motion of the usual form.

Without u the beam has no stiffening by rotation and axial loads. It is quadratic in q; its shape in x is taken as the sum of
x^3, x^4 and x^5 with u's mean, first moment and end value, three quadratic forms q' K q / 2. Vectors f = d times these are coordinates,
d . f = q' K q / (2 L) and d x f = 0 their equations, and the mass matrix is the constant Gram matrix of all functions of x. Weight and
first moment are exact, so gravity and rotation act rightly for any deflection; the rest of the inertia is exact for cubic ones.

Limits: slopes w' small against the frame (to 0.1, say), and no axial strain: use the other formulations beyond.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array
from mbd.rows import Row, cross, dot

from .bending_modes import BendingModes
from .lengthwise import Lengthwise
from .measure import Measure
from .straight_beam import StraightBeam

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

Modes = Literal["craig_bampton", "cantilever"]
STEEP = 0.3
"""Slopes beyond this are worth a warning: what the second order neglects is a tenth."""
SHORTENINGS = ("mean", "moment", "end")
POWERS = np.array([3, 4, 5])
"""u(x) between the ends: the sum of these powers that has the mean, the first moment and the end value; exact for cubic deflections."""


@dataclass(frozen=True, eq=False)
class FloatingFrameBeam(StraightBeam):
    """A thin planar beam of small deflections in a floating frame, straight from start to end.

    start, end         [2] positions [m]; straight and free of stress between them; the frame is tangent at the start
    n_elements         number of bending modes (at least two of Craig and Bampton's), of a mesh of as many cubic elements that is clamped at the start
    E, A, I, rho       Young's modulus [Pa], area [m^2], second moment of area [m^4], density [kg/m^3]; axially the beam is rigid
    modes              "craig_bampton": those of a clamped end and of its displacement and rotation; "cantilever": those of a free end, which
                       converge slowly where a clamp or a torque gives that end a bending moment
    stiffening         True: rotation and axial loads stiffen it; False: the plain linear formulation, wrong where it turns or is loaded axially
    damping            Kelvin-Voigt relaxation time [s]: stress = E (strain + damping strain rate)

    Markers: ``start``, ``end``, ``at(s)`` with the fraction s of the length. They carry the tangent.
    """

    modes: Modes = field(default="craig_bampton", kw_only=True)
    stiffening: bool = field(default=True, kw_only=True)

    def faults(self, dimension: int) -> list[str]:
        found = super().faults(dimension)
        if self.modes not in get_args(Modes):
            found.append(f"modes: expected one of {', '.join(map(repr, get_args(Modes)))}, found {self.modes!r}; choose one")
        if not isinstance(self.stiffening, bool):
            found.append(f"stiffening: expected True or False, found {self.stiffening!r}; choose one")
        return found

    def place(self, site: Site) -> FloatingFrameItem:
        return FloatingFrameItem(self, site)


class FloatingFrameItem(Lengthwise):
    """A floating-frame beam in a scene; rows: origin, axis, modes, then the three vectors of shortening, if any."""

    def __init__(self, description: FloatingFrameBeam, site: Site):
        b = description
        super().__init__(b, site, b.lengths)
        self.modes = BendingModes(int(b.n_elements), b.modes)
        count = self.modes.stiffness.size
        more = len(SHORTENINGS) * b.stiffening
        values = np.vstack((b.start, b.direction, np.zeros((count + more, 2))))
        labels = ["origin position", "axis", *(f"mode {k + 1}" for k in range(count)), *(f"{what} shortening" for what in SHORTENINGS[:more])]
        rows = site.rows(values, np.zeros_like(values), [1.0, self.length, *np.ones(count + more)], labels)
        self.frame, self.modal, self.short = rows[:2], rows[2 : 2 + count], rows[2 + count :]

    def locate(self, s: float) -> tuple[Affine, tuple[Affine, ...]]:
        deflection, slope = self.modes.shape(s)[:, 0], self.modes.shape(s, 1)[:, 0] / self.length
        shortening = -_shortening(s)[: self.short.size, 0]
        point, tangent = np.concatenate(([1.0, s * self.length], deflection, shortening)), np.concatenate(([0.0, 1.0], slope, 0.0 * shortening))
        rows = np.concatenate((self.frame, self.modal, self.short))
        there, turned = (Affine.of(rows[weights != 0.0], weights[weights != 0.0], 2) for weights in (point, tangent))
        return there, (turned,)

    def doubts(self, q: Array) -> list[str]:
        """What a run with coordinates q [n_t, n] should not be believed for: deflections that are not small."""
        table = q[:, : 2 * (max(self.modal.max(), self.frame.max()) + 1)].reshape(len(q), -1, 2)
        axis = table[:, self.frame[1], None]
        across = axis[..., 0] * table[:, self.modal, 1] - axis[..., 1] * table[:, self.modal, 0]
        slope = float(np.max(np.abs(across @ self.modes.shape(np.linspace(0.0, 1.0, 4 * len(self.lengths) + 1), 1)), initial=0.0)) / self.length
        if slope <= STEEP:
            return []
        advice = "do not trust this run; use a GeometricallyExactBeam or an AncfCable, or several beams clamped to each other"
        return [f"beam {self.name!r} bends to a slope of {slope:.3g} in its floating frame, made for small ones: {advice}"]

    def assemble(self, model: Model) -> None:
        b, modes = self.description, self.modes
        axis = Affine.of(self.frame[1:], [1.0], 2)
        self._inertia(model)
        model.equation(self.name, "axis", dot(axis, axis, 1.0, 0.5), internal=True)
        for k, row in enumerate(self.modal):
            model.equation(self.name, f"mode {k + 1}", dot(axis, Affine.of([row], [1.0], 2)), internal=True)
        for row, kind in zip(self.short, SHORTENINGS):
            self._shorten(model, axis, Affine.of([row], [1.0], 2), kind)
        stiffness = float(b.E * b.I) / self.length**3 * modes.stiffness
        nodes = np.stack((np.broadcast_to(self.frame[1], self.modal.shape), self.modal), axis=1)
        numbers = {"stiffness": stiffness, "damping": np.full(len(stiffness), float(b.damping))}
        labels = [f"{self.name}: mode {k + 1}" for k in range(len(stiffness))]
        model.strain(Deflection, (), labels, nodes=2 * nodes[..., None] + np.arange(2), **numbers)

    def _inertia(self, model: Model) -> None:
        """The Gram matrix of the functions of x that the rows are multiplied by, so never indefinite."""
        xi, weight = self.modes.points
        rows = np.concatenate((self.frame, self.modal, self.short))
        functions = [np.ones_like(xi), self.length * xi, *self.modes.shape(xi)]
        functions += list(-_shortening(xi)) if self.short.size else []
        shapes = np.stack(functions)
        mass = float(self.description.rho * self.description.A) * self.length * weight
        model.mass(rows[None], ((shapes * mass) @ shapes.T)[None])
        model.weight(rows[None], (shapes @ mass)[None])

    def _shorten(self, model: Model, axis: Affine, short: Affine, kind: str) -> None:
        along = dot(axis, short)
        for row, weights in zip(self.modal, self.modes.shortening(kind)):
            products = dot(Affine.of([row], [1.0], 2), Affine.of(self.modal, weights, 2), 0.0, -0.5 / self.length).products
            along = Row(along.linear, along.products + products)
        model.equation(self.name, f"{kind} shortening along", along, internal=True)
        model.equation(self.name, f"{kind} shortening across", cross(axis, short), internal=True)


def _shortening(xi: Array | float) -> Array:
    """[3, n_xi]: u(xi) from mean, doubled first moment and end value."""
    moments = np.stack((1.0 / (POWERS + 1), 2.0 / (POWERS + 2), np.ones(3)))
    return np.linalg.solve(moments.T, np.atleast_1d(xi) ** POWERS[:, None])


class Deflection:
    """The kernel of all modal coordinates: q = (i d) . p, bilinear. nodes [n, 2, 2] indices of (d, p), stiffness [n] [N/m], damping [n] [s]."""

    def __init__(self, *, nodes: NDArray[np.intp], stiffness: Array, damping: Array):
        self.nodes, self.dofs = nodes, nodes.reshape(len(nodes), -1)
        self.modulus = stiffness[:, None]
        self.viscosity = damping[:, None] * self.modulus

    def at(self, q: Array) -> DeflectionAt:
        return DeflectionAt(self, q[..., self.dofs])


SECOND = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]])
"""The second derivative of d x p by (d, p)."""


class DeflectionAt(Measure):
    """The deflections of modes at configurations [...]."""

    def __init__(self, kernel: Deflection, local: Array):
        self.kernel = kernel
        row = local @ SECOND
        self.value = 0.5 * np.sum(row * local, axis=-1, keepdims=True)
        self.gradient = row[..., None, :]

    def curve(self, stress: Array) -> Array:
        return stress[..., None] * SECOND
