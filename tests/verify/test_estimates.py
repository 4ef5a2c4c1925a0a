"""What differences between runs are made to say, on made-up runs whose errors are known."""

from __future__ import annotations

import numpy as np
import pytest

from mbd.verification.estimates import CAUTIOUS, LOST, Values, envelope, estimate, growth, order_of, plausible

T = np.linspace(0.0, 2.0, 41)
EXACT = np.stack((np.cos(T), np.sin(T)), axis=1)
WAY = np.stack((T**2, T * np.cos(3.0 * T)), axis=1)


def values(power: float, settings: tuple[float, float, float], factor: float = 1.0) -> Values:
    """Of runs whose error is factor h^power along WAY."""
    coarse, middle, fine = (EXACT + factor * h**power * WAY for h in settings)
    seldom = np.arange(T.size)[::-3][::-1]
    return Values(T, coarse[seldom], seldom, middle, fine)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 4.0, 6.0])
@pytest.mark.parametrize("settings", [(0.04, 0.02, 0.01), (1e-2, 1e-4, 1e-5), (1e-2, 1e-4, 2e-5)])
def test_the_order_of_a_power_law(power: float, settings: tuple[float, float, float]) -> None:
    coarse, fine = np.array([settings[0] ** power - settings[1] ** power]), np.array([settings[1] ** power - settings[2] ** power])
    assert order_of(coarse, fine, (settings[0] / settings[1], settings[1] / settings[2])) == pytest.approx(power, abs=2e-2)


def test_differences_that_do_not_fall_have_no_plausible_order() -> None:
    same = np.ones(5)
    assert order_of(same, same, (2.0, 2.0)) == pytest.approx(0.0, abs=1e-6)
    for nominal in (None, 2, 4):
        assert not plausible(order_of(same, same, (2.0, 2.0)), nominal)
        assert not plausible(order_of(same, 3.0 * same, (2.0, 2.0)), nominal)
        assert plausible(float("nan"), nominal)
    assert not plausible(1.0, 2)
    assert plausible(1.9, 2)
    assert plausible(1.0, None)


@pytest.mark.parametrize("order", [2, 4])
def test_fixed_steps_of_known_order_give_the_error_itself(order: int) -> None:
    found = estimate(values(order, (0.04, 0.02, 0.01), 0.1), (2.0, 2.0), order, 1.0)
    true = 0.1 * 0.01**order * np.linalg.norm(WAY, axis=1)
    assert found.errors[1:] == pytest.approx(true[1:], rel=1e-6)
    assert found.order == pytest.approx(order, abs=0.02)
    assert found.lost == np.inf


@pytest.mark.parametrize("power", [0.5, 0.7, 1.0, 1.3])
def test_tolerances_are_read_with_caution(power: float) -> None:
    """True errors are at most the estimate, and for powers up to 1.3 not below a tenth of it."""
    found = estimate(values(power, (1e-3, 1e-5, 1e-6)), (100.0, 10.0), None, 1.0)
    shares = (1e-6**power * np.linalg.norm(WAY, axis=1))[1:] / found.errors[1:]
    assert shares.min() > 0.1
    assert shares.max() <= 1.0 + 1e-9


def test_an_output_is_lost_where_its_error_is_a_share_of_its_range() -> None:
    made = values(1.0, (1e-3, 1e-4, 1e-5))
    off = made.fine + (np.exp(8.0 * (T - 2.0)) * 3.0)[:, None]
    found = estimate(made._replace(middle=off), (10.0, 10.0), None, 1.0)
    limit = LOST * np.linalg.norm(np.ptp(made.fine, axis=0))
    error = 3.0 * np.sqrt(2.0) * np.exp(8.0 * (T - 2.0)) / (10.0 ** CAUTIOUS - 1.0)
    assert found.lost == T[np.argmax(error > limit)]
    quoted, before = envelope(T, T, found.errors, found.lost), np.less(T, found.lost)
    assert np.isinf(quoted[~before]).all() and np.isfinite(quoted[before]).all()
    assert quoted[before].max() <= limit


def test_what_hardly_moves_is_not_lost_for_a_small_error() -> None:
    still = Values(T, None, np.arange(0), np.full((41, 2), 1.0) + 1e-9, np.full((41, 2), 1.0))
    assert estimate(still, (10.0, 10.0), None, 1.0).lost == np.inf


def test_the_envelope_covers_accidental_zeros() -> None:
    t = np.linspace(0.0, 10.0, 201)
    covered = envelope(t, t, np.abs(np.sin(4.0 * t)), np.inf)
    assert covered.min() > 0.7 and covered.max() <= 1.0


@pytest.mark.parametrize("rate", [0.5, 2.0, 7.0])
def test_exponential_growth_is_told_from_powers(rate: float) -> None:
    t = np.linspace(0.0, 30.0 / rate, 100)
    found = growth(t, 1e-9 * np.exp(rate * t) * (1.2 + np.sin(5.0 * rate * t)))
    assert found.exponential and found.exponent == pytest.approx(rate, rel=0.05)
    for power in (1.0, 2.0):
        assert not growth(t, 1e-9 * t**power * (1.2 + np.sin(5.0 * rate * t))).exponential
    assert np.isnan(growth(t, np.zeros(100)).exponent)
