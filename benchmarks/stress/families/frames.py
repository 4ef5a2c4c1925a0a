"""Units, offsets of the origin and of the clock, spins, and spans of many periods."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import mbd

from ... import machines
from .. import exact
from ..common import audited, powers, share
from ..family import Checked, Family

# Units: a flexible slider-crank with a spring and damper on its slider; numbers are those of SI times the factors.
UNITS_END = 0.1


def flexible_crank(a: float, b: float, c: float) -> tuple[mbd.Scene, Any]:
    """The scene and the crank's pin, with lengths times a, masses times b, times times c."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY * a / c**2))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (0.0, 0.15 * a), mass=0.36 * b, angular_velocity=-20.0 / c, velocity=(1.5 * a / c, 0.0)))
    end = (np.sqrt(0.09 - 0.0225) * a, 0.0)
    area = 4e-6
    rod = scene.add(mbd.AncfCable(
        (0.0, 0.15 * a), end, n_elements=4, E=2e9 * b / (a * c**2), A=area * a**2, I=area**2 / 12.0 * a**4, rho=7870.0 * b / a**3, damping=1e-3 * c))
    block = scene.add(mbd.Particle(0.075 * b, end))
    scene.add(mbd.Pin(crank.at(-0.075 * a, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(rod.start, crank.at(0.075 * a, 0)))
    scene.add(mbd.Pin(block.at(), rod.end))
    scene.add(mbd.PointOnLine(block.at(), scene.ground.at(0, 0), axis=(1.0, 0.0)))
    scene.add(mbd.Spring(block.at(), scene.ground.at(0.6 * a, 0.0), stiffness=50.0 * b / c**2, damping=1.0 * b / c))
    return scene, crank.at(0.075 * a, 0)


def _in_units(a: float = 1.0, b: float = 1.0, c: float = 1.0) -> tuple[mbd.Result, np.ndarray]:
    scene, pin = flexible_crank(a, b, c)
    result = mbd.simulate(scene, UNITS_END * c, rtol=1e-7)
    return result, np.array(result.position(pin)[-1]) / a


@cache
def _in_si() -> np.ndarray:
    return _in_units()[1]


def _scaled(*factors: float) -> float:
    return share(_in_units(*factors)[1], _in_si(), 0.15)


def length_unit(factor: float) -> float:
    return _scaled(factor)


def mass_unit(factor: float) -> float:
    return _scaled(1.0, factor)


def time_unit(factor: float) -> float:
    return _scaled(1.0, 1.0, factor)


# Offsets: results less the offset, in units of the tolerance and 100 roundings of the offset.
OFFSET_RTOL = 1e-8


def _rigid_at(offset: float) -> tuple[mbd.Result, np.ndarray]:
    scene, origin = mbd.Scene(gravity=(0.0, -exact.GRAVITY)), np.array((offset, -offset))
    rod = scene.add(mbd.RigidBody.rod(origin, origin + (1.0, 0.0), mass=1.0))
    bob = scene.add(mbd.Particle(1.0, origin + (1.0, 0.75)))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(*origin)))
    scene.add(mbd.Distance(bob.at(), rod.at(0.5, 0)))
    result = mbd.simulate(scene, 1.0, rtol=OFFSET_RTOL)
    return result, np.array(result.position(bob.at())[-1]) - origin


def _beam_at(offset: float) -> tuple[mbd.Result, np.ndarray]:
    scene, origin = mbd.Scene(gravity=(0.0, -exact.GRAVITY)), np.array((offset, -offset))
    given = machines.pendulum_cable(machines.SOFT, 10)._asdict()
    rod = scene.add(mbd.AncfCable(**{**given, "start": origin, "end": origin + (1.2, 0.0)}, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(*origin)))
    result = mbd.simulate(scene, 0.5, rtol=OFFSET_RTOL)
    return result, np.array(result.position(rod.end)[-1]) - origin


def _offset(run: Any, offset: float) -> float:
    allowed = 30.0 * OFFSET_RTOL + 100.0 * np.finfo(float).eps * offset
    return share(run(offset)[1], _at_home(run), 1.0) / allowed


@cache
def _at_home(run: Any) -> np.ndarray:
    return run(0.0)[1]


def rigid_offset(offset: float) -> float:
    return _offset(_rigid_at, offset)


def beam_offset(offset: float) -> float:
    return _offset(_beam_at, offset)


def clock(start: float) -> Checked:
    """A pendulum whose run starts at a late time; the clock itself is exact to its rounding only."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1.2, 0), mass=1.0, name="rod"))
    scene.add(mbd.Pin(rod.at(-0.6, 0), scene.ground.at(0, 0), name="pivot"))
    system = scene.build()
    result = mbd.simulate(scene, start + 1.0, start=mbd.State(system.q0, system.v0, start))
    return audited(result, share(result.position(rod.at(0.6, 0))[-1], exact.flat(1.0), 1.2))


def periods(count: float) -> Checked:
    """A rod released 60 degrees from hanging, at rtol 1e-10."""
    tilt = np.pi / 3.0
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (np.sin(tilt), -np.cos(tilt)), mass=1.0, name="rod"))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    result = mbd.simulate(scene, long_end(count)[0], rtol=1e-10)
    return audited(result, share(result.position(rod.at(0.5, 0))[-1], long_end(count)[1], 1.0))


def long_end(count: float) -> tuple[float, np.ndarray]:
    """The time [s] after so many periods and a third, and the end of the rod then [2]."""
    tilt, frequency = np.pi / 3.0, np.sqrt(1.5 * exact.GRAVITY)
    period = exact.period(tilt, frequency)
    angle = exact.swing(tilt, frequency, period / 3.0)
    return (count + 1.0 / 3.0) * period, np.array([np.sin(angle), -np.cos(angle)])


# A top in regular precession, 60 degrees from the vertical: 1 kg, 0.1 m from its tip; moments about its mass centre.
ARM, ACROSS, ALONG, LEAN, SPIN_END = 0.1, 0.01, 0.004, np.pi / 3.0, 0.05


def precession(spin: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a top whose angular velocity along its axis is ``spin``: angular velocity [3], rotation [3, 3] at the start and at SPIN_END."""
    about = ACROSS + ARM**2
    moment = ALONG * spin
    rate = 2.0 * exact.GRAVITY * ARM / (moment + np.sqrt(moment**2 - 4.0 * about * np.cos(LEAN) * exact.GRAVITY * ARM))
    c, s = np.cos(LEAN), np.sin(LEAN)
    start = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    own = spin - rate * c
    end = _about_z(rate * SPIN_END) @ start @ _about_z(own * SPIN_END)
    return own * start[:, 2] + (0.0, 0.0, rate), start, end


