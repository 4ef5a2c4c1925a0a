"""Every elastic kind (kinds.ELASTIC): forces are gradients, tangents Hessians, dampers and many items at once right; then masses and gravity."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import mbd

from .kinds import ELASTIC, Elastic, dense, derivative, moved, rotation
from .symbolic import evaluate, hermite

EXACT = 1e-12
"""Relative to the largest entry, against 30 digits: some hundred roundings of 1e-16, amplified by |r'|^-4 of the strains."""

DIFFERENCED = 1e-10
"""Central differences of order 6 over 5e-4: rounding 1e-12 and 1e-22 times a seventh derivative of up to 1e11 (|r'| = 0.1 somewhere)."""

kinds = pytest.mark.parametrize("kind", ELASTIC, ids=lambda kind: kind.name)
damped = pytest.mark.parametrize("damping", [0.0, 0.3], ids=["elastic", "damped"])


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest difference, relative to the largest number expected."""
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def rng_of(kind: Elastic) -> np.random.Generator:
    return np.random.default_rng(sum(map(ord, kind.name)))


def stiffness(system: mbd.scene.System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """K [n, n] of the elastic forces, damping included."""
    stress = system.stress(system.strains(q), v)
    values = system.stiffness(q, v, system.inputs(0.0), stress, np.zeros(system.m))
    return dense(system.stiffness_rows, system.stiffness_cols, values, (system.n, system.n))


def damping_matrix(system: mbd.scene.System, q: np.ndarray) -> np.ndarray:
    return dense(system.damping_rows, system.damping_cols, system.damping(q, np.zeros_like(q), system.inputs(0.0)), (system.n, system.n))


def internal(system: mbd.scene.System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The elastic and damping force B' sigma [n]: there is no gravity and no load here."""
    return -system.force(q, v, system.inputs(0.0))


@kinds
@damped
def test_energy_force_and_tangents_agree_with_sympy(kind: Elastic, damping: float) -> None:
    _, system, items = kind.scene(damping=damping)
    rng = rng_of(kind)
    terms = [term for item in items for term in kind.terms(item, system.q0)]
    for _ in range(2):
        q, v = kind.state(rng, system)
        energy, force, k, d = evaluate(terms, q, v)
        assert float(system.elastic(q)) == pytest.approx(energy, rel=EXACT)
        assert relative(internal(system, q, v), force) < EXACT
        assert relative(stiffness(system, q, v), k) < EXACT
        if damping:
            assert relative(damping_matrix(system, q), d) < EXACT
        else:
            assert system.viscosity is None and not d.any()


@kinds
@damped
def test_force_and_tangents_agree_with_differences(kind: Elastic, damping: float) -> None:
    _, system, _ = kind.scene(damping=damping)
    rng = rng_of(kind)
    q, v = kind.state(rng, system)
    dq, dv = rng.standard_normal((2, system.n))
    still = np.zeros(system.n)
    assert relative(internal(system, q, still) @ dq, derivative(system.elastic, q, dq)) < DIFFERENCED
    assert relative(stiffness(system, q, v) @ dq, derivative(lambda x: internal(system, x, v), q, dq)) < DIFFERENCED
    if damping:
        assert relative(damping_matrix(system, q) @ dv, derivative(lambda x: internal(system, q, x), v, dv)) < DIFFERENCED
        loss = np.sum(system.viscosity * system.strains(q).push(v) ** 2)
        assert (internal(system, q, v) - internal(system, q, still)) @ v == pytest.approx(loss, rel=EXACT)


@kinds
def test_push_and_pull_are_the_gradient_of_the_strains(kind: Elastic) -> None:
    _, system, _ = kind.scene(damping=0.3)
    rng = rng_of(kind)
    q, v = kind.state(rng, system)
    dq, sigma = rng.standard_normal(system.n), rng.standard_normal(system.n_stresses)
    at = system.strains(q)
    assert relative(at.push(dq), derivative(lambda x: system.strains(x).value, q, dq)) < DIFFERENCED
    # The same sum of products in two orders: rounding only.
    assert abs(sigma @ at.push(dq) - at.pull(sigma) @ dq) < 1e-13 * np.abs(sigma) @ np.abs(at.push(dq))
    swirl = derivative(lambda x: system.strains(x).push(v), q, dq)
    assert np.max(np.abs(at.swirl_times(v, dq) - swirl)) <= DIFFERENCED * np.max(np.abs(swirl))


