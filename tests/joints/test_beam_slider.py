"""A point on a cable: derivatives, kinematics from the cable's own markers, balance, passing from element to element, and the cable's end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

import mbd
from mbd.elements.shapes import hermite_bend

from ..kinds import MARKERS, ZERO, dense, derivative, rotation
from ..symbolic import hermite
from ..test_joints import DIFFERENCED, EXACT, numeric, random_state, same

CABLE: dict[str, Any] = {"E": 1e7, "A": 1e-4, "I": 1e-8, "rho": 1000.0}
PLACES = [0.0, 0.35, 0.52, 1.21, 1.5]
"""On a cable of three elements of half a metre: at its ends, in each element."""


def build(kind: str, d: int) -> tuple[Any, Any, Any, Any]:
    """A marker on a cable of three elements: scene, system, cable, slider."""
    rng = np.random.default_rng(d)
    scene, frame = mbd.Scene(gravity=ZERO[d]), rotation(rng, d)
    cable = scene.add(mbd.AncfCable(np.zeros(d), 1.5 * frame[:, 0], n_elements=3, **CABLE))
    point = MARKERS[kind](scene, 0.6 * frame[:, 0] + 0.1 * frame[:, 1], rotation(rng, d), "other")
    slider = scene.add(mbd.BeamSlider(point, cable))
    return scene, scene.build(), cable, slider


def test_it_starts_where_the_cable_is_nearest() -> None:
    scene, system, _, slider = build("particle", 2)
    assert system.q0[slider.coordinate] == pytest.approx(0.6, abs=1e-12)
    assert scene.coordinates()[slider.coordinate] == "beam slider 1 place along the cable"


@pytest.mark.parametrize("s", PLACES)
@pytest.mark.parametrize("kind, d", [("body", 2), ("span", 2), ("particle", 3), ("ground", 3)])
def test_equations_agree_with_sympy(kind: str, d: int, s: float) -> None:
    """P - sum N_k(s) e_k on the element that s is in, N by symbolic differentiation, P as the marker declares it."""
    rng = np.random.default_rng(4)
    _, system, cable, slider = build(kind, d)
    q, v, _, multipliers = random_state(system, rng)
    q[slider.coordinate] = s
    rows = np.array([k for k, (item, _) in enumerate(system.joints.labels) if item == slider.name])
    element = min(int(s / 0.5), 2)
    place = slider.coordinate % system.n
    symbols = sp.symbols(f"q:{system.n}")
    point = slider.markers[0].point
    expected = {name: np.zeros(shape) for name, shape in (("value", d), ("gradient", (d, system.n)), ("swirl", (d, system.n)), ("bias", d))}
    curvature = np.zeros((system.n, system.n))
    numbers = dict(zip(symbols, (sp.Float(x, 30) for x in q)))
    table = np.array(symbols[: d * (system.n // d)], dtype=object).reshape(-1, d)
    x = symbols[place] - sp.Float(0.5 * element, 30)
    length = sp.Rational(1, 2)
    xi = x / length
    shapes = [1 - 3 * xi**2 + 2 * xi**3, length * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, length * (xi**3 - xi**2)]
    own = cable.rows[element : element + 2].ravel()
    assert [float(n.evalf(30, subs=numbers)) for n in shapes] == pytest.approx([float(n) for n in hermite(0, s - 0.5 * element, 0.5)])
    for i, component in enumerate(point.components()):
        g = sp.Float(component.constant, 30) + sum(sp.Float(c, 30) * symbols[k] for k, c in zip(component.columns, component.coefficients))
        g -= sum(n * table[row, i] for n, row in zip(shapes, own))
        expected["value"][i] = g.evalf(30, subs=numbers)
        used = sorted(g.free_symbols, key=str)
        index = [symbols.index(u) for u in used]
        first = [sp.diff(g, u) for u in used]
        hessian = np.array([[float(sp.diff(f, u).evalf(30, subs=numbers)) for u in used] for f in first])
        expected["gradient"][i, index] = [float(f.evalf(30, subs=numbers)) for f in first]
        expected["swirl"][i, index] = hessian @ v[index]
        expected["bias"][i] = v[index] @ hessian @ v[index]
        curvature[np.ix_(index, index)] += multipliers[rows[i]] * hessian
    masked = np.zeros(system.m)
    masked[rows] = multipliers[rows]
    found = numeric(system, q, v, masked)
    others = dense(*_patterns_without(system, slider, masked, q), (system.n, system.n))
    same({name: found[name][rows] for name in expected}, expected)
    same({"curvature": found["curvature"] - others}, {"curvature": curvature})


def _patterns_without(system: Any, slider: Any, multipliers: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The curvature of all other equations: zero, as their multipliers are."""
    rest = multipliers * np.array([item != slider.name for item, _ in system.joints.labels])
    return system.joints.curvature_rows, system.joints.curvature_cols, system.joints.at(q).curvature(rest)


