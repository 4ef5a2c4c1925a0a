"""Pictures of results: deformed shapes over time, animations, paths of markers. matplotlib is imported when one is asked for.

An item is drawn by points of it, affine in q like its markers, so that one evaluation serves all times:
    cable      a smooth curve, several points on each cubic element
    body       its rod; lines from the mass centre to where something is attached; where neither, its axes
    particle   a dot;   spring and distance   a dashed line;   joint to the ground   a triangle
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .affine import Affine, Array
from .elements.ancf_cable import Cable
from .elements.particle import PlacedParticle
from .elements.rigid import Body
from .elements.spring import PlacedSpring
from .elements.straight_beam import PlacedBeam
from .joints.pairs import Distance
from .joints.placed import PlacedJoint
from .marker import Marker

if TYPE_CHECKING:
    from .result import Result
    from .scene import Scene

SHAPES = 10
"""Shapes that a plot shows by default."""
FINE = 400
"""Points along the path of a marker, and about the most along a cable of few elements."""

Line = list[Affine]


class Outline(NamedTuple):
    """What there is to draw: polylines, dashed polylines, dots, and fixed points of joints [d]."""

    solid: list[Line]
    dashed: list[Line]
    dots: list[Line]
    pivots: list[Array]


def plot(result: Result, times: ArrayLike | None = None, *, items: Sequence[Any] | None = None, ax: Any = None) -> Any:
    """The shapes of all items, or of some, at times [n] [s] (by default ten, evenly spaced), coloured by time.

    ax is a matplotlib Axes, a 3-D one for a spatial scene; None makes a figure. Returns the Axes.
    """
    plt = _pyplot()
    chosen = _spread(result, SHAPES) if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    outline = _outline(result, items)
    ax = _axes(plt, result.system.dimension, ax)
    q, _ = result.trajectory.at(chosen)
    shade = plt.cm.ScalarMappable(plt.Normalize(chosen.min(), chosen.max()), "viridis")
    layers = [(_joined(lines, q), style) for lines, style in _layers(outline)]
    for k, colour in enumerate(shade.to_rgba(chosen)):
        for points, style in layers:
            ax.plot(*points[k].T, color=colour, **style)
    _finish(ax, outline)
    if chosen.min() < chosen.max():
        ax.figure.colorbar(shade, ax=ax, label="t [s]")
    return ax


def plot_path(result: Result, marker: Marker, ax: Any = None, **style: Any) -> Any:
    """The path of a marker over the whole run; ``style`` goes to matplotlib's plot. Returns the Axes."""
    ax = _axes(_pyplot(), result.system.dimension, ax)
    ax.plot(*result.position(marker, t=_spread(result, FINE)).T, **style)
    _frame(ax)
    return ax


def animate(result: Result, path: str | os.PathLike[str] | None = None, *, fps: float = 30, speed: float = 1.0) -> Any:
    """A matplotlib FuncAnimation of all items, ``speed`` times as fast as real time.

    A path ending in .gif is written by Pillow, any other by matplotlib's ffmpeg writer. Keep the returned object: it runs while it lives.
    """
    plt = _pyplot()
    from matplotlib.animation import FuncAnimation

    if not (fps > 0.0 and speed > 0.0):
        raise ValueError(f"animate: expected positive fps and speed, found {fps!r} and {speed!r}")
    span = float(result.trajectory.t[-1] - result.trajectory.t[0])
    times = _spread(result, max(int(np.ceil(span / speed * fps)), 1) + 1)
    outline = _outline(result, None)
    ax = _axes(plt, result.system.dimension, None)
    q, _ = result.trajectory.at(times)
    layers = [(_joined(lines, q), style) for lines, style in _layers(outline)]
    whole = np.concatenate([points.reshape(-1, result.system.dimension) for points, _ in layers])
    ax.plot(*whole.T, alpha=0.0)  # sets the limits once and for all
    drawn = [ax.plot(*points[0].T, color="C0", **style)[0] for points, style in layers]
    title = ax.set_title("t = 0 s")
    _finish(ax, outline)

    def show(k: int) -> list[Any]:
        for line, (points, _) in zip(drawn, layers):
            line.set_data(*points[k].T[:2])
            if points.shape[-1] == 3:
                line.set_3d_properties(points[k, :, 2])
        title.set_text(f"t = {times[k]:.3f} s")
        return [*drawn, title]

    film: Any = FuncAnimation(ax.figure, show, frames=len(times), interval=1000.0 / fps)
    if path is not None:
        film.save(os.fspath(path), writer="pillow" if os.fspath(path).endswith(".gif") else "ffmpeg", fps=fps)
    return film


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError('pictures need matplotlib, which is not installed: pip install "mbd[plot]"') from error
    return plt


