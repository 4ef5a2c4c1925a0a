"""The planar beams beside ``AncfCable``: inertia, conserved quantities, statics, order, and what joints see, each by a witness of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd
from mbd.elements.bending_modes import BendingModes

from . import machines
from .kinds import dense
from .statics import equilibria

NAMES = ("CorotationalBeam", "FloatingFrameBeam", "GeometricallyExactBeam")
FULLY_NONLINEAR = ("CorotationalBeam", "GeometricallyExactBeam")
beams = pytest.mark.parametrize("name", NAMES)
SECTION = {"E": 1e6, "A": 1e-2, "I": 1e-5, "rho": 1000.0}


def beam(scene: mbd.Scene, kind: str, start: Any = (0, 0), end: Any = (2, 0), n: int = 4, **changes: Any) -> Any:
    return scene.add(getattr(mbd, kind)(start, end, n_elements=n, **{**SECTION, "name": "beam", **changes}))


def mass_matrix(system: Any) -> np.ndarray:
    return dense(system.mass_rows, system.mass_cols, system.mass_values, (system.n, system.n))


def momentum(scene: mbd.Scene, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Linear [n_t, 2] and angular momentum about the origin [n_t]: all rows of the table turn as vectors, positions also move."""
    system = scene.build()
    rows = scene.layout.n_rows
    moved = np.array([label.endswith(("position", "mass centre")) for label in scene.layout.row_labels()])
    table, action = q[:, : 2 * rows].reshape(-1, rows, 2), system.mass(v)[:, : 2 * rows].reshape(-1, rows, 2)
    turning = table[..., 0] * action[..., 1] - table[..., 1] * action[..., 0]
    return action[:, moved].sum(axis=1), turning.sum(axis=1)


# Inertia and conserved quantities.


@beams
def test_inertia_of_rigid_motion(name: str) -> None:
    """Mass, moment and inertia about the origin of a uniform rod; the sections' own inertia where the formulation has it."""
    scene, start = mbd.Scene(), np.array([0.3, -0.2])
    item = beam(scene, name, start, start + (1.2, 0.9))
    system, mass, end = scene.build(), 1000.0 * 1e-2 * 1.5, start + (1.2, 0.9)
    m, table = mass_matrix(system), system.q0.reshape(-1, 2)
    here = np.array([label.endswith("position") for label in scene.layout.row_labels()])
    shift = np.where(here[:, None], (1.0, 0.0), 0.0).ravel()
    turn = np.stack((-table[:, 1], table[:, 0]), axis=1).ravel()
    polar = mass / 3 * (start @ start + start @ end + end @ end)
    polar += 1000.0 * 1e-5 * 1.5 * (name == "GeometricallyExactBeam")
    assert shift @ m @ shift == pytest.approx(mass, rel=1e-13)
    assert turn @ m @ turn == pytest.approx(polar, rel=1e-13)
    assert shift @ m @ turn == pytest.approx(-mass * 0.5 * (start + end)[1], rel=1e-13)
    assert np.linalg.eigvalsh(m)[0] > -1e-15 * np.linalg.eigvalsh(m)[-1]
    assert system.weight == pytest.approx(system.mass(np.where(here[:, None], (0.0, -9.81), 0.0).ravel()), rel=1e-12, abs=1e-12)
    assert item.length == pytest.approx(1.5, rel=1e-15)


@beams
def test_free_flight_keeps_momentum_and_energy(name: str) -> None:
    """Spun about its centre and bent by the start of it: the ends move sideways at first."""
    scene = mbd.Scene(gravity=(0, 0))
    item = beam(scene, name, (1, 1), (2.2, 1.9))
    load = scene.add(mbd.Torque(item.end, mbd.piecewise(lambda t: 4.0 if t < 0.1 else 0.0, at=[0.1])))
    result = mbd.simulate(scene, 0.4, rtol=1e-8)
    free = result.t > 0.1 + 1e-9
    energy = result.energy.total[free]
    linear, angular = (x[free] for x in momentum(scene, result.q, result.v))
    assert load.name and np.ptp(result.energy.elastic[free]) > 1e-3 * energy[0]
    assert np.ptp(energy) < 1e-6 * energy[0]
    assert np.abs(linear).max() < 1e-10  # a couple moves no centre
    assert angular == pytest.approx(0.4, abs=1e-8)  # torque times time
    assert result.audit.position_drift < 1e-10


