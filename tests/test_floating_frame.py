"""The floating frame of reference: modes, kinematics and energies by their definitions, stiffening by textbook formulas, the usual equations."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest

import mbd
from mbd.elements.bending_modes import BendingModes

from .cantilever import SECTION, Cantilever, equilibria

REFERENCE = json.loads((Path(__file__).resolve().parents[1] / "examples" / "escalona_1998" / "reference.json").read_text(encoding="utf-8"))


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
        make = Cantilever("FloatingFrameBeam", 10, force=(-p, q), stiffening=stiffening)
        *_, (state, _) = equilibria(make, 4)
        found.append(make.item.end.point.value(state.q)[1])
    assert found[0] == pytest.approx(expected, rel=1e-6)
    assert found[1] == pytest.approx(q * length**3 / (3 * stiffness), rel=1e-7)


def test_modes_of_a_fine_mesh_are_those_of_a_beam() -> None:
    """cos b cosh b = -1, unit end, int w^2 = 1/4, int w''^2 = b^4 / 4."""
    modes, b = BendingModes(40, "cantilever"), np.array([1.8751040687119611, 4.694091132974174, 7.854757438237613])
    assert 4.0 * modes.stiffness[:3] == pytest.approx(b**4, rel=1e-5)
    assert modes.shape(1.0)[:3, 0] == pytest.approx(1.0, rel=1e-5)
    xi, weight = modes.points
    w = modes.shape(xi)
    assert (w * weight) @ w.T == pytest.approx(0.25 * np.eye(40), abs=1e-12)
    assert np.abs(modes.shape(0.0)).max() == np.abs(modes.shape(0.0, 1)).max() == 0.0


@pytest.mark.parametrize("n", [1, 2, 5])
def test_craig_bampton_shapes(n: int) -> None:
    """They span xi^2 and xi^3, the shapes of a loaded end, and modes of a beam clamped at both ends: cos b cosh b = 1."""
    modes = BendingModes(n, "craig_bampton")
    count = max(n, 2)
    xi, weight = modes.points
    w, bend = modes.shape(xi), modes.shape(xi, 2)
    assert (w * weight) @ w.T == pytest.approx(0.25 * np.eye(count), abs=1e-12)
    assert (bend * weight) @ bend.T == pytest.approx(np.diag(modes.stiffness), abs=1e-9 * modes.stiffness[-1])
    for power in (2, 3):
        assert 4.0 * (w * weight) @ xi**power @ w == pytest.approx(xi**power, abs=1e-12)
    if n == 5:
        held = np.linalg.svd(np.stack((modes.shape(1.0)[:, 0], modes.shape(1.0, 1)[:, 0])))[2][2:]  # combinations with a clamped end
        b = np.sqrt(2.0 * np.sqrt(np.linalg.eigvalsh(held @ np.diag(modes.stiffness) @ held.T)))
        assert b == pytest.approx([4.730040744862704, 7.853204624095838, 10.995607838001671], rel=1e-2)


def test_a_clamped_end_needs_craig_bampton() -> None:
    """A torque at the end bends the beam to a circle: exact by xi^2; modes of a free end approach its angle with the first power of their number."""
    torque, expected = 1e-4, 1e-4 * 2.0 / 10.0
    errors = []
    for n, words in ((4, {}), (10, {"modes": "cantilever"}), (20, {"modes": "cantilever"})):
        make = Cantilever("FloatingFrameBeam", n, torque=torque, **words)
        ((state, _),) = equilibria(make, 1)
        errors.append(abs(make.item.end.axes[0].value(state.q)[1] / expected - 1.0))
    assert errors[0] < 1e-8
    assert 0.01 < errors[2] < 0.6 * errors[1]


@pytest.mark.parametrize("stiffening", [True, False])
def test_floating_frame_is_the_turned_beam(stiffening: bool) -> None:
    """One element, whose mode is a cubic, so that everything is exact: at a random frame and deflection the equations hold, and kinetic energy,
    potential, elastic energy and points are those of r = R + rot(x - u, w), u = 1/2 int w'^2, by quadrature."""
    scene, rng = mbd.Scene(gravity=(1.5, -9.81)), np.random.default_rng(7)
    length, density = 2.0, 1000.0 * 1e-2
    item = scene.add(mbd.FloatingFrameBeam((0, 0), (length, 0), n_elements=1, modes="cantilever", stiffening=stiffening, **SECTION))
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


