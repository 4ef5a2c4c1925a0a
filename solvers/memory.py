"""What methods remember of the last step, as named arrays and back: with it a run that was broken off goes on to the last bit.

A memory is a tuple of numbers, arrays and further such tuples; its leaves are named by their path. What only serves values within the last
step (the parts of a divided one) is left out.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from . import automatic, forecast, gauss, generalized_alpha, projected, radau, workspace
from .index_one import index_one
from .linear import Linear
from .stages import Stages
from .system import Array, System

Leaves = dict[str, Array]

NESTED = ("inner", "stages")
"""Fields that may be memories themselves, and else are left out."""


def packed(memory: Any) -> Leaves:
    """Leaves by their path; none of no memory."""
    out: Leaves = {}
    for name, value in {} if memory is None else memory._asdict().items():
        if name in NESTED:
            out |= {f"{name}.{path}": leaf for path, leaf in packed(value).items()} if hasattr(value, "_asdict") else {}
        else:
            out[name] = np.array(value, dtype=float)
    return out


def unpacked(method: Any, system: System, linear: Linear, leaves: Leaves) -> Any:
    """The memory of a method that has these leaves. Raises ValueError where they are not its own."""
    if not leaves:
        return None
    return _MEMORIES[type(method)](method, system, linear, _Checked(leaves))


class _Checked:
    """Leaves, asked for by name and shape."""

    def __init__(self, leaves: Leaves):
        self.leaves = leaves

    def __call__(self, name: str, *shape: int) -> Array:
        found = self.leaves.get(name, np.zeros(0))
        if name not in self.leaves or found.shape != shape or np.isnan(found).any():
            raise ValueError(f"memory: expected numbers {name!r} of shape {shape}, found shape {found.shape}, or NaN among them")
        return found

    def number(self, name: str) -> float:
        return float(self(name))

    def within(self, field: str) -> Leaves:
        return {name.removeprefix(f"{field}."): leaf for name, leaf in self.leaves.items() if name.startswith(f"{field}.")}


def _radau(method: Any, system: System, linear: Linear, of: _Checked) -> Any:
    n, m, k, s = system.n, system.m, system.n_stresses, method.table.stages
    stages = Stages(*(of(f"stages.{name}", s, width) for name, width in zip(Stages._fields, (n, n, m, m, k))))
    return forecast.Memory(of.number("h"), of("v0", n), of("stress0", k), stages, s, of.number("rate"))


def _alpha(method: Any, system: System, linear: Linear, of: _Checked) -> Any:
    return generalized_alpha.Memory(of.number("h"), of("algorithmic", system.n), of("acceleration", system.n))


def _gauss(method: Any, system: System, linear: Linear, of: _Checked) -> Any:
    s, stress = method.table.stages, of("stress", method.table.samples.size, system.n_stresses)
    multipliers, trend = (of(name, s + 1, system.m) for name in ("multipliers", "trend"))
    return gauss.Memory(of.number("h"), of("v", s + 2, system.n), multipliers, trend, stress)


def _explicit(method: Any, system: System, linear: Linear, of: _Checked) -> Any:
    form = index_one(system, linear)
    known = of("w", 2, form.width), of("acceleration", form.width), of("multipliers", form.m), of("home", form.width)
    return workspace.Memory(*known, *(of.number(name) for name in workspace.Memory._fields[len(known) :]))


def _switching(method: Any, system: System, linear: Linear, of: _Checked) -> Any:
    explicit = bool(of.number("explicit"))
    inner = unpacked(method.explicit if explicit else method.implicit, system, linear, of.within("inner"))
    return automatic.Memory(explicit, inner, bool(of.number("stiff")), int(of.number("alarms")))


_MEMORIES: dict[type, Any] = {
    radau.RadauIIA: _radau,
    generalized_alpha.ChungHulbert: _alpha,
    gauss.GaussCollocation: _gauss,
    projected.ProjectedExplicit: _explicit,
    automatic.Switching: _switching,
}
