"""Plots of run time against error, a curve for each method."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from .work import Row

COLOURS = {"mbd": "viridis", "Exudyn": "autumn", "Exudyn tree": "cool"}
MARKERS = {"mbd": "o", "Exudyn": "s", "Exudyn tree": "^"}


def plot(path: Path, title: str, rows: Sequence[Row]) -> None:
    """Writes a .png: error on the x axis, falling to the right, median solve time on the y axis."""
    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    ax = figure.subplots()
    curves = list(dict.fromkeys((row.program, row.method) for row in rows))
    for program, method in curves:
        same = [m for p, m in curves if p == program]
        shade = colormaps[COLOURS[program]](0.85 * same.index(method) / max(1, len(same) - 1))
        points = [(row.error, row.time) for row in rows if (row.program, row.method) == (program, method) and np.isfinite(row.error)]
        if points:
            dash = "-" if program == "mbd" else "--"
            ax.loglog(*zip(*points), marker=MARKERS[program], ms=4, lw=1.2, color=shade, ls=dash, label=f"{program}: {method}")
    ax.invert_xaxis()
    ax.set(xlabel="error as a share of the scene's scale", ylabel="solve time [s]", title=title)
    ax.grid(True, which="major", alpha=0.3)
    ax.legend(fontsize=7)
    figure.savefig(path, dpi=110)
