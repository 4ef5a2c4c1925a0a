"""The KKT matrix in three formats: equal solutions, equal refusals, a condition that can be believed, a format chosen by cost."""

from types import SimpleNamespace

import numpy as np
import pytest

import mbd
import mbd.solvers.linear as linear_module
from mbd.solvers.formats import Band, Dense, Singular, Sparse
from mbd.solvers.linear import Linear
from mbd.solvers.ordering import half_bandwidth, reverse_cuthill_mckee

FORMATS = {
    "dense": lambda size, half, rows, cols: Dense(size),
    "band": lambda size, half, rows, cols: Band(size, half),
    "sparse": lambda size, half, rows, cols: Sparse(size, rows, cols),
}


class RandomSystem:
    """Patterns and values of M (positive), K, D (symmetric) and G on random coordinates, and the same as full matrices."""

    def __init__(self, seed, n=23, m=7):
        rng = np.random.default_rng(seed)
        self.n, self.m, self.length, self.levers, self.lengths, self.arm = n, m, 1.0, np.ones(n), np.zeros(n, dtype=bool), np.inf
        self.vectors = self.mass_rows = self.mass_cols = np.arange(n)
        self.mass_values = rng.uniform(0.5, 2.0, n)
        i, j = rng.integers(0, n, (2, 3 * n))
        value = rng.normal(size=i.size)
        self.stiffness_rows, self.stiffness_cols = np.concatenate((i, j)), np.concatenate((j, i))
        self.damping_rows, self.damping_cols = self.stiffness_rows, self.stiffness_cols
        self.k_values, self.d_values = np.concatenate((value, value)), 0.1 * np.concatenate((value, value))
        # Each row of G has a coordinate of its own, so that the rows are independent, and two more.
        cols = np.array([[r, *m + rng.choice(n - m, 2, replace=False)] for r in range(m)])
        self.g_values = rng.normal(size=(m, 3)) + np.array([2.0, 0.0, 0.0])
        self.joints = SimpleNamespace(m=m, rows=np.repeat(np.arange(m), 3), cols=cols.ravel(), linear=False, slips=np.zeros(0, np.intp), at=self._at)

    def _at(self, q):
        return SimpleNamespace(gradient=self.g_values.ravel())

    def full(self, rows, cols, values, shape=None):
        matrix = np.zeros(shape or (self.n, self.n))
        np.add.at(matrix, (rows, cols), values)
        return matrix

    def kkt(self, c_mass, c_damping, c_stiffness):
        g = self.full(self.joints.rows, self.joints.cols, self.g_values.ravel(), (self.m, self.n))
        top = c_mass * np.diag(self.mass_values) + c_stiffness * self.full(self.stiffness_rows, self.stiffness_cols, self.k_values)
        top = top + c_damping * self.full(self.damping_rows, self.damping_cols, self.d_values)
        return np.block([[top, g.T], [g, np.zeros((self.m, self.m))]])

    def factor(self, monkeypatch, name, c_mass=1.0, c_damping=0.0, c_stiffness=0.0):
        monkeypatch.setattr(linear_module, "cheapest", FORMATS[name])
        linear = Linear(self, np.zeros(self.n))
        assert linear.format.name == name
        tangent = linear.tangent(self.g_values.ravel(), self.k_values, self.d_values)
        return linear, linear.factor(tangent, c_mass, c_damping, c_stiffness)


@pytest.mark.parametrize("softened", [False, True])
@pytest.mark.parametrize("name", FORMATS)
def test_matrices_of_several_rates_solve_their_own_equations(monkeypatch, name, softened):
    system, rates = RandomSystem(3), [60.0, 50.0 + 40.0j, 30.0 + 70.0j]
    linear, _ = system.factor(monkeypatch, name)
    if softened:
        linear.soften()
    factors = linear.factors(linear.tangent(system.g_values.ravel(), system.k_values, system.d_values), rates)
    right = np.random.default_rng(5).normal(size=system.n + system.m)
    for z, factor in zip(rates, factors):
        np.testing.assert_array_equal(factor.weight, factors[0].weight)
        x = np.concatenate(factor.solve(right[: system.n], right[system.n :]))
        expected = np.linalg.solve(system.kkt(z * z, z, 1.0), right)
        assert np.max(np.abs(x - expected)) < (1e-4 if softened else 1e-11) * np.max(np.abs(expected))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("coefficients", [(1.0, 0.0, 0.0), (2e4, 150.0, 1.0), (3e3 + 4e3j, 50.0 + 60.0j, 1.0)])
@pytest.mark.parametrize("name", FORMATS)
def test_formats_agree(monkeypatch, name, coefficients, seed):
    system = RandomSystem(seed)
    _, factor = system.factor(monkeypatch, name, *coefficients)
    matrix = system.kkt(*coefficients)
    rng = np.random.default_rng(99)
    for shape in ((), (3,)):
        right = rng.normal(size=(*shape, system.n + system.m))
        x, y = factor.solve(right[..., : system.n], right[..., system.n :])
        expected = np.linalg.solve(matrix, right[..., None])[..., 0]
        # The matrices' scaled condition is below 1e3: rounding leaves 1e-13 of each block, whose sizes differ by c_mass.
        for found, true in ((x, expected[..., : system.n]), (y, expected[..., system.n :])):
            assert found.shape == true.shape
            assert np.abs(found - true).max() < 1e-10 * np.abs(true).max()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", FORMATS)
