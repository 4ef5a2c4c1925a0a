"""What a joint does to its first marker: force and moment from its multipliers.

The joint's own rows, and its turning angles, are written once more, over a small table that holds just its markers' points and axes;
the gradient with respect to the first marker's point is the force, with respect to its axes the moment (axis x force on the axis).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .affine import Affine, Array
from .constraint import Quadratic
from .marker import Marker
from .scatter import Scatter
from .slip import Slip
from .turn import Turn


def _standalone(marker: Marker, first: int) -> Marker:
    """The marker with a point and axes that are rows of their own."""
    d = marker.dimension
    axes = tuple(Affine.of([first + 1 + k], [1.0], d) for k in range(len(marker.axes)))
    return Marker(marker.item, marker.scene, Affine.of([first], [1.0], d), axes, marker.rigid)


def _values(marker: Marker, q: Array) -> list[Array]:
    return [marker.point.value(q), *(axis.value(q) for axis in marker.axes)]


def reaction(joint: Any, pose: Any, q: Array, multipliers: Array) -> Array:
    """[..., 3] (planar) or [..., 6] (spatial): force and moment on the first marker, about it, inertial axes.

    q [..., n]; multipliers [..., rows of the joint].
    """
    a = joint.markers[0]
    firsts = np.cumsum([0, *(1 + len(marker.axes) for marker in joint.markers)]).tolist()
    own = [_standalone(marker, first) for marker, first in zip(joint.markers, firsts)]
    scalars = [-1 - k for k in range(len(joint.scalars))]
    rows = [row for _, row in joint.rows(own, pose, scalars)]
    turns, slips = joint.turns(own, pose, scalars), [row for _, row in joint.slips(own, pose, scalars)]
    d = a.dimension
    n = d * firsts[-1] + len(scalars)
    vectors = np.concatenate([value for marker in joint.markers for value in _values(marker, q)], axis=-1)
    table = np.concatenate((vectors, q[..., joint.scalars[::-1]]), axis=-1) if scalars else vectors
    kernels: list[Any] = ([Quadratic(rows, n)] if rows else []) + ([Turn(turns, n)] if turns else []) + ([Slip(slips, n)] if slips else [])
    dense, first = np.zeros((*q.shape[:-1], n)), 0
    for kernel in kernels:
        share = multipliers[..., first : first + kernel.m]
        dense = dense - Scatter(kernel.cols, n)(kernel.gradient(kernel.prepare(table)) * share[..., kernel.rows])
        first += kernel.m
    on_axes = dense[..., d : d * (1 + len(a.axes))].reshape(*q.shape[:-1], len(a.axes), d)
    axes = vectors[..., d : d * (1 + len(a.axes))].reshape(on_axes.shape)
    if d == 2:
        moment = np.sum(axes[..., 0] * on_axes[..., 1] - axes[..., 1] * on_axes[..., 0], axis=-1)[..., None]
    else:
        moment = np.sum(np.cross(axes, on_axes), axis=-2) if len(a.axes) else np.zeros((*q.shape[:-1], 3))
    return np.concatenate((dense[..., :d], moment), axis=-1)
