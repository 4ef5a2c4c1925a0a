"""The plots of a report: energies, drift, outputs, reactions, estimated errors; each with a title, a unit and labelled curves."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..affine import Array
from ..audit import History, histories
from ..errors import SceneWarning
from ..joints.measures import PlacedMeasure
from ..measured import measured
from ..outputs import check, joint, series
from ..result import Result
from ..verification.verification import Verification
from .frames import LOST

JOINTS = 6
"""So many joints are plotted where none is chosen."""
BINS = 400
"""Of many steps the worst in each of so many intervals is shown."""


@dataclass
class Plot:
    """Curves [n_t] by label over the frames, or over times of their own."""

    group: str
    title: str
    unit: str
    curves: dict[str, Array]
    times: Array | None = None
    log: bool = False
    note: str = ""


def plots(result: Result, run: Result, outputs: dict[str, Any], verification: Verification | None = None) -> list[Plot]:
    """All plots of a result; ``run``: the same at the frames."""
    shown = [_output(run, name, item) for name, item in outputs.items() if not is_joint(item) or measured(item)]
    chosen = {name: item for name, item in outputs.items() if is_joint(item)}
    return [_energy(run), *_drift(result), *_errors(verification), *shown, *_reactions(run, chosen)]


def is_joint(item: Any) -> bool:
    """Whether it is one whose reaction is of interest in itself; measures have a value instead."""
    return joint(item) and not isinstance(item, PlacedMeasure)


def checked(result: Result, wanted: Any) -> dict[str, Any]:
    """The outputs by name; where none are given, what moves. Raises SceneError for what cannot be shown, all at once."""
    if wanted is None:
        return _moving(result)
    check(result.scene, wanted)
    return dict(wanted)


def _moving(result: Result, most: int = 4) -> dict[str, Any]:
    """Ends of beams, particles, mass centres: the first few that move."""
    found: dict[str, Any] = {}
    for item in result.scene.items:
        name, marker = (f"{item.name}.end", item.end) if hasattr(item, "end") else (item.name, item.at() if hasattr(item, "at") else None)
        if marker and np.ptp(marker.point.value(result.trajectory.q), axis=0).max() > 1e-6 * result.system.length:
            found[name] = marker
        if len(found) == most:
            break
    return found


def _energy(run: Result) -> Plot:
    energy = run.energy
    curves = {"kinetic": energy.kinetic, "elastic": energy.elastic, "potential": energy.potential, "total": energy.total}
    return Plot("energy", "Energy", "J", {name: values for name, values in curves.items() if name != "elastic" or run.system.n_stresses})


def _drift(result: Result) -> list[Plot]:
    try:
        told = histories(result.system, result.accounted)
    except LOST as error:
        return [Plot("audit", "Drift of the joints", "relative", {}, note=f"not to be had: {error}")]
    t, (position, velocity, imbalance) = _worst(told)
    energy = Plot("audit", "Imbalance of the energy", "J", {"|energy - start - work|": imbalance}, t, log=True)
    energy.note = "work of loads, drives and dampers taken off" + ("; the largest of all parts" if len(told) > 1 else "")
    if not result.system.m:
        return [energy]
    drift = Plot("audit", "Drift of the joints", "relative", {"|g| / length": position, "|G v| / speed": velocity}, t, log=True)
    drift.note = "at the accepted steps: how far joints are open, and how fast they open"
    return [drift, energy]


def _worst(told: Sequence[History]) -> tuple[Array, Array]:
    """Times [k] and position drift, velocity drift, imbalance [3, k] of all parts: where steps are many, the worst in each interval."""
    t, *values = (np.concatenate(column) for column in zip(*told))
    bins = ((t - t.min()) / max(float(np.ptp(t)), 1e-300) * (BINS - 1)).astype(int)
    used, place = np.unique(bins, return_inverse=True)
    last, worst = np.full(used.size, -np.inf), np.zeros((3, used.size))
    np.maximum.at(last, place, t)
    for row, each in zip(worst, values):
        np.maximum.at(row, place, each)
    return last, worst


def _output(run: Result, name: str, item: Any) -> Plot:
    one = next(iter(series(run, {name: item})))
    stem = "" if one.what == "position" else one.what or name
    labels = [" ".join(filter(None, (stem, component))) for component in one.components]
    return Plot("outputs", name, one.unit, dict(zip(labels, one.values.T)))


def _reactions(run: Result, chosen: dict[str, Any]) -> list[Plot]:
    held = {name for name, _ in run.system.joints.labels}
    every = {item.name: item for item in run.scene.items if is_joint(item) and item.name in held}
    joints = chosen or dict(list(every.items())[:JOINTS])
    found: list[Plot] = []
    for name, item in joints.items():
        try:
            found += _reaction(run, name, item)
        except LOST as error:
            return [Plot("reactions", "Reactions", "", {}, note=f"not to be had: {error}")]
    if found and len(every) > len(joints):
        found[-1].note += f" {len(every) - len(joints)} more joints are not shown: name them in outputs=."
    return found


def _reaction(run: Result, name: str, joint: Any) -> list[Plot]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)  # the page says it
        values = run.reaction(joint)
    d = run.system.dimension
    note = f"on {joint.description.markers[0].item!r}, about the joint."
    if joint.name in run.indeterminate:
        note += " Indeterminate: other joints hold the same, and this is the one of least norm."
    force, moment = np.abs(values[:, :d]).max(initial=0.0), np.abs(values[:, d:]).max(initial=0.0)
    tiny, shown = 1e-9 * run.system.length, []
    if force > tiny * moment / run.system.length**2 or not moment:
        shown.append(Plot("reactions", f"{name}: force", "N", {f"force {axis}": row for axis, row in zip("xyz", values[:, :d].T)}, note=note))
    if moment > tiny * force:
        axes = "z" if d == 2 else "xyz"
        shown.append(Plot("reactions", f"{name}: moment", "N m", {f"moment {axis}": row for axis, row in zip(axes, values[:, d:].T)}, note=note))
    return shown


def _errors(verification: Verification | None) -> list[Plot]:
    """Estimated errors of outputs over time, a plot for each unit."""
    if verification is None:
        return []
    found: dict[str, Plot] = {}
    for row in verification.rows:
        plot = found.setdefault(row.unit, Plot("errors", "Estimated errors", row.unit, {}, verification.t, log=True))
        plot.curves[row.output] = verification.errors[row.output]
    return list(found.values())
