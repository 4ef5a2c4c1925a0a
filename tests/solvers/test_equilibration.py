"""Scales by a matching: no entry above 1, one of 1 in every row, in whatever units; and what they make of loops of very unequal masses."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mbd
from mbd.assembly import prepare
from mbd.solvers.equilibration import equilibrated
from mbd.solvers.start import mass_factor

GRAVITY = 9.81


def saddle(seed, n=12, m=5):
    """A symmetric matrix with a random diagonal over 30 decades and rows of a random G."""
    rng = np.random.default_rng(seed)
    matrix = np.zeros((n + m, n + m))
    matrix[np.arange(n), np.arange(n)] = 10.0 ** rng.uniform(-15, 15, n)
    for row in range(m):
        cols = np.concatenate(([row], m + rng.choice(n - m, 3, replace=False)))
        matrix[n + row, cols] = matrix[cols, n + row] = 10.0 ** rng.uniform(-3, 3, 4)
    return matrix


def scales(matrix):
    rows, cols = np.nonzero(matrix)
    return equilibrated(rows, cols, np.abs(matrix[rows, cols]), len(matrix))


@pytest.mark.parametrize("seed", range(20))
def test_every_row_has_an_entry_of_one_and_none_above(seed):
    matrix = saddle(seed)
    d = scales(matrix)
    np.testing.assert_allclose(np.max(d[:, None] * matrix * d, axis=1), 1.0, rtol=2e-3)


def test_units_do_not_matter():
    matrix, units = saddle(1), 10.0 ** np.random.default_rng(2).uniform(-6, 6, 17)
    scaled = scales(matrix)[:, None] * matrix * scales(matrix)
    other = units[:, None] * matrix * units
    again = scales(other)[:, None] * other * scales(other)
    np.testing.assert_allclose(np.linalg.cond(again), np.linalg.cond(scaled), rtol=0.9)


def test_what_no_matching_covers_has_no_scales():
    assert scales(np.array([[1.0, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])) is None


def parallelogram(coupler, bob=0.0, tilt=np.pi / 3.0):
    """Two links of 1 m and 1 kg with a coupler, released at an angle from hanging, and a rod that hangs from the coupler's end."""
    scene, tip = mbd.Scene(gravity=(0.0, -GRAVITY)), np.array([np.sin(tilt), -np.cos(tilt)])
    links = [scene.add(mbd.RigidBody.rod((k, 0), tip + (k, 0), mass=1.0)) for k in (0, 1)]
    middle = scene.add(mbd.RigidBody.rod(tip, tip + (1, 0), mass=coupler))
    for k, link in enumerate(links):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(k, 0)))
        scene.add(mbd.Pin(link.at(0.5, 0), middle.at(k - 0.5, 0)))
    end = links[0].at(0.5, 0)
    if bob:
        rod = scene.add(mbd.RigidBody.rod(tip, tip + (0, -1), mass=bob))
        scene.add(mbd.Pin(rod.at(-0.5, 0), middle.at(-0.5, 0)))
        end = rod.at(0.5, 0)
    return scene, end


@pytest.mark.parametrize("ratio", [1e-30, 1e-12, 1e-6, 1.0, 1e6, 1e12, 1e15, 1e30])
def test_masses_do_not_spoil_the_condition(ratio):
    system = parallelogram(ratio)[0].build()
    linear, redundant = prepare(system, system.q0)
    assert not redundant
    assert mass_factor(system, linear, system.q0).rcond > 1e-3


@pytest.mark.parametrize("solver", [None, mbd.Radau()], ids=["automatic", "radau"])
@pytest.mark.parametrize("ratio", [1e8, 1e15, 1e20])
def test_what_is_light_and_free_moves_beside_what_is_light_and_held(ratio, solver):
    """A rod on the coupler: its support goes the way of a pendulum of the length of the links, whatever the rod does."""
    scene, end = parallelogram(ratio, bob=1.0)
    result = mbd.simulate(scene, 1.0, rtol=1e-8, solver=solver)

    def rates(t, y):
        a, va, b, vb = y  # angles of the links and of the rod, from hanging
        turning = -GRAVITY * np.sin(a)
        x, z = turning * np.cos(a) - va**2 * np.sin(a), turning * np.sin(a) + va**2 * np.cos(a)
        return va, turning, vb, -1.5 * ((GRAVITY + z) * np.sin(b) + x * np.cos(b))

    a, _, b, _ = solve_ivp(rates, (0.0, 1.0), (np.pi / 3.0, 0.0, 0.0, 0.0), rtol=1e-11, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(result.position(end)[-1], (np.sin(a) + np.sin(b), -np.cos(a) - np.cos(b)), atol=3e-7)
    assert result.audit.position_drift < 1e-13
    assert result.stats["rejected"] <= 5
