"""Springs with dampers: between two points, and between two axes.

Spring:         strain |p| - length, p = a - b, force stiffness strain + damping d(strain)/dt along the line
zero length:    strain p itself, d components, smooth where the ends meet
TorsionSpring:  strain phi - angle, phi the counter-clockwise turn of the first marker relative to the second since assembly (planar)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Affine, Array
from mbd.maps import Maps
from mbd.marker import Marker

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Spring:
    """A spring and damper between two markers.

    stiffness [N/m], damping [N s/m], length [m]: unstretched; None: the distance at the start.
    """

    a: Marker
    b: Marker
    stiffness: Any = field(kw_only=True)
    damping: Any = field(default=0.0, kw_only=True)
    length: Any = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "spring"

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping", "length"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("stiffness", self.stiffness, negative_allowed=False)
        found += validate.number("damping", self.damping, negative_allowed=False)
        return found + (validate.number("length", self.length, negative_allowed=False) if self.length is not None else [])

    def place(self, site: Site) -> PlacedSpring:
        return PlacedSpring(self, site)


class PlacedSpring:
    """A spring in a scene."""

    def __init__(self, description: Spring, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        s = self.description
        apart = s.a.point - s.b.point
        now = float(np.linalg.norm(apart.value(model.q0)))
        length = now if s.length is None else float(s.length)
        numbers = {"stiffness": np.array([float(s.stiffness)]), "damping": np.array([float(s.damping)])}
        if length == 0.0:
            model.strain(Offset, (), [self.name], apart=[apart], **numbers)
        elif now == 0.0:
            model.complain(self, "expected ends apart at the start (the force of a spring of given length has no direction otherwise), "
                                 "found them at one point; move one, or give length=0")  # fmt: skip
        else:
            model.strain(Stretch, (), [self.name], apart=[apart], length=np.array([length]), **numbers)


@dataclass(frozen=True, eq=False)
class TorsionSpring:
    """A torsion spring and damper between two planar markers that carry an axis (bodies, cables, the ground).

    stiffness [N m/rad], damping [N m s/rad], angle [rad]: unstressed turn of the first relative to the second since assembly.
    """

    a: Marker
    b: Marker
    stiffness: Any = field(kw_only=True)
    damping: Any = field(default=0.0, kw_only=True)
    angle: Any = field(default=0.0, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "torsion spring"

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping", "angle"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    def faults(self, dimension: int) -> list[str]:
        found = validate.number("stiffness", self.stiffness, negative_allowed=False)
        found += validate.number("damping", self.damping, negative_allowed=False) + validate.number("angle", self.angle)
        if dimension != 2:
            found.append("scene: expected a planar one (a turn about no given axis is not defined in space), found a spatial one; use springs")
        found += [f"marker: expected one that carries an axis, found {m!r}; use a body, a cable or the ground" for m in self.markers if not m.turns()]
        return found

    def place(self, site: Site) -> PlacedTorsionSpring:
        return PlacedTorsionSpring(self, site)


class PlacedTorsionSpring:
    """A torsion spring in a scene, with its turn as a coordinate."""

    def __init__(self, description: TorsionSpring, site: Site):
        self.description, self.name, self.site = description, site.name, site
        self.turn = site.scalar(0.0, _turning(description.a, site) - _turning(description.b, site), "turn")

    def assemble(self, model: Model) -> None:
        s = self.description
        model.turn(self.name, s.a.axes[0], s.b.axes[0], self.turn)
        numbers = {"stiffness": np.array([float(s.stiffness)]), "damping": np.array([float(s.damping)])}
        model.strain(Twist, (), [self.name], turn=np.array([self.turn]), angle=np.array([float(s.angle)]), **numbers)


def _turning(marker: Marker, site: Site) -> float:
    """The angular velocity of a planar marker's axis at the start."""
    q, v = site.scene.layout.start()
    axis, rate = marker.axes[0].value(q), marker.axes[0].rate(v)
    return float((axis[0] * rate[1] - axis[1] * rate[0]) / (axis @ axis))


