"""The benchmark scenes in mbd, and what is compared: the position of one point at the end of the run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import mbd

from . import machines

Array = np.ndarray


@dataclass(frozen=True)
class Case:
    """A scene of the benchmark.

    build     the scene and the marker whose position at t_end [s] is compared
    scale     errors are given as shares of this length [m]
    beam      a stiff scene: no explicit method, sparse solver in Exudyn; each program is compared with the exact solution of its own mesh
    steps     of the coarsest run with fixed steps; the others take 2, 4, ... times as many
    newton    Exudyn's (relative, absolute) Newton tolerances, tight and loose
    chain     number of links of a chain, 0 for others
    chaotic   errors grow so fast that none is promised for a tolerance
    patience  times the budget that a run may take
    """

    name: str
    build: Callable[[], tuple[mbd.Scene, Any]]
    t_end: float
    peer: str
    arguments: tuple[Any, ...] = ()
    scale: float = 1.0
    beam: bool = False
    steps: int = 50
    newton: tuple[tuple[float, float], ...] = ((1e-8, 1e-10), (1e-5, 1e-6))
    chain: int = 0
    sparse: bool = False
    chaotic: bool = False
    patience: float = 1.0

    @property
    def key(self) -> str:
        return self.name.replace(" ", "_").replace("-", "_")

    def reference(self, program: str) -> Array:
        """Position [d] [m] to compare with; of the program's own mesh where meshes differ."""
        entry = machines.data("references")[self.name]
        return np.array(entry.get(program, entry.get("value")), dtype=float)

    def error(self, program: str, value: Array) -> float:
        """Distance of an output from the reference over the scale, not below what the reference is known to."""
        return max(float(np.linalg.norm(value - self.reference(program))) / self.scale, self.known(program))

    def known(self, program: str) -> float:
        """What the reference is known to, over the scale."""
        entry = machines.data("references")[self.name]
        return float(entry.get(f"uncertainty of {program}", entry.get("uncertainty", 0.0))) / self.scale


def pendulum(E: float, elements: int = 30) -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, -machines.GRAVITY))
    rod = scene.add(mbd.AncfCable(**machines.pendulum_cable(E, elements)._asdict(), name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    return scene, rod.end


def spaghetti() -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**machines.SPAGHETTI._asdict(), name="rod"))
    force = mbd.piecewise(lambda t: (machines.spaghetti_force(t), 0.0), at=[machines.PULSE])
    scene.add(mbd.Force(rod.start, force))
    scene.add(mbd.Torque(rod.start, mbd.piecewise(machines.spaghetti_moment, at=[machines.PULSE])))
    return scene, rod.end


def spinup() -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(mbd.AncfCable(**machines.SPINUP._asdict(), name="rod"))
    turning = mbd.Motion(machines.hub_angle, rate=machines.hub_speed, acceleration=machines.hub_acceleration)
    scene.add(mbd.Prescribed(rod.start, (0.0, 0.0), angle=turning))
    return scene, rod.end