@beams
def test_rigid_spin_is_not_damped(name: str) -> None:
    """A damped beam that spins as a rigid body (stretched by rotation, no more) loses nothing: dampers see strains, not turns."""
    scene, speed = mbd.Scene(gravity=(0, 0)), 3.0
    beam(scene, name, (-1, 0), (1, 0), damping=0.05, E=1e9)
    system = scene.build()
    table = system.q0.reshape(-1, 2)
    spin = speed * np.stack((-table[:, 1], table[:, 0]), axis=1).ravel()
    loss = np.sum(system.viscosity * system.strains(system.q0).push(spin) ** 2)
    assert loss < 1e-20 * np.sum(system.viscosity) * speed**2


# Statics.


def cantilever(name: str, n: int, *, force: Any = (0, 0), torque: float = 0.0, **changes: Any) -> Any:
    def make(load: float) -> mbd.Scene:
        scene = mbd.Scene(gravity=(0, 0))
        item = beam(scene, name, n=n, **changes)
        scene.add(mbd.Clamp(item.start, scene.ground.at(0, 0)))
        if torque:
            scene.add(mbd.Torque(item.end, load * torque))
        else:
            scene.add(mbd.Force(item.end, load * np.asarray(force, dtype=float)))
        make.item = item  # type: ignore[attr-defined]
        return scene

    return make


def order(errors: list[float]) -> float:
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize(("name", "expected"), [("CorotationalBeam", 2.0), ("GeometricallyExactBeam", 4.0)])
def test_rolled_up_by_a_moment(name: str, expected: float) -> None:
    """Half a turn by pi EI / L: the end's angle is exact on any mesh, its position of the formulation's order."""
    length, errors = 2.0, []
    for n in (4, 8, 16):
        make = cantilever(name, n, torque=np.pi * 1e6 * 1e-5 / length)
        *_, (state, _) = equilibria(make, 4)
        point, axis = make.item.end.point.value(state.q), make.item.end.axes[0].value(state.q)
        assert axis == pytest.approx([-1.0, 0.0], abs=1e-12)
        errors.append(float(np.linalg.norm(point - (0.0, 2.0 * length / np.pi))))
    assert order(errors) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(("name", "expected"), [("CorotationalBeam", 2.0), ("GeometricallyExactBeam", 4.0)])
def test_elastica_under_a_force_at_its_end(name: str, expected: float) -> None:
    """F L^2 / (E I) = 4.7407..., L = 2.4: end at (1.50314639647935, -1.6895165663457091) in the limit without stretch and shear."""
    stiff = {"E": 1e7, "A": 1.8, "I": 1.215e-8}
    errors = []
    for n in (4, 8, 16):
        make = cantilever(name, n, force=(0, -0.1), end=(2.4, 0), **stiff)
        *_, (state, _) = equilibria(make, 8)
        errors.append(float(np.linalg.norm(make.item.end.point.value(state.q) - (1.50314639647935, -1.6895165663457091))))
    assert order(errors) == pytest.approx(expected, abs=0.25)


@beams
def test_small_force_bends_by_the_beam_formula(name: str) -> None:
    """F L^3 / (3 E I), and F L / GA where it shears."""
    make = cantilever(name, 8, force=(0, 1e-6))
    ((state, _),) = equilibria(make, 1)
    shear = 2.0 / (1e4 * 5 / 6 / 2.6) if name == "GeometricallyExactBeam" else 0.0
    expected = 1e-6 * (2.0**3 / (3 * 1e6 * 1e-5) + shear)
    # Modes above the eighth would add sum 12 / b^4 = 8e-5 of the deflection; nodes are exact otherwise.
    assert make.item.end.point.value(state.q)[1] == pytest.approx(expected, rel={"FloatingFrameBeam": 1e-4}.get(name, 1e-6))


@beams
def test_reaction_of_a_clamp_at_rest(name: str) -> None:
    """Against the load, with its moment about the clamp in the bent shape; what rests in equilibrium stays."""
    make = cantilever(name, 6, force=(0.3, -0.4))
    *_, (state, _) = equilibria(make, 4)
    scene = make(1.0)
    result = mbd.simulate(scene, 1e-3, start=state, rtol=1e-6)
    arm = result.position(make.item.end)[-1]
    expected = [-0.3, 0.4, 0.4 * arm[0] + 0.3 * arm[1]]
    assert result.reaction(scene["clamp 1"])[-1] == pytest.approx(expected, abs=1e-7)
    assert np.abs(result.q - state.q).max() < 1e-9


