"""Pictures of results: deformed shapes over time, animations, paths of markers. matplotlib is imported when one is asked for.

What is drawn is said in ``drawing.py``: bodies and beams as lines, springs, rods and guides dashed, mass centres and particles as dots,
fixed points as triangles.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .drawing import FINE, Drawing
from .extras import need
from .marker import Marker

if TYPE_CHECKING:
    from .result import Result

SHAPES = 10
"""Shapes that a plot shows by default."""
STYLES: dict[tuple[str, ...], dict[str, Any]] = {
    ("beam", "rod", "hull", "arm", "axes", "disc"): {"linestyle": "-"},
    ("spring", "link", "guide"): {"linestyle": "--", "linewidth": 0.8},
    ("centre", "particle"): {"linestyle": "", "marker": "o", "markersize": 4},
}
"""How the forms of shapes look that move; symbols of joints would crowd a picture of ten shapes."""


def plot(result: Result, times: ArrayLike | None = None, *, items: Sequence[Any] | None = None, ax: Any = None) -> Any:
    """The shapes of all items, or of some, at times [n] [s] (by default ten, evenly spaced), coloured by time.

    ax is a matplotlib Axes, a 3-D one for a spatial scene; None makes a figure. Returns the Axes.
    """
    plt = need("matplotlib.pyplot", "plot")
    chosen = _spread(result, SHAPES) if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    ax = _axes(plt, result.system.dimension, ax)
    q, _ = result.trajectory.at(chosen)
    drawing = Drawing(result.scene, q, items)
    shade = plt.cm.ScalarMappable(plt.Normalize(chosen.min(), chosen.max()), "viridis")
    layers = _layers(drawing, q)
    for k, colour in enumerate(shade.to_rgba(chosen)):
        for points, style in layers:
            ax.plot(*points[k].T, color=colour, **style)
    _finish(ax, drawing)
    if chosen.min() < chosen.max():
        ax.figure.colorbar(shade, ax=ax, label="t [s]")
    return ax


def plot_path(result: Result, marker: Marker, ax: Any = None, **style: Any) -> Any:
    """The path of a marker over the whole run; ``style`` goes to matplotlib's plot. Returns the Axes."""
    ax = _axes(need("matplotlib.pyplot", "plot"), result.system.dimension, ax)
    ax.plot(*result.position(marker, t=_spread(result, FINE)).T, **style)
    _frame(ax)
    return ax


def animate(result: Result, path: str | os.PathLike[str] | None = None, *, fps: float = 30, speed: float = 1.0) -> Any:
    """A matplotlib FuncAnimation of all items, ``speed`` times as fast as real time.

    A path ending in .gif is written by Pillow, any other (.mp4) by the program ffmpeg; raises RuntimeError where that is not installed.
    Keep the returned object: it runs while it lives.
    """
    plt = need("matplotlib.pyplot", "plot")
    from matplotlib.animation import FuncAnimation

    writer = None if path is None else _writer(os.fspath(path))
    if not (fps > 0.0 and speed > 0.0):
        raise ValueError(f"animate: expected positive fps and speed, found {fps!r} and {speed!r}")
    span = float(result.trajectory.t[-1] - result.trajectory.t[0])
    times = _spread(result, max(int(np.ceil(span / speed * fps)), 1) + 1)
    ax = _axes(plt, result.system.dimension, None)
    q, _ = result.trajectory.at(times)
    drawing = Drawing(result.scene, q)
    layers = _layers(drawing, q)
    whole = np.concatenate([points.reshape(-1, result.system.dimension) for points, _ in layers])
    ax.plot(*whole.T, alpha=0.0)  # sets the limits once and for all
    drawn = [ax.plot(*points[0].T, color="C0", **style)[0] for points, style in layers]
    title = ax.set_title("t = 0 s")
    _finish(ax, drawing)

    def show(k: int) -> list[Any]:
        for line, (points, _) in zip(drawn, layers):
            line.set_data(*points[k].T[:2])
            if points.shape[-1] == 3:
                line.set_3d_properties(points[k, :, 2])
        title.set_text(f"t = {times[k]:.3f} s")
        return [*drawn, title]

    film: Any = FuncAnimation(ax.figure, show, frames=len(times), interval=1000.0 / fps)
    if path is not None:
        film.save(os.fspath(path), writer=writer, fps=fps)
    return film


def _writer(path: str) -> str:
    """The name of matplotlib's writer for a file."""
    from matplotlib.animation import writers

    name = "pillow" if path.lower().endswith(".gif") else "ffmpeg"
    if not writers.is_available(name):
        how = "install it (apt-get install ffmpeg, conda install ffmpeg, brew install ffmpeg), or write a .gif"
        raise RuntimeError(f"animate: {path!r}: expected the program ffmpeg, which writes films, found none on the path; {how}")
    return name


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


def _finish(ax: Any, drawing: Drawing) -> None:
    fixed = [drawing.points[shape.points[0]].constant for shape in drawing.shapes if shape.form == "ground"]
    if fixed:
        ax.plot(*np.array(fixed).T, "^", color="black", markersize=7, zorder=3)
    _frame(ax)


def _spread(result: Result, count: int) -> Array:
    return np.linspace(result.trajectory.t[0], result.trajectory.t[-1], count)


def _layers(drawing: Drawing, q: Array) -> list[tuple[Array, dict[str, Any]]]:
    """Polylines [n_t, n_points, d], those of one style apart by NaN, so that one artist draws them all."""
    points, layers = drawing.at(q), []
    gap = np.full((len(q), 1, drawing.scene.dimension), np.nan)
    for forms, style in STYLES.items():
        lines = [points[:, shape.points] for shape in drawing.shapes if shape.form in forms]
        if lines:
            layers.append((np.concatenate([part for line in lines for part in (line, gap)][:-1], axis=1), style))
    return layers
