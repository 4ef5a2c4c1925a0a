"""The one linear system of all solvers, the KKT matrix

    [ cM M + cD D + cK K    G' ] [ x ]   [ top    ]
    [ G                     0  ] [ y ] = [ bottom ]

in scaled unknowns: coordinates by the root of their mass, equations by the size of their row in these units, multipliers by |cM|, so
that pivots are chosen among comparable numbers whatever the units. A reciprocal condition number is estimated after every
factorisation. With redundant joints the lower right block is -softening (tiny): the multipliers of least norm among all equal ones;
Newton's iterations and ``refined`` remove its trace from the solution.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from math import isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .equilibration import alike, moved_with
from .formats import Format, Singular, Solve, cheapest
from .ordering import half_bandwidth, reverse_cuthill_mckee
from .system import Array, Index, System

SINGULAR = 1e-15
FAIR = 1e-12
"""Reciprocal condition, in units that make a matrix' own entries alike, from which on its solutions are right to three digits at least."""

SOFTENING = 1e-7

MASSLESS = 1e-16
"""Inertia below this share of the typical one is none: scaled by its root, the equations that hold it would look dependent."""

UNEVEN = 1e4
"""The ratio of inertias from which on what they move with decides over scales, not they alone."""

TURNED = 0.1
"""Share of an equation's largest slope that its others count with at least where they change: a turn may make them as large."""

TURN = 0.01
"""The largest angle [rad] that a tolerance may mean for a rigid body."""


class Tangent(NamedTuple):
    """Assembled buffers at one configuration: K, D (None: no damping), G with G'."""

    stiffness: Array | None
    damping: Array | None
    gradient: Array


