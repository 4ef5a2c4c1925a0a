"""The algebra of the Radau IIA tableaus, s = 1..9, in double precision, and the polynomials that predict stages."""

import numpy as np
import pytest

from mbd.solvers.coefficients import Tableau

ROUNDING = 2e-15
"""Numbers of size 1, rounded once from extended precision."""

pytestmark = pytest.mark.parametrize("s", range(1, 10))


def test_nodes_and_weights(s):
    t = Tableau(s)
    powers = np.arange(1, s + 1)
    assert t.c[-1] == 1.0 and np.all(np.diff(t.c) > 0.0) and t.c[0] > 0.0
    assert np.array_equal(t.b, t.a[-1]), "stiffly accurate"
    assert np.allclose(t.a @ t.c[:, None] ** (powers - 1), t.c[:, None] ** powers / powers, rtol=0, atol=ROUNDING), "C(s)"
    moments = [t.b @ t.c ** (k - 1) - 1.0 / k for k in range(1, 2 * s + 1)]
    assert np.abs(moments[:-1]).max() < ROUNDING, "B(2 s - 1)"
    assert abs(moments[-1]) > 100 * ROUNDING, "the order is 2 s - 1, not more"


def test_published_three_stages(s):
    # Hairer and Wanner (1996), table IV.5.6; the other numbers of stages have no entry there.
    root = np.sqrt(6.0)
    published = {1: [1.0], 2: [1 / 3, 1.0], 3: [(4 - root) / 10, (4 + root) / 10, 1.0]}
    if s in published:
        assert np.allclose(Tableau(s).c, published[s], rtol=0, atol=ROUNDING)


def test_inverse_and_derivatives(s):
    t = Tableau(s)
    # Rounding of each entry, 1e-16, times the size of the inverse, which grows as s^2.
    size = np.abs(t.inverse).max()
    assert np.abs(t.inverse @ t.a - np.eye(s)).max() < ROUNDING * size
    # The polynomial x^k through 0 and the stages: derivative at 0 is 1 for k = 1, else 0; at the stages k x^(k-1).
    for k in range(1, s + 1):
        assert abs(t.start @ t.c**k - (k == 1)) < ROUNDING * np.abs(t.start).max()
        assert np.abs(t.inverse @ t.c**k - k * t.c ** (k - 1)).max() < ROUNDING * size


def test_eigenvalues_decouple(s):
    t = Tableau(s)
    assert t.real == s % 2 and len(t.eigenvalues) == (s + 1) // 2
    assert np.all(t.eigenvalues.real > 0.0), "A-stable: no eigenvalue of A on the left"
    # The eigenvectors' condition, 1e4 for 9 stages, magnifies rounding; this only limits Newton's contraction, not its result.
    amplified = 1e-15 * np.linalg.cond(np.vstack((t.into, t.into.conj())))
    again = (t.back @ (t.eigenvalues[:, None] * t.into)).real
    assert np.abs(again - t.inverse).max() < 10 * amplified * np.abs(t.inverse).max()
    assert np.abs(t.back_parts @ t.into_parts - np.eye(s)).max() < 10 * amplified
    if t.real:
        assert t.eigenvalues[0].imag == pytest.approx(0.0, abs=1e-9) and t.gamma == t.eigenvalues[0].real


def test_stage_polynomials_are_reproduced(s):
    t = Tableau(s)
    ahead = np.array([0.3, 1.0, 1.2, 2.0])
    for with_start in (True, False):
        nodes = np.concatenate(([0.0], t.c)) if with_start else t.c
        weights = t.extend(ahead, with_start=with_start)
        for k in range(len(nodes)):  # beyond the step rounding grows as the weights do
            assert np.allclose(weights @ nodes**k, ahead**k, rtol=0, atol=1e-14 * np.abs(weights).sum())