def usual(n: int, times: np.ndarray, stiffening: bool, rtol: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle and end's offset of the paper's 0.4 m pendulum by the usual equations of the floating frame, coordinates (theta, q):

    (J + q.q - q.Kc q) th'' + s.q'' + 2 (q.q' - q'.Kc q) th' = -g [(h0 - q.Kd q / 2) cos th - h.q sin th]
    s th'' + q'' = (q - Kc q) th'^2 - Om^2 q - g (h cos th - Kd q sin th),     Kc = Kd = 0 without stiffening."""
    from scipy.integrate import solve_ivp

    length, line, g = 0.4, 5540 * 1.8e-3, 9.81
    modes, unit = BendingModes(n, "cantilever"), 1.0 / np.sqrt(0.25 * line * length)  # modal masses one
    xi, weight = modes.points
    shapes = unit * modes.shape(xi)
    h, s = line * length * shapes @ weight, line * length**2 * shapes @ (weight * xi)
    om2 = 1e9 * 1.215e-8 / (line * length**4) * 4.0 * modes.stiffness
    kd = stiffening * line * unit**2 * modes.shortening("mean")
    kc = stiffening * line * length * unit**2 * 0.5 * modes.shortening("moment")

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        th, q, w, qd = y[0], y[1 : 1 + n], y[1 + n], y[2 + n :]
        m, softer = np.eye(n + 1), kc @ q
        m[0, 0], m[0, 1:], m[1:, 0] = line * length**3 / 3 + q @ q - q @ softer, s, s
        turning = -g * ((0.5 * line * length**2 - 0.5 * q @ kd @ q) * np.cos(th) - h @ q * np.sin(th)) - 2.0 * (q @ qd - qd @ softer) * w
        bending = (q - softer) * w**2 - om2 * q - g * (h * np.cos(th) - kd @ q * np.sin(th))
        return np.concatenate(([w], qd, np.linalg.solve(m, np.concatenate(([turning], bending)))))

    run = solve_ivp(rates, (0.0, times[-1]), np.zeros(2 * n + 2), method="DOP853", rtol=rtol, atol=1e-2 * rtol, t_eval=times)
    return run.y[0], unit * modes.shape(1.0)[:, 0] @ run.y[1 : 1 + n]


def swing(n: int, t_end: float, times: np.ndarray, rtol: float, stiffening: bool) -> tuple[np.ndarray, np.ndarray]:
    """The same of the library."""
    scene = mbd.Scene()
    words = {"E": 1e9, "A": 1.8e-3, "I": 1.215e-8, "rho": 5540}
    rod = scene.add(mbd.FloatingFrameBeam((0, 0), (0.4, 0), n_elements=n, modes="cantilever", stiffening=stiffening, **words))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    result = mbd.simulate(scene, t_end, rtol=rtol)
    angle, tip = result.angle(rod.start, t=times), result.position(rod.end, t=times)
    return angle, np.cos(angle) * tip[:, 1] - np.sin(angle) * tip[:, 0]


def test_linear_floating_frame_has_the_usual_equations() -> None:
    """The constant mass matrix and its rows give the motion that the usual coordinates give."""
    times = np.linspace(0.02, 0.2, 10)
    angle, offset = usual(3, times, False, 1e-10)
    found = swing(3, 0.2, times, 1e-9, False)
    assert found[0] == pytest.approx(angle, abs=2e-7)
    assert found[1] == pytest.approx(offset, abs=5e-8)


@pytest.mark.slow
@pytest.mark.parametrize("stiffening", [False, True], ids=["linear", "stiffened"])
def test_figures_9_and_10_by_the_usual_equations(stiffening: bool) -> None:
    """They give the reference to 1e-8, with its modes. The library's linear form too; its stiffened form keeps terms of third order."""
    reference = REFERENCE["floating_frame"]["stiffened" if stiffening else "linear"]
    times = np.array(reference["t"])
    angle, offset = usual(10, times, stiffening, 1e-8)
    assert angle == pytest.approx(reference["th"], abs=1e-8)
    assert offset == pytest.approx(reference["v"], abs=1e-8)
    found = swing(10, 1.0, times, 1e-6 if stiffening else 1e-10, stiffening)
    assert found[0] == pytest.approx(angle, abs=5e-4 if stiffening else 1e-8)
    assert found[1] == pytest.approx(offset, abs=1.5e-4 if stiffening else 1e-8)


@pytest.mark.parametrize(("E", "warned"), [(1e9, False), (1e7, True)])
def test_deflections_beyond_its_means_are_told(E: float, warned: bool) -> None:
    scene = mbd.Scene()
    rod = scene.add(mbd.FloatingFrameBeam((0, 0), (0.4, 0), n_elements=3, E=E, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mbd.simulate(scene, 0.3, rtol=1e-4)
    assert [str(w.message).startswith("beam 'rod' bends to a slope of ") for w in caught] == [True] * warned