def _axes(plt: Any, dimension: int, ax: Any) -> Any:
    if ax is None:
        return plt.figure(layout="constrained").add_subplot(projection="3d" if dimension == 3 else None)
    if (ax.name == "3d") != (dimension == 3):
        raise ValueError(f"ax: expected {'3-D' if dimension == 3 else 'planar'} axes for this scene, found {ax.name!r} ones")
    return ax


def _frame(ax: Any) -> None:
    """Equal scales and labels; after the data, because 3-D axes scale at once."""
    ax.set_aspect("equal", adjustable="datalim")
    for axis in "xyz" if ax.name == "3d" else "xy":
        getattr(ax, f"set_{axis}label")(f"{axis} [m]")


def _finish(ax: Any, outline: Outline) -> None:
    if outline.pivots:
        ax.plot(*np.array(outline.pivots).T, "^", color="black", markersize=7, zorder=3)
    _frame(ax)


def _spread(result: Result, count: int) -> Array:
    return np.linspace(result.trajectory.t[0], result.trajectory.t[-1], count)


def _layers(outline: Outline) -> list[tuple[list[Line], dict[str, Any]]]:
    layers: list[tuple[list[Line], dict[str, Any]]] = [
        (outline.solid, {"linestyle": "-"}),
        (outline.dashed, {"linestyle": "--", "linewidth": 0.8}),
        (outline.dots, {"linestyle": "", "marker": "o", "markersize": 4}),
    ]
    return [(lines, style) for lines, style in layers if lines]


def _joined(lines: list[Line], q: Array) -> Array:
    """[n_t, n_points, d] of polylines, apart by NaN, so that one artist draws them all."""
    parts = []
    for line in lines:
        parts += [point.value(q) for point in line] + [np.full((len(q), line[0].dimension), np.nan)]
    return np.stack(parts[:-1], axis=1)


def _outline(result: Result, items: Sequence[Any] | None) -> Outline:
    outline = Outline([], [], [], [])
    for item in result.scene.items if items is None else items:
        if isinstance(item, Cable | PlacedBeam):
            outline.solid.append(_curve(item))
        elif isinstance(item, Body):
            lines = _skeleton(item, result.scene, result.system.length)
            outline.solid.extend(lines)
            outline.dots.append([item.at().point])
        elif isinstance(item, PlacedParticle):
            outline.dots.append([item.at().point])
        elif isinstance(item, PlacedSpring) or (isinstance(item, PlacedJoint) and isinstance(item.description, Distance)):
            outline.dashed.append([marker.point for marker in item.description.markers])
        if isinstance(item, PlacedJoint):
            outline.pivots.extend(marker.point.constant for marker in item.description.markers if marker.fixed)
    return outline


def _curve(cable: Cable | PlacedBeam) -> Line:
    n = len(cable.lengths)
    ends = np.concatenate(([0.0], np.cumsum(cable.lengths))) / cable.lengths.sum()
    points = max(2, min(24, FINE // n))
    inner = (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(points) / points).ravel()
    return [cable.at(float(s)).point for s in (*inner, 1.0)]


def _skeleton(body: Body, scene: Scene, extent: float) -> list[Line]:
    centre = body.at().point
    lines = []
    if body.length is not None:
        half = 0.5 * float(body.length)
        lines.append([centre + body.axes[0].scaled(-half), centre + body.axes[0].scaled(half)])
    attached = [m.point for item in scene.items for m in getattr(item.description, "markers", ()) if m.item == body.name]
    lines += [[centre, point] for point in attached]
    return lines or [[centre, centre + axis.scaled(0.05 * extent)] for axis in _all_axes(body)]


def _all_axes(body: Body) -> list[Affine]:
    return [body.axes[0], body.axes[0].scaled(1j)] if len(body.axes) == 1 else list(body.axes)
