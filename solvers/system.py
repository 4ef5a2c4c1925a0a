"""What a solver needs to know of a system, as protocols.

    M dv/dt = load(q, v, t) - B(q)' sigma - G(q)' lambda,   sigma = C strain(q) + eta d(strain)/dt,   0 = g(q, t) = gamma(q) - c(t)

q, v [..., n], lambda [..., m], sigma [..., n_stresses] with any leading axes; C (``modulus``) and eta (``viscosity``, None where
nothing damps) are diagonal. Matrices come as values on constant patterns: M and K on n x n, G on m x n.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class Targets(Protocol):
    """c, c' and c'' [..., m], or anything that broadcasts to it, at the times of the inputs."""

    @property
    def value(self) -> Array: ...
    @property
    def rate(self) -> Array: ...
    @property
    def acceleration(self) -> Array: ...


class Still:
    """The targets of a system that nothing drives."""

    value = rate = acceleration = np.zeros(1)


STILL = Still()


def targets(inputs: Any) -> Targets:
    """What drives follow, of a system's inputs; None are those of a system without any."""
    return STILL if inputs is None else inputs.targets


class JointsAt(Protocol):
    """The equations at configurations [...]: ``value`` is gamma, ``bias`` v' d2(gamma)/dq2 v."""

    @property
    def gradient(self) -> Array: ...
    @property
    def value(self) -> Array: ...
    def pull(self, multipliers: Array) -> Array: ...
    def push(self, v: Array) -> Array: ...
    def swirl(self, v: Array) -> Array: ...
    def bias(self, v: Array) -> Array: ...


class Joints(Protocol):
    """The equations gamma(q) = c(t) [m].

    ``linear``: G is constant and nothing is driven: g = 0 then implies G v = 0. ``quadratic``: all rows are, at most; ``constant_rows``
    [m] those whose part of G is constant and that nothing drives. ``slips``: the numbers of nonholonomic rows, which hold for velocities
    only; their gamma is 0, and their part of G is the gradient of nothing.
    """

    m: int
    rows: Index
    cols: Index
    linear: bool
    quadratic: bool
    slips: Index
    to_rows: Callable[[Array], Array]

    @property
    def constant_rows(self) -> NDArray[np.bool_]: ...
    def at(self, q: Array) -> JointsAt: ...


class Strains(Protocol):
    """The elastic measures at configurations [...]."""

    @property
    def value(self) -> Array: ...
    def pull(self, stress: Array) -> Array: ...
    def push(self, change: Array) -> Array: ...
    def swirl_times(self, v: Array, change: Array) -> Array: ...
    def frozen(self) -> Any: ...


class System(Protocol):
    """A mechanical system; see the module's equations.

    ``affine``: loads are constant in time and linear in q alone. ``driven``: c depends on time. ``damped``: something is viscous, or loads
    depend on velocities. ``onsets``: some strains set in, with slopes that are zero before. ``arm``: the smallest lever [m] of a slope or axis.
    ``vectors`` [n]: components of one vector have the same number, of 0 ... n - 1.
    """

    n: int
    m: int
    n_stresses: int
    length: float
    levers: Array
    lengths: NDArray[np.bool_]
    arm: float
    vectors: Index
    modulus: Array
    viscosity: Array | None
    affine: bool
    damped: bool
    onsets: bool
    driven: bool
    joints: Any
    mass_rows: Index
    mass_cols: Index
    mass_values: Array
    stiffness_rows: Index
    stiffness_cols: Index
    damping_rows: Index
    damping_cols: Index

    def mass(self, x: Array) -> Array: ...
    def inputs(self, t: Any) -> Any: ...
    def strains(self, q: Array) -> Any: ...
    def load(self, q: Array, v: Array, inputs: Any) -> Array: ...
    def force(self, q: Array, v: Array, inputs: Any) -> Array: ...
    def stress(self, strains: Any, v: Array) -> Array: ...
    def stiffness(self, q: Array, v: Array, inputs: Any, stress: Array, multipliers: Array, *, strains: Any = None, joints: Any = None) -> Array: ...
    def damping(self, q: Array, v: Array, inputs: Any) -> Array: ...
    def label(self, row: int) -> str: ...
    def coordinate(self, index: int) -> str: ...
