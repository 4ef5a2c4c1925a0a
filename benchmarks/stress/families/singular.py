"""Positions in which joints lose their grip, joints too many, joints that contradict each other, and bodies without mass."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import mbd

from .. import exact
from ..common import audited, powers, share
from ..family import Checked, Family

SPEED = 5.0


def aligned(angle: float) -> Checked:
    """A parallelogram turns without loads, from this angle to the line in which all bars lie, through it five times."""
    scene, tip = mbd.Scene(gravity=(0.0, 0.0)), np.array([np.cos(angle), np.sin(angle)])
    swing = SPEED * np.array([-tip[1], tip[0]])
    links = [
        scene.add(mbd.RigidBody.rod((2.0 * k, 0.0), tip + (2.0 * k, 0.0), mass=1.0, velocity=0.5 * swing, angular_velocity=SPEED, name=f"link {k}"))
        for k in (0, 1)
    ]
    coupler = scene.add(mbd.RigidBody.rod(tip, tip + (2.0, 0.0), mass=1.0, velocity=swing, name="coupler"))
    for k, link in enumerate(links):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(2.0 * k, 0.0), name=f"foot {k}"))
        scene.add(mbd.Pin(link.at(0.5, 0), coupler.at(2.0 * k - 1.0, 0), name=f"top {k}"))
    result = mbd.simulate(scene, 3.0)
    return audited(result, max(share(result.position(link.at(0.5, 0))[-1] - (2.0 * k, 0.0), aligned_end(angle), 1.0) for k, link in enumerate(links)))


def aligned_end(angle: float) -> np.ndarray:
    return np.array([np.cos(angle + 3.0 * SPEED), np.sin(angle + 3.0 * SPEED)])


# A crank of 1 m, 1 kg m^2 about its support, a rod of 1 + excess without mass, a block of 1 kg: turns freely from the dead centre.
CRANK_END = 2.0


def _transmission(angle: float, excess: float) -> float:
    """dx/d(angle) of the block. l^2 - sin^2 without cancellation: (l - 1)(l + 1) + cos^2."""
    s, c = np.sin(angle), np.cos(angle)
    return float(-s - s * c / np.sqrt(excess * (2.0 + excess) + c * c))


@cache
def crank_angle(excess: float) -> float:
    """After CRANK_END seconds: time is the integral of sqrt(inertia), energy being constant."""
    ends = [0.5 * np.pi * k for k in range(12)]

    def duration(a: float, b: float) -> float:
        at = quad(lambda x: np.sqrt(1.0 + _transmission(x, excess) ** 2), a, b, limit=400, epsabs=1e-13, epsrel=1e-12, points=None)
        return at[0] / SPEED

    times = np.cumsum([0.0, *(duration(a, b) for a, b in zip(ends, ends[1:]))])
    k = int(np.searchsorted(times, CRANK_END)) - 1
    return float(brentq(lambda x: times[k] + duration(ends[k], x) - CRANK_END, ends[k], ends[k + 1], xtol=1e-13))


def dead_centre(excess: float) -> Checked:
    scene, length = mbd.Scene(gravity=(0.0, 0.0)), 1.0 + excess
    crank = scene.add(mbd.RigidBody(mass=1.0, inertia=0.75, position=(0.5, 0.0), velocity=(0.0, 0.5 * SPEED), angular_velocity=SPEED, name="crank"))
    block = scene.add(mbd.Particle(1.0, (1.0 + length, 0.0), name="block"))
    scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0), name="bearing"))
    scene.add(mbd.Distance(block.at(), crank.at(0.5, 0), length=length, name="rod"))
    scene.add(mbd.PointOnLine(block.at(), scene.ground.at(0, 0), axis=(1.0, 0.0), name="guide"))
    result = mbd.simulate(scene, CRANK_END)
    angle = crank_angle(excess)
    return audited(result, share(result.position(crank.at(0.5, 0))[-1], (np.cos(angle), np.sin(angle)), 1.0))


def folded(angle: float) -> Checked:
    """Two particles on rods of 1 m, folded onto each other up to this angle, at rest under gravity."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    elbow = np.array([1.0, 0.0])
    inner = scene.add(mbd.Particle(1.0, elbow, name="elbow"))
    outer = scene.add(mbd.Particle(1.0, elbow - (np.cos(angle), np.sin(angle)), name="tip"))
    scene.add(mbd.Distance(inner.at(), scene.ground.at(0, 0), length=1.0, name="upper rod"))
    scene.add(mbd.Distance(outer.at(), inner.at(), length=1.0, name="lower rod"))
    result = mbd.simulate(scene, 0.8)
    return audited(result, share(result.position(outer.at())[-1], folded_end(angle), 2.0))


