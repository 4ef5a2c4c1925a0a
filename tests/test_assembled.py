"""Strains and rows of a whole scene: shortcuts of small ones against the general way."""

import numpy as np
import pytest

import mbd
import mbd.strains as strains_module
import mbd.sums as sums_module
import mbd.system as system_module
from mbd.affine import Affine, Scalar
from mbd.constraint import Quadratic
from mbd.rows import Row, distance
from mbd.scatter import MANY, Scatter

from .kinds import ELASTIC, Elastic


def test_slopes_of_few_strains_are_one_matrix(monkeypatch) -> None:
    scene, rng = mbd.Scene(gravity=(0.0, -9.81)), np.random.default_rng(3)
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.0, 0.0), n_elements=3, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
    scene.add(mbd.Spring(rod.end, scene.ground.at(1.0, 0.5), stiffness=10.0, length=0.3))
    system = scene.build()
    at = system.strains(system.q0 + 0.05 * rng.normal(size=system.n))
    stress, change = rng.normal(size=(5, system.n_stresses)), rng.normal(size=(5, system.n))
    whole = at.frozen()
    monkeypatch.setattr(strains_module, "SMALL", 0)
    parts = at.frozen()
    assert type(whole) is not type(parts)
    np.testing.assert_allclose(whole.pull(stress), parts.pull(stress), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(whole.push(change), parts.push(change), rtol=1e-12, atol=1e-12)


def joints_of_three_kinds() -> mbd.Scene:
    """Linear and quadratic rows, turns of a cable against the ground and against a body, a blade."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.0, 0.2), n_elements=2, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(1.3, 0.2), angle=0.3))
    scene.add(mbd.Prescribed(rod.start, (0.0, 0.0), angle=lambda t: 0.2 + t))
    scene.add(mbd.Pin(body.at(-0.3, 0.0), rod.end))
    scene.add(mbd.Distance(body.at(0.1, 0.1), scene.ground.at(2.0, 1.0)))
    scene.add(mbd.TorsionSpring(body.at(0.0, 0.0), rod.end, stiffness=1.0))
    scene.add(mbd.KnifeEdge(body.at(0.2, 0.0), axis=(1.0, 0.0)))
    return scene


def evaluated(q: np.ndarray, v: np.ndarray, multipliers: np.ndarray) -> dict[str, np.ndarray]:
    joints = joints_of_three_kinds().build().joints
    at = joints.at(q)
    return {
        "value": at.value, "gradient": at.gradient, "swirl": at.swirl(v), "bias": at.bias(v), "curvature": at.curvature(multipliers),
        "push": at.push(v), "pull": at.pull(multipliers),
    }  # fmt: skip


@pytest.mark.parametrize("batch", [(), (3,), (2, 3)])
def test_equations_of_small_scenes_are_products_of_matrices(batch: tuple[int, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    system, rng = joints_of_three_kinds().build(), np.random.default_rng(4)
    assert len(system.joints.kernels) == 3
    q = system.q0 + 0.3 * rng.normal(size=(*batch, system.n))
    v, multipliers = rng.normal(size=q.shape), rng.normal(size=(*batch, system.m))
    by_products = evaluated(q, v, multipliers)
    monkeypatch.setattr(sums_module, "SMALL", 0)
    for name, values in evaluated(q, v, multipliers).items():
        assert values.shape == by_products[name].shape and np.ptp(values) > 0.0, name
        np.testing.assert_allclose(by_products[name], values, rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("small", [0, 100])
def test_affine_maps_are_their_matrices(small: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With entries in any order, twice in one place, and rows without any: behind, between and before the others."""
    monkeypatch.setattr(sums_module, "SMALL", small)
    rng = np.random.default_rng(1)
    for rows in ([3, 1, 3, 2, 1], [1, 1, 1, 3, 3], [0, 1, 2, 3, 4], []):
        index, columns, weights = np.array(rows, dtype=np.intp), np.arange(5)[: len(rows)] % 3, rng.normal(size=len(rows))
        matrix, constant = np.zeros((5, 3)), rng.normal(size=5)
        np.add.at(matrix, (index, columns), weights)
        x = rng.normal(size=(4, 3))
        found = sums_module.affine(constant, index, columns, weights, 3)
        np.testing.assert_allclose(found(x), constant + x @ matrix.T, rtol=1e-14, atol=1e-14)
        np.testing.assert_allclose(found.slope(x[0]), matrix @ x[0], rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("kind", ELASTIC, ids=lambda kind: kind.name)
@pytest.mark.parametrize("small", [0, 2**20])
def test_frozen_slopes_are_those_of_the_strains(kind: Elastic, small: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strains_module, "SMALL", small)
    rng, (_, system, _) = np.random.default_rng(7), kind.scene()
    at = system.strains(kind.state(rng, system)[0])
    stress, change = rng.normal(size=(3, system.n_stresses)), rng.normal(size=(3, system.n))
    for found, expected in ((at.frozen().pull(stress), at.pull(stress)), (at.frozen().push(change), at.push(change))):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.max(np.abs(expected)))


@pytest.mark.parametrize("kind", ELASTIC, ids=lambda kind: kind.name)
def test_derivatives_at_one_configuration_serve_velocities_of_many(kind: Elastic) -> None:
    """The middle of a step, and the velocities of its stages."""
    rng, (_, system, _) = np.random.default_rng(8), kind.scene()
    at = system.strains(kind.state(rng, system)[0])
    v, change = rng.normal(size=(2, 3, system.n))
    together = at.swirl_times(v, change)
    for k in range(3):
        np.testing.assert_allclose(together[k], at.swirl_times(v[k], change[k]), rtol=1e-11, atol=1e-11 * np.max(np.abs(together)))


@pytest.mark.parametrize("targets", [10, 2 * MANY])
def test_sums_of_local_values(targets: int) -> None:
    rng = np.random.default_rng(5)
    place, local, expected = rng.integers(0, 50, targets), rng.normal(size=(2, 3, targets)), np.zeros((2, 3, 50))
    np.add.at(expected, (..., place), local)
    np.testing.assert_allclose(Scatter(place, 50)(local), expected, rtol=0.0, atol=1e-12)


def test_rows_without_coordinates_keep_their_value() -> None:
    def point(index: int) -> Affine:
        return Affine.of(np.array([index]), np.ones(1), 2)

    fixed = Row(Scalar(np.zeros(0, dtype=np.intp), np.zeros(0), 0.25))
    rows = Quadratic([fixed, distance(point(0), point(1), 2.0), fixed], 4)
    q = np.array([[0.0, 0.0, 3.0, 0.0], [0.0, 1.0, 0.0, 3.0]])
    np.testing.assert_allclose(rows.value(rows.prepare(q)), [[0.25, 1.25, 0.25], [0.25, 0.0, 0.25]])
    assert set(rows.rows) == {1} and list(rows.constant_rows) == [True, False, True]
    np.testing.assert_allclose(rows.bias(rows.prepare(q), np.array([1.0, 0.0, 0.0, 0.0])), [0.0, 0.5, 0.0])


def test_steady_loads_are_asked_for_their_values_once() -> None:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0.0, 0.0)))
    scene.add(mbd.Torque(body.at(0.0, 0.0), 2.0))
    system = scene.build()
    assert system.inputs(0.0).loads is system.inputs(np.linspace(0.0, 1.0, 3)).loads


def test_masses_of_few_coordinates_are_one_matrix(monkeypatch) -> None:
    """With coordinates that have no mass, such as turning angles."""
    scene, rng = mbd.Scene(gravity=(0.0, -9.81)), np.random.default_rng(4)
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.0, 0.0), n_elements=3, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
    scene.add(mbd.Motor(rod.start, scene.ground, angle=lambda t: t))
    whole = scene.build()
    monkeypatch.setattr(system_module, "DENSE_MASS", 0)
    scene.add(mbd.Force(rod.end, (0.0, 0.0)))  # builds anew
    parts = scene.build()
    assert parts is not whole and whole.n > whole.n_table
    for batch in ((), (5,), (2, 3)):
        x = rng.normal(size=(*batch, whole.n))
        np.testing.assert_allclose(whole.mass(x), parts.mass(x), rtol=1e-13, atol=1e-16)
    assert np.all(whole.mass(np.ones(whole.n))[whole.n_table :] == 0.0)
