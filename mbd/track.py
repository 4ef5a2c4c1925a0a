"""A point on a cable, wherever it has slid to: P(q) - r(s, q) = 0, with the place s along the cable as a scalar coordinate.

    r = sum_k N_k(s) e_k      cubic Hermite functions of all nodes (position, slope), zero but on the element where s is

Not quadratic, since N is cubic in s. The pattern of G covers the whole cable, so that it does not change as the point moves on. r and dr/ds
are continuous across the nodes, so positions and velocities pass smoothly; d2r/ds2, and with it the bias, jumps there by as much as the
curvature of the cable does. s has no mass, its own equation is dr/ds . force = 0: nothing rubs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array

HERMITE = np.array([[1.0, 0.0, -3.0, 2.0], [0.0, 1.0, -2.0, 1.0], [0.0, 0.0, 3.0, -2.0], [0.0, 0.0, -1.0, 1.0]])
"""Coefficients of 1, x, x^2, x^3 for the vectors (r_0, l r'_0, r_1, l r'_1) of an element, x from 0 to 1."""

FALLING = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 2.0, 6.0]])
"""d^j x^p / dx^j = FALLING[j, p] x^(p - j)."""

BEYOND = 1e-9
"""A point so far beyond an end, as a share of the length, is still at the end."""


class Track(NamedTuple):
    """A point, the rows [nodes, 2] (position, slope) and element lengths [m] of a cable, the index of s, and the cable's name."""

    point: Affine
    rows: NDArray[np.intp]
    lengths: Array
    place: int
    cable: str

    def weights(self, s: Array, order: int) -> Array:
        """d^j N / ds^j [..., 2 nodes] at places s [...]."""
        ends = np.concatenate(([0.0], np.cumsum(self.lengths)))
        element = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, self.lengths.size - 1)
        length = self.lengths[element][..., None]
        x = (s[..., None] - ends[element][..., None]) / length
        powers = FALLING[order] * x ** np.maximum(np.arange(4) - order, 0)
        own = powers @ HERMITE.T * length ** (np.array([0, 1, 0, 1]) - order)
        out = np.zeros((*s.shape, self.rows.size))
        np.put_along_axis(out, 2 * element[..., None] + np.arange(4), own, axis=-1)
        return out

    def nodes(self, q: Array) -> Array:
        """[..., 2 nodes, d] from coordinates, velocities or changes [..., n]."""
        d = self.point.dimension
        return q[..., self.columns()].reshape(*q.shape[:-1], -1, d)

    def columns(self) -> NDArray[np.intp]:
        d = self.point.dimension
        return (d * self.rows.reshape(-1, 1) + np.arange(d)).ravel()

    def nearest(self, point: Array, q: Array) -> float:
        """The place on the cable that is nearest to a point [d], at q [n]: from samples, then by Newton's method."""
        total, nodes = float(self.lengths.sum()), self.nodes(q)
        samples = np.linspace(0.0, total, 20 * self.lengths.size + 1)
        s = samples[np.argmin(np.sum((self.weights(samples, 0) @ nodes - point) ** 2, axis=-1))]
        for _ in range(10):
            r, tangent, bend = (self.weights(s, j) @ nodes for j in range(3))
            slope = tangent @ tangent + (r - point) @ bend
            s = np.clip(s - (r - point) @ tangent / (slope if slope > 0.0 else tangent @ tangent), 0.0, total)
        return float(s)


class _Place(NamedTuple):
    """Weights of the nodes and their first two derivatives [..., 2 nodes], the nodes' sums with them [..., d], and the gap [..., d]."""

    weights: tuple[Array, Array, Array]
    tangent: Array
    bend: Array
    gap: Array


class OnTrack:
    """The rows [d] of one sliding point."""

    linear = False

    def __init__(self, track: Track, item: str, n: int):
        self.track, self.item = track, item
        self.m = d = track.point.dimension
        self.place, self.end = track.place % n, float(track.lengths.sum())
        matrix = track.point.matrix()
        row, entry = np.nonzero(matrix)
        self.point, axes, self.cable = matrix[row, entry], np.arange(d), track.columns()
        self.rows = np.concatenate((row, np.tile(axes, track.rows.size), axes))
        self.cols = np.concatenate((track.point.columns()[entry], self.cable, np.full(d, self.place)))
        along = np.full(self.cable.size, self.place)
        self.curvature_rows = np.concatenate((self.cable, along, [self.place]))
        self.curvature_cols = np.concatenate((along, self.cable, [self.place]))

    def prepare(self, q: Array) -> _Place:
        s, nodes = q[..., self.place], self.track.nodes(q)
        if np.any(s < -BEYOND * self.end) or np.any(s > (1.0 + BEYOND) * self.end):
            from .solvers.formats import Singular  # there is no curve to be on: a step that gets there is refused, as at a singular position

            raise Singular(f"{self.item!r} leaves {self.track.cable!r} at its {'start' if np.min(s) < 0.0 else 'end'}")
        weights = (self.track.weights(s, 0), self.track.weights(s, 1), self.track.weights(s, 2))
        r, tangent, bend = (_sum(w, nodes) for w in weights)
        return _Place(weights, tangent, bend, self.track.point.value(q) - r)

    def value(self, z: _Place) -> Array:
        return z.gap

    def _pattern(self, point: Array, nodes: Array, place: Array) -> Array:
        """Values on the pattern of G: of the point's coordinates, of each node [..., 2 nodes] for all axes, of s [..., d]."""
        point = np.broadcast_to(point, (*nodes.shape[:-1], point.size))
        return np.concatenate((point, np.repeat(nodes, self.m, axis=-1), place), axis=-1)

    def gradient(self, z: _Place) -> Array:
        return self._pattern(self.point, -z.weights[0], -z.tangent)

    def swirl(self, z: _Place, v: Array) -> Array:
        speed = v[..., self.place, None]
        turning = _sum(z.weights[1], self.track.nodes(v))
        return self._pattern(np.zeros(self.point.size), -z.weights[1] * speed, -turning - z.bend * speed)

    def bias(self, z: _Place, v: Array) -> Array:
        speed = v[..., self.place, None]
        return -speed * (2.0 * _sum(z.weights[1], self.track.nodes(v)) + z.bend * speed)

    def curvature(self, z: _Place, multipliers: Array) -> Array:
        mixed = -(z.weights[1][..., :, None] * multipliers[..., None, :]).reshape(*multipliers.shape[:-1], -1)
        return np.concatenate((mixed, mixed, -np.sum(multipliers * z.bend, axis=-1, keepdims=True)), axis=-1)


def _sum(weights: Array, nodes: Array) -> Array:
    """[..., d]."""
    return (weights[..., None, :] @ nodes)[..., 0, :]
