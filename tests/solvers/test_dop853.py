"""The coefficients of the explicit method: row sums, quadrature to order 8, and embedded formulas that vanish as they must."""

from __future__ import annotations

import numpy as np
import pytest

from mbd.solvers.dop853 import ERROR_3, ERROR_5, MATRIX, NODES, WEIGHTS
from mbd.solvers.nystrom import END, ERRORS, combinations

ROUNDING = 1e-13  # coefficients up to 50 in size, given to 16 digits


def test_rows_sum_to_the_nodes() -> None:
    assert np.abs(MATRIX.sum(axis=1) - NODES).max() < ROUNDING
    assert np.array_equal(MATRIX, np.tril(MATRIX, -1))


@pytest.mark.parametrize("power", range(8))
def test_quadrature_has_order_8(power: int) -> None:
    assert WEIGHTS @ NODES**power == pytest.approx(1.0 / (power + 1), abs=ROUNDING)
    for weights, order in ((ERROR_5, 5), (ERROR_3, 3)):
        if power < order:
            assert weights @ NODES**power == pytest.approx(0.0, abs=ROUNDING)


@pytest.mark.parametrize("length", range(2, 9))
def test_tall_trees(length: int) -> None:
    """b A^(k-1) 1 = 1/k!: the order conditions that linear systems see."""
    tree = WEIGHTS @ np.linalg.matrix_power(MATRIX, length - 1) @ np.ones(12)
    assert tree == pytest.approx(1.0 / np.prod(np.arange(1.0, length + 1)), abs=ROUNDING)


def test_sums_of_accelerations_are_the_method() -> None:
    """One step of y'' = K y + D y' beside the Runge-Kutta method for (y, y')."""
    rng, h = np.random.default_rng(7), 0.3
    stiffness, damping, start = rng.standard_normal((3, 3)), rng.standard_normal((3, 3)), rng.standard_normal((2, 3))
    sums, rows = np.empty((15, 2, 14)), np.zeros((14, 3))
    combinations(h, sums)
    rows[:2] = start
    rates = np.zeros((12, 2, 3))
    for i in range(12):
        y, v = start + h * np.tensordot(MATRIX[i], rates, 1)
        rates[i] = v, stiffness @ y + damping @ v
        np.testing.assert_allclose(sums[i] @ rows, (y, v), atol=1e-12)
        rows[2 + i] = rates[i, 1]
    np.testing.assert_allclose(sums[END] @ rows, start + h * np.tensordot(WEIGHTS, rates, 1), atol=1e-12)
    for found, weights in zip(sums[ERRORS], (ERROR_5, ERROR_3)):
        position, velocity = h * np.tensordot(weights, rates, 1)
        np.testing.assert_allclose(found @ rows, (position, h * velocity), atol=1e-12)
