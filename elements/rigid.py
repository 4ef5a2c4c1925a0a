"""Rigid bodies by directors: the rows are the mass centre and the body axes, the mass matrix is constant.

In the plane one director d1 suffices, the second being i d1: 4 coordinates, 1 equation |d1| = 1, inertia J on d1. In space three:
12 coordinates, 6 equations, E_ij = int x_i x_j dm = (tr J / 2) delta_ij - J_ij on them. Betsch and Steinmann (2001), Int. J. Numer.
Meth. Engng 51. A flat body or a thin rod makes E singular: solvers take the mass matrix only together with the joints.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Affine
from mbd.errors import SceneError
from mbd.fields import Matrix, Number, Vector
from mbd.marker import Marker
from mbd.rows import dot

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site

Array = NDArray[np.float64]

ROUNDING = 1e-14
"""Inertia of a director below this share of the whole is what rounding left of a flat body's or a rod's, which is none."""


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A rigid body.

    mass               [kg]
    inertia            about the mass centre in body axes [kg m^2]: a number (planar); three moments or a 3x3 matrix (spatial)
    position           [d] of the mass centre [m]
    angle, rotation    of the body axes: counter-clockwise [rad] (planar); 3x3, columns are the body axes (spatial)
    velocity           [d] of the mass centre [m/s]
    angular_velocity   a number (planar), inertial components [3] (spatial) [rad/s]

    Mass and inertia may be zero where joints, with what else has mass, determine the motion.
    Marker: ``at(x, y[, z])``, metres in body axes from the mass centre. ``length`` is that of ``RigidBody.rod``, otherwise None.
    """

    mass: Number = field(kw_only=True)
    inertia: Number | Vector | Matrix = field(kw_only=True)
    position: Vector = field(kw_only=True)
    angle: Number = field(default=None, kw_only=True)
    rotation: Matrix = field(default=None, kw_only=True)
    velocity: Vector = field(default=None, kw_only=True)
    angular_velocity: Number | Vector = field(default=None, kw_only=True)
    length: Number = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "body"

    def __post_init__(self) -> None:
        for name in ("mass", "inertia", "position", "angle", "rotation", "velocity", "angular_velocity"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    @classmethod
    def rod(cls, start: Vector, end: Vector, *, mass: Number, radius: Number = 0.0, **motion: Any) -> RigidBody:
        """A uniform slender rod from start to end [d] [m]; in space a solid cylinder of this radius [m]. Axis 1 runs along it."""
        a, b = validate.floats(start), validate.floats(end)
        if not (isinstance(a, np.ndarray) and isinstance(b, np.ndarray) and a.shape == b.shape and a.shape in ((2,), (3,))):
            return cls(mass=mass, inertia=1.0, position=start if not isinstance(a, np.ndarray) or a.shape not in ((2,), (3,)) else end, **motion)
        length = float(np.linalg.norm(b - a))
        axis = b - a if 0.0 < length < np.inf else np.eye(a.size)[0]  # other lengths and a wrong mass are complained of once, not as inertia
        m, wrong = _mass(mass), validate.number("radius", validate.floats(radius), negative_allowed=False)
        if wrong:
            raise SceneError([f"body {motion.get('name')!r}: {line}" for line in wrong])
        across = m * float(axis @ axis) / 12.0
        if a.size == 2:
            pose: dict[str, Any] = {"inertia": across, "angle": np.arctan2(axis[1], axis[0])}
        else:
            moments = (0.5 * m * radius**2, across + 0.25 * m * radius**2, across + 0.25 * m * radius**2)
            pose = {"inertia": moments, "rotation": _frame_along(axis)}
        return cls(mass=mass, position=0.5 * (a + b), length=length, **pose, **motion)

    @classmethod
    def box(cls, size: Vector, *, mass: Number, position: Vector, **motion: Any) -> RigidBody:
        """A uniform rectangle (planar) or cuboid (spatial) with edges size [d] [m] along the body axes."""
        edges, m = validate.floats(size), _mass(mass)
        if not (isinstance(edges, np.ndarray) and edges.shape in ((2,), (3,)) and np.isfinite(edges).all() and np.all(edges > 0.0)):
            what = f"size: expected two (planar) or three (spatial) positive edges, found {validate.show(edges)}; correct it"
            raise SceneError([f"body {motion.get('name')!r}: {what}"])
        inertia = m * (edges @ edges - edges**2) / 12.0 if edges.size == 3 else m * (edges @ edges) / 12.0
        return cls(mass=mass, inertia=inertia, position=position, **motion)

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("mass", self.mass, negative_allowed=False) + validate.vector("position", self.position, dimension)
        if np.shape(self.position) == (5 - dimension,):
            return found  # planar in a spatial scene or the other way round: all the rest would be wrong too
        if self.velocity is not None:
            found += validate.vector("velocity", self.velocity, dimension)
        if self.length is not None and self.length <= 0.0:
            found.append("length: expected a rod longer than zero, found equal ends; move them apart")
        return found + (self._faulty_planar() if dimension == 2 else self._faulty_spatial())

    def _faulty_planar(self) -> list[str]:
        found = validate.number("inertia", self.inertia, negative_allowed=False)
        if self.rotation is not None:
            found.append("rotation: expected angle= in a planar scene, found a matrix; give the angle [rad]")
        for name in ("angle", "angular_velocity"):
            if getattr(self, name) is not None:
                found += validate.number(name, getattr(self, name))
        return found

    def _faulty_spatial(self) -> list[str]:
        found = []
        if self.angle is not None:
            found.append("angle: expected rotation= in a spatial scene, found an angle; give a 3x3 matrix whose columns are the body axes")
        if self.angular_velocity is not None:
            found += validate.vector("angular_velocity", self.angular_velocity, 3)
        r = self.rotation
        square = isinstance(r, np.ndarray) and r.shape == (3, 3)
        if r is not None and (not square or not np.allclose(r.T @ r, np.eye(3), atol=1e-9) or np.linalg.det(r) < 0):
            found.append(f"rotation: expected a right-handed orthonormal 3x3 matrix, found {validate.show(r)}; normalise its columns")
        j = self.inertia
        if not isinstance(j, np.ndarray) or j.shape not in ((3,), (3, 3)) or not np.isfinite(j).all():
            about = "give them about the mass centre in body axes"
            return [*found, f"inertia: expected three moments or a 3x3 matrix, found {validate.show(j)}; {about}"]
        if j.shape == (3, 3) and not np.allclose(j, j.T, rtol=1e-9, atol=0):
            return [*found, f"inertia: expected a symmetric matrix, found {validate.show(j)}; mirror its products"]
        moments = np.linalg.eigvalsh(j) if j.ndim == 2 else np.sort(j)
        if moments[-1] < 0 or moments[0] < -1e-12 * moments[-1] or moments[0] + moments[1] < moments[2] * (1 - 1e-9):
            found.append(
                f"inertia: expected principal moments that obey the triangle inequality (the largest at most the sum of the others), "
                f"found {validate.show(moments)}; no body has these moments: check units and the reference point"
            )
        return found

    def directors(self) -> Array:
        """[n_axes, d]: the body axes that are coordinates."""
        if self.position.size == 2:
            angle = 0.0 if self.angle is None else float(self.angle)
            return np.array([[np.cos(angle), np.sin(angle)]])
        return np.eye(3) if self.rotation is None else self.rotation.T

    def director_rates(self) -> Array:
        axes = self.directors()
        if self.angular_velocity is None:
            return np.zeros_like(axes)
        if self.position.size == 2:
            return float(self.angular_velocity) * np.stack((-axes[:, 1], axes[:, 0]), axis=1)
        return np.cross(self.angular_velocity, axes)

    def director_mass(self) -> Array:
        """E [n_axes, n_axes]."""
        if self.position.size == 2:
            return self.inertia.reshape(1, 1)
        j = np.diag(self.inertia) if self.inertia.ndim == 1 else self.inertia
        mass = 0.5 * np.trace(j) * np.eye(3) - j
        return np.where(np.abs(mass) > ROUNDING * np.trace(j), mass, 0.0)

    def place(self, site: Site) -> Body:
        axes, mass = self.directors(), self.director_mass()
        levers = np.concatenate(([1.0], self._arms(mass)))
        velocity = np.zeros_like(self.position) if self.velocity is None else self.velocity
        labels = ["mass centre", *(f"axis {k + 1}" for k in range(len(axes)))]
        rows = site.rows(np.vstack((self.position, axes)), np.vstack((velocity, self.director_rates())), levers, labels)
        return Body(self, site, rows)


    def _arms(self, mass: Array) -> Array:
        """[n_axes] the lever of each axis: its radius of gyration, or that of a rod; NaN, the scene's length, where mass or inertia is zero."""
        if float(self.mass) > 0.0 and mass.any():
            gyration = np.sqrt(np.maximum(np.diag(mass), 0.0) / float(self.mass))
            return np.where(gyration > 0.1 * gyration.max(), gyration, gyration.max())
        return np.full(len(mass), np.nan if self.length is None else self.length / np.sqrt(12.0))


class Body:
    """A rigid body in a scene."""

    def __init__(self, description: RigidBody, site: Site, rows: NDArray[np.intp]):
        self.description, self.name, self.site, self.rows = description, site.name, site, rows
        self.length = description.length

    @property
    def axes(self) -> tuple[Affine, ...]:
        return tuple(Affine.of([row], [1.0], self.description.position.size) for row in self.rows[1:])

    def at(self, *point: float) -> Marker:
        """The marker at (x, y[, z]) [m] in body axes from the mass centre; without numbers, the mass centre."""
        d = self.description.position.size
        if len(point) not in (0, d):
            what = f"at: expected {d} numbers, metres in body axes from the mass centre, found {point}; correct it"
            raise SceneError([f"body {self.name!r}: {what}"])
        arm = np.array(point or np.zeros(d), dtype=float)
        weights = [complex(*arm)] if d == 2 else list(arm)
        return Marker(self.name, self.site.scene, Affine.of(self.rows, [1.0, *weights], d), self.axes, True, point)

    def assemble(self, model: Model) -> None:
        mass, axes = float(self.description.mass), self.axes
        block = np.zeros((1, len(self.rows), len(self.rows)))
        block[0, 0, 0], block[0, 1:, 1:] = mass, self.description.director_mass()
        model.mass(self.rows[None], block)
        model.weight(self.rows[None, :1], np.array([[mass]]))
        for i, a in enumerate(axes):
            for j in range(i, len(axes)):
                model.equation(self.name, f"axes {i + 1} and {j + 1}", dot(a, axes[j], float(i == j), 0.5 if i == j else 1.0), internal=True)


def _mass(value: Any) -> float:
    """The mass for computing moments; 1 for a wrong one, which is complained of as a mass."""
    mass = validate.floats(value)
    return 1.0 if validate.number("mass", mass, negative_allowed=False) else float(mass)


def _frame_along(axis: Array) -> Array:
    """A rotation matrix whose first column is the axis."""
    first = axis / max(float(np.linalg.norm(axis)), 1e-300)
    second = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
    second /= max(float(np.linalg.norm(second)), 1e-300)
    return np.stack((first, second, np.cross(first, second)), axis=1)
