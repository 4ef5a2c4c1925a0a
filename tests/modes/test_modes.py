"""Modes of beams and mechanisms against closed forms and against each other by two routes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbd

from .. import machines

HEIGHT, E, RHO = 0.01, 2.07e11, 7800.0
SPEED = np.sqrt(E * HEIGHT**2 / 12 / RHO)
"""sqrt(EI / rho A) [m^2/s]."""

REFERENCE = machines.data("beam_frequencies")["reference"]


def beam(kind: str, n: int, d: int = 2, damping: float = 0.0) -> tuple[mbd.Scene, Any]:
    """A steel beam of 1 m without gravity: scene, beam."""
    scene = mbd.Scene(gravity=(0.0,) * d)
    ends = np.eye(d)[0]
    section = {"E": E, "A": HEIGHT**2, "I": HEIGHT**4 / 12, "rho": RHO, "damping": damping}
    cable = scene.add(mbd.AncfCable(0.0 * ends, ends, n_elements=n, name="beam", **section))
    if kind != "free_free":
        scene.add(mbd.Clamp(cable.start, scene.ground.at(*(0.0 * ends))))
    if kind == "clamped_pinned":
        scene.add((mbd.Pin if d == 2 else mbd.Ball)(cable.end, scene.ground.at(*ends)))
    return scene, cable


@pytest.mark.parametrize("kind", ["free_free", "cantilever", "clamped_pinned"])
def test_beam_frequencies_converge_at_order_four(kind: str) -> None:
    exact = np.array(REFERENCE[f"{kind}_betaL"], dtype=float)[:4] ** 2 * SPEED
    errors = []
    for n in (8, 16, 32):
        modes = mbd.modes(beam(kind, n)[0], 8)
        rigid = 3 if kind == "free_free" else 0
        assert (modes.rigid, modes.unstable) == (rigid, 0) and (modes.frequencies[:rigid] == 0.0).all()
        errors.append(modes.frequencies[rigid : rigid + 4] / exact - 1.0)
    assert np.max(errors[2]) < 3e-5 and np.min(errors) > 0.0  # a conforming beam is too stiff
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.15)


@pytest.mark.parametrize("kind", ["free_free", "cantilever", "clamped_pinned"])
def test_sparse_finds_what_dense_finds(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from mbd.solvers import eigen

    scene, cable = beam(kind, 24)
    dense = mbd.modes(scene, 8)
    monkeypatch.setattr(eigen, "UNDAMPED_DENSE", 0)
    sparse = mbd.modes(scene, 8)
    assert sparse.rigid == dense.rigid
    assert sparse.frequencies == pytest.approx(dense.frequencies, rel=1e-8)
    assert np.abs(sparse.displacement(cable.end))[dense.rigid :] == pytest.approx(np.abs(dense.displacement(cable.end))[dense.rigid :], abs=1e-5)


def test_a_large_beam_to_the_digits_of_its_mesh() -> None:
    """400 elements, 1604 coordinates, rigid modes among them."""
    modes = mbd.modes(beam("free_free", 400)[0], 6)
    exact = np.array(REFERENCE["free_free_betaL"], dtype=float)[:3] ** 2 * SPEED
    assert modes.rigid == 3 and modes.frequencies[3:] == pytest.approx(exact, rel=1e-8)


def test_shapes_are_orthonormal_and_obey_the_joints() -> None:
    scene, _ = beam("clamped_pinned", 12)
    system, modes = scene.build(), mbd.modes(scene, 6)
    assert modes.shapes.shape == (6, system.n)
    assert modes.shapes @ system.mass(modes.shapes).T == pytest.approx(np.eye(6), abs=1e-8)
    assert np.abs(system.joints.at(system.q0).push(modes.shapes)).max() < 1e-9
    assert modes.hertz * 2 * np.pi == pytest.approx(modes.frequencies)


def test_rigid_modes_in_space() -> None:
    """A thin cable has no torsion: three translations and two rotations. Bending comes in pairs."""
    modes = mbd.modes(beam("free_free", 8, 3)[0], 9)
    assert modes.rigid == 5
    assert modes.frequencies[5::2] == pytest.approx(modes.frequencies[6::2], rel=1e-9)


def pendulum(angle: float, damping: float = 0.0) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (np.cos(angle), np.sin(angle)), mass=1.0, name="rod"))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0)))
    if damping:
        scene.add(mbd.TorsionSpring(body.at(0, 0), scene.ground.at(0, 0), stiffness=1e-12, damping=damping))
    return scene, body


def test_pendulum() -> None:
    """omega^2 = 3 g / 2 L hanging; upright it grows at that rate; the geometry of the joint's force is all the stiffness there is."""
    rate = np.sqrt(1.5 * 9.81)
    hanging, upright = (mbd.modes(pendulum(sign * np.pi / 2)[0], 3) for sign in (-1, 1))
    assert hanging.frequencies == pytest.approx([rate]) and not hanging.unstable
    assert upright.eigenvalues == pytest.approx([rate]) and upright.unstable == 1 and upright.frequencies == [0.0]
    fallen = mbd.modes(pendulum(0.0)[0], about=mbd.equilibrium(pendulum(0.0)[0]).state)
    assert fallen.frequencies == pytest.approx([rate])


