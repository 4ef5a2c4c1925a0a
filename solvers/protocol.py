"""What integrators and the time loop say to each other.

An integrator's ``step`` is pure: state in, attempt out. Rejecting, retrying, halving and restarting need no code in it.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

from .linear import Linear
from .system import Array, System


class State(NamedTuple):
    """Where a run is: time, q [n], v [n], multipliers [m], stresses [n_stresses], and what the integrator remembers of the last step.

    ``method``: of an integrator that has several, the number of the one that took the step.
    """

    t: float
    q: Array
    v: Array
    multipliers: Array
    stress: Array
    memory: Any = None
    method: int = 0


class Attempt(NamedTuple):
    """The outcome of one step.

    state        at the end, or None where the iteration failed
    error        estimated local error over tolerance (accept below 1; 0 for methods of fixed step)
    order        the power of h that the error follows
    rate         Newton's contraction: the largest ratio of successive changes
    solves       Newton iterations spent
    failure      what went wrong, or ""
    worst        the equation with the largest residual (an index into the rows), -1 where none is to blame
    nodes        times [s], q [s, n], v [s, n] and weights [s] of the step's own quadrature
    multipliers  [s, m] at the nodes, for the work of drives
    inputs       of the system at the nodes, where the method has them at hand
    """

    state: State | None
    error: float
    order: float
    rate: float
    solves: int
    failure: str = ""
    worst: int = -1
    nodes: tuple[Array, Array, Array, Array] | None = None
    multipliers: Array | None = None
    inputs: Any = None


class Integrator(Protocol):
    """A method of integration; ``fixed`` is its step where the user gave one."""

    name: str
    fixed: float | None

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt: ...
    def kept(self, memory: Any) -> Any: ...  # what a stored state still needs of its memory to be interpolated
    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float: ...
    def inside(self, system: System, linear: Linear, before: State, after: State, t: Array) -> tuple[Array, Array]: ...