@pytest.mark.parametrize("kind", [kind for kind in ELASTIC if kind.free], ids=lambda kind: kind.name)
def test_rigid_motion_costs_no_energy_and_turns_the_force(kind: Elastic) -> None:
    scene, system, _ = kind.scene(damping=0.3)
    rng, still = rng_of(kind), np.zeros(system.n)
    turn, shift = rotation(rng, kind.dimension), 3.0 * rng.standard_normal(kind.dimension)
    if kind.stress_free:
        rest = moved(system, scene, system.q0, turn, shift)
        stress = system.stress(system.strains(rest), still)
        # Differences of coordinates of size 10 over elements of length 0.5, in units of the modulus: 1e-14.
        assert np.max(np.abs(system.strains(rest).value)) < 1e-12
        assert np.max(np.abs(stress)) < 1e-12 * np.max(system.modulus)
        assert np.max(np.abs(internal(system, rest, still))) < 1e-12 * np.max(np.abs(stiffness(system, rest, still)))
    q, v = kind.state(rng, system)
    other, other_v = moved(system, scene, q, turn, shift), moved(system, scene, v, turn, np.zeros(kind.dimension))
    force = moved(system, scene, internal(system, q, v), turn, np.zeros(kind.dimension))
    assert float(system.elastic(other)) == pytest.approx(float(system.elastic(q)), rel=1e-12)
    assert relative(internal(system, other, other_v), force) < 1e-12


@kinds
def test_many_items_are_the_same_as_one_at_a_time(kind: Elastic) -> None:
    """Bitwise: every item and stage goes through the same sums."""
    together, system, _ = kind.scene(items=(0, 1, 2), damping=0.3)
    rng, names = rng_of(kind), together.coordinates()
    q, v = kind.state(rng, system)
    strains, force, k, d = system.strains(q).value, internal(system, q, v), stiffness(system, q, v), damping_matrix(system, q)
    apart = []
    for item in range(3):
        alone, single, _ = kind.scene(items=(item,), damping=0.3)
        own = [names.index(name) for name in alone.coordinates()]
        apart.append(single.strains(q[own]).value)
        assert np.array_equal(internal(single, q[own], v[own]), force[own])
        assert np.array_equal(stiffness(single, q[own], v[own]), k[np.ix_(own, own)])
        assert np.array_equal(damping_matrix(single, q[own]), d[np.ix_(own, own)])
    assert np.array_equal(np.sort(np.concatenate(apart)), np.sort(strains))


@kinds
def test_stages_are_the_same_as_one_at_a_time(kind: Elastic) -> None:
    """For any leading axes; not bitwise, because numpy orders some sums of products by the size of the batch: a few roundings."""
    _, system, _ = kind.scene(damping=0.3)
    rng = rng_of(kind)
    q, v = (np.array(x).reshape(2, 3, -1) for x in zip(*(kind.state(rng, system) for _ in range(6))))
    dq, sigma = rng.standard_normal(q.shape), rng.standard_normal((2, 3, system.n_stresses))

    def everything(q: np.ndarray, v: np.ndarray, dq: np.ndarray, sigma: np.ndarray) -> list[np.ndarray]:
        at = system.strains(q)
        return [at.value, at.pull(sigma), at.push(v), at.swirl_times(v, dq), internal(system, q, v), system.elastic(q)]

    many = everything(q, v, dq, sigma)
    for i in np.ndindex(2, 3):
        for batched, single in zip(many, everything(q[i], v[i], dq[i], sigma[i])):
            assert np.max(np.abs(batched[i] - single)) <= 4e-15 * np.max(np.abs(single))


