"""Sums of local contributions into global vectors: one bincount for all items, in small scenes for all stages as well."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .affine import Array

MANY = 1024
"""Targets from which on every vector has a bincount of its own: one for all saves a tenth of the time, and its index is as large as the values."""


class Scatter:
    """Adds local values [..., k] into vectors [..., size]; ``target`` [k] says where, repeated targets are summed."""

    def __init__(self, target: NDArray[np.intp], size: int):
        self.target, self.size = target.ravel() % max(size, 1), size
        self._index: dict[int, NDArray[np.intp]] = {1: self.target}

    def __call__(self, local: Array) -> Array:
        batch = local.shape[:-1]
        count = math.prod(batch)
        if self.target.size >= MANY and count > 1:
            out = np.empty((count, self.size))
            for total, row in zip(out, local.reshape(count, -1)):
                total[:] = np.bincount(self.target, row, minlength=self.size)
            return out.reshape(*batch, self.size)
        index = self._index.get(count)
        if index is None:
            if len(self._index) > 8:  # samples of results come in any number: keep only the batches that solvers repeat
                self._index = {1: self.target}
            index = self._index[count] = (self.target + self.size * np.arange(count)[:, None]).ravel()
        summed: Any = np.bincount(index, local.ravel(), minlength=count * self.size)  # numpy's stub forgets the weights: they are floats
        return summed.reshape(*batch, self.size)
