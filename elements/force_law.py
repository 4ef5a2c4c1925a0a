"""Forces that a user's function gives, on measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Array
from mbd.fields import Law, Measures
from mbd.formula import Formula
from mbd.measured import measure_faults
from mbd.signal import Signal

if TYPE_CHECKING:
    from mbd.model import Model
    from mbd.scene import Site


@dataclass(frozen=True, eq=False)
class ForceLaw:
    """Forces on measures s_1 ... s_k as a function of time and of these, or also of their rates: a spring that is not linear, a magnet, a
    field; a shock absorber, the drag of air, a controller.

    measures   a measure or a list of them, as ``scene.add(mbd.Length(...))`` returned them
    function   (t, s_1, ..., s_k) to the k forces [N] or [N m], in the direction in which each measure grows; continuously differentiable
    rates      whether the function takes the rates ds_1/dt ... ds_k/dt too, after the measures
    gradient   of the same arguments to d(force_i)/ds_j [k, k], with rates also to d(force_i)/d(ds_j/dt), beside it [k, 2 k]; None: by
               differences

    A given gradient is checked at the start. The function may declare times at which it jumps (``mbd.piecewise``'s attribute
    ``discontinuities``). Its work is in the audit; what it does to bodies is in the reactions of the measures.
    """

    measures: Measures
    function: Law
    rates: bool = field(default=False, kw_only=True)
    gradient: Law = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "force law"

    def __post_init__(self) -> None:
        object.__setattr__(self, "measures", list(self.measures) if isinstance(self.measures, (list, tuple)) else [self.measures])

    def faults(self, dimension: int) -> list[str]:
        found = [line for item in self.measures for line in measure_faults("measures", item)]
        if not isinstance(self.rates, bool):
            return [*found, f"rates: expected True or False, found {self.rates!r}; correct it"]
        wanted = f"a function of t and {len(self.measures) * (2 if self.rates else 1)} numbers"
        if not callable(self.function):
            return [*found, f"function: expected {wanted}, found {self.function!r}; correct it"]
        if self.gradient is not None and not callable(self.gradient):
            found.append(f"gradient: expected {wanted} or None, found {self.gradient!r}; correct it")
        return found + Signal(self.function, (), "", "").faults("function")

    def place(self, site: Site) -> PlacedForceLaw:
        return PlacedForceLaw(self, site)


class PlacedForceLaw:
    """A force law in a scene."""

    def __init__(self, description: ForceLaw, site: Site):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        d, k = self.description, len(self.description.measures)
        formula = Formula(d.function, d.gradient, None, (k, 2 * k if d.rates else k), self.name)
        at = np.array([[item.coordinate for item in d.measures]])
        start = np.concatenate((model.q0[at[0]], model.v0[at[0]])) if d.rates else model.q0[at[0]]
        for complaint in formula.faults(start, 0.0):
            model.complain(self, complaint)
        model.load(RateLaws if d.rates else Laws, (k,), at=at, formulas=[formula], signals=[Signal(d.function, (), self.name, "")])


class Laws:
    """The kernel of all force laws on as many measures, without their rates."""

    constant_in_q = linear_in_q = False

    def __init__(self, count: int, *, at: NDArray[np.intp], formulas: Sequence[Formula], signals: Sequence[Signal]):
        self.dofs, self.formulas, self.signals = at, formulas, signals

    def inputs(self, times: Array) -> Array:
        """The times themselves [..., n]; beside a declared jump, to the right of it."""
        return np.stack([signal.seen(times) for signal in self.signals], axis=-1)

    def force(self, q: Array, inputs: Array) -> Array:
        return self._values(q[..., self.dofs], inputs)

    def _values(self, arguments: Array, inputs: Array) -> Array:
        """[..., n, k] of measures, and perhaps rates, [..., n, k or 2 k]."""
        times = np.broadcast_to(inputs, arguments.shape[:-1])
        out = np.empty((*arguments.shape[:-1], self.dofs.shape[1]))
        for index in np.ndindex(*arguments.shape[:-1]):
            out[index] = self.formulas[index[-1]].value(arguments[index], float(times[index]))
        return out

    def gradient(self, q: Array, inputs: Array) -> Array:
        """[n, k, k] at one configuration."""
        return self._gradients(q[self.dofs], inputs)

    def _gradients(self, arguments: Array, inputs: Array) -> Array:
        times = np.broadcast_to(inputs, len(self.formulas))
        return np.array([f.gradient(x, float(t)) for f, x, t in zip(self.formulas, arguments, times)])


class RateLaws(Laws):
    """The kernel of force laws on as many measures and their rates."""

    depends_on_rate = True

    def _arguments(self, q: Array, v: Array) -> Array:
        return np.concatenate((q[..., self.dofs], v[..., self.dofs]), axis=-1)

    def force(self, q: Array, v: Array, inputs: Array) -> Array:  # type: ignore[override]
        return self._values(self._arguments(q, v), inputs)

    def gradient(self, q: Array, v: Array, inputs: Array) -> Array:  # type: ignore[override]
        """df/dq [n, k, k] at one state."""
        return self._gradients(self._arguments(q, v), inputs)[..., : self.dofs.shape[1]]

    def rate_gradient(self, q: Array, v: Array, inputs: Array) -> Array:
        """df/dv [n, k, k] at one state."""
        return self._gradients(self._arguments(q, v), inputs)[..., self.dofs.shape[1] :]