@kinds
@pytest.mark.parametrize("layout", ["F", "swapped"])
def test_the_layout_of_arrays_does_not_matter(kind: Elastic, layout: str) -> None:
    _, system, _ = kind.scene(items=(0,), damping=0.3)
    rng = rng_of(kind)
    q, v = (np.array(x).reshape(2, 3, -1) for x in zip(*(kind.state(rng, system) for _ in range(6))))
    sigma = rng.standard_normal((2, 3, system.n_stresses))

    def laid(x: np.ndarray) -> np.ndarray:
        return np.asfortranarray(x) if layout == "F" else np.ascontiguousarray(x.swapaxes(0, 1)).swapaxes(0, 1)

    at, other = system.strains(q), system.strains(laid(q))
    for plain, found in ((at.value, other.value), (at.pull(sigma), other.pull(laid(sigma))), (at.push(v), other.push(laid(v)))):
        assert np.max(np.abs(found - plain)) <= 4e-15 * np.max(np.abs(plain))
    assert relative(internal(system, laid(q), laid(v)), internal(system, q, v)) < 4e-15


def test_springs_between_unlike_markers_share_one_kernel() -> None:
    """Maps of different sizes are padded with zeros: same numbers but for the order of a sum."""
    scene, pair = mbd.Scene(gravity=(0, 0)), []
    cable = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1, A=1, I=1, rho=1))
    ball, box = scene.add(mbd.Particle(1.0, (0.2, 1.0))), scene.add(mbd.RigidBody.box((1, 1), mass=1, position=(2, 1)))
    for k, (a, b) in enumerate([(cable.at(0.3), box.at(0.5, 0.5)), (ball.at(), scene.ground.at(0, 0))]):
        pair.append(scene.add(mbd.Spring(a, b, stiffness=2.0 + k, length=0.5)).description)
    system = scene.build()
    springs = system.measures[-1]
    q = system.q0 + 0.1 * np.random.default_rng(0).standard_normal(system.n)
    at = springs.at(q)
    for k, spring in enumerate(pair):
        apart = (spring.a.point - spring.b.point).value(q)
        force = (2.0 + k) * (np.linalg.norm(apart) - 0.5) * apart / np.linalg.norm(apart)
        expected = np.zeros(system.n)
        for marker, sign in ((spring.a, 1), (spring.b, -1)):
            np.add.at(expected, marker.point.columns(), sign * marker.point.matrix().T @ force)
        sigma = np.zeros((2, 1))
        sigma[k] = at.value[k] * springs.modulus[k]
        found = np.zeros(system.n)
        np.add.at(found, springs.dofs, at.pull(sigma))
        assert relative(found, expected) < 1e-15


# Lengths, masses and gravity.


def cable(scene: mbd.Scene, **changes: object) -> object:
    numbers = {"E": 2.0, "A": 0.0018, "I": 0.5, "rho": 2770.0, **changes}
    return scene.add(mbd.AncfCable(**numbers))


def circle(n: int, circumference: float = 2.4) -> dict[str, np.ndarray]:
    radius, angle = circumference / (2 * np.pi), 2 * np.pi * np.arange(n + 1) / n
    return {"nodes": radius * np.stack((np.cos(angle), np.sin(angle)), 1), "tangents": np.stack((-np.sin(angle), np.cos(angle)), 1)}


def mass_matrix(system: mbd.scene.System) -> np.ndarray:
    return dense(system.mass_rows, system.mass_cols, system.mass_values, (system.n, system.n))


def positions(scene: mbd.Scene) -> np.ndarray:
    return np.array([label.endswith(("position", "mass centre")) for label in scene.layout.row_labels()])


def test_element_length_is_that_of_the_arc_or_the_line() -> None:
    """Elements through points of a circle with its tangents are as long as the arc, straight ones as the chord."""
    scene = mbd.Scene()
    assert cable(scene, **circle(5)).lengths == pytest.approx(2.4 / 5, rel=1e-14)
    assert cable(scene, nodes=[(0, 0), (0.3, 0.4), (1.2, 1.6)]).lengths == pytest.approx([0.5, 1.5], rel=1e-15)


