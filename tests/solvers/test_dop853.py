"""The coefficients of the explicit method: row sums, quadrature to order 8, and embedded formulas that vanish as they must."""

from __future__ import annotations

import numpy as np
import pytest

from mbd.solvers.dop853 import ERROR_3, ERROR_5, MATRIX, NODES, WEIGHTS

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
