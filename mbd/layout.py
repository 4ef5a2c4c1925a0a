"""The table of coordinates: hands out rows to items and keeps their start values, lever arms and names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .affine import Array


class Layout:
    """q = all rows of the table one after the other, then the scalar coordinates from the end of q backwards.

    The lever of a row is the length [m] by which a change of its (dimensionless) vector moves material; 1 for positions. It makes
    errors of positions, slopes and directors comparable. NaN stands for the length of the scene.
    """

    def __init__(self, dimension: int):
        self.dimension = dimension
        self.n_rows = 0
        self._q: list[Array] = []
        self._v: list[Array] = []
        self._levers: list[Array] = []
        self._labels: list[tuple[str, str]] = []
        self._scalars: list[tuple[float, float, str, str]] = []
        self._lengths: list[bool] = []

    def rows(self, item: str, q: ArrayLike, v: ArrayLike, levers: ArrayLike, labels: Sequence[str]) -> NDArray[np.intp]:
        """Row numbers [k] for start values q, v [k, d]."""
        values = np.array(q, dtype=float).reshape(-1, self.dimension)
        self._q.append(values)
        self._v.append(np.array(v, dtype=float).reshape(values.shape))
        self._levers.append(np.array(levers, dtype=float).reshape(len(values)))
        self._labels.extend((item, label) for label in labels)
        rows = np.arange(self.n_rows, self.n_rows + len(values))
        self.n_rows += len(values)
        return rows

    def scalar(self, item: str, value: float, rate: float, label: str, length: bool = False) -> int:
        """The index of a new scalar coordinate, a length or a number: negative, counted from the end of q."""
        self._scalars.append((float(value), float(rate), item, label))
        self._lengths.append(length)
        return -len(self._scalars)

    @property
    def n(self) -> int:
        return self.dimension * self.n_rows + len(self._scalars)

    def _assemble(self, parts: list[Array], scalars: list[float]) -> Array:
        return np.concatenate([part.ravel() for part in parts] + [np.array(scalars[::-1], dtype=float)])

    def start(self) -> tuple[Array, Array]:
        """q, v [n] as described by the items."""
        return (
            self._assemble(self._q, [value for value, *_ in self._scalars]),
            self._assemble(self._v, [rate for _, rate, *_ in self._scalars]),
        )

    def levers(self, unknown: float) -> Array:
        """[n], with ``unknown`` for NaN; scalar coordinates follow others through equations of their own and weigh nothing (0)."""
        known = [np.where(np.isnan(lever), unknown, lever) for lever in self._levers]
        return self._assemble([np.repeat(lever, self.dimension) for lever in known], [0.0] * len(self._scalars))

    def lengths(self) -> NDArray[np.bool_]:
        """[n]: which scalar coordinates are lengths."""
        return np.concatenate((np.zeros(self.dimension * self.n_rows, dtype=bool), np.array(self._lengths[::-1], dtype=bool)))

    def positions(self) -> NDArray[np.bool_]:
        """[n_rows]: the rows that are positions; the others are slopes and axes."""
        return np.array([label.endswith(("position", "mass centre")) for _, label in self._labels], dtype=bool)

    def smallest_arm(self) -> float:
        """The smallest lever of a slope or axis [m]; infinite where nothing has one."""
        levers = np.concatenate([*self._levers, np.zeros(0)])[~self.positions()]
        return float(levers.min(initial=np.inf, where=levers > 0.0))

    def row_labels(self) -> list[str]:
        """What each row of the table is: "mass centre", "node 3 slope"."""
        return [label for _, label in self._labels]

    def owners(self) -> list[tuple[str, str]]:
        """(item, coordinate) for each entry of q."""
        axes = "xyz"[: self.dimension]
        table = [(item, f"{label} {axis}".strip()) for item, label in self._labels for axis in axes]
        return table + [(item, label) for *_, item, label in self._scalars[::-1]]