def test_markers_lie_at_fractions_of_the_arc() -> None:
    """Within an element by the arc length of its cubic curve, here by adaptive quadrature."""
    scene = mbd.Scene()
    item = cable(scene, **circle(5))
    q0, length = scene.build().q0, item.lengths[0]
    nodal = q0[:8].reshape(4, 2)

    def derivative_at(k: int, x: mpmath.mpf) -> list[mpmath.mpf]:
        return [sum(n * r[i] for n, r in zip(hermite(k, x, length), nodal)) for i in (0, 1)]

    def arc(x: mpmath.mpf) -> mpmath.mpf:
        return mpmath.quad(lambda x: mpmath.norm(derivative_at(1, x)), [0, x])

    x = mpmath.findroot(lambda x: arc(x) - 0.65 * arc(length), 0.65 * length)
    marker = item.at(0.13)  # 0.65 of one element of five
    # Newton's method of the library ends at 1e-15 of the element.
    assert marker.point.value(q0) == pytest.approx([float(r) for r in derivative_at(0, x)], abs=1e-14)
    assert marker.axes[0].value(q0) == pytest.approx([float(r) for r in derivative_at(1, x)], abs=1e-13)


@pytest.mark.parametrize("d", [2, 3])
def test_mass_matrix_of_rigid_motion(d: int) -> None:
    """e' M e of a translation is the mass; with a rotation about the first node it is eq. 11 of Escalona et al. (1998); M is symmetric."""
    scene = mbd.Scene(gravity=np.zeros(d))
    rng = np.random.default_rng(d)
    axis, start = rotation(rng, d)[:, 0], rng.standard_normal(d)
    length = 1.7
    item = cable(scene, start=start, end=start + length * axis, n_elements=3)
    system = scene.build()
    m, mass = mass_matrix(system), 2770 * 0.0018 * length
    assert np.array_equal(m, m.T)
    assert np.linalg.eigvalsh(m)[0] > 0
    here = positions(scene)
    columns = [np.where(here[:, None], np.eye(d)[i], 0.0) for i in range(d)]
    generators = [np.array([[0, -1], [1, 0]])] if d == 2 else [np.cross(np.eye(3), -e) for e in np.eye(3)]
    table = np.where(here[:, None], system.q0.reshape(-1, d) - start, system.q0.reshape(-1, d))
    columns += [table @ w.T for w in generators]
    b = np.stack([c.ravel() for c in columns], axis=1)
    half = [0.5 * length * w @ axis for w in generators]
    turn = [[length**2 / 3 * (u @ axis) @ (w @ axis) for w in generators] for u in generators]
    expected = mass * np.block([[np.eye(d), np.array(half).T], [np.array(half), np.array(turn)]])
    # Sums of at most 16 products.
    assert np.max(np.abs(b.T @ m @ b - expected)) < 1e-14 * mass
    assert system.mass(b.T) == pytest.approx(b.T @ m, rel=1e-14)
    assert item.length == pytest.approx(length, rel=1e-15)


@pytest.mark.parametrize("d", [2, 3])
def test_mass_of_a_rigid_body(d: int) -> None:
    """Kinetic energy of translation and rotation, with products of inertia in space."""
    rng = np.random.default_rng(d)
    scene = mbd.Scene(gravity=np.zeros(d))
    v, omega, mass, pose = rng.standard_normal(d), rng.standard_normal(3), 3.0, rotation(rng, d)
    if d == 2:
        inertia, spin = 0.7, {"angle": np.arctan2(pose[1, 0], pose[0, 0]), "angular_velocity": omega[2]}
        turning = 0.7 * omega[2] ** 2
    else:
        a = rng.standard_normal((3, 3))
        inertia = np.trace(a @ a.T) * np.eye(3) - a @ a.T  # of a body with int x x' dm = a a'
        spin, turning = {"rotation": pose, "angular_velocity": omega}, omega @ pose @ inertia @ pose.T @ omega
    scene.add(mbd.RigidBody(mass=mass, inertia=inertia, position=rng.standard_normal(d), velocity=v, **spin))
    system = scene.build()
    assert system.kinetic(system.v0) == pytest.approx(0.5 * mass * v @ v + 0.5 * turning, rel=1e-14)


