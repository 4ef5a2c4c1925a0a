"""Turning angles as coordinates: phi follows the angle of an axis p between two axes c (ahead) and s (across), turns counted.

    g = sin(phi) C - cos(phi) S = 0,   C = p . c,  S = p . s        (g = |p| |c| sin(phi - angle))

In the plane s = i c. In space c and s turn with one body and p with another, all perpendicular to a common axis of rotation at phi = 0.
C - i S is a quadratic row itself, with complex coefficients, so that g = Im exp(i phi) (C - i S); phi is a coordinate without mass, so that the kernels keep no state and a spring, a motor or a
gear sees an angle that grows over many turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array, Scalar
from .constraint import At, Quadratic
from .rows import NOTHING, Row
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
    """At q [..., n]: exp(i phi) and w = exp(i phi) (C - i S) [..., m], and what the inner row takes."""

    unit: NDArray[np.complex128]
    w: NDArray[np.complex128]
    at: At


class Turn:
    """The rows [m] of all turning angles: g = Im w, dg/dphi = Re w."""

    linear = False

    def __init__(self, turns: Sequence[Turning], n: int):
        self.m = len(turns)
        self.inner = inner = Quadratic([_aligned(t) for t in turns], n)
        self.phi = phi = np.array([t.phi for t in turns], dtype=np.intp) % n
        self.rows = np.concatenate((inner.rows, np.arange(self.m)))
        self.cols = np.concatenate((inner.cols, phi))
        self._sum = sums(inner.rows, self.m)
        self.curvature_rows = np.concatenate((inner.curvature_rows, inner.cols, phi[inner.rows], phi))
        self.curvature_cols = np.concatenate((inner.curvature_cols, phi[inner.rows], inner.cols, phi))

    def prepare(self, q: Array) -> _Posture:
        phi, at = q.take(self.phi, axis=-1), self.inner.prepare(q)
        unit = np.empty(phi.shape, complex)
        np.cos(phi, unit.real)
        np.sin(phi, unit.imag)
        return _Posture(unit, unit * self.inner.value(at), at)

    def _turned(self, p: _Posture, values: Array) -> NDArray[np.complex128]:
        """exp(i phi) times values on the inner pattern."""
        return p.unit.take(self.inner.rows, axis=-1) * values

    def _slopes(self, p: _Posture) -> NDArray[np.complex128]:
        """dw/dq on the inner pattern."""
        return self._turned(p, self.inner.gradient(p.at))

    def value(self, p: _Posture) -> Array:
        return p.w.imag

    def gradient(self, p: _Posture) -> Array:
        return np.concatenate((self._slopes(p).imag, p.w.real), axis=-1)

    def swirl(self, p: _Posture, v: Array) -> Array:
        turning, across = v.take(self.phi, axis=-1), self._slopes(p).real
        along = self._turned(p, self.inner.swirl(p.at, v)).imag + turning.take(self.inner.rows, axis=-1) * across
        return np.concatenate((along, self._pushed(across, v) - turning * p.w.imag), axis=-1)

    def _pushed(self, values: Array, v: Array) -> Array:
        """Of values on the inner pattern and v [..., m]."""
        return self._sum(values * v.take(self.inner.cols, axis=-1))

    def bias(self, p: _Posture, v: Array) -> Array:
        turning, across = v.take(self.phi, axis=-1), self._pushed(self._slopes(p).real, v)
        return (p.unit * self.inner.bias(p.at, v)).imag + 2.0 * turning * across - turning**2 * p.w.imag

    def curvature(self, p: _Posture, multipliers: Array) -> Array:
        along = self.inner.curvature(p.at, p.unit * multipliers).imag
        cross_term = self._slopes(p).real * multipliers.take(self.inner.rows, axis=-1)
        return np.concatenate((along, cross_term, cross_term, -multipliers * p.w.imag), axis=-1)


def _aligned(turn: Turning) -> Row:
    """C - i S: p . c - i p . s."""
    both = [_complex(c, s) for c, s in zip(turn.ahead.components(), turn.across.components())]
    return Row(NOTHING, list(zip(turn.moving.components(), both)))


def _complex(x: Scalar, y: Scalar) -> Scalar:
    """x - i y."""
    return Scalar(np.concatenate((x.columns, y.columns)), np.concatenate((x.coefficients, -1j * y.coefficients)), x.constant - 1j * y.constant)
