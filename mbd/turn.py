"""Turning angles as coordinates: phi follows the angle of an axis p between two axes c (ahead) and s (across), turns counted.

    g = sin(phi) C - cos(phi) S = 0,   C = p . c,  S = p . s        (g = |p| |c| sin(phi - angle))

In the plane s = i c. In space c and s turn with one body and p with another, all perpendicular to a common axis of rotation at phi = 0.
C and S are quadratic rows themselves, and g = Im w with w = exp(i phi) (C - i S), of which dw/dphi = i w. phi is a coordinate without mass,
so that the kernels keep no state and a spring, a motor or a gear sees an angle that grows over many turns.
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


class Turn:
    """The rows [m] of all turning angles. The inner rows are C and -S of each in turn, seen as one complex number."""

    linear = False

    def __init__(self, turns: Sequence[Turning], n: int):
        self.m = len(turns)
        pairs = [(dot(t.moving, t.ahead), dot(t.moving, t.across, factor=-1.0)) for t in turns]
        self.inner = inner = Quadratic([row for pair in pairs for row in pair], n)
        self.phi = phi = np.array([t.phi for t in turns], dtype=np.intp) % n
        self.owner, self._beside = inner.rows // 2, inner.rows ^ 1
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
        return _Posture(unit, unit * self.inner.value(at).view(complex), at)

    def _mix(self, p: _Posture, values: Array) -> Array:
        """sin(phi) times what belongs to C, cos(phi) times what belongs to -S, of values on the pattern of their gradients."""
        return p.unit.view(float).take(self._beside, axis=-1) * values

    def _mix_rate(self, p: _Posture) -> Array:
        """The derivative of the mixture of the gradients with respect to phi: cos(phi) dC + sin(phi) dS."""
        return p.unit.conj().view(float).take(self.inner.rows, axis=-1) * self.inner.gradient(p.at)

    def _turning(self, values: Array, v: Array) -> Array:
        """The products [..., m] of v with rows of these values."""
        return self._sum(values * v.take(self.inner.cols, axis=-1))

    def value(self, p: _Posture) -> Array:
        return p.w.imag

    def gradient(self, p: _Posture) -> Array:
        return np.concatenate((self._mix(p, self.inner.gradient(p.at)), p.w.real), axis=-1)

    def swirl(self, p: _Posture, v: Array) -> Array:
        rate, cross_term = v.take(self.phi, axis=-1), self._mix_rate(p)
        along = self._mix(p, self.inner.swirl(p.at, v)) + rate.take(self.owner, axis=-1) * cross_term
        return np.concatenate((along, self._turning(cross_term, v) - rate * p.w.imag), axis=-1)

    def bias(self, p: _Posture, v: Array) -> Array:
        rate, cross_term = v.take(self.phi, axis=-1), self._turning(self._mix_rate(p), v)
        return (p.unit * self.inner.bias(p.at, v).view(complex)).imag + 2.0 * rate * cross_term - rate**2 * p.w.imag

    def curvature(self, p: _Posture, multipliers: Array) -> Array:
        weights = (1j * p.unit.conj() * multipliers).view(float)  # times sin(phi), cos(phi)
        cross_term = self._mix_rate(p) * multipliers.take(self.owner, axis=-1)
        return np.concatenate((self.inner.curvature(p.at, weights), cross_term, cross_term, -multipliers * p.w.imag), axis=-1)
