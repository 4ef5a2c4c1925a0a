"""Strains and rows of a whole scene: shortcuts of small ones against the general way."""

import numpy as np
import pytest

import mbd
import mbd.strains as strains_module
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


@pytest.mark.parametrize("kind", ELASTIC, ids=lambda kind: kind.name)
@pytest.mark.parametrize("small", [0, 2**20])
def test_frozen_slopes_are_those_of_the_strains(kind: Elastic, small: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strains_module, "SMALL", small)
    rng, (_, system, _) = np.random.default_rng(7), kind.scene()
    at = system.strains(kind.state(rng, system)[0])
    stress, change = rng.normal(size=(3, system.n_stresses)), rng.normal(size=(3, system.n))
    for found, expected in ((at.frozen().pull(stress), at.pull(stress)), (at.frozen().push(change), at.push(change))):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.max(np.abs(expected)))


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
