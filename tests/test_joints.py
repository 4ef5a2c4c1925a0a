"""Every joint between every pair of markers that it admits: derivatives by sympy, geometry by moving items, reactions by virtual work."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
import pytest
import sympy as sp

import mbd
import mbd.sums as sums
from mbd.model import Model
from mbd.reaction import reaction

from .kinds import ARM, MARKERS, ZERO, dense, derivative, rotation

EXACT = 1e-12
"""Relative to the largest entry: polynomials of degree two, some ten products of numbers of order one."""

DIFFERENCED = 1e-10
"""Central differences over 5e-4: rounding 1e-12, times a multiplier of order one; quadratic rows have no truncation error."""


THIN = ("node", "span")
LINES = ("PointOnLine", "Slider")


class Case(NamedTuple):
    """A joint between markers of two kinds."""

    joint: str
    first: str
    second: str
    dimension: int

    def __str__(self) -> str:
        return f"{self.joint} {self.first}-{self.second} {self.dimension}D"

    @property
    def thin(self) -> int:
        """How many of the two are cables."""
        return sum(kind in THIN for kind in self[1:3])


def _admitted(case: Case) -> bool:
    kinds = case[1:3]
    if kinds == ("ground", "ground"):
        return False
    if case.joint in LINES and case.second not in ("body", "ground"):
        return False
    if case.joint in ("Clamp", "Slider") or (case.joint == "Pin" and case.dimension == 3):
        return "particle" not in kinds and not (case.joint == "Pin" and case.thin == 2)
    return True


CASES = [
    case
    for d, joint, a, b in itertools.product((2, 3), ("Pin", "Ball", "Distance", "Clamp", *LINES), MARKERS, MARKERS)
    if _admitted(case := Case(joint, a, b, d))
]
PAIRS = [(a, b, d) for d, a, b in itertools.product((2, 3), MARKERS, MARKERS) if (a, b) != ("ground", "ground")]
each_case = pytest.mark.parametrize("case", CASES, ids=str)


class Build(NamedTuple):
    """A joint between two items in a scene; the axis of a pin or line; the tangent of a cable in it."""

    scene: Any
    system: Any
    joint: Any
    axis: np.ndarray
    tangent: np.ndarray


def build(case: Case, rng: np.random.Generator) -> Build:
    """Two items with the points of their markers together (Distance: apart), frames as the joint needs them."""
    d = case.dimension
    scene = mbd.Scene(gravity=ZERO[d])
    joint, axis, tangent = add(scene, case, rng, ("a", "b"))
    return Build(scene, scene.build(), joint, axis, tangent)


def add(scene: Any, case: Case, rng: np.random.Generator, names: tuple[str, str]) -> tuple[Any, np.ndarray, np.ndarray]:
    d = case.dimension
    point, frame, other, axis = rng.standard_normal(d), rotation(rng, d), rotation(rng, d), rng.standard_normal(d)
    second_point, words = point, {}
    if case.joint == "Distance":
        second_point = point + rng.standard_normal(d)
    if d == 3 and case.joint == "Clamp" and case.thin == 2:
        other = frame @ np.diag([-1.0, -1.0, 1.0])  # parallel tangents, against each other
    tangent = frame[:, 0] if case.first in THIN else other[:, 0]
    if case.thin:
        axis -= axis @ tangent * tangent  # a pin's axis must lie across the cable
    if d == 3 and case.joint == "Pin":
        words["axis"] = axis
    if case.joint in LINES:
        words["axis"] = other.T @ axis if case.second == "body" else axis
    a = MARKERS[case.first](scene, point, frame, names[0])
    b = MARKERS[case.second](scene, second_point, other, names[1])
    joint = scene.add(getattr(mbd, case.joint)(a, b, name=f"{case.joint} of {names}", **words))
    return joint, axis / np.linalg.norm(axis), tangent


def random_state(system: Any, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """q near the start, not on the constraint; v, dq and multipliers."""
    q = system.q0 + 0.3 * rng.standard_normal(system.n)
    return q, rng.standard_normal(system.n), rng.standard_normal(system.n), rng.standard_normal(system.m)


# Derivatives.


class Polynomials:
    """All equations of a scene as sympy expressions of q, from what the items declare, and their derivatives."""

    def __init__(self, scene: Any):
        model = Model(scene.layout, np.zeros(scene.dimension), 1.0)
        for item in scene.items:
            item.assemble(model)
        self.q = sp.symbols(f"q:{model.n}")
        self.g = [self._row(row) for *_, row in model.equations] + [self._turn(*turn) for _, turn in model.turns]

    def _scalar(self, scalar: Any) -> sp.Expr:
        terms = zip(scalar.columns, scalar.coefficients)
        return sp.Add(sp.Float(scalar.constant, 30), *(sp.Float(c, 30) * self.q[k] for k, c in terms))

    def _row(self, row: Any) -> sp.Expr:
        return sp.Add(self._scalar(row.linear), *(self._scalar(x) * self._scalar(y) for x, y in row.products))

    def _turn(self, moving: Any, ahead: Any, across: Any, phi: int) -> sp.Expr:
        """|moving| |ahead| sin(phi - angle from ahead to moving)."""
        p, c, s = (sp.Matrix([self._scalar(x) for x in axis.components()]) for axis in (moving, ahead, across))
        return sp.sin(self.q[phi]) * p.dot(c) - sp.cos(self.q[phi]) * p.dot(s)

    def at(self, q: np.ndarray, v: np.ndarray, multipliers: np.ndarray) -> dict[str, np.ndarray]:
        """g [m], G [m, n], d(G' lambda)/dq [n, n], d(G v)/dq [m, n], v' d2g v [m] from 30 digits."""
        numbers, n, m = dict(zip(self.q, (sp.Float(x, 30) for x in q))), len(q), len(self.g)
        value, gradient, hessian = np.zeros(m), np.zeros((m, n)), np.zeros((m, n, n))
        index = {symbol: k for k, symbol in enumerate(self.q)}
        for r, g in enumerate(self.g):
            value[r] = g.evalf(30, subs=numbers)
            for x in g.free_symbols:
                first = sp.diff(g, x)
                gradient[r, index[x]] = first.evalf(30, subs=numbers)
                for y in first.free_symbols:
                    hessian[r, index[x], index[y]] = sp.diff(first, y).evalf(30, subs=numbers)
        return {
            "value": value,
            "gradient": gradient,
            "curvature": np.einsum("r,rxy->xy", multipliers, hessian),
            "swirl": np.einsum("rxy,y->rx", hessian, v),
            "bias": np.einsum("rxy,x,y->r", hessian, v, v),
        }


def numeric(system: Any, q: np.ndarray, v: np.ndarray, multipliers: np.ndarray) -> dict[str, np.ndarray]:
    """The same from the library's kernels."""
    joints, at, n, m = system.joints, system.joints.at(q), system.n, system.m
    return {
        "value": at.value,
        "gradient": dense(joints.rows, joints.cols, at.gradient, (m, n)),
        "curvature": dense(joints.curvature_rows, joints.curvature_cols, at.curvature(multipliers), (n, n)),
        "swirl": dense(joints.rows, joints.cols, at.swirl(v), (m, n)),
        "bias": at.bias(v),
    }


def same(found: dict[str, np.ndarray], expected: dict[str, np.ndarray]) -> None:
    for name, value in expected.items():
        assert np.max(np.abs(found[name] - value)) <= EXACT * max(1.0, np.max(np.abs(value))), name


def pair_scene(first: str, second: str, d: int, rng: np.random.Generator) -> Any:
    """Every joint that this pair of kinds admits, each between items of its own; a torsion spring's turn too."""
    scene = mbd.Scene(gravity=ZERO[d])
    for k, case in enumerate(case for case in CASES if case[1:] == (first, second, d)):
        add(scene, case, rng, (f"a{k}", f"b{k}"))
    if d == 2 and "particle" not in (first, second):
        a, b = (MARKERS[kind](scene, rng.standard_normal(2), rotation(rng, 2), name) for kind, name in ((first, "c"), (second, "d")))
        scene.add(mbd.TorsionSpring(a, b, stiffness=1.0))
    return scene


@pytest.mark.parametrize(("first", "second", "d"), [pair for pair in PAIRS if list(MARKERS).index(pair[0]) <= list(MARKERS).index(pair[1])])
def test_equations_agree_with_sympy(first: str, second: str, d: int) -> None:
    rng = np.random.default_rng(d)
    scene = pair_scene(first, second, d, rng)
    system = scene.build()
    q, v, _, multipliers = random_state(system, rng)
    same(numeric(system, q, v, multipliers), Polynomials(scene).at(q, v, multipliers))


@pytest.mark.parametrize(("first", "second", "d"), PAIRS)
def test_equations_agree_with_differences(first: str, second: str, d: int) -> None:
    rng = np.random.default_rng(d + 1)
    system = pair_scene(first, second, d, rng).build()
    q, v, dq, multipliers = random_state(system, rng)
    joints, found = system.joints, numeric(system, q, v, multipliers)
    at = joints.at(q)
    assert at.push(dq) == pytest.approx(found["gradient"] @ dq, rel=EXACT, abs=EXACT)
    assert at.pull(multipliers) == pytest.approx(multipliers @ found["gradient"], rel=EXACT, abs=EXACT)
    assert abs(multipliers @ at.push(dq) - at.pull(multipliers) @ dq) < 1e-13 * np.abs(multipliers) @ np.abs(at.push(dq))
    for name, f in {
        "gradient": lambda x: joints.at(x).value,
        "swirl": lambda x: joints.at(x).push(v),
        "curvature": lambda x: joints.at(x).pull(multipliers),
    }.items():
        expected = derivative(f, q, dq)
        assert np.max(np.abs(found[name] @ dq - expected)) <= DIFFERENCED * max(1.0, np.max(np.abs(expected))), name
    assert found["bias"] == pytest.approx(found["swirl"] @ v, rel=EXACT, abs=EXACT)
    many = joints.at(np.stack((q, system.q0)))
    assert many.value[0] == pytest.approx(at.value, abs=1e-15)
    assert many.bias(np.stack((v, v)))[0] == pytest.approx(at.bias(v), abs=1e-14)
    assert many.curvature(np.stack((multipliers, multipliers)))[0] == pytest.approx(at.curvature(multipliers), abs=1e-15)


def test_all_joints_of_a_scene_share_one_tensor(monkeypatch: pytest.MonkeyPatch) -> None:
    """The equations of many joints together are those of each alone: bitwise, by entries (products of small matrices round otherwise)."""
    monkeypatch.setattr(sums, "SMALL", 0)
    for d in (2, 3):
        rng = np.random.default_rng(5)
        together, cases = mbd.Scene(gravity=ZERO[d]), [case for case in CASES if case.dimension == d][::5]
        for k, case in enumerate(cases):
            add(together, case, np.random.default_rng(k), (f"a{k}", f"b{k}"))
        system, names = together.build(), together.coordinates()
        q, v, _, multipliers = random_state(system, rng)
        found = numeric(system, q, v, multipliers)
        labels = [item for item, _ in system.joints.labels]
        for k, case in enumerate(cases):
            alone = mbd.Scene(gravity=ZERO[d])
            add(alone, case, np.random.default_rng(k), (f"a{k}", f"b{k}"))
            own, single = [names.index(name) for name in alone.coordinates()], alone.build()
            mine = [r for r, label in enumerate(labels) if label in {item for item, _ in single.joints.labels}]
            expected = numeric(single, q[own], v[own], multipliers[mine])
            for name, axes in {"value": (mine,), "gradient": (mine, own), "swirl": (mine, own), "bias": (mine,), "curvature": (own, own)}.items():
                assert np.array_equal(found[name][np.ix_(*axes)], expected[name]), (case, name)


# Geometry: items moved rigidly (and cables stretched) as the joint allows or forbids.


def span_of(scene: Any, item: str) -> slice:
    """The rows of the table that belong to an item."""
    owners = [owner for owner, _ in scene.layout.owners()][: scene.dimension * scene.layout.n_rows : scene.dimension]
    mine = [k for k, owner in enumerate(owners) if owner == item]
    return slice(mine[0], mine[-1] + 1)


def move(scene: Any, q: np.ndarray, item: str, turn: np.ndarray, about: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """q with one item mapped by x -> about + turn (x - about) + shift; vectors are only mapped by ``turn`` (a stretch too, for a cable)."""
    if item == "ground":
        return q
    d, rows = scene.dimension, span_of(scene, item)
    table = q[: d * scene.layout.n_rows].reshape(-1, d).copy()
    points = np.array([label.endswith(("position", "mass centre")) for label in scene.layout.row_labels()[rows]])
    mapped = table[rows] @ turn.T
    mapped[points] += about + shift - turn @ about
    table[rows] = mapped
    return np.concatenate((table.ravel(), q[table.size :]))


def about_axis(axis: np.ndarray, angle: float) -> np.ndarray:
    """A rotation matrix; planar ones ignore the axis (of any length)."""
    if len(axis) == 2:
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    cross = np.cross(np.eye(3), axis / np.linalg.norm(axis))
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def allowed_turn(case: Case, built: Build, rng: np.random.Generator) -> np.ndarray:
    """A relative rotation that the joint leaves free."""
    angle = rng.uniform(0.5, 2.5)
    if case.joint in ("Ball", "Distance", "PointOnLine"):
        return rotation(rng, case.dimension)
    if case.joint == "Pin":
        return about_axis(built.axis, angle)
    return about_axis(built.tangent, angle) if case.dimension == 3 and case.thin else np.eye(case.dimension)


def forbidden_turn(case: Case, built: Build) -> np.ndarray | None:
    """A relative rotation that the joint forbids; None where all are free."""
    if case.joint in ("Ball", "Distance", "PointOnLine") or (case.joint == "Pin" and case.dimension == 2):
        return None
    if case.joint == "Pin" and not case.thin:  # about any axis across that of the pin
        return about_axis(np.cross(built.axis, np.eye(3)[np.argmin(np.abs(built.axis))]), 0.4)
    return about_axis(built.axis if case.joint in ("Clamp", "Slider") else np.cross(built.axis, built.tangent), 0.4)


def rows_of(build: Build) -> np.ndarray:
    return np.array([k for k, (item, _) in enumerate(build.system.joints.labels) if item == build.joint.name])


def residual(build: Build, q: np.ndarray) -> float:
    return float(np.max(np.abs(build.system.joints.at(q).value[rows_of(build)])))


def placed(case: Case, build: Build, rng: np.random.Generator, turn: np.ndarray, offset: np.ndarray | None = None) -> np.ndarray:
    """q after a common rigid motion and a relative rotation ``turn`` of the moving item about the joint; with cables stretched about it."""
    scene, d = build.scene, case.dimension
    a, b = build.joint.markers
    q = build.system.q0
    pa, pb = a.point.value(q), b.point.value(q)
    mover, here, other, there = (a, pa, b, pb) if case.second == "ground" else (b, pb, a, pa)
    gap = offset if offset is not None else np.zeros(d)
    if case.joint in LINES:  # a line that moves turns about the point on it
        gap = gap + rng.standard_normal() * (turn if mover is b else np.eye(d)) @ build.axis
    if case.joint == "Distance":  # anywhere on the sphere around the other point
        gap = gap + there + turn @ (here - there) - here
        turn = rotation(rng, d)
    scales = {m.item: 1.3 if kind in THIN else 1.0 for m, kind in zip((a, b), case[1:3])}
    q = move(scene, q, mover.item, scales[mover.item] * turn, here, gap)
    q = move(scene, q, other.item, scales[other.item] * np.eye(d), there, np.zeros(d))
    if "ground" not in case[1:3]:
        common, shift = rotation(rng, d), rng.standard_normal(d)
        for marker in (a, b):
            q = move(scene, q, marker.item, common, np.zeros(d), shift)
    if build.joint.scalars:
        ta, tb = (m.axes[0].value(q) for m in (a, b))
        q[build.joint.scalars] = ta @ tb / (tb @ tb)
    return q


@each_case
def test_joint_allows_and_forbids(case: Case) -> None:
    """g = 0 after every motion that the joint allows (cables stretch along their tangents), and not after others."""
    rng = np.random.default_rng(7)
    built = build(case, rng)
    a, b = built.joint.markers
    # Coordinates of size 5 and their products: some roundings of 1e-15.
    assert residual(built, built.system.q0) < 1e-14
    for _ in range(3):
        turn = allowed_turn(case, built, rng)
        assert residual(built, placed(case, built, rng, turn)) < 1e-13
        if case.joint == "Distance":
            stretch = 0.1 * (a.point.value(built.system.q0) - b.point.value(built.system.q0))
            assert residual(built, placed(case, built, rng, np.eye(case.dimension), stretch)) > 1e-2
        else:
            assert residual(built, placed(case, built, rng, turn, 0.1 * rng.standard_normal(case.dimension))) > 1e-3
        wrong = forbidden_turn(case, built)
        if wrong is not None:
            assert residual(built, placed(case, built, rng, wrong)) > 1e-2


def test_residuals_have_the_documented_scale() -> None:
    """Distance: (|p|^2 - L^2) / (2 L), so that its multiplier is the force in the rod; planar clamp: |a| |b| sin(angle error)."""
    scene = mbd.Scene(gravity=(0, 0))
    a, b = scene.add(mbd.Particle(1.0, (0, 0))), scene.add(mbd.Particle(1.0, (0.6, 0.8)))
    rod = scene.add(mbd.Distance(a.at(), b.at(), length=2.0))
    cable = MARKERS["node"](scene, np.zeros(2), np.eye(2), "cable")
    scene.add(mbd.Clamp(scene.ground.at(0, 0), cable))
    system = scene.build()
    q = move(scene, system.q0, "cable", 1.3 * about_axis(np.ones(2), 0.1), np.zeros(2), np.zeros(2))
    assert system.joints.at(q).value == pytest.approx([(1.0 - 4.0) / 4.0, 0.0, 0.0, 1.3 * np.sin(0.1)], abs=1e-15)
    wrench = reaction(rod, rod.pose(system.q0), 2.0 * system.q0, np.array([3.0]))  # at its length: 3 N pull a towards b
    assert wrench == pytest.approx([3.0 * 0.6, 3.0 * 0.8, 0.0], abs=1e-15)


@each_case
def test_joint_removes_the_right_number_of_freedoms(case: Case) -> None:
    """Independent equations between two free items; a thin spatial cable has no torsion to hold. Two cables: one equation more, for
    the ratio of their stretches."""
    built = build(case, np.random.default_rng(8))
    rows = rows_of(built)
    d, g = case.dimension, numeric(built.system, built.system.q0, built.system.v0, np.zeros(built.system.m))["gradient"][rows]
    expected = {
        "Ball": d,
        "Distance": 1,
        "Pin": d if d == 2 else 5 - case.thin,
        "PointOnLine": d - 1,
        "Slider": 2 if d == 2 else 5 - case.thin,
        "Clamp": 3 if d == 2 else {0: 6, 1: 5, 2: 6}[case.thin],
    }[case.joint]
    assert len(rows) == expected
    assert np.linalg.matrix_rank(g, tol=1e-9) == expected


@each_case
def test_reaction_does_the_work_of_the_multipliers(case: Case) -> None:
    """force . dp + moment . dtheta = -lambda . dg for rigid virtual motions of the first item (of the second, against it, if it is grounded)."""
    rng = np.random.default_rng(9)
    built = build(case, rng)
    d, rows = case.dimension, rows_of(built)
    q = placed(case, built, rng, allowed_turn(case, built, rng))
    multipliers = rng.standard_normal(len(rows))
    wrench = reaction(built.joint, built.joint.pose(built.system.q0), q, multipliers)
    assert wrench.shape == (3 if d == 2 else 6,)
    a, b = built.joint.markers
    point = a.point.value(q)
    mover, sign = (b, -1.0) if case.first == "ground" else (a, 1.0)
    spins = list(np.eye(3)) if d == 3 else [np.ones(2)]
    motions = [(direction, spins[0], 0.0) for direction in np.eye(d)] + [(np.zeros(d), axis, 1.0) for axis in spins]
    for component, (direction, axis, angle) in enumerate(motions):

        def g(h: np.ndarray, direction: Any = direction, axis: Any = axis, angle: Any = angle) -> np.ndarray:
            turn = about_axis(axis, float(h[0]) * angle)
            return built.system.joints.at(move(built.scene, q, mover.item, turn, point, h[0] * direction)).value[rows]

        expected = -multipliers @ derivative(g, np.zeros(1), np.array([sign]))
        assert wrench[component] == pytest.approx(expected, abs=1e-10)  # as DIFFERENCED


def test_reaction_has_time_samples_first() -> None:
    built = build(Case("Clamp", "body", "node", 3), np.random.default_rng(1))
    q = built.system.q0 + 0.1 * np.random.default_rng(2).standard_normal((4, 2, built.system.n))
    multipliers = np.random.default_rng(3).standard_normal((4, 2, 5))
    pose = built.joint.pose(built.system.q0)
    many = reaction(built.joint, pose, q, multipliers)
    assert many.shape == (4, 2, 6)
    assert many[1, 1] == pytest.approx(reaction(built.joint, pose, q[1, 1], multipliers[1, 1]), abs=1e-15)


# A rigid body's own equations, and turns.


@pytest.mark.parametrize("d", [2, 3])
def test_axes_of_a_body_stay_orthonormal(d: int) -> None:
    """The rows are (E'E - 1) of its axes E, halved on the diagonal: zero for every rotation, and only for those."""
    rng = np.random.default_rng(d)
    scene = mbd.Scene(gravity=ZERO[d])
    MARKERS["body"](scene, rng.standard_normal(d), rotation(rng, d), "body")
    system = scene.build()
    pairs = [(0, 0)] if d == 2 else [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
    assert system.m == len(pairs)
    assert np.max(np.abs(system.joints.at(system.q0).value)) < 1e-15
    q = rng.standard_normal(system.n)
    axes = q.reshape(-1, d)[1:]
    expected = [(axes[i] @ axes[j] - (i == j)) * (0.5 if i == j else 1.0) for i, j in pairs]
    assert system.joints.at(q).value == pytest.approx(expected, abs=1e-15)
    turned = np.vstack((rng.standard_normal(d), rotation(rng, d).T[: len(axes)]))
    assert np.max(np.abs(system.joints.at(turned.ravel()).value)) < 1e-15


def test_turn_counts_whole_turns() -> None:
    """phi is the counter-clockwise turn of the first axis relative to the second since assembly, without a jump at pi."""
    rng = np.random.default_rng(4)
    scene = mbd.Scene(gravity=(0, 0))
    a, b = (MARKERS[kind](scene, rng.standard_normal(2), rotation(rng, 2), kind) for kind in ("body", "span"))
    spring = scene.add(mbd.TorsionSpring(a, b, stiffness=1.0))
    system = scene.build()
    row = [k for k, (item, _) in enumerate(system.joints.labels) if item == spring.name]
    for phi in (0.0, 0.4, 3.5, 7.0, -20.0):
        q = move(scene, system.q0, "body", about_axis(np.zeros(2), phi + 0.3), np.ones(2), np.ones(2))
        q = move(scene, q, "span", 1.4 * about_axis(np.zeros(2), 0.3), np.zeros(2), np.zeros(2))
        q[spring.turn] = phi
        assert abs(system.joints.at(q).value[row][0]) < 1e-14
        q[spring.turn] = phi + 0.1
        assert system.joints.at(q).value[row][0] == pytest.approx(1.4 * np.sin(0.1), abs=1e-14)  # |a| |b| sin(error)


def test_arm_of_a_body_marker() -> None:
    """at(x, y[, z]) is in body axes from the mass centre."""
    for d in (2, 3):
        rng = np.random.default_rng(d)
        point, frame = rng.standard_normal(d), rotation(rng, d)
        scene = mbd.Scene(gravity=ZERO[d])
        marker = MARKERS["body"](scene, point, frame, "body")
        system = scene.build()
        assert marker.point.value(system.q0) == pytest.approx(point, abs=1e-15)
        assert scene["body"].at().point.value(system.q0) == pytest.approx(point - frame @ ARM[d], abs=1e-15)
