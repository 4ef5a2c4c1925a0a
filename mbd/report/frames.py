"""A run as the page shows it: frames at even times, so many that a curve through them is the motion to the eye.

Between frames the page interpolates by cubics whose slopes are central differences. Frames are doubled until the frames between, which
were computed, lie on those cubics to a thousandth of the scene, or until the page would become too large.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..affine import Array
from ..drawing import Drawing
from ..errors import SimulationError
from ..marker import Marker, frame
from ..result import Result
from ..signal import Signal

FEWEST, MOST = 61, 961
"""Frames."""
SIZE = 1_500_000
"""Bytes that the points of all frames may take."""
MISS = 1e-3
"""Of the scene's extent: halving the distance of frames divides what the cubics miss by eight, so what remains is less than a pixel."""
LOST = (LookupError, SimulationError)
"""Raised by what needs functions of time that a file could not keep."""
DETAIL = 120
"""Points along a beam."""


@dataclass(frozen=True)
class Frames:
    """run: the result with ``t`` at the frames; points [n_t, n_points, d] [m] of the drawing; forces: arrows [n_t, d] [N] by item."""

    run: Result
    drawing: Drawing
    points: Array
    forces: dict[str, Array]
    between: bool
    """Whether values between the accepted steps were to be had; a result from a file may have lost its functions of time."""


def frames(result: Result, outputs: dict[str, Marker], size: int = SIZE) -> Frames:
    """The frames of a run, with the points of these outputs, each a shape of form "output"."""
    drawing = Drawing(result.scene, result.trajectory.q, fine=DETAIL)
    for name, marker in outputs.items():
        drawing.add(name, "output", [marker.point])
    try:
        run, between = _even(result, drawing, size), True
    except LOST:
        run, between = _at_steps(result, drawing, size), False
    return Frames(run, drawing, drawing.at(run.q), _forces(run), between)


def _weight(drawing: Drawing) -> int:
    """Bytes of one frame."""
    return 4 * max(len(drawing.points), 1) * drawing.scene.dimension


def _even(result: Result, drawing: Drawing, size: int) -> Result:
    start, end = float(result.trajectory.t[0]), float(result.trajectory.t[-1])
    count = FEWEST if end > start else 1
    while count > 16 and count * _weight(drawing) > size:
        count = count // 2 + 1
    times = np.linspace(start, end, count)
    q, v = result.trajectory.at(times)
    while 1 < count < MOST and (2 * count - 1) * _weight(drawing) <= size:
        count = 2 * count - 1
        middle = 0.5 * (times[1:] + times[:-1])
        between = result.trajectory.at(middle)
        q, v, times = (_woven(a, b) for a, b in ((q, between[0]), (v, between[1]), (times, middle)))
        if missed(drawing.at(q)) <= MISS * drawing.extent:
            break
    return result.resampled(times, (q, v))


def _woven(a: Array, b: Array) -> Array:
    out = np.empty((len(a) + len(b), *a.shape[1:]))
    out[::2], out[1::2] = a, b
    return out


def missed(points: Array) -> float:
    """How far odd frames [m] are from the cubics through the even ones; points [2 k + 1, n_points, d]."""
    even, odd = points[::2], points[1::2]
    if len(even) < 3:
        return np.inf
    slope = np.gradient(even, axis=0, edge_order=2)
    middle = 0.5 * (even[1:] + even[:-1]) + 0.125 * (slope[:-1] - slope[1:])
    return float(np.max(np.linalg.norm(middle - odd, axis=-1), initial=0.0))


def _at_steps(result: Result, drawing: Drawing, size: int) -> Result:
    """At accepted steps, as many as there is room for."""
    most = max(2, min(MOST, size // _weight(drawing)))
    steps = result.trajectory
    chosen = np.unique(np.linspace(0, len(steps.t) - 1, most).round().astype(int))
    return result.resampled(steps.t[chosen], (steps.q[chosen], steps.v[chosen]))


def _forces(run: Result) -> dict[str, Array]:
    found = {}
    for item in run.scene.items:
        if item.description.kind == "force":
            try:
                found[item.name] = _force(run, item.name, item.description)
            except LOST:
                continue
    return found


def _force(run: Result, name: str, force: Any) -> Array:
    """[n_t, d] [N], inertial components."""
    d = run.system.dimension
    values = Signal(force.vector, (d,), name, "[N]").sample(run.t)
    if not force.follower:
        return values
    axes = frame(force.marker, run.q)
    if d == 2:
        axes = np.concatenate((axes, np.stack((-axes[:, 1], axes[:, 0]), axis=1)), axis=-1)
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    return np.einsum("tda,ta->td", axes, values[:, : axes.shape[-1]])


def packed(values: ArrayLike, kind: str = "<f4") -> str:
    """Numbers as base64 of little-endian floats; what is not finite, or too large for a float32, as NaN."""
    array = np.asarray(values, dtype=float)
    with np.errstate(over="ignore"):
        rounded = array.astype(kind)
    rounded[~np.isfinite(rounded)] = np.nan
    return base64.b64encode(rounded.tobytes()).decode()