@pytest.mark.parametrize("share", [-2.0, 0.5])
def test_floating_frame_as_beam_column(share: float) -> None:
    """An axial force P at the end, pulling or pushing (share of Euler's pi^2 E I / 4 L^2), changes the deflection by Q as in textbooks:
    Q (tan kL - kL) / (k P) for pushing, Q (kL - tanh kL) / (k P) for pulling; without stiffening it changes nothing."""
    stiffness, length, q = 10.0, 2.0, 1e-6
    p = share * np.pi**2 * stiffness / (4 * length**2)
    k = np.sqrt(abs(p) / stiffness)
    expected = q * (np.tan(k * length) - k * length) / (k * p) if p > 0 else q * (k * length - np.tanh(k * length)) / (k * -p)
    found = []
    for stiffening in (True, False):
        make = cantilever("FloatingFrameBeam", 10, force=(-p, q), stiffening=stiffening)
        *_, (state, _) = equilibria(make, 4)
        found.append(make.item.end.point.value(state.q)[1])
    assert found[0] == pytest.approx(expected, rel=1e-4)
    assert found[1] == pytest.approx(q * length**3 / (3 * stiffness), rel=1e-4)


# The floating frame by its definition.


def test_modes_of_a_fine_mesh_are_those_of_a_beam() -> None:
    """cos b cosh b = -1, unit end, int w^2 = 1/4, int w''^2 = b^4 / 4."""
    modes, b = BendingModes(40), np.array([1.8751040687119611, 4.694091132974174, 7.854757438237613])
    assert 4.0 * modes.stiffness[:3] == pytest.approx(b**4, rel=1e-5)
    assert modes.shape(1.0)[:3, 0] == pytest.approx(1.0, rel=1e-5)
    xi, weight = modes.points
    w = modes.shape(xi)
    assert (w * weight) @ w.T == pytest.approx(0.25 * np.eye(40), abs=1e-12)
    assert np.abs(modes.shape(0.0)).max() == np.abs(modes.shape(0.0, 1)).max() == 0.0


@pytest.mark.parametrize("stiffening", [True, False])
def test_floating_frame_is_the_turned_beam(stiffening: bool) -> None:
    """One element, whose mode is a cubic, so that everything is exact: at a random frame and deflection the equations hold, and kinetic energy,
    potential, elastic energy and points are those of r = R + rot(x - u, w), u = 1/2 int w'^2, by quadrature."""
    scene, rng = mbd.Scene(gravity=(1.5, -9.81)), np.random.default_rng(7)
    length, density = 2.0, 1000.0 * 1e-2
    item = beam(scene, "FloatingFrameBeam", n=1, stiffening=stiffening)
    system, modes = scene.build(), item.modes
    theta, q, spin, rate, origin, shift = 0.7, 0.3, 1.3, -0.8, rng.standard_normal(2), rng.standard_normal(2)
    slope = np.polynomial.Polynomial.fit(x := np.linspace(0, 1, 5), modes.shape(x, 1)[0] / length, 3)  # of w by the coordinate x / L
    along = lambda xi: (slope**2).integ(lbnd=0.0)(xi) * 0.5 * length * stiffening  # noqa: E731

    def state(theta: float, q: float, origin: np.ndarray) -> np.ndarray:
        d = np.array([np.cos(theta), np.sin(theta)])
        forms = [float(modes.shortening(kind)[0, 0]) / (2 * length) for kind in ("mean", "moment", "end")][: 3 * stiffening]
        return np.concatenate([origin, d, q * np.array([-d[1], d[0]]), *(f * q**2 * d for f in forms)])

    def points(theta: float, q: float, origin: np.ndarray, xi: np.ndarray) -> np.ndarray:
        d = np.array([np.cos(theta), np.sin(theta)])
        w = q * modes.shape(xi)[0]
        return origin + np.outer(length * xi - q**2 * along(xi), d) + np.outer(w, (-d[1], d[0]))

    h = 1e-5
    moved = [(theta + k * h * spin, q + k * h * rate, origin + k * h * shift) for k in (-1, 0, 1)]
    here, before, after = state(*moved[1]), state(*moved[0]), state(*moved[2])
    v = (after - before) / (2 * h)
    assert np.abs(system.joints.at(here).value).max() < 1e-14
    assert np.abs(system.joints.at(here).push(v)).max() < 1e-8  # differences
    xi, weight = np.polynomial.legendre.leggauss(12)
    xi, weight = 0.5 * (xi + 1), 0.5 * weight * length * density
    velocity = (points(*moved[2], xi) - points(*moved[0], xi)) / (2 * h)
    assert system.kinetic(v) == pytest.approx(0.5 * weight @ np.sum(velocity**2, axis=1), rel=1e-8)
    assert system.potential(here) == pytest.approx(-weight @ points(*moved[1], xi) @ (1.5, -9.81), rel=1e-12)
    bend = (modes.shape(x, 2)[0] * q / length**2) ** 2
    assert system.elastic(here) == pytest.approx(0.5 * 10.0 * length * np.polynomial.Polynomial.fit(x, bend, 2).integ(lbnd=0.0)(1.0), rel=1e-12)
    for s in (0.0, 0.4, 1.0):
        assert item.at(s).point.value(here) == pytest.approx(points(*moved[1], np.array([s]))[0], abs=1e-14)
    tangent = item.end.axes[0].value(here)
    assert np.arctan2(tangent[1], tangent[0]) == pytest.approx(theta + np.arctan(q * modes.shape(1.0, 1)[0, 0] / length), rel=1e-13)