def _about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def top(spin: float) -> Checked:
    omega, start, end = precession(spin)
    scene, centre = mbd.Scene(gravity=(0.0, 0.0, -exact.GRAVITY)), ARM * start[:, 2]
    motion = {"velocity": np.cross(omega, centre), "angular_velocity": omega}
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=(ACROSS, ACROSS, ALONG), position=centre, rotation=start, **motion, name="top"))
    scene.add(mbd.Ball(body.at(0, 0, -ARM), scene.ground.at(0, 0, 0), name="tip"))
    result = mbd.simulate(scene, SPIN_END, rtol=1e-9)
    return audited(result, share(result.rotation(body)[-1], end, 1.0))


# A steel rod of 0.1 m turns about its end, stretched by its own inertia: r = sin(k s) / (k cos(k L)), k = omega sqrt(rho / E), for two turns.
TURNS = 2.3
BLADE = machines.Cable((0.0, 0.0), (0.1, 0.0), 8, machines.STEEL, 1e-4, 1e-8 / 12.0, 7800.0)


def stretched(speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Radius and slope at the nodes."""
    k, s = speed * np.sqrt(BLADE.rho / BLADE.E), np.linspace(0.0, 0.1, BLADE.n_elements + 1)
    return np.sin(k * s) / (k * np.cos(0.1 * k)), np.cos(k * s) / np.cos(0.1 * k)


def blade(speed: float) -> Checked:
    radius, slope = stretched(speed)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**BLADE._asdict(), name="blade"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="hub"))
    zero = np.zeros_like(radius)
    q = np.stack((radius, zero, slope, zero), axis=1).ravel()
    v = speed * np.stack((zero, radius, zero, slope), axis=1).ravel()
    result = mbd.simulate(scene, TURNS * 2.0 * np.pi / speed, start=mbd.State(q, v))
    return audited(result, share(result.position(rod.end)[-1], blade_end(speed), radius[-1]))


def blade_end(speed: float) -> np.ndarray:
    angle = TURNS * 2.0 * np.pi
    return stretched(speed)[0][-1] * np.array([np.cos(angle), np.sin(angle)])


UNITS = "for Exudyn too any difference above 1e-9 counts, which may be far from wrong"
SAME = "the same run in metres, kilograms and seconds"
UNIT = powers(-15, 15, 5)
SHIFT = "the same run at the origin; in units of 30 rtol and 100 roundings of the offset"
FAMILIES = (
    Family("unit of length", "numbers over those in metres", SAME, UNIT, 1.0, 1e-9, length_unit, quick=(1e5,), wanted=powers(-5, 5, 5), note=UNITS),
    Family("unit of mass", "numbers over those in kilograms", SAME, UNIT, 1.0, 1e-9, mass_unit, wanted=powers(-5, 5, 5), note=UNITS),
    Family("unit of time", "numbers over those in seconds", SAME, UNIT, 1.0, 1e-9, time_unit, wanted=powers(-5, 5, 5), note=UNITS),
    Family("offset, bodies", "offset of all coordinates [m]", SHIFT, (0.0, *powers(0, 12, 3)), 0.0, 1.0, rigid_offset, quick=(1e6,),
           wanted=powers(0, 6, 3)),
    Family("offset, beam", "offset of all coordinates [m]", SHIFT, (0.0, *powers(0, 9, 3)), 0.0, 1.0, beam_offset, quick=(1e6,),
           wanted=powers(0, 6, 3)),
    Family("clock", "time at the start of a run of 1 s", "elliptic functions", (0.0, *powers(3, 18, 3)), 0.0, 1e-3, clock, quick=(1e6,),
           wanted=powers(3, 12, 3)),
    Family("time span", "periods of a rigid pendulum", "elliptic functions", powers(0, 4), 1.0, 1e-3, periods, quick=(10.0,), wanted=powers(0, 4),
           patience=600.0, note="rtol 1e-10 at every level: the phase drifts with the square of the span"),
    Family("spin of a top", "angular velocity [rad/s], 0.05 s, rtol 1e-9", "regular precession", (50.0, *powers(2, 5)), 100.0, 1e-3, top,
           quick=(1e4,),
           wanted=powers(2, 4)),
    Family("spin of a beam", "angular velocity [rad/s] of a steel rod of 0.1 m", "stretched rod, closed form",
           (*powers(0, 4), 3e4, 5e4, 7e4, 8e4), 1e2, 1e-3, blade, quick=(1e4,), wanted=powers(0, 4)),
)  # fmt: skip