class Linear:
    """Patterns, scales and the format of a system's KKT matrices, prepared once. ``order`` [n + m] lists unknowns as the format has them, ``place``
    says where each went, ``below`` which are multipliers.

    ``reach`` [m] turns a residual of an equation into a length: how far its most effective coordinate would have to move. ``origin`` [n] is
    a configuration on the joints; who corrects the one given here says so. ``constant_factor`` is kept where G never changes. ``coarsest`` is the
    largest tolerance [m] that means something: one that turns the smallest rigid body by TURN. In a long chain a share of the whole is more than
    a link, and steps that leave links anywhere fail. Where a continuum couples coordinates by its mass there is no such limit.
    """

    def __init__(self, system: System, q: Array):
        n, m = system.n, system.m
        self.n, self.size, self.origin = n, n + m, q
        joints = system.joints
        top, left = joints.rows + n, joints.cols
        corner, rolling = n + np.arange(m), _rolling(system)
        rows, cols = _entries(system)
        order = reverse_cuthill_mckee(rows, cols, self.size)
        self.format: Format = cheapest(self.size, half_bandwidth(rows, cols, order), rows, cols)
        self.order = order if self.format.name == "band" else np.arange(self.size)
        self.place = np.argsort(self.order)
        self._entries = partial(_entries, system)
        self.below = self.order >= n
        self._together = np.concatenate((system.vectors, n + np.arange(m)))[self.order]
        self.scale = self._scales(system, q)
        self.into = self.scale[self.order]
        k = np.arange(self.size)
        self._rising = (1.0 - 2.0 * (k % 2)) * (1.0 + k / max(self.size - 1, 1))
        self.softened = False
        self.factorizations = 0
        self.constant_factor: Factor | None = None
        self.coarsest = TURN * system.arm if np.array_equal(system.mass_rows, system.mass_cols) else np.inf
        self._mass_slots, self._mass_scale = self._slots(system.mass_rows, system.mass_cols)
        self._stiffness_slots, self._stiffness_scale = self._slots(system.stiffness_rows, system.stiffness_cols)
        self._gradient_slots, self._gradient_scale = self._slots(top, left)
        self._both_slots = np.concatenate((self._gradient_slots, self._slots(left, top)[0]))
        self._corner = self._slots(corner, corner)[0]
        self._slips, self._rows, self._rolling = joints.slips, joints.rows, self._slots(rolling, rolling)[0]
        self._damping_slots, self._damping_scale = self._slots(system.damping_rows, system.damping_cols)
        self.mass = self._fill(self._mass_slots, self._mass_scale * system.mass_values)
        self._constant_gradient = self._gradient(joints.at(q).gradient) if joints.linear else None

    def _scales(self, system: System, q: Array) -> Array:
        """[n + m]: what a unit of each scaled unknown is in the user's units."""
        diagonal = np.zeros(self.n)
        own = system.mass_rows == system.mass_cols
        diagonal[system.mass_rows[own]] = system.mass_values[own]
        levers = np.where(system.levers > 0.0, system.levers, np.where(system.lengths, 1.0, system.length))
        typical = diagonal.sum() / np.sum(levers[diagonal > 0.0] ** 2) if diagonal.any() else 1.0
        coordinates = 1.0 / np.sqrt(np.where(diagonal > MASSLESS * typical * levers**2, diagonal, typical * levers**2))
        rows, cols, gradient = system.joints.rows, system.joints.cols, system.joints.at(q).gradient
        effect = np.zeros(system.m)
        np.maximum.at(effect, rows, np.abs(gradient) / levers[cols])
        self.reach = 1.0 / np.where(effect > 0.0, effect, 1.0)
        inertias = diagonal[diagonal > 0.0] / levers[diagonal > 0.0] ** 2
        if inertias.max(initial=0.0) > UNEVEN * inertias.min(initial=np.inf):
            turned = np.where(system.joints.constant_rows, 0.0, TURNED)[rows] * effect[rows] * levers[cols]
            found = moved_with(diagonal, rows, cols, np.maximum(np.abs(gradient), turned), system.m)
            coordinates = coordinates if found is None else found
        size = np.bincount(rows, (gradient * coordinates[cols]) ** 2, minlength=system.m)
        equations = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
        return np.concatenate((coordinates, equations))

    def _slots(self, rows: Index, cols: Index) -> tuple[Index, Array]:
        return self.format.slot(self.place[rows], self.place[cols]), self.scale[rows] * self.scale[cols]

    def _fill(self, slots: Index, values: Array) -> Array:
        return np.bincount(slots, values, minlength=self.format.slots)  # type: ignore[return-value]

    def tangent(self, gradient: Array, stiffness: Array | None = None, damping: Array | None = None) -> Tangent:
        """Buffers from the system's values of G, K and D at one configuration."""
        return Tangent(
            None if stiffness is None else self._fill(self._stiffness_slots, self._stiffness_scale * stiffness),
            None if damping is None else self._fill(self._damping_slots, self._damping_scale * damping),
            self._constant_gradient if self._constant_gradient is not None else self._gradient(gradient),
        )

    def tangent_of_positions(self, gradient: Array) -> Tangent:
        """The same of G alone, without nonholonomic rows: their multipliers are zero, and coordinates without mass that they move stay."""
        if not self._slips.size:
            return self.tangent(gradient)
        filled = self._gradient(np.where(np.isin(self._rows, self._slips), 0.0, gradient))
        filled[self._corner[self._slips]] -= 1.0
        filled[self._rolling] += 1.0
        return Tangent(None, None, filled)

    def _gradient(self, values: Array) -> Array:
        scaled = self._gradient_scale * values
        return self._fill(self._both_slots, np.concatenate((scaled, scaled)))

    def factor(
        self, tangent: Tangent, c_mass: complex = 1.0, c_damping: complex = 0.0, c_stiffness: float = 0.0, *, least: float = SINGULAR
    ) -> Factor:
        """The factorised KKT matrix; raises Singular unless its reciprocal condition is above ``least``; 0: it is not estimated."""
        size = abs(c_mass)
        rest = self._without_rates(tangent, size, c_stiffness)
        return self.factorised(lambda: (self._filled(tangent, rest, c_mass, c_damping), size), least)

    def factors(self, tangent: Tangent, rates: Sequence[complex]) -> list[Factor]:
        """The factorised matrices of z^2 M + z D + K for rates z of about one size, that of the first being the ``weight`` of all. Only its
        condition is estimated: where it is regular so are the others, of a symmetric K none of its vibrations or instabilities has a rate off
        both axes. Raises Singular."""
        size = abs(rates[0]) ** 2
        rest = self._without_rates(tangent, size, 1.0)
        fills = [partial(self._filled, tangent, rest, z * z, z) for z in rates]
        return [self.factorised(lambda fill=fill: (fill(), size), 0.0 if k else SINGULAR) for k, fill in enumerate(fills)]  # type: ignore[misc]

    def _without_rates(self, tangent: Tangent, size: float, c_stiffness: float) -> Array:
        """The part of the matrix that has neither M nor D, for multipliers in units of a size."""
        rest = size * tangent.gradient
        if c_stiffness and tangent.stiffness is not None:
            rest += c_stiffness * tangent.stiffness
        if self.softened:
            rest[self._corner] -= SOFTENING * size
        return rest

    def _filled(self, tangent: Tangent, rest: Array, c_mass: complex, c_damping: complex) -> NDArray:
        buffer: NDArray = c_mass * self.mass
        real = buffer.real  # of a complex buffer a view: adding to it takes half the time
        real += rest
        if c_damping and tangent.damping is not None:
            buffer += c_damping * tangent.damping
        return buffer

    def factorised(self, filled: Callable[[], tuple[NDArray, float]], least: float) -> Factor:
        """A buffer, which ``filled`` gives anew, with its size, whenever it is called, factorised; raises Singular unless its reciprocal
        condition is above ``least``, or above FAIR in units of its own; 0: it is not estimated.

        In units in which masses are 1 a short element of a beam may be stiffer than rounding leaves the others, though it takes no part in
        their motions. Before a matrix is refused it is judged in units that make its own entries alike."""
        buffer, size = filled()
        norm = self.format.norm(buffer) if least else 0.0
        self.factorizations += 1
        solve = self.format.factor(buffer)
        if not least:
            return Factor(self, solve, size, np.nan)
        rcond = self._reciprocal_condition(norm, solve)
        if not rcond > least and not self._fair_condition(filled()[0], solve) > FAIR:
            raise Singular(f"reciprocal condition {rcond:.1e}")
        return Factor(self, solve, size, rcond)

    def _fair_condition(self, buffer: NDArray, solve: Solve) -> float:
        """The reciprocal condition in units that make the entries alike."""
        rows, cols, slots = self.pattern
        sizes = np.abs(buffer[slots])
        units = alike(rows, cols, sizes, self._together)
        if units is None:
            return 0.0
        norm = float(np.max(np.bincount(cols, units[rows] * sizes * units[cols])))
        return self._reciprocal_condition(norm, lambda right: solve(right / units) / units)

    def _reciprocal_condition(self, norm: float, solve: Solve) -> float:
        """1 / (|A| |A^-1|) in the 1-norm, with |A^-1| estimated from below by the growth of one vector of alternating signs and rising
        size (Higham 1988, ACM Trans. Math. Softw. 14, algorithm 4.1, the safeguard): singular matrices show in it whatever their kernel."""
        growth = float(np.abs(solve(self._rising.copy())).sum()) / (1.5 * self.size)
        return 1.0 / (norm * growth) if norm * growth > 0.0 and isfinite(growth) else 0.0

    @cached_property
    def pattern(self) -> tuple[Index, Index, Index]:
        """Rows and columns, in the order of the format, of all entries, each once, and their slots."""
        rows, cols = self._entries()  # seldom asked for, and as large as the matrices: not kept
        keys = np.unique(self.place[cols] * self.size + self.place[rows])
        rows, cols = keys % self.size, keys // self.size
        return rows, cols, self.format.slot(rows, cols)

    def enter(self, top: Array, bottom: Array) -> Array:
        """Right sides [..., n] and [..., m] in scaled, ordered unknowns [..., size]."""
        return np.concatenate((top, bottom), axis=-1).take(self.order, axis=-1) * self.into

    def leave(self, x: Array) -> tuple[Array, Array]:
        """Solutions [..., n] and [..., m] from scaled, ordered unknowns [..., size]."""
        natural = x.take(self.place, axis=-1) * self.scale
        return natural[..., : self.n], natural[..., self.n :]

    def __getstate__(self) -> dict[str, Any]:
        """Without the factor that is kept: it is found again where it is asked for."""
        return vars(self) | {"constant_factor": None}

    def soften(self) -> None:
        """From now on, redundant equations are allowed."""
        self.softened, self.constant_factor = True, None


