"""``mbd.equations(scene)``: expressions with the scene's names, equal to the assembled numbers."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import mbd
from mbd.derivations.step import EXACT

from .machines import double_pendulum, heavy_top, simple_pendulum


def pendulum() -> tuple[mbd.Scene, object]:
    scene = mbd.Scene()
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.5, name="rod"))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(), name="pivot"))
    return scene, rod


def test_a_pendulum_as_in_a_textbook() -> None:
    scene, _ = pendulum()
    found = mbd.equations(scene)
    x, y, dx, dy = found.q
    m, j, g = (sp.Symbol(name, real=True) for name in ("m_rod", "J_rod", "g_y"))
    assert [str(q) for q in found.q] == ["rod_mass_centre_x", "rod_mass_centre_y", "rod_axis_1_x", "rod_axis_1_y"]
    assert sp.diag(m, m, j, j) == found.M
    assert sp.Matrix([0, m * g, 0, 0]) == found.f
    assert found.labels == ["rod axes 1 and 1", "pivot position x", "pivot position y"]
    assert (found.g - sp.Matrix([(dx**2 + dy**2 - 1) / 2, x - dx / 2, y - dy / 2])).expand() == sp.zeros(3, 1)
    half = sp.Rational(-1, 2)
    assert sp.Matrix([[0, 0, dx, dy], [1, 0, half, 0], [0, 1, 0, half]]) == found.G
    assert found.values == {m: sp.Rational(3, 2), j: sp.Rational(1, 8), g: sp.Rational(-981, 100)}
    assert found.check() < EXACT


def test_eliminating_the_multipliers_gives_the_equation_of_the_angle() -> None:
    """(J + m l^2/4) theta'' = m g_y l/2 cos theta: on the null space of G."""
    scene, _ = pendulum()
    e, theta = mbd.equations(scene), sp.Symbol("theta")
    place = dict(zip(e.q, (sp.cos(theta) / 2, sp.sin(theta) / 2, sp.cos(theta), sp.sin(theta))))
    along = sp.Matrix(list(place.values())).diff(theta)
    assert sp.simplify(e.G.subs(place) * along) == sp.zeros(3, 1)
    m, j, g = (next(s for s in e.values if s.name == name) for name in ("m_rod", "J_rod", "g_y"))
    assert sp.simplify((along.T * e.M * along)[0] - (m / 4 + j)) == 0
    assert sp.simplify((along.T * e.f.subs(place))[0] - m * g * sp.cos(theta) / 2) == 0


def vehicle() -> mbd.Scene:
    """A body on a skate and a braked, driven wheel."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    cart = scene.add(mbd.RigidBody(mass=1.5, inertia=0.3, position=(0.0, 0.0), name="cart"))
    scene.add(mbd.KnifeEdge(cart, axis=(1.0, 0.0), name="skate"))
    wheel = scene.add(mbd.Wheel(cart.at(0.4, 0.0), axis=(3.0, 4.0), radius=0.2, name="wheel"))
    scene.add(mbd.Friction(wheel, force=0.5, speed=2.0, name="brake"))
    scene.add(mbd.ForceLaw(wheel, lambda t, s, rate: t - s - rate**3, rates=True, name="engine"))
    return scene


def test_nonholonomic_rows_are_those_of_a_textbook() -> None:
    """A skate along u at p: p' x u = 0; a wheel of radius R: p' . u = R phi'. G v in terms of x, y, theta and their rates."""
    found = mbd.equations(vehicle())
    assert [found.labels[k] for k in found.slips] == ["skate slip", "wheel slip", "wheel rolling"]
    theta, dx, dy, turning, spin = sp.symbols("theta dx dy omega spin")
    at = {found.q[2]: sp.cos(theta), found.q[3]: sp.sin(theta)}
    v = sp.Matrix([dx, dy, -sp.sin(theta) * turning, sp.cos(theta) * turning, spin])
    u = sp.Matrix([sp.cos(theta + sp.atan2(4, 3)), sp.sin(theta + sp.atan2(4, 3))])
    contact = sp.Matrix([dx, dy]) + sp.Rational(2, 5) * turning * sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    expected = [dy * sp.cos(theta) - dx * sp.sin(theta), u[0] * contact[1] - u[1] * contact[0], u.dot(contact) - spin / 5]
    rates = found.G.xreplace(at) * v
    for k, right in zip(found.slips, expected):
        assert found.g[k] == 0
        assert sp.simplify(sp.nsimplify(sp.expand(sp.expand_trig(rates[k] - right)), tolerance=1e-14)) == 0


def test_loads_that_depend_on_rates_contain_them() -> None:
    found = mbd.equations(vehicle())
    turn, rate = found.q[-1], found.v[-1]
    assert sp.simplify(found.f[-1] - (found.t - turn - rate**3 - sp.tanh(rate / 2) / 2)) == 0


