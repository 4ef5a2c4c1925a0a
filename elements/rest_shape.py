"""The shape of a cable without stress: tangents of a spline, arc lengths of its elements, places by arc length."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .shapes import gauss, hermite_slope

Array = NDArray[np.float64]


def spline_tangents(nodes: Array) -> Array:
    """Unit tangents of the natural cubic spline through the nodes, by chord length."""
    h = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    n = len(nodes)
    matrix, right = np.zeros((n, n)), np.zeros_like(nodes)
    slope = np.diff(nodes, axis=0) / np.maximum(h, 1e-300)[:, None]
    for k in range(1, n - 1):
        matrix[k, k - 1 : k + 2] = h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1]
        right[k] = 3.0 * (h[k] * slope[k - 1] + h[k - 1] * slope[k])
    matrix[0, :2], matrix[-1, -2:] = (2.0, 1.0), (1.0, 2.0)
    right[0], right[-1] = 3.0 * slope[0], 3.0 * slope[-1]
    tangents = np.linalg.solve(matrix, right)
    return tangents / np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-300)


def speed(nodal: Array, lengths: Array, xi: Array) -> Array:
    """|dr/dxi| [n, n_xi] of elements with nodal vectors [n, 4, d]."""
    scale = np.stack((np.ones_like(lengths), lengths, np.ones_like(lengths), lengths), axis=1)[:, :, None]
    return np.linalg.norm(np.einsum("nad,ag->ngd", nodal * scale, hermite_slope(xi)), axis=-1)


def element_lengths(nodes: Array, tangents: Array) -> Array:
    """Arc lengths l [n] of the elements; the slopes are dr/dx with x from 0 to l.

    Those of the smoothest planar curves with the given end points and tangent directions: the angle to the chord is
    theta(u) = a (1 - u) + b u + c u (1 - u), with c such that int sin theta = 0, and l = chord / int cos theta. Exact for circles.
    """
    chord = np.diff(nodes, axis=0)
    lengths = np.linalg.norm(chord, axis=1)
    if nodes.shape[1] == 3:
        return lengths
    axis = chord @ np.array([1.0, 1j])
    slope = tangents @ np.array([1.0, 1j])
    a, b = np.angle(slope[:-1] / axis)[:, None], np.angle(slope[1:] / axis)[:, None]
    u, weight = gauss(16)
    c = np.zeros_like(a)
    for _ in range(30):
        theta = a * (1.0 - u) + b * u + c * u * (1.0 - u)
        change = (np.sin(theta) @ weight) / ((u * (1.0 - u) * np.cos(theta)) @ weight)
        c = c - change[:, None]
        if np.max(np.abs(change)) < 1e-14:
            break
    return lengths / (np.cos(a * (1.0 - u) + b * u + c * u * (1.0 - u)) @ weight)


def arc_parameter(nodal: Array, length: float, fraction: float) -> float:
    """xi at a fraction of the element's arc length: Newton's method on the arc length."""
    points, weight = gauss(16)
    lengths, xi = np.array([length]), float(np.clip(fraction, 0.0, 1.0))
    if xi in (0.0, 1.0):
        return xi
    whole = float((speed(nodal[None], lengths, points) @ weight)[0])
    for _ in range(20):
        arc = xi * float((speed(nodal[None], lengths, xi * points) @ weight)[0])
        change = (fraction * whole - arc) / float(speed(nodal[None], lengths, np.array([xi]))[0, 0])
        xi = min(max(xi + change, 0.0), 1.0)
        if abs(change) < 1e-15:
            break
    return xi


def backward(nodes: Array, tangents: Array) -> NDArray[np.bool_]:
    """[n + 1]: nodes whose tangent makes more than a right angle with a chord beside it."""
    chords = np.diff(nodes, axis=0)
    along = np.sum(chords * tangents[:-1], axis=1) < 0.0, np.sum(chords * tangents[1:], axis=1) < 0.0
    return np.append(along[0], False) | np.append(False, along[1])


def straight(nodes: Array, tangents: Array) -> bool:
    axis = (nodes[-1] - nodes[0]) / max(np.linalg.norm(nodes[-1] - nodes[0]), 1e-300)
    vectors: Sequence[ArrayLike] = (np.diff(nodes, axis=0), tangents)
    for group in vectors:
        unit = np.asarray(group) / np.linalg.norm(group, axis=1, keepdims=True)
        if np.max(np.abs(unit - axis)) > 1e-9:
            return False
    return True
