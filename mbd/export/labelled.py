"""A result as an xarray Dataset: named dimensions, labelled coordinates, units in attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from .. import __version__
from ..extras import need
from ..outputs import Output, series
from ..result import Result


def to_xarray(result: Result, outputs: Mapping[str, Output] | None = None, t: ArrayLike | None = None) -> Any:
    """Over ``time``: q, v by ``coordinate``, energies, and the outputs with their components along x, y, z. Attributes: units, solver, versions."""
    xarray = need("xarray", "data")
    run = result if t is None else result.resampled(t)
    time = ("time", run.t, {"units": "s", "long_name": "time"})
    data: dict[str, Any] = {
        "q": (("time", "coordinate"), run.q, {"long_name": "coordinates"}),
        "v": (("time", "coordinate"), run.v, {"long_name": "velocities"}),
    }
    for name in ("kinetic", "elastic", "potential", "total"):
        data[f"{name}_energy"] = ("time", getattr(run.energy, name), {"units": "J", "long_name": f"{name} energy"})
    for each in series(run, outputs) if outputs else ():
        attributes = {"long_name": f"{each.what} of {each.name}".strip(), "units": each.unit or "1"}
        label = f"{each.name} {each.what}".strip()
        scalar = len(each.components) == 1
        dims = ("time",) if scalar else ("time", "axis" if set(each.components) <= set("xyz") else f"{label} component")
        data[label] = (dims, each.values[:, 0] if scalar else each.values, attributes)
    coordinates = {"time": time, "coordinate": run.scene.coordinates(), "axis": list("xyz")[: run.system.dimension]}
    told = {name: str(result.stats[name]) for name in ("solver", "rtol", "steps")}
    return xarray.Dataset(data, coordinates, {"source": f"mbd {__version__}"} | told)