class Stretch:
    """The kernel of all springs with a length."""

    def __init__(self, *, apart: Sequence[Affine], length: Array, stiffness: Array, damping: Array):
        self.maps, self.length = Maps(apart), length
        self.dofs, self.items, self.m = self.maps.dofs, len(length), 1
        self.modulus, self.viscosity = stiffness[:, None], damping[:, None]

    def at(self, q: Array) -> StretchAt:
        return StretchAt(self, self.maps.value(q))


class StretchAt:
    """The springs at configurations [...]."""

    def __init__(self, kernel: Stretch, apart: Array):
        self.kernel = kernel
        self.distance = np.sqrt(np.sum(apart**2, axis=-1, keepdims=True))
        self.unit = apart / self.distance

    @property
    def value(self) -> Array:
        return self.distance - self.kernel.length[:, None]

    def pull(self, stress: Array) -> Array:
        return self.kernel.maps.pull(stress * self.unit)

    def push(self, change: Array) -> Array:
        return np.sum(self.unit * self.kernel.maps.push(change), axis=-1, keepdims=True)

    def _across(self) -> Array:
        """d2|p|/dp2 [..., n, d, d]."""
        u = self.unit
        return (np.eye(u.shape[-1]) - u[..., :, None] * u[..., None, :]) / self.distance[..., None]

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        u, p = self.unit, self.kernel.maps.matrix
        h = modulus[..., None] * u[..., :, None] * u[..., None, :] + stress[..., None] * self._across()
        return np.swapaxes(p, -1, -2) @ h @ p

    def swirl_times(self, v: Array, change: Array) -> Array:
        return (self.swirl(v) @ change[..., self.kernel.dofs][..., None])[..., 0]

    def swirl(self, v: Array) -> Array:
        rate = self._across() @ self.kernel.maps.push(v)[..., None]
        return np.swapaxes(rate, -1, -2) @ self.kernel.maps.matrix

    def energy(self) -> Array:
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))


class Offset:
    """The kernel of all springs of zero length: linear."""

    def __init__(self, *, apart: Sequence[Affine], stiffness: Array, damping: Array):
        self.maps = Maps(apart)
        d = apart[0].dimension
        self.dofs, self.items, self.m = self.maps.dofs, len(apart), d
        self.modulus, self.viscosity = np.repeat(stiffness[:, None], d, axis=1), np.repeat(damping[:, None], d, axis=1)

    def at(self, q: Array) -> LinearAt:
        return LinearAt(self, self.maps.value(q), self.maps)


class _Coordinates:
    """One coordinate for each item, as ``Maps`` gives vectors."""

    def __init__(self, index: NDArray[np.intp]):
        self.dofs, self.matrix = index[:, None], np.ones((index.size, 1, 1))

    def push(self, dq: Array) -> Array:
        return dq[..., self.dofs]

    def pull(self, force: Array) -> Array:
        return force


class Twist:
    """The kernel of all torsion springs: linear in their turns."""

    def __init__(self, *, turn: NDArray[np.intp], angle: Array, stiffness: Array, damping: Array):
        self.maps, self.angle = _Coordinates(turn), angle[:, None]
        self.dofs, self.items, self.m = self.maps.dofs, turn.size, 1
        self.modulus, self.viscosity = stiffness[:, None], damping[:, None]

    def at(self, q: Array) -> LinearAt:
        return LinearAt(self, q[..., self.dofs] - self.angle, self.maps)


class LinearAt:
    """A measure whose gradient is constant."""

    def __init__(self, kernel: Offset | Twist, value: Array, maps: Maps | _Coordinates):
        self.kernel, self.value, self.maps = kernel, value, maps

    def pull(self, stress: Array) -> Array:
        return self.maps.pull(stress)

    def push(self, change: Array) -> Array:
        return self.maps.push(change)

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        p = self.maps.matrix
        return np.swapaxes(p, -1, -2) @ (modulus[..., None] * p)

    def swirl_times(self, v: Array, change: Array) -> Array:
        return np.zeros((*np.broadcast_shapes(v.shape[:-1], change.shape[:-1]), self.kernel.items, self.kernel.m))

    def swirl(self, v: Array) -> Array:
        return np.zeros((*v.shape[:-1], self.kernel.items, self.kernel.m, self.maps.dofs.shape[1]))

    def energy(self) -> Array:
        return 0.5 * np.sum(self.kernel.modulus * self.value**2, axis=(-2, -1))