def minimal(n: int, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle and end's offset of the paper's 0.4 m pendulum by the usual equations of the linear floating frame, coordinates (theta, q):
    (J + q.q) th'' + s.q'' + 2 q.q' th' = -g (h0 cos th - h.q sin th),  s th'' + q'' = q th'^2 - Om^2 q - g h cos th."""
    from scipy.integrate import solve_ivp

    length, line, g = 0.4, 5540 * 1.8e-3, 9.81
    modes, unit = BendingModes(n), 1.0 / np.sqrt(0.25 * line * length)  # modal masses one
    xi, weight = modes.points
    shapes = unit * modes.shape(xi)
    h, s = line * length * shapes @ weight, line * length**2 * shapes @ (weight * xi)
    om2 = 1e9 * 1.215e-8 / (line * length**4) * 4.0 * modes.stiffness

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        th, q, w, qd = y[0], y[1 : 1 + n], y[1 + n], y[2 + n :]
        m = np.eye(n + 1)
        m[0, 0], m[0, 1:], m[1:, 0] = line * length**3 / 3 + q @ q, s, s
        turning = -g * (0.5 * line * length**2 * np.cos(th) - h @ q * np.sin(th)) - 2.0 * (q @ qd) * w
        bending = q * w**2 - om2 * q - g * h * np.cos(th)
        return np.concatenate(([w], qd, np.linalg.solve(m, np.concatenate(([turning], bending)))))

    run = solve_ivp(rates, (0.0, times[-1]), np.zeros(2 * n + 2), method="DOP853", rtol=1e-10, atol=1e-13, t_eval=times)
    return run.y[0], unit * modes.shape(1.0)[:, 0] @ run.y[1 : 1 + n]


def test_linear_floating_frame_has_the_usual_equations() -> None:
    """The constant mass matrix and its rows give the motion that the usual coordinates give."""
    times = np.linspace(0.02, 0.2, 10)
    angle, offset = minimal(3, times)
    scene = mbd.Scene()
    rod = scene.add(mbd.FloatingFrameBeam((0, 0), (0.4, 0), n_elements=3, E=1e9, A=1.8e-3, I=1.215e-8, rho=5540, stiffening=False))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 0.2, rtol=1e-9)
    found, tip = result.angle(rod.start, t=times), result.position(rod.end, t=times)
    assert found == pytest.approx(angle, abs=2e-7)
    assert np.cos(found) * tip[:, 1] - np.sin(found) * tip[:, 0] == pytest.approx(offset, abs=5e-8)


# Dynamics against references, and among joints.


def spaghetti(n: int) -> tuple[mbd.Result, Any]:
    scene = mbd.Scene(gravity=(0, 0))
    item = beam(scene, "GeometricallyExactBeam", (6, 0), (0, 8), n, E=1e4, A=1.0, I=0.05, rho=1.0, GA=1e4, rotary_inertia=10.0)

    def pulse(t: float) -> float:
        return np.sin(np.pi * t / 2.5) ** 2 if t < 2.5 else 0.0

    scene.add(mbd.Force(item.start, mbd.piecewise(lambda t: (16.0 * pulse(t), 0.0), at=[2.5])))
    scene.add(mbd.Torque(item.start, mbd.piecewise(lambda t: -160.0 * pulse(t), at=[2.5])))
    return mbd.simulate(scene, 4.0, rtol=1e-6), item


def test_flying_spaghetti() -> None:
    """Simo and Vu-Quoc (1986), smooth pulse: within the reference's digits (5e-5 m), at the order of quadratic elements."""
    values = [value for value in machines.data("spaghetti_reissner_smooth")["reference"]["values"] if value["t"] <= 4.0]
    times, errors = [value["t"] for value in values], []
    for n in (8, 16, 32):
        result, item = spaghetti(n)
        found = [result.position(marker, t=times) for marker in (item.start, item.at(0.5), item.end)]
        errors.append(max(np.abs(x - [value[key] for value in values]).max() for x, key in zip(found, ("A", "mid", "B"))))
    assert errors[-1] < 3e-6  # better than the reference says of itself
    assert errors[1] < 5e-5
    assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(4.0, abs=0.4)
    angles = result.angle(item.start, t=times)
    assert angles == pytest.approx([value["thA"] for value in values], abs=2e-5)  # of order 3: the rotary inertia sits at the nodes
    assert result.energy.total[-1] == pytest.approx(values[-1]["T"] + values[-1]["U"], rel=1e-5)


