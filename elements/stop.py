"""Stops: springs and dampers that act beyond a limit of a measure only, with a smooth onset.

    p = g(s - upper) - g(lower - s),   g(x) = 0 (x < 0),   w (u^3 - u^4 / 2), u = x / w (0 < x < w),   x - w / 2 (x > w)
    force on s = -stiffness p - damping (dp/ds)^2 ds/dt

dg/dx rises from 0 to 1 over the width w as 3 u^2 - 2 u^3, so p is twice continuously differentiable, and steps need not end where contact
begins. The spring is a load: beside a limit its stiffness jumps from nothing, which an iteration sees in a load's value at once, but in a
strain only through a gradient that is zero before. The damper is a strain, dp, without stiffness, so that it is as implicit as any.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd import validate
from mbd.affine import Array
from mbd.fields import Measured, Number
from mbd.measured import measure_faults
from mbd.signal import Signal

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class Stop:
    """A stop that lets a measure pass its limits only against a spring and damper.

    lower, upper   [m] or [rad], limits of the measure; one may be None
    stiffness      [N/m] or [N m/rad]
    damping        [N s/m] or [N m s/rad], while in contact; where it is large it may hold back what leaves
    width          [m] or [rad], over which the spring sets in

    Its work is in the audit; what it does to bodies is in ``result.reaction(measure)``.
    """

    measure: Measured
    lower: Number = field(default=None, kw_only=True)
    upper: Number = field(default=None, kw_only=True)
    stiffness: Number = field(kw_only=True)
    damping: Number = field(default=0.0, kw_only=True)
    width: Number = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "stop"

    def __post_init__(self) -> None:
        for name in ("lower", "upper", "stiffness", "damping", "width"):
            object.__setattr__(self, name, validate.floats(getattr(self, name)))

    def faults(self, dimension: int) -> list[str]:
        limits = [name for name in ("lower", "upper") if getattr(self, name) is not None]
        found = measure_faults("measure", self.measure) + validate.number("damping", self.damping, negative_allowed=False)
        found += [line for name in limits for line in validate.number(name, getattr(self, name))]
        found += [line for name in ("stiffness", "width") for line in validate.number(name, getattr(self, name), positive=True)]
        if not limits:
            found.append("expected lower= or upper=, found none; give one or both")
        elif not found and len(limits) == 2 and not self.lower < self.upper:
            found.append(f"lower: expected a limit below the upper one, found {float(self.lower):g} and {float(self.upper):g}; exchange them")
        return found

    def place(self, site: Site) -> PlacedStop:
        return PlacedStop(self, site)


class PlacedStop:
    """A stop in a scene."""

    def __init__(self, description: Stop, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        s = self.description
        limits = [-np.inf if s.lower is None else float(s.lower), np.inf if s.upper is None else float(s.upper)]
        numbers = {"at": np.array([s.measure.coordinate]), "limits": np.array([limits]), "width": np.array([float(s.width)])}
        model.load(StopSprings, (), stiffness=np.array([float(s.stiffness)]), signals=[], **numbers)
        if s.damping:
            model.strain(StopDampers, (), [self.name], damping=np.array([float(s.damping)]), **numbers)


class _Penetration:
    """p and its first two derivatives for all stops: [..., n, 1]."""

    def __init__(self, at: NDArray[np.intp], limits: Array, width: Array):
        self.dofs, self.limits, self.width = at[:, None], limits, width[:, None]

    def __call__(self, q: Array) -> tuple[Array, Array, Array]:
        s = q[..., self.dofs]
        above, below = self._onset(s - self.limits[:, 1:]), self._onset(self.limits[:, :1] - s)
        return above[0] - below[0], above[1] + below[1], above[2] - below[2]

    def _onset(self, x: Array) -> tuple[Array, Array, Array]:
        """g and its first two derivatives."""
        w = self.width
        u = np.clip(x / w, 0.0, 1.0)
        return w * (u**3 - 0.5 * u**4) + np.maximum(x - w, 0.0), u**2 * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / w


class StopSprings:
    """The kernel of the springs of all stops."""

    constant_in_q = linear_in_q = False

    def __init__(self, *, at: NDArray[np.intp], limits: Array, width: Array, stiffness: Array, signals: Sequence[Signal]):
        self.penetration, self.stiffness, self.signals = _Penetration(at, limits, width), stiffness[:, None], signals
        self.dofs = self.penetration.dofs

    def inputs(self, times: Array) -> Array:
        """None: they do not depend on time."""
        return np.zeros(0)

    def force(self, q: Array, inputs: Array) -> Array:
        return -self.stiffness * self.penetration(q)[0]

    def gradient(self, q: Array, inputs: Array) -> Array:
        return (-self.stiffness * self.penetration(q)[1])[..., None]


class StopDampers:
    """The kernel of the dampers of all stops."""

    sets_in = True

    def __init__(self, *, at: NDArray[np.intp], limits: Array, width: Array, damping: Array):
        self.penetration = _Penetration(at, limits, width)
        self.dofs, self.items, self.m = self.penetration.dofs, at.size, 1
        self.modulus, self.viscosity = np.zeros((at.size, 1)), damping[:, None]

    def at(self, q: Array) -> StopDampersAt:
        return StopDampersAt(self.dofs, *self.penetration(q))


class StopDampersAt:
    """The dampers at configurations [...]: strain p, [..., n, 1]."""

    def __init__(self, dofs: NDArray[np.intp], value: Array, slope: Array, bend: Array):
        self.dofs, self.value, self.slope, self.bend = dofs, value, slope, bend

    @property
    def gradient(self) -> Array:
        """B [..., n, 1, 1]."""
        return self.slope[..., None]

    def pull(self, stress: Array) -> Array:
        return self.slope * stress

    def push(self, change: Array) -> Array:
        return self.slope * change[..., self.dofs]

    def stiffness(self, stress: Array, modulus: Array) -> Array:
        return (modulus * self.slope**2 + stress * self.bend)[..., None]

    def swirl(self, v: Array) -> Array:
        return (self.bend * v[..., self.dofs])[..., None]

    def swirl_times(self, v: Array, change: Array) -> Array:
        return self.bend * v[..., self.dofs] * change[..., self.dofs]

    def energy(self) -> Array:
        return np.zeros(self.value.shape[:-2])
