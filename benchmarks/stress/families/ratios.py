"""Ratios of masses, stiffnesses, thicknesses, dampers and elements."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import mbd

from ... import machines
from .. import exact
from ..common import audited, powers, share
from ..family import Checked, Family

TILT = np.pi / 3.0
ALONG = np.array([np.sin(TILT), -np.cos(TILT)])
"""From the support to what is released: 60 degrees from hanging."""


# A parallelogram of two links of 1 m and 1 kg and a coupler, released 60 degrees from hanging: one pendulum.
def parallelogram_end(ratio: float, t: float) -> np.ndarray:
    angle = exact.swing(TILT, np.sqrt((1.0 + ratio) / (2.0 / 3.0 + ratio) * exact.GRAVITY), t)
    return np.array([np.sin(angle), -np.cos(angle)])


def parallelogram(ratio: float) -> Checked:
    scene, tip = mbd.Scene(gravity=(0.0, -exact.GRAVITY)), np.array([np.sin(TILT), -np.cos(TILT)])
    left = scene.add(mbd.RigidBody.rod((0, 0), tip, mass=1.0))
    right = scene.add(mbd.RigidBody.rod((1, 0), tip + (1, 0), mass=1.0))
    coupler = scene.add(mbd.RigidBody.rod(tip, tip + (1, 0), mass=ratio))
    for k, link in enumerate((left, right)):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(k, 0)))
        scene.add(mbd.Pin(link.at(0.5, 0), coupler.at(k - 0.5, 0)))
    result = mbd.simulate(scene, 1.5)
    return audited(result, share(result.position(left.at(0.5, 0))[-1], parallelogram_end(ratio, 1.5), 1.0))


double_end = cache(exact.double_pendulum)


def double_pendulum(ratio: float) -> Checked:
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    inner, outer = scene.add(mbd.Particle(1.0, ALONG)), scene.add(mbd.Particle(ratio, 2.0 * ALONG))
    scene.add(mbd.Distance(inner.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Distance(outer.at(), inner.at()))
    result = mbd.simulate(scene, 1.0)
    return audited(result, share(result.position(outer.at())[-1], double_end(ratio, TILT, 1.0), 2.0))


def _pendulum(given: machines.Cable, t_end: float, rtol: float = 1e-6, solver: Any = None, **options: Any) -> tuple[mbd.Result, np.ndarray]:
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    rod = scene.add(mbd.AncfCable(**{**given._asdict(), **options}, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    result = mbd.simulate(scene, t_end, rtol=rtol, solver=solver)
    return result, result.position(rod.end)[-1]


FALL = 0.5


@cache
def pendulum_end(factor: float) -> np.ndarray:
    """Free fall where no wave has come half way along the rod; a rigid rod where it is as good as one; else the mesh at a tight rtol, 7 stages."""
    if np.sqrt(machines.SOFT * factor / 5540.0) * FALL < 0.3:
        return np.array([1.2, -0.5 * exact.GRAVITY * FALL**2])
    if factor >= 1e9:
        return exact.flat(FALL)
    return _pendulum(machines.pendulum_cable(machines.SOFT * factor), FALL, 1e-10 if factor <= 10.0 else 1e-8, mbd.Radau(stages=7))[1]


def stiffness(factor: float) -> Checked:
    result, end = _pendulum(machines.pendulum_cable(machines.SOFT * factor), FALL)
    return audited(result, share(end, pendulum_end(factor), 1.2))


# A cantilever of steel, 1 m, square: free vibration in its first mode, amplitude 1 mm, for 1.3 periods.
BETA = 1.875104068711961
VIBRATING, BENT = 32, 64
"""Elements: fewer lock, as their axial strain, stiff by the square of the slenderness, cannot be zero all along a bent element."""


def square(slenderness: float, elements: int) -> machines.Cable:
    h = 1.0 / slenderness
    return machines.Cable((0.0, 0.0), (1.0, 0.0), elements, machines.STEEL, h * h, h**4 / 12.0, 7800.0)


def first_mode(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Deflection and slope of a clamped beam's first mode, 1 at its end."""
    c = (np.cosh(BETA) + np.cos(BETA)) / (np.sinh(BETA) + np.sin(BETA))
    shape = np.cosh(BETA * x) - np.cos(BETA * x) - c * (np.sinh(BETA * x) - np.sin(BETA * x))
    slope = BETA * (np.sinh(BETA * x) + np.sin(BETA * x) - c * (np.cosh(BETA * x) - np.cos(BETA * x)))
    end = np.cosh(BETA) - np.cos(BETA) - c * (np.sinh(BETA) - np.sin(BETA))
    return shape / end, slope / end


def vibration(slenderness: float) -> tuple[float, float, float]:
    """Frequency [rad/s], time of 1.3 periods [s], deflection then of the end [m]."""
    frequency = BETA**2 * np.sqrt(machines.STEEL / 12.0 / 7800.0) / slenderness
    return frequency, 1.3 * 2.0 * np.pi / frequency, 1e-3 * np.sin(1.3 * 2.0 * np.pi)