def carousel(name: str) -> tuple[mbd.Scene, Any]:
    """A hub on the ground, a beam clamped to it, a body pinned to the beam's end, one clamped to that: all kinds of ends."""
    scene = mbd.Scene()
    hub = scene.add(mbd.RigidBody.box((0.2, 0.2), mass=2.0, position=(0, 0), name="hub"))
    rod = beam(scene, name, (0.1, 0), (1.1, 0), 6, E=2e8)
    bob = scene.add(mbd.RigidBody.rod((1.1, 0), (1.1, -0.4), mass=1.0, name="bob"))
    tail = beam(scene, name, (1.1, -0.4), (1.1, -0.9), 4, E=2e8, name="tail")
    scene.add(mbd.Pin(hub.at(), scene.ground.at(0, 0), name="bearing"))
    scene.add(mbd.Clamp(rod.start, hub.at(0.1, 0), name="clamp"))
    scene.add(mbd.Pin(rod.end, bob.at(-0.2, 0), name="pin"))
    scene.add(mbd.Clamp(tail.start, bob.at(0.2, 0), name="joint"))
    return scene, tail.end


@beams
def test_joints_to_rigid_bodies(name: str) -> None:
    """The machine moves as with ANCF cables (stiff beams: what the formulations neglect is small), closed and in balance."""
    runs = []
    for kind in ("AncfCable", name):
        scene, tip = carousel(kind)
        result = mbd.simulate(scene, 0.6, rtol=1e-7)
        assert result.audit.position_drift < 1e-10 and result.audit.velocity_drift < 1e-10
        assert result.audit.energy_error < 1e-5 * result.audit.energy_scale
        runs.append(result.position(tip, t=[0.2, 0.4, 0.6]))
    assert runs[1] == pytest.approx(runs[0], abs=2e-3)


@beams
def test_a_motor_counts_turns(name: str) -> None:
    """A beam driven by two and a half turns at its start, light enough to stay almost straight."""
    scene = mbd.Scene(gravity=(0, 0))
    item = beam(scene, name, (0, 0), (0.5, 0), 2, E=1e8)
    scene.add(mbd.Pin(item.start, scene.ground.at(0, 0)))
    turns = 5.0 * np.pi
    scene.add(mbd.Motor(item.start, scene.ground, angle=lambda t: turns * (t - np.sin(2 * np.pi * t) / (2 * np.pi))))
    result = mbd.simulate(scene, 1.0, rtol=1e-4)
    assert result.angle(item.start)[-1] == pytest.approx(turns, abs=1e-8)
    assert result.angle(item.end)[-1] == pytest.approx(turns, abs=1e-2)


# Mistakes.


@beams
def test_space_is_refused_by_name(name: str) -> None:
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    beam(scene, name, (0, 0, 0), (1, 0, 0))
    with pytest.raises(mbd.SceneError, match=rf"'beam': scene: expected a planar one for a {name}, found a spatial one"):
        scene.build()


@beams
def test_every_mistake_is_told_at_once(name: str) -> None:
    scene = mbd.Scene()
    beam(scene, name, (0, 0), (0, 0), n=0, E=-1.0, A=None, damping=-0.1)
    with pytest.raises(mbd.SceneError) as caught:
        scene.build()
    for what in ("E: expected a positive", "A: expected a positive", "damping: expected", "n_elements: expected", "length: expected"):
        assert what in str(caught.value)


def test_mistakes_of_one_formulation() -> None:
    scene = mbd.Scene()
    beam(scene, "GeometricallyExactBeam", GA=-1.0, rotary_inertia=0.0)
    beam(scene, "FloatingFrameBeam", stiffening="no", name="other")
    with pytest.raises(mbd.SceneError) as caught:
        scene.build()
    for what in ("GA: expected a positive", "rotary_inertia: expected a positive", "stiffening: expected True or False, found 'no'"):
        assert what in str(caught.value)
    item = beam(mbd.Scene(), "GeometricallyExactBeam")
    assert item.at(0.125).turns() and not item.at(0.1).turns()
    with pytest.raises(mbd.SceneError, match="between 0 and 1, found 1.5"):
        item.at(1.5)