class Factor:
    """A factorised KKT matrix."""

    def __init__(self, linear: Linear, solve: Solve, size: float, rcond: float):
        self.linear, self.raw, self.size, self.rcond = linear, solve, size, rcond

    @cached_property
    def weight(self) -> Array:
        """[size]: what scaled, ordered unknowns are multiplied by before and after: multipliers are in units of |c_mass|."""
        return np.where(self.linear.below, self.size, 1.0)

    def solve(self, top: Array, bottom: Array) -> tuple[Array, Array]:
        """x [..., n], y [..., m] from right sides top [..., n], bottom [..., m]."""
        right = self.linear.enter(top, bottom)
        flat = right.reshape(-1, right.shape[-1])
        x = self.solve_scaled(flat if len(flat) > 1 else flat[0])
        return self.linear.leave(x.reshape(right.shape))

    def solve_scaled(self, right: NDArray) -> NDArray:
        """The solution in scaled unknowns [size] or [k, size], from ``linear.enter`` and for ``linear.leave``."""
        return self.raw((right * self.weight).T).T * self.weight


def _rolling(system: System) -> Index:
    """Coordinates without mass that nonholonomic rows move: while these rows are left out, the diagonal holds them."""
    joints = system.joints
    return np.setdiff1d(joints.cols[np.isin(joints.rows, joints.slips)], system.mass_rows)


def _entries(system: System) -> tuple[Index, Index]:
    """Rows and columns of all entries of the KKT matrix; some are there several times."""
    top, left, corner, rolling = system.joints.rows + system.n, system.joints.cols, system.n + np.arange(system.m), _rolling(system)
    return (
        np.concatenate((system.mass_rows, system.stiffness_rows, system.damping_rows, top, left, corner, rolling)),
        np.concatenate((system.mass_cols, system.stiffness_cols, system.damping_cols, left, top, corner, rolling)),
    )
