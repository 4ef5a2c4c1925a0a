"""The table that a sweep gives: a row for each case, labelled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .case import Case, Outcome


@dataclass(frozen=True, eq=False)
class Sweep:
    """What came of every case, in order.

    cases       the parameters of each, a dict
    outcomes    of each: ``values`` (an array for each output) or, where it failed, ``failure``, a message; ``warnings``, ``seconds``
    parameters  names and values where the cases are all combinations; else None
    """

    cases: list[Case]
    outcomes: list[Outcome]
    outputs: list[str]
    parameters: dict[str, list[Any]] | None

    def __len__(self) -> int:
        return len(self.cases)

    def __getitem__(self, output: str) -> np.ma.MaskedArray:
        """An output of all cases [n_cases, ...]; cases that failed are masked."""
        if output not in self.outputs:
            raise KeyError(f"no output named {output!r}; there are {', '.join(map(repr, self.outputs))}")
        shape = self._shape(output)
        found = np.ma.masked_all((len(self), *shape))
        for k, outcome in enumerate(self.outcomes):
            if not outcome.failure:
                found[k] = outcome.values[output]
        return found

    def _shape(self, output: str) -> tuple[int, ...]:
        shapes = {outcome.values[output].shape for outcome in self.outcomes if not outcome.failure}
        if len(shapes) > 1:
            raise ValueError(f"output {output!r}: expected one shape in all cases, found {sorted(shapes)}; read .outcomes, or give t_eval")
        return shapes.pop() if shapes else ()

    @property
    def failures(self) -> list[tuple[Case, str]]:
        """Parameters and message of each case that failed."""
        return [(case, outcome.failure) for case, outcome in zip(self.cases, self.outcomes) if outcome.failure]

    def columns(self) -> dict[str, list[Any]]:
        """Parameters, outputs (of arrays each entry, as ``tip[0]``), failure and seconds; None where a case failed."""
        found: dict[str, list[Any]] = {name: [case.get(name) for case in self.cases] for name in self._names()}
        for output in self.outputs:
            values = self[output]
            for place in np.ndindex(values.shape[1:]):
                label = f"{output}[{', '.join(map(str, place))}]" if place else output
                found[label] = values[(slice(None), *place)].tolist()
        return found | {"failure": [o.failure for o in self.outcomes], "seconds": [o.seconds for o in self.outcomes]}

    def _names(self) -> list[str]:
        return list(dict.fromkeys(name for case in self.cases for name in case))

    def __str__(self) -> str:
        columns = self.columns()
        if not self.failures:
            del columns["failure"]
        rows = [list(columns), *([_cell(value) for value in row] for row in zip(*columns.values()))]
        widths = [max(len(row[k]) for row in rows) for k in range(len(columns))]
        return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths)).rstrip() for row in rows)

    def to_dataframe(self) -> Any:
        """A pandas DataFrame, a row for each case (needs pandas)."""
        from ..extras import need

        return need("pandas", "data").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """An xarray Dataset (needs xarray): a dimension for each parameter where the cases are all combinations, else one, ``case``.
        Cases that failed are NaN there, and ``failure`` holds their messages."""
        from ..extras import need

        xarray = need("xarray", "data")
        dims: tuple[str, ...] = ("case",)
        shape: tuple[int, ...] = (len(self),)
        coordinates: dict[str, Any] = {name: ("case", [case.get(name) for case in self.cases]) for name in self._names()}
        if self.parameters is not None:
            dims, shape, coordinates = tuple(self.parameters), tuple(map(len, self.parameters.values())), dict(self.parameters)
        data = {}
        for output in self.outputs:
            values = self[output]
            inner = tuple(f"{output}_{k}" for k in range(values.ndim - 1))
            data[output] = ((*dims, *inner), values.filled(np.nan).reshape(*shape, *values.shape[1:]))
        failures = np.array([outcome.failure for outcome in self.outcomes], dtype=object)
        return xarray.Dataset(data | {"failure": (dims, failures.reshape(shape))}, coordinates)


def _cell(value: Any) -> str:
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value).splitlines()[0] if str(value) else ""
