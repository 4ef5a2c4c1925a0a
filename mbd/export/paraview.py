"""A result for ParaView: a file of lines and points for each frame, and an index of them by time."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from ..affine import Array
from ..drawing import Drawing
from ..extras import need
from ..result import Result

FRAMES = 100
LINES = ("beam", "rod", "arm", "hull", "axes", "disc", "spring", "link", "guide")
DOTS = ("centre", "particle", "ground")
"""The forms of shapes that are things; the others are symbols of joints."""


def to_paraview(result: Result, path: str | os.PathLike[str], t: ArrayLike | None = None) -> None:
    """Writes ``run.pvd``, to be opened in ParaView, and a folder ``run`` of one .vtu file for each time t [s] (None: a hundred, evenly spaced).

    Beams, bodies, springs and guides are lines, particles and mass centres vertices. Points carry ``velocity`` [m/s], cells the number of their
    ``item`` in the order of ``add``.
    """
    meshio = need("meshio", "data")
    index = Path(path).with_suffix(".pvd")
    steps = result.trajectory.t
    run = result.resampled(np.linspace(steps[0], steps[-1], FRAMES) if t is None else t)
    drawing = Drawing(run.scene, run.trajectory.q)
    cells, items = _cells(drawing)
    positions, velocities = (_in_space(values) for values in (drawing.at(run.q), drawing.rates(run.v)))
    folder = index.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    names = [f"{folder.name}/{k:05d}.vtu" for k in range(len(run.t))]
    for name, points, rates in zip(names, positions, velocities):
        meshio.Mesh(points, cells, point_data={"velocity": rates}, cell_data={"item": items}).write(index.parent / name)
    _write_index(index, names, run.t)


def _cells(drawing: Drawing) -> tuple[list[tuple[str, Array]], list[Array]]:
    """Lines and vertices by the indices of their points, and of each the number of its item."""
    number = {item.name: k for k, item in enumerate(drawing.scene.items)}
    lines = [(pair, number[shape.item]) for shape in drawing.shapes if shape.form in LINES for pair in zip(shape.points, shape.points[1:])]
    dots = [(shape.points, number[shape.item]) for shape in drawing.shapes if shape.form in DOTS]
    kinds = [(kind, found) for kind, found in (("line", lines), ("vertex", dots)) if found]
    return [(kind, np.array([points for points, _ in found])) for kind, found in kinds], [np.array([k for _, k in found]) for _, found in kinds]


def _in_space(values: Array) -> Array:
    """[n_t, n_points, 3]: planar scenes lie in z = 0."""
    return np.concatenate((values, np.zeros((*values.shape[:-1], 3 - values.shape[-1]))), axis=-1)


def _write_index(path: Path, names: list[str], t: Array) -> None:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for name, time in zip(names, t.tolist()):
        ElementTree.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=name)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
