"""The motion of a small system in the coordinates that its linear equations leave: q = q0 + N z.

Pins in the plane, balls, points on lines: equations of constant gradient hold for every z, and need no multipliers while the motion is
computed. N spans what they leave free, N' M N = 1. What remains are the quadratic rows, with z and its rate u in one product each:

    G(z) = G0 + H z,     W = H u,     g = (G0 + G) z / 2 + g0,     (G G') lambda = G f + W u - c'',     a = f - G' lambda

H, dense, is symmetric in its two places for coordinates. Its size sets how large a system may be.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cholesky, lapack, qr, solve_triangular

from .formats import Singular
from .linear import Linear
from .start import REDUNDANT, floor_of, settle
from .system import Array, Index, System, targets

LARGEST = 2**15
"""Entries of H up to which dense products are faster than sparse ones."""

NEARLY_SINGULAR = 1e-4
"""Share of an equation's slope, squared, that those before it leave: below it multipliers are no longer trusted."""

WEIGHTLESS = 1e-12
"""Share of the largest inertia of a free coordinate, in scaled unknowns, below which another has none."""

MANY = 100
"""Equations above which that share is the smaller, the more they are."""


def reduced(system: System, linear: Linear) -> Reduced | None:
    """The reduced form of a system; None where it has none or would be too large."""
    joints = system.joints
    if linear.softened or not joints.quadratic:
        return None
    constant = joints.constant_rows
    kept = np.flatnonzero(~constant)
    free = system.n - (system.m - kept.size)
    if max(kept.size, 1) * free**2 > LARGEST or system.n > 4 * free + 40:
        return None
    basis = _basis(system, linear, _dense(system, joints.at(linear.origin).gradient)[constant])
    return None if basis is None else Reduced(system, linear, basis, kept)


def _basis(system: System, linear: Linear, gradient: Array) -> Array | None:
    """N [n, k] for constant rows of G; None where nothing stays free, or coordinates without inertia."""
    scale = linear.scale[: system.n]
    directions, upper, order = qr((gradient * scale).T, pivoting=True)
    pivots = np.abs(upper.diagonal())
    rank = int(np.sum(pivots > REDUNDANT * pivots.max(initial=0.0)))
    if rank == system.n:
        return None
    free = np.ascontiguousarray((directions[:, rank:] * scale[:, None]).T)
    try:
        root = cholesky(system.mass(free) @ free.T, lower=True)
    except LinAlgError:
        return None
    pivots = root.diagonal()  # where there is no inertia rounding may be positive
    if pivots.min(initial=np.inf) ** 2 < WEIGHTLESS * pivots.max(initial=0.0) ** 2:
        return None
    basis = _apart(system, solve_triangular(root, free, lower=True).T)
    over = solve_triangular(upper[:rank, :rank], (gradient @ basis)[order[:rank]], trans="T")
    return basis - scale[:, None] * (directions[:, :rank] @ over)  # what is light has to follow to its own rounding, not to that of what is heavy


def _apart(system: System, basis: Array) -> Array:
    """The same span, and N' M N = 1, with columns in the order of how far they move: light motions are not left over from heavy ones."""
    return basis @ np.linalg.svd(system.levers[:, None] * basis, full_matrices=False)[2].T


def _dense(system: System, values: Array) -> Array:
    """G [..., m, n] of its values [..., nnz]."""
    out = np.zeros((*values.shape[:-1], system.m, system.n))
    out[..., system.joints.rows, system.joints.cols] = values
    return out


