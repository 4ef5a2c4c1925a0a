"""Loads that snap, wrinkle, strike and drop."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import mbd

from ... import machines
from .. import exact
from ..common import audited, powers, share
from ..family import Checked, Family

# A flat truss: a particle of 1 kg between two springs of 1e3 N/m, 0.1 m above its supports at x = -1 and 1; a force down from t = 0 on.
RISE, STIFFNESS, SNAP_END = 0.1, 1e3, 1.0
REST = float(np.hypot(1.0, RISE))


def _pull(y: float) -> float:
    """The springs' force [N] up on the particle at height y."""
    length = np.hypot(1.0, y)
    return float(2.0 * STIFFNESS * (REST - length) * y / length)


CRITICAL = max(_pull(y) for y in np.linspace(0.0, RISE, 20001))


@cache
def truss_height(factor: float) -> float:
    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return np.array([x[1], _pull(x[0]) - factor * CRITICAL])

    return float(exact.integrated(rate, np.array([RISE, 0.0]), SNAP_END)[0])


def truss_scale(factor: float) -> float:
    return max(RISE, abs(truss_height(factor)))


def truss(factor: float) -> Checked:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    crown = scene.add(mbd.Particle(1.0, (0.0, RISE), name="crown"))
    for x in (-1.0, 1.0):
        scene.add(mbd.Spring(crown.at(), scene.ground.at(x, 0.0), stiffness=STIFFNESS))
    scene.add(mbd.Force(crown.at(), (0.0, -factor * CRITICAL)))
    result = mbd.simulate(scene, SNAP_END)
    return audited(result, abs(result.position(crown.at())[-1, 1] - truss_height(factor)) / truss_scale(factor))


def arch(factor: float) -> Checked:
    """A shallow arch of steel strip under a load at its crown, switched on at once: the run against one at rtol 1e-9, and the audit."""
    result, crown = _arch(factor, 1e-6)
    return audited(result, share(crown, _arch(factor, 1e-9)[1], 0.05))


def _arch(factor: float, rtol: float) -> tuple[mbd.Result, np.ndarray]:
    x = np.linspace(-0.5, 0.5, 7)
    nodes = np.stack((x, 0.05 * np.cos(np.pi * x)), axis=1)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    strip = scene.add(mbd.AncfCable(nodes=nodes, E=2.07e11, A=2e-5, I=2e-5 * 1e-6 / 12.0, rho=7800.0, damping=1e-4, name="strip"))
    scene.add(mbd.Pin(strip.start, scene.ground.at(*nodes[0])))
    scene.add(mbd.Pin(strip.end, scene.ground.at(*nodes[-1])))
    scene.add(mbd.Force(strip.at(0.5), (0.0, -20.0 * factor)))
    result = mbd.simulate(scene, 0.01, rtol=rtol)
    return result, np.array(result.position(strip.at(0.5))[-1])


# A pinned strut of 1 m in steel, slenderness 1000, loaded at once by a multiple of Euler's load and pushed sideways with 1e-6 m/s.
STRUT = machines.Cable((0.0, 0.0), (1.0, 0.0), 16, machines.STEEL, 1e-6, 1e-12 / 12.0, 7800.0)
EULER, PUSH = np.pi**2 * STRUT.E * STRUT.I, 1e-6
GROWTH = 5.0
"""Time simulated, in units of the rate of growth."""


def strut_rate(factor: float) -> float:
    """Growth (above 1) or frequency (below) of a half wave [1/s]."""
    return float(np.pi * np.sqrt(EULER * abs(factor - 1.0) / (STRUT.rho * STRUT.A)))


def strut_middle(factor: float) -> float:
    rate = strut_rate(factor)
    return float(PUSH * (np.sinh(GROWTH) if factor > 1.0 else np.sin(GROWTH)) / rate)


def strut_start(factor: float) -> tuple[np.ndarray, np.ndarray]:
    """q, v [17, 4]: compressed by the load, pushed in a half wave."""
    x = np.linspace(0.0, 1.0, 17)
    short, zero = 1.0 - factor * EULER / (STRUT.E * STRUT.A), np.zeros(17)
    q = np.stack((short * x, zero, np.full(17, short), zero), axis=1)
    v = PUSH * np.stack((zero, np.sin(np.pi * x), zero, np.pi * np.cos(np.pi * x)), axis=1)
    return q, v


def strut(factor: float) -> float:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**STRUT._asdict(), name="strut"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="foot"))
    scene.add(mbd.PointOnLine(rod.end, scene.ground.at(0, 0), axis=(1.0, 0.0), name="guide"))
    scene.add(mbd.Force(rod.end, (-factor * EULER, 0.0), name="load"))
    q, v = (x.ravel() for x in strut_start(factor))
    result = mbd.simulate(scene, GROWTH / strut_rate(factor), rtol=1e-10, start=mbd.State(q, v))
    middle, wanted = result.position(rod.at(0.5))[-1, 1], strut_middle(factor)
    return abs(middle - wanted) / abs(wanted)