def test_dependent_equations_are_singular(monkeypatch, name, seed):
    system = RandomSystem(seed)
    system.joints.cols[3:6] = system.joints.cols[:3]
    system.g_values[1] = 0.3 * system.g_values[0]
    with pytest.raises(Singular):
        system.factor(monkeypatch, name)


@pytest.mark.parametrize("name", FORMATS)
def test_softened_equations_give_least_multipliers(monkeypatch, name):
    system = RandomSystem(0)
    system.joints.cols[3:6] = system.joints.cols[:3]
    system.g_values[1] = system.g_values[0]
    monkeypatch.setattr(linear_module, "cheapest", FORMATS[name])
    linear = Linear(system, np.zeros(system.n))
    linear.soften()
    factor = linear.factor(linear.tangent(system.g_values.ravel()))
    _, y = factor.solve(np.ones(system.n), np.zeros(system.m))
    # Two equal equations share their multiplier equally; softening is 1e-10, rounding divided by it 1e-6.
    assert y[0] == pytest.approx(y[1], rel=1e-5)
    assert abs(y[0]) > 1e-3


@pytest.mark.parametrize("gap", [1.0, 1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("name", FORMATS)
def test_condition_estimate(monkeypatch, name, gap):
    system = RandomSystem(1)
    system.joints.cols[3:6] = system.joints.cols[:3]
    system.g_values[1] = system.g_values[0] * (1.0 + gap * np.array([1.0, -1.0, 0.5]))
    linear, factor = system.factor(monkeypatch, name)
    scaled = linear.scale[:, None] * system.kkt(1.0, 0.0, 0.0) * linear.scale
    true = 1.0 / np.linalg.cond(scaled, 1)
    # The two rows make the condition the square of 1 / gap.
    # One vector's growth bounds |A^-1| from below: the estimate is never pessimistic, and within 100 of the truth.
    assert 0.5 * true < factor.rcond < 100.0 * true
    assert true < 10.0 * gap**2


def test_mass_and_gradient_alone_need_no_stiffness(monkeypatch):
    system = RandomSystem(2)
    linear, _ = system.factor(monkeypatch, "dense")
    bare = linear.factor(linear.tangent(system.g_values.ravel()))
    right = np.arange(float(system.n + system.m))
    x, y = bare.solve(right[: system.n], right[system.n :])
    assert np.allclose(np.concatenate((x, y)), np.linalg.solve(system.kkt(1.0, 0.0, 0.0), right), rtol=1e-10)


def _linear(scene):
    system = scene.build()
    return Linear(system, system.q0)


def _chosen(scene):
    return _linear(scene).format


def _particles(scene, count):
    return [scene.add(mbd.Particle(1.0, (0.1 * (k + 1), 0.0))) for k in range(count)]


def test_small_scenes_are_dense():
    scene = mbd.Scene(gravity=(0, -9.81))
    (ball,) = _particles(scene, 1)
    scene.add(mbd.Distance(ball.at(), scene.ground.at(0, 0)))
    assert _chosen(scene).name == "dense"


def test_chains_are_bands():
    scene = mbd.Scene(gravity=(0, -9.81))
    balls = _particles(scene, 60)
    for a, b in zip(balls[:-1], balls[1:]):
        scene.add(mbd.Distance(a.at(), b.at()))
    chosen = _chosen(scene)
    # Two coordinates and one multiplier for each ball: neighbours are at most 5 unknowns apart in the best order.
    assert chosen.name == "band" and chosen.half <= 5


def test_stars_are_sparse():
    scene = mbd.Scene(gravity=(0, -9.81))
    hub = scene.add(mbd.Particle(1.0, (0, 1)))
    for ball in _particles(scene, 200):
        scene.add(mbd.Distance(hub.at(), ball.at()))
    assert _chosen(scene).name == "sparse"


def test_reverse_cuthill_mckee_finds_a_shuffled_chain():
    rng = np.random.default_rng(5)
    shuffled = rng.permutation(300)
    rows, cols = shuffled[:-1], shuffled[1:]
    order = reverse_cuthill_mckee(rows, cols, 300)
    assert np.array_equal(np.sort(order), np.arange(300))
    assert half_bandwidth(rows, cols, np.arange(300)) > 100
    assert half_bandwidth(rows, cols, order) == 1


def test_reverse_cuthill_mckee_on_separate_parts_and_none():
    # Two chains and a loose vertex: each part is numbered on its own.
    rows, cols = np.array([0, 2, 1, 3]), np.array([2, 4, 3, 6])
    order = reverse_cuthill_mckee(rows, cols, 7)
    assert np.array_equal(np.sort(order), np.arange(7))
    assert half_bandwidth(rows, cols, order) == 1
    assert reverse_cuthill_mckee(rows[:0], cols[:0], 0).size == 0


@pytest.mark.parametrize("metre", [1.0, 1e3], ids=["m", "mm"])
def test_the_coarsest_tolerance_is_a_small_turn_of_the_smallest_rigid_body_in_any_unit(metre):
    scene = mbd.Scene(gravity=(0, -9.81 * metre))
    _particles(scene, 2)
    assert _linear(scene).coarsest == np.inf  # a point does not turn
    for length in (12.0**0.5 * metre, 3.0 * metre):  # the first has a radius of gyration of 1 m, the lever of positions
        scene.add(mbd.RigidBody.rod((0, 0), (length, 0), mass=2.0))
        assert _linear(scene).coarsest == pytest.approx(linear_module.TURN * length / 12.0**0.5)
    scene.add(mbd.AncfCable((0, 0), (metre, 0), n_elements=1, E=1.0, A=1.0, I=1.0, rho=1.0))
    assert _linear(scene).coarsest == np.inf