def slenderness(value: float) -> Checked:
    frequency, t, wanted = vibration(value)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable(**square(value, VIBRATING)._asdict(), name="beam"))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0), name="clamp"))
    q = scene.build().q0
    shape, slope = first_mode(np.linspace(0.0, 1.0, VIBRATING + 1))
    v = np.zeros((VIBRATING + 1, 4))
    v[:, 1], v[:, 3] = 1e-3 * frequency * shape, 1e-3 * frequency * slope
    result = mbd.simulate(scene, t, start=mbd.State(q, v.ravel()))
    return audited(result, abs(result.position(beam.end)[-1, 1] - wanted) / 1e-3)


# Statics: a half circle by an end moment.
def half_circle(value: float) -> float:
    given = square(value, BENT)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable(**given._asdict(), name="beam"))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(0, 0), name="clamp"))
    scene.add(mbd.Torque(beam.end, np.pi * given.E * given.I))
    found = mbd.equilibrium(scene)
    return share(found.position(beam.end), (0.0, 2.0 / np.pi), 1.0)


# A particle of 1 kg between a spring and damper and nothing, 10 rad/s.
def damper(ratio: float) -> Checked:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    bob = scene.add(mbd.Particle(1.0, (1.5, 0.0), name="bob"))
    scene.add(mbd.Spring(bob.at(), scene.ground.at(0, 0), stiffness=100.0, damping=20.0 * ratio, length=1.0, name="damper"))
    result = mbd.simulate(scene, 1.0)
    return audited(result, abs(result.position(bob.at())[-1, 0] - 1.0 - 0.5 * exact.damped(ratio, 10.0, 1.0)) / 0.5)


# The pendulum of steel with internal friction: the relaxation time times the lowest free frequency over 2 is about its damping ratio.
def kelvin_voigt(time: float) -> Checked:
    result, end = _pendulum(machines.pendulum_cable(100.0 * machines.STEEL), FALL, damping=time)
    return audited(result, share(end, exact.flat(FALL), 1.2))


def fractions(ratio: float, elements: int = 12) -> np.ndarray:
    sizes = ratio ** (np.arange(elements) / (elements - 1.0))
    return np.concatenate(([0.0], np.cumsum(sizes) / np.sum(sizes)))


def graded_run(ratio: float) -> tuple[mbd.Result, float]:
    given = machines.pendulum_cable(100.0 * machines.STEEL)._asdict()
    nodes = 1.2 * np.stack((fractions(ratio), np.zeros(13)), axis=1)
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    section = {name: given[name] for name in ("E", "A", "I", "rho")}
    rod = scene.add(mbd.AncfCable(nodes=nodes, tangents=np.tile((1.0, 0.0), (13, 1)), **section, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    result = mbd.simulate(scene, FALL)
    return result, share(result.position(rod.end)[-1], exact.flat(FALL), 1.2)


def graded(ratio: float) -> Checked:
    return audited(*graded_run(ratio))


FAMILIES = (
    Family(
        "mass ratio, loop", "mass of a parallelogram's coupler over a link's", "pendulum of the same period, elliptic functions",
        powers(-18, 18, 3), 1.0, 1e-3, parallelogram, quick=(1e-9, 1.0, 1e9), wanted=powers(-18, 18, 3)),
    Family(
        "mass ratio, chain", "outer over inner mass of a double pendulum", "angles integrated by SciPy; above 1e5 one pendulum",
        powers(-18, 18, 3), 1.0, 1e-3, double_pendulum, quick=(1e-9, 1.0, 1e6), wanted=powers(-18, 15, 3)),
    Family(
        "stiffness", "E over that of the soft pendulum (0.7 MPa)", "free fall (soft), rigid rod (stiff), tight rtol between; audit",
        powers(-8, 12, 2), 1.0, 1e-2, stiffness, quick=(1e-6, 1.0), wanted=powers(-6, 6, 2)),
    Family(
        "slenderness, vibration", "length over height of a cantilever in its first mode", "Euler-Bernoulli beam",
        powers(1, 9), 1e2, 1e-2, slenderness, quick=(10.0, 1e6), wanted=powers(1, 6)),
    Family(
        "slenderness, statics", "length over height of a beam bent to a half circle", "circle",
        powers(1, 9), 1e2, 1e-3, half_circle, quick=(10.0, 1e5), wanted=powers(1, 5)),
    Family(
        "damping", "ratio of a damper to the critical one", "closed form",
        (0.0, *powers(-3, 12, 3)), 1.0, 1e-3, damper, quick=(0.0, 1.0, 1e6), wanted=(0.0, *powers(-3, 6, 3))),
    Family(
        "internal damping", "relaxation time [s] of a stiff pendulum's material", "rigid rod",
        (0.0, *powers(-9, 9, 3)), 1e-3, 1e-3, kelvin_voigt, quick=(1.0,), wanted=(0.0, *powers(-9, 0, 3)),
        note="the work of a damper is known as well as the rates it damps: where it all but forbids them, to 0.3 % at this tolerance, as the audit "
        "shows; positions are right"),
    Family(
        "element lengths", "longest over shortest of 12 elements of a stiff pendulum", "rigid rod",
        powers(0, 12), 1.0, 1e-3, graded, quick=(1.0, 1e4), wanted=powers(0, 7)),
)  # fmt: skip