def everything() -> mbd.Scene:
    """Cable, body, particle; spring, damper, loads that are constant, follow, or vary; drives; joints."""
    scene = mbd.Scene(gravity=(0.2, -9.81))
    cable = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=1, E=10.0, A=0.2, I=0.03, rho=2.0, gauss_points=3, damping=0.1, name="cable"))
    body = scene.add(mbd.RigidBody(mass=1.5, inertia=0.3, position=(1.5, 0), name="arm"))
    ball = scene.add(mbd.Particle(0.7, (2.0, 1.0), name="ball"))
    scene.add(mbd.Clamp(cable.end, body.at(-0.3, 0), name="weld"))
    scene.add(mbd.Prescribed(cable.start, lambda t: (t**2, np.sin(t)), name="shaker"))
    scene.add(mbd.Distance(ball.at(), body.at(), name="link"))
    scene.add(mbd.Spring(ball.at(), scene.ground.at(2, 2), stiffness=3.0, damping=0.2, name="spring"))
    scene.add(mbd.TorsionSpring(body.at(), scene.ground.at(), stiffness=2.0, damping=0.1, angle=0.3, name="coil"))
    scene.add(mbd.Force(body.at(0.3, 0), (1.0, 2.5), follower=True, name="jet"))
    scene.add(mbd.Force(ball.at(), (0.5, 0.0), name="push"))
    scene.add(mbd.Force(ball.at(), lambda t: (t, 1.0), name="wind"))
    scene.add(mbd.Torque(cable.at(0.5), lambda t: np.cos(t), name="twist"))
    scene.add(mbd.Motor(body, scene.ground, torque=lambda t: 2.0 * t, name="motor"))
    return scene


def beams() -> mbd.Scene:
    """One of each formulation with unit directors, hung up backwards; modes whose stiffnesses differ."""
    scene = mbd.Scene()
    for k, kind in enumerate((mbd.CorotationalBeam, mbd.GeometricallyExactBeam, mbd.FloatingFrameBeam)):
        beam = scene.add(kind((0, k), (-0.4, k + 0.1), n_elements=1 if k == 1 else 2, E=10.0, A=0.2, I=0.03, rho=2.0, damping=0.1, name=f"beam{k}"))
        scene.add(mbd.Pin(beam.start, scene.ground.at(0, k), name=f"pivot{k}"))
    return scene


SCENES = {
    "everything": everything,
    "beams": beams,
    "vehicle": vehicle,
    "double pendulum": lambda: double_pendulum()[0],
    "simple pendulum": lambda: simple_pendulum()[0],
    "heavy top": lambda: heavy_top()[0],
}


@pytest.mark.parametrize("name", SCENES)
def test_expressions_are_the_assembled_numbers(name: str) -> None:
    found = mbd.equations(SCENES[name]())
    assert found.check(seed=3) < EXACT
    assert sp.simplify(found.M - found.M.T) == sp.zeros(len(found.q), len(found.q))
    known = {*found.q, *found.v, *found.values, found.t}
    assert found.M.free_symbols | found.f.free_symbols | found.g.free_symbols <= known


def test_names_of_loads_and_drives_are_those_of_the_scene() -> None:
    found = mbd.equations(everything())
    t = found.t
    functions = {str(f) for f in found.f.atoms(sp.core.function.AppliedUndef) | found.g.atoms(sp.core.function.AppliedUndef)}
    assert {"Fx_wind(t)", "Fy_wind(t)", "T_twist(t)", "T_motor(t)", "c_shaker_position_x(t)", "c_shaker_position_y(t)"} == functions
    assert {"Fx_push", "F1_jet", "F2_jet", "EA_cable", "EI_cable", "tau_cable", "l_cable", "k_spring", "c_spring", "L_spring", "phi0_coil"} <= {
        str(symbol) for symbol in found.values
    }
    assert t in found.f.free_symbols


def test_a_wrong_number_in_the_system_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, _ = pendulum()
    found = mbd.equations(scene)
    system = scene.build()
    monkeypatch.setattr(system, "weight", -system.weight)
    monkeypatch.setattr(system, "constant_force", -system.constant_force)
    assert found.check() == pytest.approx(2.0)


def test_latex_has_a_line_for_each_matrix_and_definitions_for_long_ones() -> None:
    scene, _ = pendulum()
    lines = mbd.equations(scene).latex().splitlines()
    assert [line.split(" = ")[0] for line in lines] == ["M", "f", "g", "G"]
    assert r"x_{\text{rod mass centre}}" in lines[2]
    long = mbd.equations(everything()).latex()
    assert "z_{1} = " in long and len(long) < 60000 and long.count("{") == long.count("}")


def test_large_scenes_are_refused_with_a_way_out() -> None:
    scene = mbd.Scene()
    scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=20, E=1.0, A=1.0, I=1.0, rho=1.0))
    with pytest.raises(mbd.SceneError, match=r"expected at most 40 coordinates.*found 84; take fewer elements"):
        mbd.equations(scene)


def test_complaints_of_a_bad_scene_come_first() -> None:
    scene = mbd.Scene()
    scene.add(mbd.Particle(-1.0, (0, 0), name="ball"))
    with pytest.raises(mbd.SceneError, match="particle 'ball': mass"):
        mbd.equations(scene)