@pytest.mark.parametrize("s", PLACES[1:4:2])
@pytest.mark.parametrize("d", [2, 3])
def test_equations_agree_with_differences(d: int, s: float) -> None:
    rng = np.random.default_rng(3)
    _, system, _, slider = build("body", d)
    q, v, dq, multipliers = random_state(system, rng)
    q[slider.coordinate], joints = s, system.joints
    found = numeric(system, q, v, multipliers)
    for name, f in {
        "gradient": lambda x: joints.at(x).value,
        "swirl": lambda x: joints.at(x).push(v),
        "curvature": lambda x: joints.at(x).pull(multipliers),
    }.items():
        expected = derivative(f, q, dq)
        assert np.max(np.abs(found[name] @ dq - expected)) <= DIFFERENCED * max(1.0, np.max(np.abs(expected))), name
    assert found["bias"] == pytest.approx(found["swirl"] @ v, rel=EXACT, abs=EXACT)
    many = joints.at(np.stack((q, system.q0)))
    at = joints.at(q)
    assert many.value[0] == pytest.approx(at.value, abs=1e-15) and many.gradient[0] == pytest.approx(at.gradient, abs=1e-15)
    assert many.bias(np.stack((v, v)))[0] == pytest.approx(at.bias(v), abs=1e-13)
    assert many.curvature(np.stack((multipliers, multipliers)))[0] == pytest.approx(at.curvature(multipliers), abs=1e-14)


def test_equations_pass_from_element_to_element() -> None:
    """Value and gradient are continuous in s at a node."""
    _, system, _, slider = build("body", 2)
    q = random_state(system, np.random.default_rng(8))[0]
    sides = []
    for s in (0.5 - 1e-12, 0.5 + 1e-12):
        q[slider.coordinate] = s
        at = system.joints.at(q)
        sides.append((at.value, dense(system.joints.rows, system.joints.cols, at.gradient, (system.m, system.n))))
    assert all(np.abs(a - b).max() < 1e-10 for a, b in zip(*sides))


PULL = {2: np.array((0.0, -9.81)), 3: np.array((0.0, 2.0, -9.81))}


@pytest.fixture(scope="module", params=[2, 3])
def ride(request: pytest.FixtureRequest) -> tuple[Any, Any, Any, Any]:
    """A body of 0.5 kg rides a sagging cable over several elements: result, cable, body, slider."""
    d = request.param
    along, pull = np.eye(d)[0], PULL[d]
    scene = mbd.Scene(gravity=pull)
    cable = scene.add(mbd.AncfCable(0 * along, 2 * along, n_elements=6, **CABLE, name="rope"))
    for marker, x in ((cable.start, 0.0), (cable.end, 2.0)):
        scene.add((mbd.Pin if d == 2 else mbd.Ball)(marker, scene.ground.at(*(x * along))))
    body = scene.add(mbd.RigidBody(mass=0.5, inertia=0.01 if d == 2 else (0.01, 0.01, 0.02), position=0.4 * along, velocity=2.0 * along))
    slider = scene.add(mbd.BeamSlider(body, cable, name="carriage"))
    return mbd.simulate(scene, 0.4, rtol=1e-6), cable, body, slider


def test_kinematics_along_a_ride(ride: tuple[Any, Any, Any, Any]) -> None:
    """Position, velocity and acceleration against the marker of the cable that is at the same place at that instant."""
    result, cable, body, slider = ride
    s, speed = result.q[:, slider.coordinate], result.v[:, slider.coordinate]
    assert s[-1] - s[0] > 0.6, "over two nodes"
    point = body.at()
    for k in range(0, len(s), 5):
        t, marker = result.t[k], cable.at(float(s[k] / cable.length))
        tangent, turning = marker.axes[0].value(result.q[k]), marker.axes[0].rate(result.v[k])
        element = int(s[k] / cable.length * 6)
        length = cable.length / 6
        d = tangent.size
        nodes = result.q[k, : d * (cable.rows.max() + 1)].reshape(-1, d)[cable.rows[element : element + 2].ravel()]
        bend = (hermite_bend(s[k] / length - element) * (1.0, length, 1.0, length) / length**2) @ nodes
        assert result.position(marker)[k] == pytest.approx(result.position(point)[k], abs=1e-11)
        assert result.velocity(marker)[k] + tangent * speed[k] == pytest.approx(result.velocity(point)[k], abs=1e-10)
        there = result.acceleration(marker, t=[t])[0] + 2.0 * turning * speed[k] + bend * speed[k] ** 2
        left = result.acceleration(point, t=[t])[0] - there  # is the tangent times the acceleration of the place
        across = left - tangent * (left @ tangent) / (tangent @ tangent)
        assert np.abs(across).max() < 1e-9 * np.abs(there).max()