class Reduced:
    """A system for states w [2, k + 1], rows (z, 1) and (u, 0): the constant beside z makes all of G one product."""

    def __init__(self, system: System, linear: Linear, basis: Array, kept: Index):
        q = linear.origin
        self.origin, self.basis, self.kept = q, basis, kept
        self.k, self.m, self.rows = basis.shape[1], kept.size, system.m
        self.shape = (2, self.k + 1)
        self._across = np.ascontiguousarray(basis.T)
        self._into = system.mass(self._across).T
        self._levers = self._across * system.levers
        self._reach = linear.reach[kept]
        self._floor = floor_of(system, q)
        joints = system.joints.at(q)
        self._gap = joints.value[kept]
        self._first, turning = np.zeros((0, self.k)), np.zeros((self.k, 0, self.k))
        if kept.size:
            self._first = _dense(system, joints.gradient)[kept] @ basis
            turning = _dense(system, joints.swirl(self._across))[:, kept] @ basis
        self._tensor = np.concatenate((turning.reshape(self.k, self.m * self.k), self._first.reshape(1, self.m * self.k)))
        self._load = self._affine_load(system, q) if system.affine else None

    def _affine_load(self, system: System, q: Array) -> Array:
        """[k + 1, k]: the load of (z, 1)."""
        inputs, nowhere = system.inputs(0.0), np.zeros(system.n)
        slope = np.broadcast_to(system.load(self._across, nowhere, inputs) - system.load(nowhere, nowhere, inputs), self._across.shape)
        return np.concatenate((slope, (nowhere + system.load(q, nowhere, inputs))[None])) @ self.basis

    def enter(self, q: Array, v: Array) -> Array:
        """w of q, v on the joints."""
        w = np.zeros(self.shape)
        w[0, :-1], w[1, :-1], w[0, -1] = (q - self.origin) @ self._into, v @ self._into, 1.0
        return w

    def leave(self, w: Array) -> tuple[Array, Array]:
        """q, v [..., n] of w [..., 2, k + 1]."""
        x = w[..., :-1] @ self._across
        return self.origin + x[..., 0, :], x[..., 1, :]

    def lengths(self, dw: Array) -> Array:
        """[..., 2]: the largest changes of positions [m] and of velocities [m/s] that dw [..., 2, k + 1] stands for."""
        return np.abs(dw[..., :-1] @ self._levers).max(axis=-1)

    def all_rows(self, multipliers: Array) -> Array:
        """[..., rows] of those of the quadratic rows; zero for the others, which no motion needs."""
        out = np.zeros((*multipliers.shape[:-1], self.rows))
        out[..., self.kept] = multipliers
        return out

    def rates(self, system: System, w: Array, t: float, out: Array) -> Array:
        """dw/dt into ``out``; returns the multipliers [m] of the quadratic rows. Raises Singular where these nearly depend on each other."""
        gradient, turning = (w @ self._tensor).reshape(2, self.m, self.k)
        factor = _factor(gradient)
        return self._finish(system, w, t, gradient, turning, factor, out)

    def land(self, system: System, w: Array, t: float, out: Array) -> Array:
        """Moves w to the joints, in place, and goes on as ``rates``; raises Inconsistent where it finds none near."""
        goal, speed = self._goals(system, t)
        start = self._gradient(w[0])
        near = _factor(start)
        w[0, :-1] = settle(w[0, :-1], lambda z: self._gap_at(z) - goal, lambda gap: _solve(near, gap) @ start, self._reach, self._floor)
        gradient = self._gradient(w[0])
        factor = _factor(gradient)
        w[1, :-1] -= _solve(factor, gradient @ w[1, :-1] - speed) @ gradient
        turning = self._gradient(w[1])
        return self._finish(system, w, t, gradient, turning, factor, out)

    def _goals(self, system: System, t: float) -> tuple[Array | float, Array | float]:
        """c and c' of the quadratic rows."""
        if not system.driven:
            return 0.0, 0.0
        goal = targets(system.inputs(t))
        return goal.value[self.kept], goal.rate[self.kept]

    def _gradient(self, z: Array) -> Array:
        return (z @ self._tensor).reshape(self.m, self.k)

    def _gap_at(self, z: Array) -> Array:
        half = 0.5 * (z @ self._tensor[:-1]).reshape(self.m, self.k)
        return (half + self._first) @ z + self._gap

    def _finish(self, system: System, w: Array, t: float, gradient: Array, turning: Array, factor: Array, out: Array) -> Array:
        force = self._force(system, w, t)
        right = gradient @ force + turning @ w[1, :-1]
        if system.driven:
            right -= targets(system.inputs(t)).acceleration[self.kept]
        multipliers = _solve(factor, right)
        out[0], out[1, :-1], out[1, -1] = w[1], force - multipliers @ gradient, 0.0
        return multipliers

    def _force(self, system: System, w: Array, t: float) -> Array:
        """Loads and stresses [k]."""
        if self._load is None:
            return system.force(*self.leave(w), system.inputs(t)) @ self.basis
        force = w[0] @ self._load
        if system.n_stresses:
            q, v = self.leave(w)
            strains = system.strains(q)
            force -= strains.pull(system.stress(strains, v)) @ self.basis
        return force


def _factor(gradient: Array) -> Array:
    """Cholesky factor of G G'; raises Singular."""
    if not len(gradient):
        return np.zeros((0, 0))
    square = gradient @ gradient.T
    sizes = square.diagonal().tolist()
    factor, info = lapack.dpotrf(square, lower=1, clean=0, overwrite_a=1)
    if info or not independent(factor.diagonal().tolist(), sizes):
        raise Singular("joints in a nearly singular position")
    return factor


def independent(pivots: list[float], sizes: list[float]) -> bool:
    """Whether no equation nearly follows from those before it: pivots of the Cholesky factor of a matrix with this diagonal.

    In a long chain the last equation keeps no more than one part in its number."""
    least = NEARLY_SINGULAR * min(1.0, MANY / len(pivots))
    return all(pivot * pivot > least * size for pivot, size in zip(pivots, sizes))


def _solve(factor: Array, right: Array) -> Array:
    return lapack.dpotrs(factor, right, lower=1)[0] if len(right) else right
