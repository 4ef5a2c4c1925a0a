"""A state at rest in balance: what ``equilibrium`` returns, and what the points of a path are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .marker import Marker
from .reaction import reaction
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A scene at rest in balance.

    q            [n] coordinates, in order of ``scene.coordinates()``;  multipliers [m];  t the time [s] of its loads and drives
    factor       of the loads that a continuation scales; 1 otherwise
    unstable     how many independent motions lower the energy, or grow where forces follow: 0 where it is stable
    neutral      how many motions change nothing: the position is not unique along them
    inputs       what its loads are given (of a path: times the factor)
    stats        iterations, factorizations, restarts, and "falls": how often the path broke off and the scene fell into the next balance
    """

    scene: Scene
    system: System
    q: Array
    multipliers: Array
    t: float
    factor: float
    unstable: int
    neutral: int
    stats: dict[str, Any]
    inputs: Any

    def __repr__(self) -> str:
        return f"<equilibrium: {self.kind}, in {self.stats.get('iterations', 0)} iterations>"

    @property
    def stable(self) -> bool:
        """Whether every motion that the joints allow takes energy."""
        return self.unstable == 0 and self.neutral == 0

    @property
    def kind(self) -> str:
        """ "stable", "unstable" or "neutral"."""
        return f"unstable ({self.unstable} ways)" if self.unstable else "neutral" if self.neutral else "stable"

    @property
    def state(self) -> State:
        """The state at rest: ``simulate(..., start=rest.state)``, or ``start=rest``, starts from it, prestressed."""
        return State(self.q, self.v, self.t)

    @property
    def v(self) -> Array:
        """[n]: nothing moves."""
        return np.zeros_like(self.q)

    def check(self, system: System) -> None:
        """Raises SceneError unless it fits the system."""
        self.state.check(system)

    def position(self, marker: Marker) -> Array:
        """[d] [m]."""
        if not isinstance(marker, Marker):
            raise TypeError(f"expected a marker such as rod.end or body.at(x, y), found {marker!r}")
        return marker.point.value(self.q)

    def angle(self, item: Any) -> float:
        """[rad], from -pi to pi: of a planar body's or marker's axis, of a cable marker's tangent."""
        axes: Any = getattr(item, "axes", ())
        if self.system.dimension != 2 or not axes:
            raise ValueError(f"angle({item!r}): expected a body, or a marker that carries an axis, in the plane; in space use rotation()")
        x, y = axes[0].value(self.q)
        return float(np.arctan2(y, x))

    def rotation(self, body: Any) -> Array:
        """[d, d]: columns are the body axes."""
        axes: Any = getattr(body, "axes", ())
        d = self.system.dimension
        if len(axes) != (1 if d == 2 else 3):
            raise ValueError(f"rotation({body!r}): expected a rigid body, or one of its markers")
        columns = [axes[0], axes[0].scaled(1j)] if d == 2 else axes
        return np.stack([axis.value(self.q) for axis in columns], axis=-1)

    def reaction(self, joint: Any) -> Array:
        """[3] or [6]: force [N], then moment [N m], that the joint exerts on its first marker, about it, in inertial axes."""
        rows = [k for k, (item, _) in enumerate(self.system.joints.labels) if item == getattr(joint, "name", None)]
        if not rows or not hasattr(getattr(joint, "description", None), "rows"):
            raise ValueError(f"reaction({joint!r}): expected a joint of this scene, as scene.add(mbd.Pin(...)) returned it")
        return reaction(joint, joint.pose(self.system.q0), self.q, self.multipliers[rows])

    @cached_property
    def elastic_energy(self) -> float:
        """[J]."""
        return float(self.system.elastic(self.q))

    @cached_property
    def potential_energy(self) -> float:
        """Of gravity [J], zero at the origin."""
        return float(self.system.potential(self.q))