def test_about_an_equilibrium_of_the_same_scene() -> None:
    scene, _ = pendulum(0.3)
    assert mbd.modes(scene, about=mbd.equilibrium(scene)).frequencies == pytest.approx([np.sqrt(1.5 * 9.81)])


@pytest.mark.parametrize("damping", [0.5, 20.0])
def test_damped_pendulum(damping: float) -> None:
    """J s^2 + c s + m g L / 2 = 0, below and above critical damping."""
    modes = mbd.modes(pendulum(-np.pi / 2, damping)[0], 2)
    roots = np.roots([1 / 3, damping, 9.81 / 2])
    exact = sorted((s for s in roots if s.imag >= 0.0), key=abs)
    assert modes.eigenvalues == pytest.approx(exact, rel=1e-9)
    assert modes.damping_ratios == pytest.approx([-s.real / abs(s) for s in exact])


@pytest.mark.parametrize("kind", ["cantilever", "free_free"])
def test_kelvin_voigt_damping_of_a_beam(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Proportional to stiffness: s^2 + tau omega^2 s + omega^2 = 0 for every undamped omega; dense and sparse."""
    from mbd.solvers import eigen

    tau = 1e-4
    undamped = mbd.modes(beam(kind, 12)[0], 6)
    w = undamped.frequencies
    exact = -0.5 * tau * w**2 + 1j * w * np.sqrt(1.0 - (0.5 * tau * w) ** 2)
    scene, _ = beam(kind, 12, damping=tau)
    for limit in (1000, 0):
        monkeypatch.setattr(eigen, "GENERAL_DENSE", limit)
        found = mbd.modes(scene, 6)
        assert found.rigid == undamped.rigid
        assert found.eigenvalues == pytest.approx(exact, rel=1e-6)
        assert np.iscomplexobj(found.shapes) and found.damping_ratios == pytest.approx(0.5 * tau * w, rel=1e-6)


def test_a_prestressed_string() -> None:
    """Frequencies of a string under tension T: (k pi / L) sqrt(T / rho A), its bending stiffness negligible."""
    scene = mbd.Scene(gravity=(0, 0))
    string = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=24, E=1e9, A=1e-6, I=1e-18, rho=1000.0))
    scene.add(mbd.Pin(string.start, scene.ground.at(0, 0)))
    scene.add(mbd.Prescribed(string.end, (1.001, 0.0)))
    found = mbd.modes(scene, 3, about=mbd.equilibrium(scene))
    tension, length = 1e9 * 1e-6 * 1e-3, 1.001
    assert found.frequencies == pytest.approx(np.pi * np.arange(1, 4) / length * np.sqrt(tension / (1e-3 / length)), rel=1e-5)


def test_buckling_is_where_the_frequency_vanishes() -> None:
    """omega^2 of a column falls with its load, nearly in a straight line, to zero at Euler's; beyond it is unstable."""
    squares = []
    for share in (0.0, 0.5, 0.99, 1.01):
        scene, cable = beam("cantilever", 8)
        scene.add(mbd.Force(cable.end, (-share * np.pi**2 / 4 * E * HEIGHT**4 / 12, 0.0)))
        modes = mbd.modes(scene, 1, about=mbd.equilibrium(scene, start=None))
        squares.append((modes.eigenvalues[0] ** 2).real)
        assert modes.unstable == (share > 1.0)
    assert 0.99 + 0.02 * squares[2] / (squares[2] - squares[3]) == pytest.approx(1.0, abs=1e-4)
    assert squares[1] / squares[0] == pytest.approx(0.5, abs=0.03)


def test_modes_along_a_path_see_the_load_times_its_factor() -> None:
    """Beck's column again, the follower force growing along a path: the slowest mode there is that of the column under that very force."""
    scene, cable = beam("cantilever", 6)
    load = scene.add(mbd.Force(cable.end, (-10.0 * E * HEIGHT**4 / 12, 0.0), follower=True))
    path = mbd.continuation(scene, load, until=0.4, step=0.2, longest=0.2)
    single, other = beam("cantilever", 6)
    single.add(mbd.Force(other.end, (-4.0 * E * HEIGHT**4 / 12, 0.0), follower=True))
    expected = mbd.modes(single, 2, about=mbd.equilibrium(single)).frequencies
    assert mbd.modes(scene, 2, about=path[-1]).frequencies == pytest.approx(expected, rel=1e-6)


def test_flutter_of_a_follower_force() -> None:
    """Beck's column: no buckling, but flutter from P L^2 / EI = 20.05 on (Beck 1952)."""
    growing = []
    for load in (19.9, 20.2):
        scene, cable = beam("cantilever", 8)
        scene.add(mbd.Force(cable.end, (-load * E * HEIGHT**4 / 12, 0.0), follower=True))
        modes = mbd.modes(scene, 2, about=mbd.equilibrium(scene))
        growing.append(modes.unstable)
    assert growing == [0, 1]


def test_a_frequency_is_that_of_a_simulation() -> None:
    """A sagging cable with a heavy bead: its first mode, let go with a small amplitude."""
    scene = mbd.Scene()
    cable = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=6, E=1e8, A=1e-5, I=1e-11, rho=1000.0))
    bead = scene.add(mbd.Particle(0.05, (0.5, 0.0)))
    scene.add(mbd.Pin(cable.start, scene.ground.at(0, 0)))
    scene.add(mbd.Pin(cable.end, scene.ground.at(1, 0)))
    scene.add(mbd.Pin(bead.at(), cable.at(0.5)))
    rest = mbd.equilibrium(scene)
    modes = mbd.modes(scene, 1, about=rest)
    shape, period = modes.shapes[0], 1.0 / modes.hertz[0]
    amplitude = 1e-5 / np.abs(modes.displacement(bead.at())).max()
    result = mbd.simulate(scene, 1.25 * period, start=mbd.State(rest.q + amplitude * shape, 0 * rest.q), rtol=1e-10, t_eval=[period, 1.25 * period])
    moved = (result.q - rest.q) @ scene.build().mass(shape) / amplitude
    assert moved == pytest.approx([1.0, 0.0], abs=2e-3)


def test_a_moving_state_is_refused_and_an_unbalanced_one_announced() -> None:
    scene, _ = pendulum(0.0)
    system = scene.build()
    with pytest.raises(mbd.SceneError, match="expected a state at rest"):
        mbd.modes(scene, about=mbd.State(system.q0, np.ones(system.n)))
    with pytest.warns(mbd.SceneWarning, match="not an equilibrium"):
        mbd.modes(scene)
    with pytest.raises(mbd.SceneError, match="n: expected a whole number"):
        mbd.modes(scene, 0)
