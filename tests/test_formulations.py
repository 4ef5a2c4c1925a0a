"""The planar beams beside ``AncfCable``: inertia, conserved quantities, statics, order, and what joints see, each by a witness of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from . import machines
from .cantilever import SECTION, Cantilever, equilibria
from .kinds import dense

NAMES = ("CorotationalBeam", "FloatingFrameBeam", "GeometricallyExactBeam")
beams = pytest.mark.parametrize("name", NAMES)


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
@pytest.mark.filterwarnings("ignore:.*in its floating frame")  # what is conserved is so for any deflection
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


def order(errors: list[float]) -> float:
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize(("name", "expected"), [("CorotationalBeam", 2.0), ("GeometricallyExactBeam", 4.0)])
def test_rolled_up_by_a_moment(name: str, expected: float) -> None:
    """Half a turn by pi EI / L: the end's angle is exact on any mesh, its position of the formulation's order."""
    length, errors = 2.0, []
    for n in (4, 8, 16):
        make = Cantilever(name, n, torque=np.pi * 1e6 * 1e-5 / length)
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
        make = Cantilever(name, n, force=(0, -0.1), end=(2.4, 0), **stiff)
        *_, (state, _) = equilibria(make, 8)
        errors.append(float(np.linalg.norm(make.item.end.point.value(state.q) - (1.50314639647935, -1.6895165663457091))))
    assert order(errors) == pytest.approx(expected, abs=0.25)


@beams
def test_small_force_bends_by_the_beam_formula(name: str) -> None:
    """F L^3 / (3 E I), and F L / GA where it shears."""
    make = Cantilever(name, 8, force=(0, 1e-6))
    ((state, _),) = equilibria(make, 1)
    shear = 2.0 / (1e4 * 5 / 6 / 2.6) if name == "GeometricallyExactBeam" else 0.0
    expected = 1e-6 * (2.0**3 / (3 * 1e6 * 1e-5) + shear)
    assert make.item.end.point.value(state.q)[1] == pytest.approx(expected, rel=1e-6)


@beams
def test_reaction_of_a_clamp_at_rest(name: str) -> None:
    """Against the load, with its moment about the clamp in the bent shape; what rests in equilibrium stays."""
    make = Cantilever(name, 6, force=(0.3, -0.4))
    *_, (state, _) = equilibria(make, 4)
    scene = make(1.0)
    result = mbd.simulate(scene, 1e-3, start=state, rtol=1e-6)
    arm = result.position(make.item.end)[-1]
    expected = [-0.3, 0.4, 0.4 * arm[0] + 0.3 * arm[1]]
    assert result.reaction(scene["clamp"])[-1] == pytest.approx(expected, abs=1e-7)
    assert np.abs(result.q - state.q).max() < 1e-9


# Dynamics against references, and among joints.


def spaghetti(n: int, t_end: float = 4.0) -> tuple[mbd.Result, Any]:
    scene = mbd.Scene(gravity=(0, 0))
    item = beam(scene, "GeometricallyExactBeam", (6, 0), (0, 8), n, E=1e4, A=1.0, I=0.05, rho=1.0, GA=1e4, rotary_inertia=10.0)

    def pulse(t: float) -> float:
        return np.sin(np.pi * t / 2.5) ** 2 if t < 2.5 else 0.0

    scene.add(mbd.Force(item.start, mbd.piecewise(lambda t: (16.0 * pulse(t), 0.0), at=[2.5])))
    scene.add(mbd.Torque(item.start, mbd.piecewise(lambda t: -160.0 * pulse(t), at=[2.5])))
    return mbd.simulate(scene, t_end, rtol=1e-6), item


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
    assert angles == pytest.approx([value["thA"] for value in values], abs=2e-5)  # 16 times coarser with half the elements
    assert result.energy.total[-1] == pytest.approx(values[-1]["T"] + values[-1]["U"], rel=1e-5)


@pytest.mark.slow
def test_flying_spaghetti_to_its_end() -> None:
    """All listed times, to 15 s: the worst difference between the reference's own meshes is 4.7e-5 m."""
    values = machines.data("spaghetti_reissner_smooth")["reference"]["values"]
    times = [value["t"] for value in values]
    result, item = spaghetti(32, 15.0)
    for marker, key in ((item.start, "A"), (item.at(0.5), "mid"), (item.end, "B")):
        assert result.position(marker, t=times) == pytest.approx(np.array([value[key] for value in values]), abs=2e-5)


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


@beams
def test_pictures_show_the_bent_beam(name: str) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    scene = mbd.Scene()
    item = beam(scene, name, n=3)
    scene.add(mbd.Clamp(item.start, scene.ground.at(0, 0)))
    result = mbd.simulate(scene, 0.1, rtol=1e-4)
    axes = result.plot([0.1])
    line = np.array(axes.lines[0].get_xydata())
    expected = [result.position(item.at(s), t=[0.1])[0] for s in (0.0, 0.5, 1.0)]
    for point in expected:
        assert np.linalg.norm(line - point, axis=1).min() < 1e-12
    matplotlib.pyplot.close(axes.figure)


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
    beam(scene, "FloatingFrameBeam", stiffening="no", modes="some", name="other")
    with pytest.raises(mbd.SceneError) as caught:
        scene.build()
    for what in (
        "GA: expected a positive",
        "rotary_inertia: expected a positive",
        "stiffening: expected True or False, found 'no'",
        "modes: expected one of",
    ):
        assert what in str(caught.value)
    item = beam(mbd.Scene(), "GeometricallyExactBeam")
    assert item.at(0.125).turns() and not item.at(0.1).turns()
    with pytest.raises(mbd.SceneError, match=r"between 0 and 1, found 1\.5"):
        item.at(1.5)
