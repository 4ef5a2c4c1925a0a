"""Turning angles as coordinates: phi follows the angle of an axis p between two axes c (ahead) and s (across), turns counted.

    g = sin(phi) C - cos(phi) S = 0,   C = p . c,  S = p . s        (g = |p| |c| sin(phi - angle))

In the plane s = i c. In space c and s turn with one body and p with another, all perpendicular to a common axis of rotation at phi = 0.
C and S are quadratic rows themselves; phi is a coordinate without mass, so that the kernels keep no state and a spring, a motor or a
gear sees an angle that grows over many turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .affine import Affine, Array
from .constraint import At, Quadratic
from .rows import dot
from .scatter import Scatter


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
    sine: Array
    cosine: Array
    weights: Array  # of C and S in g [..., 2 m]
    aligned: Array  # C and S [..., 2 m]
    z: At


class Turn:
    """The rows [m] of all turning angles."""

    def __init__(self, turns: Sequence[Turning], n: int):
        self.m = len(turns)
        self.inner = Quadratic([dot(t.moving, t.ahead) for t in turns] + [dot(t.moving, t.across) for t in turns], n)
        self.phi = np.array([t.phi for t in turns], dtype=np.intp) % n
        self.owner = self.inner.rows % self.m
        self.rows = np.concatenate((self.owner, np.arange(self.m)))
        self.cols = np.concatenate((self.inner.cols, self.phi))
        self._sum = Scatter(self.owner, self.m)
        inner, phi = self.inner, self.phi
        self.curvature_rows = np.concatenate((inner.curvature_rows, inner.cols, phi[self.owner], phi))
        self.curvature_cols = np.concatenate((inner.curvature_cols, phi[self.owner], inner.cols, phi))
        self.linear = False

    def prepare(self, q: Array) -> _Posture:
        z, phi = self.inner.prepare(q), q.take(self.phi, axis=-1)
        sine, cosine = np.sin(phi), np.cos(phi)
        return _Posture(sine, cosine, np.concatenate((sine, -cosine), axis=-1), self.inner.value(z), z)

    def _mix(self, p: _Posture, values: Array) -> Array:
        """sin(phi) times what belongs to C, -cos(phi) times what belongs to S, of values on the pattern of their gradients."""
        return p.weights.take(self.inner.rows, axis=-1) * values

    def _mix_rate(self, p: _Posture, values: Array) -> Array:
        """The derivative of the mixture with respect to phi."""
        return np.concatenate((p.cosine, p.sine), axis=-1).take(self.inner.rows, axis=-1) * values

    def value(self, p: _Posture) -> Array:
        parts = p.weights * p.aligned
        return parts[..., : self.m] + parts[..., self.m :]

    def _slope(self, p: _Posture) -> Array:
        return p.cosine * p.aligned[..., : self.m] + p.sine * p.aligned[..., self.m :]

    def gradient(self, p: _Posture) -> Array:
        return np.concatenate((self._mix(p, self.inner.gradient(p.z)), self._slope(p)), axis=-1)

    def swirl(self, p: _Posture, v: Array) -> Array:
        turning = v[..., self.phi]
        cross_term = self._mix_rate(p, self.inner.gradient(p.z))
        along = self._mix(p, self.inner.swirl(p.z, v)) + turning[..., self.owner] * cross_term
        return np.concatenate((along, self._sum(cross_term * v[..., self.inner.cols]) - turning * self.value(p)), axis=-1)

    def bias(self, p: _Posture, v: Array) -> Array:
        turning, inner = v[..., self.phi], self.inner.bias(p.z, v)
        mixed = p.sine * inner[..., : self.m] - p.cosine * inner[..., self.m :]
        cross_term = self._sum(self._mix_rate(p, self.inner.gradient(p.z)) * v[..., self.inner.cols])
        return mixed + 2.0 * turning * cross_term - turning**2 * self.value(p)

    def curvature(self, p: _Posture, multipliers: Array) -> Array:
        weights = np.concatenate((p.sine * multipliers, -p.cosine * multipliers), axis=-1)
        cross_term = self._mix_rate(p, self.inner.gradient(p.z)) * multipliers[..., self.owner]
        return np.concatenate((self.inner.curvature(p.z, weights), cross_term, cross_term, -multipliers * self.value(p)), axis=-1)
