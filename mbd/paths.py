"""What ``continuation`` returns: paths of equilibrium, and the points where others cross them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from .affine import Array
from .balance import Equilibrium
from .loading import Loading
from .marker import Marker
from .reaction import reaction

if TYPE_CHECKING:
    from .scene import Scene


def on_path(scene: Scene, loading: Loading, factor: float, q: Array, multipliers: Array, unstable: int) -> Equilibrium:
    """The equilibrium at a point of a path."""
    return Equilibrium(scene, loading.system, q, multipliers, loading.t, float(factor), int(unstable), 0, {}, loading.inputs(float(factor)))


@dataclass(frozen=True, eq=False)
class Bifurcation:
    """A point where another path crosses: the equilibrium there and ``motion`` [n], in which direction the other path leaves.

    ``continuation(..., branch=bifurcation)`` follows that one.
    """

    at: Equilibrium
    motion: Array


@dataclass(frozen=True, eq=False)
class Branch:
    """A path of equilibrium, in the order in which it was followed.

    factor         [k] times the load at the points of the path;  q [k, n], multipliers [k, m], unstable [k]: as of ``Equilibrium``
    limits         equilibria where the factor turns: the path goes on with less load, and a structure under that load snaps
    bifurcations   points where another path crosses
    events         equilibria where the functions passed through zero: ``path.events[event]`` or by name
    ended          why the path ended before it was asked to, or ""
    """

    scene: Scene
    loading: Loading
    factor: Array
    q: Array
    multipliers: Array
    unstable: Array
    limits: list[Equilibrium]
    bifurcations: list[Bifurcation]
    events: Mapping[Any, list[Equilibrium]]
    ended: str

    def __repr__(self) -> str:
        return f"<path: {len(self.factor)} points, {len(self.limits)} limit points, {len(self.bifurcations)} bifurcations>"

    def __len__(self) -> int:
        return len(self.factor)

    def __getitem__(self, k: int) -> Equilibrium:
        """The k-th point."""
        return on_path(self.scene, self.loading, self.factor[k], self.q[k], self.multipliers[k], self.unstable[k])

    @cached_property
    def stable(self) -> Array:
        """[k]: whether no motion lowers the energy."""
        return self.unstable == 0

    def position(self, marker: Marker) -> Array:
        """[k, d] [m]."""
        return marker.point.value(self.q)

    def reaction(self, joint: Any) -> Array:
        """[k, 3] or [k, 6], as of ``Equilibrium.reaction``."""
        rows = [i for i, (item, _) in enumerate(self.loading.system.joints.labels) if item == joint.name]
        return reaction(joint, joint.pose(self.loading.system.q0), self.q, self.multipliers[:, rows])
