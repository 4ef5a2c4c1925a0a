"""Paths through limit points and bifurcations: an arch against a shooting method, columns against Euler and the elastica, a truss by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

import mbd

from .. import machines


def arch(n: int, **options: Any) -> tuple[mbd.Scene, Any]:
    """DaDeppo and Schmidt's clamped and hinged deep arch, R = 100, 215 degrees, 1000 N down at the crown: scene, arch."""
    radius, half = 100.0, np.radians(107.5)
    angle = np.linspace(half, -half, n + 1)
    nodes = radius * np.stack((-np.sin(angle), np.cos(angle)), axis=1)
    tangents = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    scene = mbd.Scene(gravity=(0, 0))
    beam = scene.add(mbd.AncfCable(nodes=nodes, tangents=tangents, E=1e8, A=1.0, I=1e-2, rho=1.0, **options))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(*nodes[0])))
    scene.add(mbd.Pin(beam.end, scene.ground.at(*nodes[-1])))
    scene.add(mbd.Force(beam.at(0.5), (0.0, -1000.0), name="crown"))
    return scene, beam


REFERENCE = machines.data("deep_arch")["reference"]["EA=1e8,shear-rigid,EI=1e6"]


def test_deep_arch() -> None:
    """Limit load within 1e-4 (measured 2.1e-5) and the path through it to the last row of the reference (within 3.4e-5)."""
    scene, beam = arch(128)
    rows = REFERENCE["curve_v_P"][3::5]
    last = rows[-1][0]

    def at(v: float) -> mbd.Event:
        return mbd.Event(lambda e: 100.0 - e.position(beam.at(0.5))[1] - v, name=f"{v}", terminal=v == last)

    path = mbd.continuation(scene, "crown", until=None, events=[at(v) for v, _ in rows], longest=0.05)
    (limit,) = path.limits
    assert 1000.0 * limit.factor == pytest.approx(REFERENCE["limit_load"], rel=1e-4)
    assert 100.0 - limit.position(beam.at(0.5))[1] == pytest.approx(REFERENCE["crown_vertical_displacement_at_limit"], rel=1e-4)
    for v, load in rows:
        (found,) = path.events[f"{v}"]
        assert 1000.0 * found.factor == pytest.approx(load, rel=1e-4)
    assert path.stable[0] and path.unstable[-1] == 1 and not path.bifurcations and not path.ended


def _turned(beam: Any) -> mbd.Event:
    return mbd.Event(lambda e: e.position(beam.at(0.5))[1] + 15.0, terminal=True)


def test_limit_load_converges_with_the_mesh() -> None:
    errors = []
    for n in (32, 48, 72):
        scene, beam = arch(n, gauss_points=3)
        path = mbd.continuation(scene, "crown", until=None, events=[_turned(beam)])
        errors.append(1000.0 * path.limits[0].factor / REFERENCE["limit_load"] - 1.0)
    assert np.log(errors[0] / errors[2]) / np.log(72 / 32) > 3.5


def column(n: int = 16) -> tuple[mbd.Scene, Any, Any]:
    """A clamped column of length and EI one, EI / EA = 8e-6, under Euler's load: scene, column, load."""
    scene, height = mbd.Scene(gravity=(0, 0)), 0.01
    modulus = 12.0 / height**4
    beam = scene.add(mbd.AncfCable((0, 0), (0, 1), n_elements=n, E=modulus, A=height**2, I=1.0 / modulus, rho=1.0))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0)))
    return scene, beam, scene.add(mbd.Force(beam.end, (0.0, -(np.pi**2) / 4)))


def test_euler_loads() -> None:
    """The compressed column is shorter: P (1 - P / EA) = ((k - 1/2) pi)^2 EI / L^2 exactly for this strain."""
    scene, _, load = column()
    path = mbd.continuation(scene, load, until=12.0, step=0.1, longest=0.5)
    found = np.array([b.at.factor for b in path.bifurcations]) * np.pi**2 / 4
    ea = 1e-4 * 12.0 / 1e-8
    assert found * (1.0 - found / ea) / (np.pi**2 / 4) == pytest.approx([1.0, 9.0], rel=2e-5)
    assert [path.unstable[0], path.unstable[-1]] == [0, 2] and not path.limits and path.factor[-1] == pytest.approx(12.0, abs=1e-9)


@pytest.mark.parametrize("reverse", [False, True])
def test_pitchfork_and_its_branches(reverse: bool) -> None:
    """The elastica: P L^2 / EI = K(k)^2, tip height 2 E(k) / K(k) - 1, k the sine of half the tip's rotation."""
    scene, beam, load = column()
    (buckling,) = mbd.continuation(scene, load, until=2.0, step=0.2, longest=0.5).bifurcations
    half = mbd.Event(lambda e: abs(e.angle(beam.end) - np.pi / 2) - 1.0)
    branch = mbd.continuation(scene, load, until=2.0, events=[half], branch=buckling, step=0.05, reverse=reverse)
    (found,) = branch.events[half]
    k2 = np.sin(0.5) ** 2
    assert found.factor * np.pi**2 / 4 == pytest.approx(ellipk(k2) ** 2, rel=1e-4)
    assert found.position(beam.end)[1] == pytest.approx(2 * ellipe(k2) / ellipk(k2) - 1, abs=1e-4)
    other = mbd.continuation(scene, load, until=1.2, branch=buckling, step=0.05, reverse=not reverse)
    aside, opposite = branch.position(beam.end)[:, 0], other.position(beam.end)[:, 0]
    assert branch.stable.all() and (aside * aside[0] > 0.0).all() and (opposite * aside[0] < 0.0).all()