def test_force_is_the_inertial_balance_and_nothing_rubs(ride: tuple[Any, Any, Any, Any]) -> None:
    result, cable, body, slider = ride
    wrench = result.reaction(slider)
    d = result.system.dimension
    expected = 0.5 * (result.acceleration(body.at()) - PULL[d])
    assert np.abs(wrench[:, :d] - expected).max() < 1e-9 * np.abs(expected).max()
    assert not wrench[:, d:].any()
    for k in (0, len(wrench) // 2, -1):
        marker = cable.at(float(result.q[k, slider.coordinate] / cable.length))
        tangent = marker.axes[0].value(result.q[k])
        assert abs(wrench[k, :d] @ tangent) < 1e-9 * np.linalg.norm(wrench[k, :d])
    assert result.audit.energy_error < 1e-4 * result.audit.energy_scale


@pytest.mark.parametrize("d", [2, 3])
def test_on_a_straight_cable_it_is_a_point_on_a_line(d: int) -> None:
    """A cable whose nodes are clamped to a swinging body stays straight; the bead passes two of them. Both ways carry the cable's mass."""
    found = []
    for way in ("cable", "line"):
        along, up = np.eye(d)[0], np.eye(d)[-1]
        scene = mbd.Scene(gravity=-9.81 * up)
        bar = scene.add(mbd.RigidBody(mass=2.0, inertia=0.3 if d == 2 else (0.2, 0.3, 0.3), position=0.75 * along))
        words = {} if d == 2 else {"axis": (0, -1, 0)}
        scene.add(mbd.Pin(bar.at(*(-0.75 * along)), scene.ground.at(), **words))
        cable = scene.add(mbd.AncfCable(0 * along, 1.5 * along, n_elements=3, **CABLE))
        for k in range(4):
            scene.add(mbd.Clamp(cable.at(k / 3), bar.at(*((0.5 * k - 0.75) * along))))
        bead = scene.add(mbd.Particle(0.7, 0.3 * along, 2.0 * along))
        on_bar = mbd.PointOnLine(bead.at(), bar.at(), axis=along)
        scene.add(mbd.BeamSlider(bead, cable) if way == "cable" else on_bar)
        result = mbd.simulate(scene, 0.35, rtol=1e-10, solver=mbd.Radau(7), t_eval=np.linspace(0.0, 0.35, 6))
        found.append((result.position(bead.at()), result.velocity(bead.at())))
    assert np.linalg.norm(found[0][0][-1]) > 1.05, "the bead passes two nodes"
    assert all(np.abs(x - y).max() < 1e-9 for x, y in zip(*found))


@pytest.mark.parametrize("solver", [None, mbd.DormandPrince(), mbd.GeneralizedAlpha(2e-3), mbd.Gauss(2e-3)], ids=lambda s: type(s).__name__)
@pytest.mark.filterwarnings("ignore:the energy is off")
def test_the_end_of_the_cable_ends_the_run(solver: Any) -> None:
    """With an error that names both, and a result that reaches to the end of the cable and not beyond; an event stops before."""
    scene = mbd.Scene()
    rope = scene.add(mbd.AncfCable((0, 0), (2, 0), n_elements=2, E=1e7, A=1e-2, I=1e-4, rho=1000, name="rope"))
    scene.add(mbd.Clamp(rope.start, scene.ground.at(0, 0)))
    bead = scene.add(mbd.Particle(0.5, (1.8, 0), velocity=(3, 0)))
    slider = scene.add(mbd.BeamSlider(bead, rope, name="bead on rope"))
    with pytest.raises(mbd.SimulationError, match="'bead on rope' leaves 'rope' at its end") as error:
        mbd.simulate(scene, 1.0, rtol=1e-4, solver=solver)
    s = error.value.result.q[:, slider.coordinate]
    assert abs(s[-1] - 2.0) < 1e-6 and s.max() <= 2.0 * (1.0 + 1e-9)
    if solver is None:
        near = mbd.Event(lambda state: state.q[slider.coordinate] - 1.95, terminal=True)
        result = mbd.simulate(scene, 1.0, rtol=1e-4, events=[near])
        assert result.q[-1, slider.coordinate] == pytest.approx(1.95, abs=1e-9)


def test_mistakes_are_named() -> None:
    scene = mbd.Scene()
    rope = scene.add(mbd.AncfCable((0, 0), (2, 0), n_elements=2, **CABLE, name="rope"))
    bad = scene.add(mbd.AncfCable((0, 0), (0, 0), n_elements=2, **CABLE, name="bad"))
    bead = scene.add(mbd.Particle(1.0, (1, 0)))
    scene.add(mbd.BeamSlider(bead, rope.end, name="one"))
    scene.add(mbd.BeamSlider(rope.at(0.5), rope, name="two"))
    scene.add(mbd.BeamSlider(bead, bad, name="quiet"))
    with pytest.raises(mbd.SceneError) as error:
        scene.build()
    text = "\n".join(error.value.complaints)
    assert "'one': beam: expected a cable" in text and "'two': point: expected one of another item" in text and "quiet" not in text
