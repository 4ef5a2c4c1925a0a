"""The motion of a small system in the coordinates that its linear equations leave: q = q0 + N z.

Pins in the plane, balls, points on lines: equations of constant gradient hold for every z, and need no multipliers while the motion is
computed. N spans what they leave free, N' M N = 1. What remains are the quadratic rows, with z and its rate u in one product each:

    G(z) = G0 + H z,     W = H u,     g = (G0 + G) z / 2 + g0,     (G G') lambda = G f + W u - c'',     a = f - G' lambda

H, dense, is symmetric in its two places for coordinates. Its size sets how large a system may be.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, cholesky, qr, solve_triangular

from .linear import Linear
from .places import Places
from .start import REDUNDANT, floor_of
from .system import Array, Index, System, targets

LARGEST = 2**15
"""Entries of H up to which dense products are faster than sparse ones."""

WEIGHTLESS = 1e-12
"""Share of the largest inertia of a free coordinate, in scaled unknowns, below which another has none."""


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
        self.width = self.k + 1
        self._across = np.ascontiguousarray(basis.T)
        self._into = system.mass(self._across).T
        self._levers = np.concatenate((self._across * system.levers, np.zeros((1, system.n))))
        self.reach = linear.reach[kept]
        self.floor = floor_of(system, q)
        joints = system.joints.at(q)
        self._gap = joints.value[kept]
        self._first, turning = np.zeros((0, self.k)), np.zeros((self.k, 0, self.k))
        if kept.size:
            self._first = _dense(system, joints.gradient)[kept] @ basis
            turning = _dense(system, joints.swirl(self._across))[:, kept] @ basis
        self._half, self.affine = 0.5 * turning.reshape(self.k, -1), system.affine
        load = self._affine_load(system, q) if system.affine else np.zeros((self.k + 1, self.k))
        rows = np.concatenate((turning, self._first[None]))
        self.tensor = -np.concatenate((load[:, None], rows), axis=1).reshape(self.k + 1, -1)

    def _affine_load(self, system: System, q: Array) -> Array:
        """[k + 1, k]: the load of (z, 1)."""
        inputs, nowhere = system.inputs(0.0), np.zeros(system.n)
        slope = np.broadcast_to(system.load(self._across, nowhere, inputs) - system.load(nowhere, nowhere, inputs), self._across.shape)
        return np.concatenate((slope, (nowhere + system.load(q, nowhere, inputs))[None])) @ self.basis

    def enter(self, q: Array, v: Array) -> Array:
        """w of q, v on the joints."""
        w = np.zeros((2, self.width))
        w[0, :-1], w[1, :-1], w[0, -1] = (q - self.origin) @ self._into, v @ self._into, 1.0
        return w

    def leave(self, w: Array) -> tuple[Array, Array]:
        """q, v [..., n] of w [..., 2, k + 1]."""
        x = w[..., :-1] @ self._across
        return self.origin + x[..., 0, :], x[..., 1, :]

    def lengths(self, rows: Array) -> Array:
        """[...]: the largest change of position [m] that each of the rows [..., k + 1] stands for."""
        return np.maximum.reduce(np.abs(rows.dot(self._levers)), axis=-1)

    def all_rows(self, multipliers: Array) -> Array:
        """[..., rows] of those of the quadratic rows; zero for the others, which no motion needs."""
        out = np.zeros((*multipliers.shape[:-1], self.rows))
        out[..., self.kept] = multipliers
        return out

    def places(self, w: Array, accelerations: Array) -> Places:
        return Places(self, w, accelerations)

    def goals(self, system: System, t: float) -> tuple[Array | float, Array | float]:
        """c and c' of the quadratic rows."""
        if not system.driven:
            return 0.0, 0.0
        goal = targets(system.inputs(t))
        return goal.value[self.kept], goal.rate[self.kept]

    def gap(self, z: Array) -> Array:
        """g of the quadratic rows [m], without what they follow."""
        half = z.dot(self._half).reshape(self.m, self.k)
        half += self._first
        return half.dot(z) + self._gap

    def force(self, system: System, w: Array, inputs: Any) -> Array:
        """Loads that are not affine, and stresses [k]."""
        q, v = self.leave(w)
        if not self.affine:
            return system.force(q, v, inputs) @ self.basis
        strains = system.strains(q)
        return -strains.pull(system.stress(strains, v)) @ self.basis
