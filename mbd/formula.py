"""A user's function of k numbers: called with checks that name the item, its derivatives given or found by differences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .affine import Array
from .called import called
from .differences import derivative
from .errors import SimulationError

AGREED = 1e-6
"""Given derivatives must agree with differences so far, relative to the larger."""


class Formula:
    """f(*before, x_1 ... x_k) with r values, its gradient [r, k] and, for measures, its Hessian [r, k, k]; ``before`` may be the time.

    A derivative may be given as a function of the same arguments that returns it in that shape, without axes of length 1; or the function
    carries it as an attribute ``gradient`` or ``hessian``, as ``mbd.Expression`` does.
    """

    def __init__(self, function: Any, gradient: Any, hessian: Any, shape: tuple[int, int], item: str):
        self.function, self.item, self._given = function, item, {"gradient": gradient, "hessian": hessian}
        self._gradient, self._hessian = (given or getattr(function, what, None) for what, given in self._given.items())
        self.r, self.k = shape

    def value(self, x: Array, *before: float) -> Array:
        """[r]."""
        return self._call(self.function, "function", (self.r,), x, before)

    def gradient(self, x: Array, *before: float) -> Array:
        """[r, k]."""
        if self._gradient:
            return self._call(self._gradient, "gradient", (self.r, self.k), x, before)
        return np.stack([self._along(x, axis, 1, before) for axis in np.eye(self.k)], axis=-1)

    def hessian(self, x: Array, *before: float) -> Array:
        """[r, k, k]; mixed derivatives from second ones along diagonals."""
        if self._hessian:
            return self._call(self._hessian, "hessian", (self.r, self.k, self.k), x, before)
        axes, out = np.eye(self.k), np.zeros((self.r, self.k, self.k))
        for i in range(self.k):
            out[:, i, i] = self._along(x, axes[i], 2, before)
        for i in range(self.k):
            for j in range(i):
                diagonal = self._along(x, axes[i] + axes[j], 2, before)
                out[:, i, j] = out[:, j, i] = 0.5 * (diagonal - out[:, i, i] - out[:, j, j])
        return out

    def _along(self, x: Array, direction: Array, order: int, before: tuple[float, ...]) -> Array:
        def line(steps: Array) -> Array:
            return np.array([self.value(x + step * direction, *before) for step in steps])

        return derivative(line, 0.0, order)

    def _call(self, function: Callable[..., Any], what: str, shape: tuple[int, ...], x: Array, before: tuple[float, ...]) -> Array:
        time, expected = before[0] if before else None, f"finite numbers of shape {shape} (axes of length 1 may be left out)"

        def fits(_: Any, value: Array) -> bool:
            return value.size == int(np.prod(shape)) and [n for n in value.shape if n > 1] == [n for n in shape if n > 1]

        return called(function, *before, *x.tolist(), fits=fits, expected=expected, what=f"its {what}", item=self.item, time=time).reshape(shape)

    def faults(self, x: Array, *before: float) -> list[str]:
        """Complaints about given derivatives that are not those of the function, at x [k]; none where a function fails there: the run that
        calls it says so."""
        try:
            return self._disagreements(x, before)
        except SimulationError:
            return []

    def _disagreements(self, x: Array, before: tuple[float, ...]) -> list[str]:
        free = Formula(lambda *x: self.function(*x), None, None, (self.r, self.k), self.item)
        found = []
        for what, given in self._given.items():
            if given:
                claimed, true = getattr(self, what)(x, *before), getattr(free, what)(x, *before)
                if np.max(np.abs(claimed - true)) > AGREED * max(np.max(np.abs(claimed)), np.max(np.abs(true)), 1e-300):
                    expected = f"{what}: expected the derivative of the function, {true.tolist()} at {x.tolist()} by differences"
                    found.append(f"{expected}, found {claimed.tolist()}; correct it, or leave it out")
        return found