def test_a_rigid_bar_on_a_torsion_spring() -> None:
    """The path to the bifurcation has no motion at all, and K is exactly singular at its end: P = k / L there, k angle / L sin(angle) aside."""
    scene = mbd.Scene(gravity=(0, 0))
    bar = scene.add(mbd.RigidBody.rod((0, 0), (0, 1), mass=1.0))
    scene.add(mbd.Pin(bar.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.TorsionSpring(bar.at(0, 0), scene.ground.at(0, 0), stiffness=10.0))
    load = scene.add(mbd.Force(bar.at(0.5, 0), (0.0, -10.0)))
    path = mbd.continuation(scene, load, until=1.5, step=0.1)
    (found,) = path.bifurcations
    assert found.at.factor == pytest.approx(1.0, abs=1e-9) and path.unstable[-1] == 1
    branch = mbd.continuation(scene, load, until=2.0, branch=found)
    x, y = branch.position(bar.at(0.5, 0)).T
    assert branch.factor == pytest.approx(np.arctan2(x, y) / x, abs=1e-9) and branch.stable.all()


def test_an_imperfect_column_keeps_to_its_own_path() -> None:
    """Beside the bifurcation another path passes close by; long steps would jump over to it, where the column is unstable."""
    scene, beam, load = column()
    scene.add(mbd.Force(beam.end, (0.003, 0.0)))
    path = mbd.continuation(scene, load, until=1.2, step=0.1, longest=0.3)
    aside = path.position(beam.end)[:, 0]
    assert path.stable.all() and not path.limits and not path.bifurcations and not path.ended
    assert (np.diff(aside) > 0.0).all() and aside[-1] > 0.5
    amplified = aside[0] / (1.0 - path.factor[path.factor < 0.8])  # Timoshenko's rule for small deflections
    assert aside[path.factor < 0.8] == pytest.approx(amplified, rel=0.03)


def truss() -> tuple[mbd.Scene, Any, Any]:
    """Von Mises' truss: an apex 0.3 m above two supports 2 m apart, on springs, under 10 N: scene, apex, load."""
    scene = mbd.Scene(gravity=(0, 0))
    apex = scene.add(mbd.Particle(1.0, (0, 0.3), name="apex"))
    for x in (-1, 1):
        scene.add(mbd.Spring(apex.at(), scene.ground.at(x, 0), stiffness=1000.0))
    return scene, apex, scene.add(mbd.Force(apex.at(), (0.0, -10.0), name="load"))


def test_von_mises_truss() -> None:
    """P = -2 k (l - L) y / l all along the path; limits where l^3 = L^2 (per half span)."""
    scene, apex, load = truss()
    path = mbd.continuation(scene, load, until=3.0, step=0.05)
    y, rest = path.position(apex.at())[:, 1], np.hypot(1.0, 0.3)
    long = np.hypot(1.0, y)
    assert 10.0 * path.factor == pytest.approx(-2000.0 * (long - rest) * y / long, abs=1e-9)
    limits = np.array([e.position(apex.at())[1] for e in path.limits])
    assert limits == pytest.approx(np.sqrt(rest ** (2 / 3) - 1.0) * np.array([1.0, -1.0]), rel=1e-7)
    assert path.stable[0] and path.stable[-1] and (np.abs(y[path.unstable > 0]) < limits[0]).all()
    assert path[-1].stable and path[-1].factor == pytest.approx(3.0) and path[-1].q == pytest.approx(path.q[-1])


def test_dead_load_snaps_the_truss_through() -> None:
    """Beyond the limit load no path leads on: ``equilibrium`` falls to the other side, where the path by arc length arrives too."""
    scene, apex, load = truss()
    with pytest.warns(mbd.SceneWarning, match="path of balance breaks off near 1e[+]02 %"):
        found = mbd.equilibrium(scene)
    path = mbd.continuation(scene, load, step=0.05)
    assert found.stats["falls"] == 1 and found.stable
    assert found.position(apex.at()) == pytest.approx([0.0, path.position(apex.at())[-1, 1]], abs=1e-9)


def test_other_loads_act_in_full() -> None:
    """A hanging weight on a spring, and a growing one: the path starts at the first one's equilibrium."""
    scene = mbd.Scene()
    bob = scene.add(mbd.Particle(2.0, (0, -1.0)))
    scene.add(mbd.Spring(bob.at(), scene.ground.at(0, 0), stiffness=100.0))
    scene.add(mbd.Force(bob.at(), (0.0, -5.0), name="kept"))
    scene.add(mbd.Force(bob.at(), lambda t: (0.0, -30.0 * t), name="grown"))
    path = mbd.continuation(scene, "grown", t=2.0)
    assert mbd.equilibrium(scene, t=2.0).q == pytest.approx(path.q[-1])
    assert path.position(bob.at())[[0, -1], 1] == pytest.approx([-1.0 - (19.62 + 5.0) / 100.0, -1.0 - (19.62 + 65.0) / 100.0], abs=1e-12)


def test_bad_input_is_listed() -> None:
    scene, _, _ = truss()
    with pytest.raises(mbd.SceneError, match="load: expected forces or torques of this scene, found 'apex'"):
        mbd.continuation(scene, "apex")
    with pytest.raises(mbd.SceneError) as raised:
        mbd.continuation(scene, until=np.inf, step=0.0, most=0)
    assert len(raised.value.complaints) == 3


def test_a_path_needs_a_start() -> None:
    scene = mbd.Scene()
    block = scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="block"))
    push = scene.add(mbd.Force(block.at(0, 0), (1.0, 0.0)))
    with pytest.raises(mbd.SimulationError, match="no equilibrium to start from"):
        mbd.continuation(scene, push)
