"""The tables of a report and of notebooks, as HTML. Whatever a user named is escaped here and nowhere else."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Sequence
from dataclasses import fields, is_dataclass
from datetime import datetime
from html import escape
from typing import Any

import numpy as np

from .. import __version__, cautions
from ..audit import Audit
from ..diagnosis import Structure
from ..errors import SceneError
from ..marker import Marker
from ..result import Result
from ..scene import Scene
from ..verification.verification import Verification
from ..vibration import Modes
from .quantities import LONGEST, array, number, place, shown, unit_of

ITEMS = 300
"""Rows of the table of items."""


def text(value: Any) -> str:
    return escape(str(value))


def table(rows: Iterable[Sequence[str]], head: Sequence[str] = (), kind: str = "") -> str:
    """Cells are HTML. Of a table without a head the first column names the rows."""
    first = "td" if head else 'th scope="row"'
    body = "".join(f"<tr><{first}>{row[0]}</{first[:2]}>" + "".join(f"<td>{cell}</td>" for cell in row[1:]) + "</tr>" for row in rows)
    top = "<thead><tr>" + "".join(f'<th scope="col">{text(cell)}</th>' for cell in head) + "</tr></thead>" if head else ""
    return f'<div class="wide {kind}"><table>{top}<tbody>{body}</tbody></table></div>'


def rounded(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def items(scene: Scene) -> str:
    rows = [_item(item) for item in scene.items[:ITEMS]]
    left = len(scene.items) - len(rows)
    more = f"<p>{left} more items are not listed.</p>" if left else ""
    return table(rows, ("name", "kind", "where [m]", "numbers"), "items") + more


def _item(item: Any) -> tuple[str, ...]:
    description = item.description
    where, numbers = [], []
    for each in fields(description) if is_dataclass(description) else ():
        value = getattr(description, each.name)
        if isinstance(value, Marker):
            where.append(place(value))
        elif value is not None and each.name != "name":
            unit = unit_of(type(description).__name__, each.name)
            numbers.append(f"{each.name} = {shown(value)}{' ' + unit if unit and not callable(value) else ''}")
    if not where:
        where = [array(description.position)] if hasattr(description, "position") else []
        numbers = [line for line in numbers if not line.startswith("position =")]
    return text(item.name), text(type(description).__name__), text("; ".join(where)), text(", ".join(numbers))


def structure(found: Structure) -> str:
    rows = [
        ("bodies, joints, independent parts", f"{len(found.bodies)}, {len(found.joints)}, {len(found.parts)}"),
        ("degrees of freedom", f"{found.freedoms} by rank, {found.count} by count (coordinates less equations)"),
        ("driven, free", f"{found.driven}, {found.free}"),
        ("loops", _listed([", ".join(loop) for loop in found.loops])),
        ("free motions", _listed(found.motions) if found.free <= len(found.motions) else f"{found.free}, too many to describe"),
        ("held twice", _listed([str(each) for each in found.redundant])),
        ("indeterminate reactions", _listed(found.indeterminate)),
        ("singular here", "yes" if found.singular else "no"),
    ]
    rows += [("not determined", _listed(found.unheld))] if found.unheld else []
    rows += [("cannot be assembled", _listed(found.complaints))] if found.complaints else []
    return table([(text(name), cell) for name, cell in rows])


def _listed(lines: Sequence[str], most: int = 20) -> str:
    left = len(lines) - most
    more = [f"{left} more"] if left > 0 else []
    return "<br>".join(text(line).replace("\n", "<br>") for line in (*lines[:most], *more)) or "none"


def audit(found: Audit) -> str:
    rows = [
        ("joints, positions", f"within {found.position_drift:.1e} of the length"),
        ("joints, velocities", f"within {found.velocity_drift:.1e} of the speed"),
        ("energy balance", f"within {found.energy_error:.2e} J; {found.energy_scale:.4g} J were exchanged"),
        ("work of loads, drives and dampers", f"{found.work:.6g} J"),
        ("energy adds up", "yes" if found.balanced else "no: do not trust this run"),
    ]
    return table([(text(name), text(cell)) for name, cell in rows])


def statistics(stats: dict[str, Any]) -> str:
    rows = [(name + (" [s]" if name == "wall time" else ""), rounded(value)) for name, value in stats.items() if name != "parts"]
    parts = stats.get("parts", [])
    whole = table([(text(name), text(cell)) for name, cell in rows])
    if not parts:
        return whole
    head = ("part", "solver", "linear algebra", "steps", "rejected", "wall time")
    lines = [(text(_listing(part["items"])), *(text(rounded(part[name])) for name in head[1:])) for part in parts[:20]]
    more = f"<p>{len(parts) - 20} more parts are not listed.</p>" if len(parts) > 20 else ""
    return whole + table(lines, (*head[:-1], "wall time [s]")) + more


def _listing(names: Sequence[str], most: int = 4) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def modes(found: Modes) -> str:
    head = ("mode", "frequency [Hz]", "[rad/s]", "damping ratio", "")
    kinds = [("rigid" if s == 0.0 else "unstable" if s.real > 1e-9 * abs(s) else "") for s in found.eigenvalues]
    numbers = zip(found.hertz, found.frequencies, found.damping_ratios, kinds)
    return table([(str(k), f"{f:.6g}", f"{w:.6g}", f"{z:.4g}", kind) for k, (f, w, z, kind) in enumerate(numbers, 1)], head)


def events(result: Result) -> str:
    rows = [(text(name), str(len(times.t)), text(", ".join(f"{t:.6g}" for t in times.t[:LONGEST])) + (" …" if len(times.t) > LONGEST else ""))
            for name, times in result.events.items()]  # fmt: skip
    return table(rows, ("event", "times", "at t [s]")) if rows else ""


def doubts(result: Result) -> list[str]:
    """What a reader should know before believing the run, as plain text."""
    told = list(cautions.doubts(result))
    told += [f"the start was corrected: {correction}" for correction in result.assembly.corrections]
    if result.assembly.redundant:
        told.append(f"redundant joints: {_listing(result.assembly.redundant, 8)}")
    return told


def reproduction(result: Result) -> str:
    """What it takes to run it again: the call, the settings, the versions."""
    import scipy

    solvers = list(dict.fromkeys(repr(piece.solver) for piece in result.trajectory.pieces()))
    rows = [
        ("run", f"<code>{text(_call(result, solvers))}</code>"),
        ("solver", _listed(solvers, 6)),
        ("gravity", text(array(np.asarray(result.scene.gravity))) + " m/s²"),
        ("coordinates, equations", f"{result.system.n}, {result.system.m}"),
        ("random numbers", "none: the same input on the same machine gives the same numbers"),
        ("mbd", text(__version__)),
        ("Python, NumPy, SciPy", text(f"{platform.python_version()}, {np.__version__}, {scipy.__version__}")),
        ("machine", text(f"{platform.system()} {platform.machine()}")),
        ("report written", text(datetime.now().astimezone().isoformat(timespec="seconds"))),
    ]
    return table([(name, cell) for name, cell in rows])


def _call(result: Result, solvers: Sequence[str]) -> str:
    """The call that made it."""
    start, end = float(result.trajectory.t[0]), float(result.trajectory.t[-1])
    if "rtol" not in result.stats:
        return f"mbd.kinematics(scene, times)  # {len(result.t)} from {number(start)} to {number(end)} s"
    options = [f"t_end={number(end)}", f"rtol={number(float(result.stats['rtol']))}"]
    options += [f"solver=mbd.{solvers[0]}"] if len(solvers) == 1 else []
    options += [f"start=mbd.State(q, v, t={number(start)})"] if start else []
    return f"mbd.simulate(scene, {', '.join(options)})"


def scene_file(scene: Scene) -> str:
    """The scene as a file that ``mbd.read_scene`` reads, or why it cannot be one."""
    from ..files.writing import scene_data, toml

    try:
        return f'<div class="wide"><pre>{text(toml(scene_data(scene)))}</pre></div>'
    except SceneError as error:
        return _listed(error.complaints)


def verification(found: Verification) -> str:
    """The rows as a table, and what else it says."""
    head = ("output", "worst error", "unit", "at t [s]", "range", "order", "verdict")
    cells = [(row.output, _quoted(row.worst), row.unit, _quoted(row.at), f"{row.range:.4g}", _quoted(row.order), row.verdict) for row in found.rows]
    return table([tuple(map(text, row)) for row in cells], head) + f"<p>{_listed(found.remarks())}</p>"


def _quoted(value: float) -> str:
    """A number, or nothing where there is none."""
    return f"{value:.2g}" if np.isfinite(value) else ""
