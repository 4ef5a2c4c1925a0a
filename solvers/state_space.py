"""First-order form of M x'' + D x' + K x = F u, y = C x: states (x, x')."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from .system import Array


def first_order(mass: Array, damping: Array, stiffness: Array, inputs: Array, outputs: Array) -> tuple[Array, Array, Array, Array]:
    """A [2 r, 2 r], B [2 r, p], C [k, 2 r], D [k, p] from M, D, K [r, r], F [r, p] and C [k, r]."""
    r = len(mass)
    factor = cho_factor(mass)
    a = np.zeros((2 * r, 2 * r))
    a[:r, r:] = np.eye(r)
    a[r:, :r], a[r:, r:] = -cho_solve(factor, stiffness), -cho_solve(factor, damping)
    b = np.concatenate((np.zeros_like(inputs), cho_solve(factor, inputs)))
    return a, b, np.concatenate((outputs, np.zeros_like(outputs)), axis=1), np.zeros((len(outputs), inputs.shape[1]))


def scipy_system(*matrices: Array) -> Any:
    """A scipy.signal.StateSpace."""
    from scipy.signal import StateSpace

    return StateSpace(*matrices)
