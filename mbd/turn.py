"""Turning angles as coordinates: phi follows the angle of an axis p between two axes c (ahead) and s (across), turns counted.

    g = sin(phi) C - cos(phi) S = 0,   C = p . c,  S = p . s        (g = |p| |c| sin(phi - angle))

In the plane s = i c. In space c and s turn with one body and p with another, all perpendicular to a common axis of rotation at phi = 0.
C and S are quadratic rows themselves, and g = Re w with w = exp(-i phi) (-S + i C), of which dw/dphi = -i w. phi is a coordinate without
mass, so that the kernels keep no state and a spring, a motor or a gear sees an angle that grows over many turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array
from .constraint import At, Quadratic
from .rows import dot
from .sums import sums


class Turning(NamedTuple):
    """One angle: the axes p, c and s, and the index of phi. c and s have one length, and phi = 0 where p points along c."""

    moving: Affine
    ahead: Affine
    across: Affine
    phi: int

    def rate(self, q: Array, v: Array) -> float:
        """dphi/dt [rad/s] where phi = 0, from q, v [n]."""
        moving, ahead, across = (axis.value(q) for axis in self[:3])
        return float((self.moving.rate(v) @ across + moving @ self.across.rate(v)) / (moving @ ahead))


class _Posture(NamedTuple):
    """At q [..., n]: exp(i phi) and w [..., m], and what the inner rows take."""

    unit: NDArray[np.complex128]
    w: NDArray[np.complex128]
    at: At

    @property
    def weights(self) -> Array:
        """Of the inner rows in g [..., 2 m]."""
        return self.unit.view(float)

    @property
    def rates(self) -> Array:
        """Of the inner rows in dg/dphi [..., 2 m]."""
        return (1j * self.unit).view(float)


class Turn:
    """The rows [m] of all turning angles. The inner rows are -S and C of each in turn, seen as one complex number."""

    linear = False

    def __init__(self, turns: Sequence[Turning], n: int):
        self.m = len(turns)
        pairs = [(dot(t.moving, t.across, factor=-1.0), dot(t.moving, t.ahead)) for t in turns]
        self.inner = inner = Quadratic([row for pair in pairs for row in pair], n)
        self.phi = phi = np.array([t.phi for t in turns], dtype=np.intp) % n
        self.owner = inner.rows // 2
        self.rows = np.concatenate((self.owner, np.arange(self.m)))
        self.cols = np.concatenate((inner.cols, phi))
        self._sum = sums(self.owner, self.m)
        self.curvature_rows = np.concatenate((inner.curvature_rows, inner.cols, phi[self.owner], phi))
        self.curvature_cols = np.concatenate((inner.curvature_cols, phi[self.owner], inner.cols, phi))

    def prepare(self, q: Array) -> _Posture:
        phi, at = q.take(self.phi, axis=-1), self.inner.prepare(q)
        unit = np.empty(phi.shape, complex)
        np.cos(phi, unit.real)
        np.sin(phi, unit.imag)
        return _Posture(unit, unit.conj() * self.inner.value(at).view(complex), at)

    def _turning(self, values: Array, v: Array) -> Array:
        """The products [..., m] of v with rows of these values on the inner pattern."""
        return self._sum(values * v.take(self.inner.cols, axis=-1))

    def value(self, p: _Posture) -> Array:
        return p.w.real

    def gradient(self, p: _Posture) -> Array:
        return np.concatenate((self.inner.weighted(p.at, p.weights), p.w.imag), axis=-1)

    def swirl(self, p: _Posture, v: Array) -> Array:
        rate, cross_term = v.take(self.phi, axis=-1), self.inner.weighted(p.at, p.rates)
        along = rate.take(self.owner, axis=-1) * cross_term
        if not self.inner.linear:
            along += p.weights.take(self.inner.rows, axis=-1) * self.inner.swirl(p.at, v)
        return np.concatenate((along, self._turning(cross_term, v) - rate * p.w.real), axis=-1)

    def bias(self, p: _Posture, v: Array) -> Array:
        rate, cross_term = v.take(self.phi, axis=-1), self._turning(self.inner.weighted(p.at, p.rates), v)
        return (p.unit.conj() * self.inner.bias(p.at, v).view(complex)).real + 2.0 * rate * cross_term - rate**2 * p.w.real

    def curvature(self, p: _Posture, multipliers: Array) -> Array:
        along = self.inner.curvature(p.at, (p.unit * multipliers).view(float))
        cross_term = self.inner.weighted(p.at, p.rates) * multipliers.take(self.owner, axis=-1)
        return np.concatenate((along, cross_term, cross_term, -multipliers * p.w.real), axis=-1)