def wrinkles(factor: float) -> Checked:
    """The same strut far above Euler's load, where any disturbance grows: it folds, and only the audit can tell."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**STRUT._asdict(), damping=1e-4, name="strut"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="foot"))
    scene.add(mbd.PointOnLine(rod.end, scene.ground.at(0, 0), axis=(1.0, 0.0), name="guide"))
    scene.add(mbd.Force(rod.end, (-factor * EULER, 0.0), name="load"))
    q, v = (x.ravel() for x in strut_start(factor))
    return audited(mbd.simulate(scene, 8.0 / strut_rate(factor), start=mbd.State(q, 1e3 * v)))


# An impulse of 1 N s on a particle of 1 kg, tied to another by a spring of 100 N/m, from t = 0.5 s.
def pair_centre(width: float) -> float:
    """x of the mass centre at 1 s; on the clock near 0.5 s the width is a multiple of 1e-16 s."""
    real = (0.5 + width) - 0.5
    return 0.5 * real / width * (1.0 - 0.5 - 0.5 * width)


def _struck(load: Any) -> tuple[mbd.Result, float]:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    one, other = scene.add(mbd.Particle(1.0, (0.0, 0.0), name="one")), scene.add(mbd.Particle(1.0, (0.0, 1.0), name="other"))
    scene.add(mbd.Spring(one.at(), other.at(), stiffness=100.0))
    scene.add(mbd.Force(one.at(), load, name="blow"))
    result = mbd.simulate(scene, 1.0)
    return result, 0.5 * float(result.position(one.at())[-1, 0] + result.position(other.at())[-1, 0])


def _pulse(width: float) -> Any:
    return lambda t: (1.0 / width if 0.5 <= t < 0.5 + width else 0.0, 0.0)


def pulse(width: float) -> Checked:
    result, x = _struck(mbd.piecewise(_pulse(width), at=[0.5, 0.5 + width]))
    return audited(result, abs(x - pair_centre(width)) / 0.25)


def undeclared_pulse(width: float) -> Checked:
    result, x = _struck(_pulse(width))
    return audited(result, abs(x - pair_centre(width)) / 0.25)


def undeclared_jump(force: float) -> Checked:
    result, x = _struck(lambda t: (force if t >= 0.5 else 0.0, 0.0))
    wanted = 0.5 * force * 0.5 * 0.25
    return audited(result, abs(x - wanted) / max(abs(wanted), 1.0))


def blow_to_beam(width: float) -> Checked:
    """An impulse of 0.1 N s on the end of a free soft beam: its mass centre moves on as any body's does."""
    given = machines.pendulum_cable(machines.SOFT, 8)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**given._asdict(), name="rod"))
    blow = mbd.piecewise(lambda t: (0.0, 0.1 / width if 0.1 <= t < 0.1 + width else 0.0), at=[0.1, 0.1 + width])
    scene.add(mbd.Force(rod.end, blow, name="blow"))
    result = mbd.simulate(scene, 0.3)
    ends = result.q[-1].reshape(-1, 4)
    middle = np.mean(0.5 * (ends[1:, 1] + ends[:-1, 1]) + 0.15 / 12.0 * (ends[:-1, 3] - ends[1:, 3]))  # of cubic elements
    wanted = 0.1 / (given.rho * given.A * 1.2) * (0.2 - 0.5 * width)
    return audited(result, float(abs(middle - wanted)) / wanted)


FAMILIES = (
    Family("snap-through, truss", "load switched on at once over the static limit", "one equation, SciPy", powers(-3, 9), 1.0, 1e-3, truss,
           quick=(0.1, 1.0, 1e3), wanted=powers(-3, 6)),
    Family("snap-through, arch", "load switched on at once over 20 N", "itself at rtol 1e-9; audit", powers(-2, 4), 1.0, 1e-2, arch,
           wanted=powers(-2, 4)),
    Family("buckling", "load over Euler's", "growth of a half wave, linear theory", (0.1, 0.5, 0.9, 1.1, 2.0, 4.0, 10.0, 20.0, 50.0), 0.5,
           2e-2, strut,
           quick=(0.5, 2.0), wanted=(0.1, 0.5, 0.9, 1.1, 2.0, 4.0, 10.0, 20.0)),
    Family("wrinkling", "load over Euler's, far beyond buckling", "audit", (2.0, *powers(1, 5)), 2.0, 1e-2, wrinkles, wanted=(2.0, *powers(1, 3))),
    Family("pulse", "width [s] of a declared impulse of 1 N s", "momentum", powers(-15, -1, 2), 0.1, 1e-3, pulse, quick=(0.1, 1e-9),
           wanted=powers(-13, -1, 2)),
    Family("pulse on a beam", "width [s] of a declared impulse", "momentum", powers(-11, -1, 2), 0.1, 1e-3, blow_to_beam, quick=(1e-3,),
           wanted=powers(-9, -1, 2)),
    Family("jump, undeclared", "force [N] that a plain function switches on", "momentum", powers(-3, 12), 1.0, 1e-3, undeclared_jump, quick=(1.0,),
           wanted=powers(-3, 6)),
    Family("pulse, undeclared", "width [s] of an impulse in a plain function", "momentum", (1e-15, *powers(-13, -3, 2), 0.01, 0.1), 0.1, 1e-3,
           undeclared_pulse, quick=(1e-13, 1e-3), wanted=(*powers(-13, -3, 2), 0.01, 0.1),
           note="a run looks at 2048 times, and where the function compares its time with numbers; a smooth bump by a formula that is narrower than "
           "these are apart, and compares nothing, nobody can see: declare it with mbd.piecewise"),
)  # fmt: skip