def slider_crank() -> tuple[mbd.Scene, Any]:
    (pin, end), scene = machines.slider_crank_points(), mbd.Scene(gravity=(0.0, -machines.GRAVITY))
    crank = scene.add(mbd.RigidBody.rod((0, 0), pin, mass=machines.CRANK_MASS))
    rod = scene.add(mbd.RigidBody.rod(pin, end, mass=machines.ROD_MASS))
    piston = scene.add(mbd.Particle(machines.PISTON, end))
    scene.add(mbd.Pin(crank.at(-0.5 * machines.CRANK, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(rod.at(-0.5 * machines.ROD, 0), crank.at(0.5 * machines.CRANK, 0)))
    scene.add(mbd.Pin(piston.at(), rod.at(0.5 * machines.ROD, 0)))
    scene.add(mbd.PointOnLine(piston.at(), scene.ground.at(0, 0), axis=(1.0, 0.0)))
    scene.add(mbd.Torque(crank.at(0, 0), machines.CRANK_TORQUE))
    return scene, crank.at(0.5 * machines.CRANK, 0)


def flexible_crank() -> tuple[mbd.Scene, Any]:
    """The output is the middle of the rod."""
    scene, arm = mbd.Scene(gravity=(0.0, 0.0)), 0.5 * machines.FLEXIBLE_CRANK
    crank = scene.add(mbd.RigidBody(mass=machines.FLEXIBLE_CRANK_MASS, inertia=machines.FLEXIBLE_CRANK_INERTIA, position=(arm, 0.0)))
    rod = scene.add(mbd.AncfCable(**machines.FLEXIBLE_ROD._asdict(), name="rod"))
    piston = scene.add(mbd.Particle(machines.FLEXIBLE_PISTON, machines.FLEXIBLE_ROD.end))
    scene.add(mbd.Pin(crank.at(-arm, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(rod.start, crank.at(arm, 0)))
    scene.add(mbd.Pin(piston.at(), rod.end))
    scene.add(mbd.PointOnLine(piston.at(), scene.ground.at(0, 0), axis=(1.0, 0.0)))
    scene.add(mbd.Torque(crank.at(0, 0), machines.FLEXIBLE_TORQUE))
    return scene, rod.at(0.5)


def four_bar(windows: int) -> tuple[mbd.Scene, Any]:
    """IFToMM A02: all bars are collinear twice in each turn, where the mechanism has N + 1 freedoms for an instant."""
    scene = mbd.Scene(gravity=(0.0, -machines.GRAVITY))
    rod = mbd.RigidBody.rod
    links = [scene.add(rod((k, 0), (k, 1), mass=1.0, velocity=(0.5, 0.0), angular_velocity=-1.0)) for k in range(windows + 1)]
    couplers = [scene.add(rod((k, 1), (k + 1, 1), mass=1.0, velocity=(1.0, 0.0))) for k in range(windows)]
    for k, link in enumerate(links):
        scene.add(mbd.Pin(link.at(-0.5, 0), scene.ground.at(k, 0)))
    for k, coupler in enumerate(couplers):
        scene.add(mbd.Pin(coupler.at(-0.5, 0), links[k].at(0.5, 0)))
        scene.add(mbd.Pin(coupler.at(0.5, 0), links[k + 1].at(0.5, 0)))
    return scene, links[0].at(0.5, 0)


def squeezer() -> tuple[mbd.Scene, Any]:
    p = machines.squeezer_numbers()
    points, scene = machines.squeezer_points(p), mbd.Scene(gravity=(0.0, 0.0))
    bodies = [
        scene.add(mbd.RigidBody(mass=m, inertia=inertia, position=position, angle=angle))
        for m, inertia, (position, angle) in zip(p["m"], p["I"], machines.squeezer_poses(p))
    ]
    bodies.append(scene.ground)
    for (a, one), (b, other) in machines.SQUEEZER_PINS:
        scene.add(mbd.Pin(bodies[a].at(*points[a][one]), bodies[b].at(*points[b][other])))
    ends = [bodies[a].at(*points[a][name]) for a, name in machines.SQUEEZER_SPRING]
    scene.add(mbd.Spring(ends[0], ends[1], stiffness=p["spring_c0"], length=p["spring_l0"]))
    scene.add(mbd.Torque(bodies[0].at(0, 0), p["motor_torque"]))
    return scene, bodies[0].at(*points[0]["F"])


def chain(links: int) -> tuple[mbd.Scene, Any]:
    scene, a = mbd.Scene(gravity=(0.0, -machines.GRAVITY)), machines.LINK
    before = scene.ground.at(0, 0)
    for k in range(links):
        body = scene.add(mbd.RigidBody.rod((k * a, 0), ((k + 1) * a, 0), mass=1.0))
        scene.add(mbd.Pin(body.at(-0.5 * a, 0), before))
        before = body.at(0.5 * a, 0)
    return scene, before


def heavy_top() -> tuple[mbd.Scene, Any]:
    spin, centre = np.array(machines.TOP_SPIN), np.array(machines.TOP_CENTRE)
    scene = mbd.Scene(gravity=(0.0, 0.0, -machines.GRAVITY))
    top = scene.add(mbd.RigidBody(
        mass=machines.TOP_MASS, inertia=machines.TOP_INERTIA, position=centre, velocity=np.cross(spin, centre), angular_velocity=spin))  # fmt: skip
    scene.add(mbd.Ball(top.at(*(-centre)), scene.ground.at(0, 0, 0)))
    return scene, top.at(0, 0, 0)


STEEL_NEWTON = ((1e-6, 1e-5), (1e-5, 1e-3))  # with Exudyn's default tolerances the steel pendulum and the spin-up fail
VIBRATION_NEWTON = ((1e-8, 1e-10), (1e-6, 1e-5))
BEAM: dict[str, Any] = {"beam": True, "sparse": True}

CASES = [
    Case("soft pendulum", lambda: pendulum(machines.SOFT), 1.1, "pendulum", (machines.SOFT,), steps=125, **BEAM),
    Case("steel pendulum", lambda: pendulum(machines.STEEL), 0.5, "pendulum", (machines.STEEL,), steps=60, newton=STEEL_NEWTON, **BEAM),
    Case("four-bar 1", lambda: four_bar(1), 10.0, "four_bar", (1,), steps=400),
    Case("four-bar 2", lambda: four_bar(2), 10.0, "four_bar", (2,), steps=400),
    Case("four-bar 40", lambda: four_bar(40), 10.0, "four_bar", (40,), steps=400, sparse=True),
    Case("squeezer", squeezer, 0.03, "squeezer", scale=0.007, steps=300),
    Case("slider-crank", slider_crank, 1.0, "slider_crank", steps=50),
    Case("flexible slider-crank", flexible_crank, 0.1, "flexible_crank", scale=0.3, newton=VIBRATION_NEWTON, **BEAM),
    Case("chain 10", lambda: chain(10), 1.0, "chain", (10,), steps=100, chain=10),
    Case("chain 100", lambda: chain(100), 1.0, "chain", (100,), scale=10.0, steps=200, chain=100, sparse=True),
    Case("chain 1000", lambda: chain(1000), 1.0, "chain", (1000,), scale=100.0, steps=200, chain=1000, sparse=True, patience=4.0),
    Case("spaghetti", spaghetti, 5.0, "spaghetti", scale=10.0, steps=100, **BEAM),
    Case("spin-up", spinup, 20.0, "spinup", scale=10.0, steps=500, newton=STEEL_NEWTON, **BEAM),
    Case("heavy top", heavy_top, 2.0, "heavy_top", steps=400),
]
BY_NAME = {case.name: case for case in CASES}