@pytest.mark.parametrize("d", [2, 3])
def test_gravity_is_the_mass_matrix_times_a_uniform_acceleration(d: int) -> None:
    g = np.array([1.5, -9.81, 0.7])[:d]
    scene = mbd.Scene(gravity=g)
    cable(scene, start=np.zeros(d), end=np.arange(1.0, d + 1), n_elements=3)
    scene.add(mbd.Particle(0.3, np.ones(d)))
    scene.add(mbd.RigidBody(mass=2.0, inertia=1.0 if d == 2 else (1.0, 1.0, 1.0), position=np.ones(d)))
    if d == 2:
        cable(scene, **circle(5))
    system = scene.build()
    fall = np.where(positions(scene)[:, None], g, 0.0).ravel()
    assert np.max(np.abs(system.weight - system.mass(fall))) < 1e-13 * np.max(np.abs(system.weight))


def test_lumped_gravity_is_eq_28() -> None:
    """m g (1/2, l/8, 1/2, -l/8) on an element: slope loads cancel between equal neighbours, the weight stays."""
    scene = mbd.Scene(gravity=(0, -9.81))
    cable(scene, start=(0, 0), end=(2.4, 0), n_elements=2, gravity="lumped")
    system, length, m = scene.build(), 1.2, 2770 * 0.0018 * 1.2
    expected = -m * 9.81 * np.array([[0, 0.5], [0, length / 8], [0, 1], [0, 0], [0, 0.5], [0, -length / 8]])
    assert system.weight == pytest.approx(expected.ravel(), rel=1e-14, abs=1e-14)


def pieces(corners: list[tuple[float, float]], n: int) -> mbd.scene.System:
    scene = mbd.Scene(gravity=(0, 0))
    for a, b in zip(corners[:-1], corners[1:]):
        cable(scene, start=a, end=b, n_elements=n)
    return scene.build()


@pytest.mark.parametrize("n", [1, 5, 30])
@pytest.mark.parametrize(
    ("corners", "inertia"),
    [
        ([(0, 0), (2.4, 0)], 22.975488),
        ([(0, 0), (1.44, 0), (1.44, 0.96)], 16.358552),
        ([(-0.72, 0.48), (-0.72, 0), (0.72, 0), (0.72, 0.48)], 4.089636),
    ],
    ids=["straight", "L", "U"],
)
def test_table_1_straight_pieces(corners: list[tuple[float, float]], inertia: float, n: int) -> None:
    """Inertia about the origin J = e' M e, Table 1 of Escalona et al. (1998): exact on any mesh."""
    system = pieces(corners, n)
    rho_a, exact = 2770 * 0.0018, 0.0
    for a, b in zip(np.array(corners[:-1]), np.array(corners[1:])):
        length = np.linalg.norm(b - a)
        exact += rho_a * length * (a @ a + a @ (b - a) + length**2 / 3)
    assert exact == pytest.approx(inertia, abs=1e-5)  # the printed digits
    assert system.q0 @ system.mass(system.q0) == pytest.approx(exact, rel=1e-12)


def test_table_1_ring() -> None:
    """A ring of circumference 2.4 about its centre, 1.7459277 exactly, approached from below with order 4."""
    found = []
    for n in (5, 10, 20, 30):
        scene = mbd.Scene(gravity=(0, 0))
        cable(scene, **circle(n))
        system = scene.build()
        found.append(system.q0 @ system.mass(system.q0))
    exact = 2770 * 0.0018 * 2.4 * (2.4 / (2 * np.pi)) ** 2
    errors = exact - np.array(found)
    assert np.all(errors > 0)
    assert np.log2(errors[:-2] / errors[1:-1]) == pytest.approx(4.0, abs=0.2)
    assert np.round(found, 4).tolist() == [1.7344, 1.7452, 1.7459, 1.7459]
