"""Dormand and Prince's method for q'' = a(q, q', t): its stages and its end as sums of accelerations alone.

A Runge-Kutta method with matrix A applied to q' = v, v' = a takes in its stages the velocities of other stages, which are sums of
accelerations themselves (Hairer, Norsett and Wanner 1993, II.14):

    q_i = q + c_i h v + h^2 sum (A A)_ij a_j,     v_i = v + h sum A_ij a_j

So a stage is one product of two rows of weights with the rows q, v, a_1, ..., and so are the end of the step and both error estimates.
"""

from __future__ import annotations

import numpy as np

from .dop853 import ERROR_3, ERROR_5, MATRIX, NODES, WEIGHTS
from .system import Array

STAGES = NODES.size
END, ERRORS = STAGES, slice(STAGES + 1, STAGES + 3)
"""Places of the end, and of the errors of orders 5 and 3, after those of the stages."""


def _powers() -> Array:
    """[3, stages + 3, 2, 2 + stages]: the factors of 1, h and h^2 in the weights of q, v, a_1, ... for positions and velocities, at the
    stages, the end and, for velocities times h, the errors."""
    out = np.zeros((3, STAGES + 3, 2, 2 + STAGES))
    matrix, nodes, errors = np.vstack((MATRIX, WEIGHTS)), np.append(NODES, 1.0), np.array([ERROR_5, ERROR_3])
    out[0, :ERRORS.start, 0, 0] = out[0, :ERRORS.start, 1, 1] = 1.0
    out[1, :ERRORS.start, 0, 1] = nodes
    out[2, :ERRORS.start, 0, 2:], out[1, :ERRORS.start, 1, 2:] = matrix @ MATRIX, matrix
    out[2, ERRORS, 0, 2:], out[2, ERRORS, 1, 2:] = errors @ MATRIX, errors
    return out


POWERS = _powers()


def combinations(h: float, out: Array) -> None:
    """The weights [stages + 3, 2, 2 + stages] for a step of length h."""
    np.dot((1.0, h, h * h), POWERS.reshape(3, -1), out.reshape(-1))
