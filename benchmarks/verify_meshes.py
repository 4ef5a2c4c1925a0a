"""What the estimates of ``mbd.verify(..., meshes=True)`` are worth: beams on coarse meshes against meshes at least six times as fine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import mbd

from .tables import table

RTOL, TRUE_RTOL, TIMES, FINER = 1e-5, 1e-7, 12, 6
"""Of the verified runs and of those on fine meshes; how many times are compared; how many times as fine the mesh is that counts as the truth."""

Row = dict[str, Any]


@dataclass(frozen=True)
class MeshCase:
    """A scene of n elements and the point that is watched until t_end [s]."""

    name: str
    build: Callable[[Any, int], tuple[mbd.Scene, Any]]
    t_end: float
    meshes: tuple[tuple[Any, int], ...]


BEAM = {"E": 2e7, "A": 1.8e-3, "I": 1.215e-8, "rho": 5540.0}


def falling(kind: Any, n: int) -> tuple[mbd.Scene, Any]:
    """A pendulum released from the horizontal, bent by its own weight."""
    scene = mbd.Scene()
    rod = scene.add(kind((0, 0), (1.2, 0), n_elements=n, **BEAM))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    return scene, rod.end


def cantilever(kind: Any, n: int) -> tuple[mbd.Scene, Any]:
    """Clamped horizontally and let go: it hangs down and swings."""
    scene = mbd.Scene()
    rod = scene.add(kind((0, 0), (1.2, 0), n_elements=n, **BEAM))
    scene.add(mbd.Clamp(rod.start, scene.ground.at(0, 0)))
    return scene, rod.end


KINDS = [(mbd.AncfCable, 3), (mbd.AncfCable, 4), (mbd.AncfCable, 8), (mbd.GeometricallyExactBeam, 2), (mbd.GeometricallyExactBeam, 4),
         (mbd.CorotationalBeam, 4), (mbd.CorotationalBeam, 8)]  # fmt: skip
CASES = [MeshCase("pendulum", falling, 0.25, tuple(KINDS)), MeshCase("cantilever", cantilever, 0.25, tuple(KINDS))]


def measure() -> list[Row]:
    """A row for every mesh of every case."""
    return [_row(case, kind, n) for case in CASES for kind, n in case.meshes]


def _row(case: MeshCase, kind: Any, n: int) -> Row:
    times = np.linspace(case.t_end / TIMES, case.t_end, TIMES)
    (scene, point), (fine, there) = case.build(kind, n), case.build(kind, FINER * n)
    found = mbd.verify(scene, case.t_end, outputs={"point": point}, rtol=RTOL, t_eval=times, meshes=True)
    true = mbd.simulate(fine, case.t_end, rtol=TRUE_RTOL, t_eval=times).position(there)
    error, row = np.linalg.norm(found.result.position(point) - true, axis=1), found.rows[0]
    return {
        "case": case.name, "beam": kind.__name__, "elements": n, "true": float(error.max()), "estimate": float(found.errors["point"].max()),
        "time": float(found.time_errors["point"].max()), "order": row.mesh_order, "anywhere": float(np.max(error / found.errors["point"])),
        "verdict": row.verdict}  # fmt: skip


def share(row: Row) -> float:
    """The worst true error over the worst estimate."""
    return float(row["true"] / row["estimate"])


def section(rows: list[Row], least: float, most: float) -> list[str]:
    """The part of the page, as paragraphs of Markdown."""
    quoted = [row for row in rows if row["verdict"] == "ok"]
    shares = [share(row) for row in quoted]
    head = ["case", "beam", "elements", "worst estimate", "of that, time", "true / estimate", "anywhere", "order", "verdict"]
    return [
        "## Errors of meshes",
        f"With `meshes=True`, at rtol {RTOL:g}, against a mesh {FINER} times as fine. Bars {least:g} and {most:g}; found {min(shares):.3g} to "
        f"{max(shares):.3g}, anywhere up to {max(row['anywhere'] for row in quoted):.3g}, in {len(quoted)} of {len(rows)} cases; "
        "in the others no error is quoted.",
        table(head, [_cells(row, least, most) for row in rows]),
    ]


def _cells(row: Row, least: float, most: float) -> list[str]:
    told = [row["case"], row["beam"], str(row["elements"])]
    if not np.isfinite(row["estimate"]):
        return [*told, "", "", "", "", _order(row), row["verdict"]]
    ratio = f"{share(row):.2g}" + ("" if least <= share(row) <= most else " !")
    anywhere = f"{row['anywhere']:.2g}" + (" !" if row["anywhere"] > most else "")
    return [*told, f"{row['estimate']:.1e} m", f"{row['time']:.1e} m", ratio, anywhere, _order(row), row["verdict"]]


def _order(row: Row) -> str:
    return "" if np.isnan(row["order"]) else f"{row['order']:.2f}"
