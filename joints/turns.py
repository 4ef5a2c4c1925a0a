"""The turn of one marker relative to another as a coordinate: its axes, its faults, and its rate at the start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mbd.affine import Array
from mbd.marker import Marker
from mbd.turn import Turning

from .placed import Pose, direction, fixed_in, mate, normals, pose_of

if TYPE_CHECKING:
    from mbd.scene import Site


def turning(a: Marker, b: Marker, axes: Sequence[Array], axis: Array | None, phi: int) -> Turning:
    """The turn of a relative to b since the start, counter-clockwise; in space about an axis [3] (inertial components at the start).

    In space one of the markers at least is rigid; a cable turns with its tangent, which is perpendicular to the axis.
    """
    axes_a, axes_b = axes
    if axis is None:
        ahead = b.axes[0].scaled(mate(axes_a, axes_b))
        return Turning(a.axes[0], ahead, ahead.scaled(1j), phi)
    unit = axis / np.linalg.norm(axis)
    if b.rigid:
        x = normals(unit)[0] if a.rigid else axes_a[:, 0] / np.linalg.norm(axes_a[:, 0])
        moving = fixed_in(a, axes_a, x) if a.rigid else a.axes[0]
        return Turning(moving, fixed_in(b, axes_b, x), fixed_in(b, axes_b, np.cross(unit, x)), phi)
    x = axes_b[:, 0] / np.linalg.norm(axes_b[:, 0])  # seen from a, the tangent of b turns the other way round
    return Turning(b.axes[0], fixed_in(a, axes_a, x), fixed_in(a, axes_a, np.cross(x, unit)), phi)


def turning_faults(a: Marker, b: Marker, axis: Any, dimension: int) -> list[str]:
    """Complaints about two markers whose relative turn is asked for."""
    found = [f"marker: expected one that carries an axis, found {m!r}; use a body, a cable or the ground" for m in (a, b) if not m.turns()]
    if dimension == 2:
        return found if axis is None else [*found, "axis: expected none in a planar scene, found one; leave it out"]
    if not (a.rigid or b.rigid):
        found.append("marker: expected at least one on a body or the ground (two thin cables hold no common axis), found two cables")
    return found + direction("axis", axis, "give axis=(x, y, z), inertial components at the start")


def across_cables(markers: Sequence[Marker], pose: Pose, axis: Array | None) -> list[str]:
    """Complaints about an axis of rotation that is not across a thin spatial cable turning about it."""
    if axis is None:
        return []
    for marker, axes in zip(markers, pose.axes):
        along = 0.0 if marker.rigid else abs(axes[:, 0] @ axis) / np.linalg.norm(axes[:, 0]) / np.linalg.norm(axis)
        if along > 1e-6:
            across = f"one across the cable {marker.item!r} (it has no torsion)"
            return [f"axis: expected {across}, found one with cosine {along:.3g} to it; turn the axis"]
    return []


def turn_scalar(a: Marker, b: Marker, axis: Array | None, site: Site) -> int:
    """A new coordinate for the turn of a relative to b, with its rate at the start."""
    q, v = site.scene.layout.start()
    rate = turning(a, b, pose_of((a, b), q).axes, axis, 0).rate(q, v)
    return site.scalar(0.0, rate, "turn")