@cache
def folded_end(angle: float) -> np.ndarray:
    """Angles from hanging: the upper rod's 90 degrees, the lower one's 270 + angle."""

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        a, b, wa, wb = y
        s, c = np.sin(a - b), np.cos(a - b)
        top, low = -0.5 * wb * wb * s - exact.GRAVITY * np.sin(a), wa * wa * s - exact.GRAVITY * np.sin(b)
        turn = (top - 0.5 * c * low) / (1.0 - 0.5 * c * c)
        return np.array([wa, wb, turn, low - c * turn])

    a, b = exact.integrated(rate, np.array([0.5 * np.pi, 1.5 * np.pi - 0.0 + angle, 0.0, 0.0]), 0.8)[:2]
    return np.array([np.sin(a) + np.sin(b), -np.cos(a) - np.cos(b)])


def squeeze(t: float, chord: float) -> float:
    """From 1 to the chord within a second, at rest at both ends."""
    return 1.0 - (1.0 - chord) * t**3 * (10.0 - 15.0 * t + 6.0 * t * t)


def chord_frame(chord: float) -> Checked:
    """One element of 1998, pushed together along itself to this chord: the energy is known."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    section = {"E": 1e6, "A": 1e-4, "I": 1e-4, "rho": 1000.0}
    rod = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=1, **section, damping=0.05, elasticity="local_frame", name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="foot"))
    scene.add(mbd.Prescribed(rod.end, lambda t: (squeeze(t, chord), 0.0), name="press"))
    result = mbd.simulate(scene, 1.0)
    wanted = 50.0 * (1.0 - abs(chord)) ** 2
    return audited(result, abs(float(result.energy.elastic[-1]) - wanted) / 50.0)


def hinges(extra: float) -> Checked:
    """A door on so many more hinges than one, in line, in space."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY, 0.0))
    door = scene.add(mbd.RigidBody(mass=1.0, inertia=(0.04, 0.16, 0.12), position=(0.6, 0.0, 0.0), name="door"))
    for k in range(int(extra) + 1):
        scene.add(mbd.Pin(door.at(-0.6, 0.0, 0.1 * k), scene.ground.at(0.0, 0.0, 0.1 * k), axis=(0, 0, 1), name=f"hinge {k}"))
    result = mbd.simulate(scene, 1.0)
    return audited(result, share(result.position(door.at(0.6, 0, 0))[-1, :2], exact.flat(1.0), 1.2))


def conflict(gap: float) -> Checked:
    """Two rods between the same points, one longer by the gap."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    bob = scene.add(mbd.Particle(1.0, (1.0, 0.0), name="bob"))
    scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0), length=1.0, name="short rod"))
    scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0), length=1.0 + gap, name="long rod"))
    result = mbd.simulate(scene, 1.0)
    angle = exact.swing(0.5 * np.pi, np.sqrt(exact.GRAVITY), 1.0)
    return audited(result, share(result.position(bob.at())[-1], (np.sin(angle), -np.cos(angle)), 1.0))


def massless(mass: float) -> Checked:
    """The coupler of a parallelogram: joints alone tell where it is."""
    from .ratios import parallelogram

    return parallelogram(mass)


SMALL = (0.0, *powers(-16, -1, 3))
FAMILIES = (
    Family("aligned four-bar", "angle at the start from all bars in line [rad]", "uniform rotation", SMALL, 0.1, 1e-3, aligned, quick=(0.1,
           1e-7, 0.0),
           wanted=SMALL),
    Family("dead centre", "rod longer than the crank by [m]; turns from and through dead centres", "quadrature of the energy", powers(-10,
           1), 1.0, 1e-3,
           dead_centre, quick=(1.0, 1e-4), wanted=powers(-4, 1)),
    Family("folded double pendulum", "angle between its rods at the start [rad]", "angles integrated by SciPy", SMALL, 0.1, 1e-3, folded,
           quick=(0.0, 0.1), wanted=SMALL),
    Family("short chord", "chord [m] to which a local_frame element of 1 m is pushed together", "energy", (-0.5, -1e-2, 0.0, *powers(-12,
           -1, 3), 1e-1, 0.5), 0.5,
           1e-3, chord_frame, quick=(0.5, 1e-3), wanted=(*powers(-6, -1, 3), 0.5)),
    Family("redundant joints", "hinges of a door in space beyond one", "elliptic functions", (0.0, 1.0, 2.0, 10.0, 100.0, 300.0), 0.0, 1e-3, hinges,
           quick=(1.0, 10.0), wanted=(0.0, 1.0, 2.0, 10.0, 100.0)),
    Family("conflicting joints", "a second rod between the same points is longer by [m]", "elliptic functions", (0.0, *powers(-16, 0, 2)),
           0.0, 1e-3, conflict,
           quick=(0.0, 1e-14, 1e-4), note="a conflict that shows must be refused"),
    Family("massless body", "mass [kg] of a coupler between links of 1 kg", "elliptic functions", (0.0, 1e-300, 1e-100, 1e-30, 1e-16, 1e-8,
           1.0), 1.0, 1e-3,
           massless, quick=(0.0, 1e-30), wanted=(0.0, 1e-300, 1e-100, 1e-30, 1e-16, 1e-8, 1.0)),
)  # fmt: skip
