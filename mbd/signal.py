"""Numbers that a user gives as constants or as functions of time, sampled with checks that name the item."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from . import validate
from .affine import Array
from .errors import SimulationError


class Signal:
    """A constant or callable(t) with values of one shape. ``faults`` complains about a constant; a callable is checked when called."""

    def __init__(self, value: Any, shape: tuple[int, ...], item: str, unit: str):
        self.function: Callable[[float], Any] | None = value if callable(value) else None
        self.constant = None if self.function else validate.floats(value)
        self.shape, self.item, self.unit = shape, item, unit

    def faults(self, field: str) -> list[str]:
        if self.function:
            return []
        if not isinstance(self.constant, np.ndarray) or self.constant.shape != self.shape:
            expected = "a number" if not self.shape else f"{self.shape[0]} numbers"
            return [f"{field}: expected {expected} {self.unit} or a function of t, found {validate.show(self.constant)}; correct it"]
        return validate.finite(field, self.constant)

    def sample(self, times: Array) -> Array:
        """[..., *shape] for times [...]."""
        if self.function is None:
            return np.broadcast_to(np.asarray(self.constant), (*times.shape, *self.shape))
        return np.array([self._call(float(t)) for t in times.ravel()]).reshape((*times.shape, *self.shape))

    def _call(self, t: float) -> Array:
        assert self.function is not None
        expected = "a number" if not self.shape else f"{self.shape[0]} numbers"
        try:
            value = np.asarray(self.function(t), dtype=float)
        except Exception as error:
            raise SimulationError(
                f"the function given for it raised {type(error).__name__}: {error}", time=t, item=self.item, advice="Correct the function"
            ) from error
        if value.shape != self.shape:
            raise SimulationError(
                f"the function given for it returned an array of shape {value.shape}, expected {expected} {self.unit}",
                time=t, item=self.item, advice="Correct the function",
            )  # fmt: skip
        if not np.isfinite(value).all():
            raise SimulationError(f"the function given for it returned {value.tolist()}", time=t, item=self.item, advice="It must be finite")
        return value
