"""The cases on which ``mbd.verify`` is validated: scenes of the benchmark with more outputs, and some with solutions in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import ellipj, ellipk

import mbd

from . import machines, scenes

Array = np.ndarray
Exact = Callable[[Array], Array]

RTOLS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
BEAM_RTOLS = RTOLS[1:4]


@dataclass(frozen=True)
class Case:
    """A scene with its outputs, and for some of them the exact values [k, m] at times [k]; others are compared with runs far tighter.

    settings  (rtol, solver) of the verified runs
    """

    name: str
    build: Callable[[], tuple[mbd.Scene, dict[str, Any]]]
    t_end: float
    exact: dict[str, Exact] = field(default_factory=dict)
    rtols: tuple[float, ...] = RTOLS
    solvers: tuple[Any, ...] = (None,)
    elastic: bool = False


def simple_pendulum() -> tuple[mbd.Scene, dict[str, Any]]:
    """IFToMM A01: a particle on a massless rod, released at (-1, 0)."""
    scene = mbd.Scene()
    bob = scene.add(mbd.Particle(1.0, (-1, 0)))
    rod = scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0)))
    return scene, {"bob": bob.at(), "force": rod}


def pendulum_path(t: Array) -> Array:
    """sin(theta / 2) = k sn(K - w t), k = sin 45 deg: theta [rad] from hanging, clockwise at the start."""
    w = np.sqrt(9.81)
    sn = ellipj(ellipk(0.5) - w * np.asarray(t), 0.5)[0]
    theta = -2.0 * np.arcsin(np.sqrt(0.5) * sn)
    return np.stack((np.sin(theta), -np.cos(theta)), axis=-1)


def pendulum_force(t: Array) -> Array:
    """Of the ground on the bob: 3 m g cos(theta) towards the pivot, as the energy says."""
    place = pendulum_path(t)
    return 3.0 * 9.81 * place[:, 1:] * place


def turning_pendulum() -> tuple[mbd.Scene, dict[str, Any]]:
    """The pendulum of the IVP test set: unit mass, length and gravity, from (1, 0) upwards at unit speed."""
    scene = mbd.Scene(gravity=(0, -1))
    bob = scene.add(mbd.Particle(1.0, (1, 0), (0, 1)))
    scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0)))
    return scene, {"bob": bob.at(), "energy": lambda result: result.energy.total}


def free_fall() -> tuple[mbd.Scene, dict[str, Any]]:
    scene = mbd.Scene()
    stone = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0, 0), velocity=(3, 4), angular_velocity=5.0))
    return scene, {"place": stone.at(), "angle": stone}


def oscillator() -> tuple[mbd.Scene, dict[str, Any]]:
    """A damped mass on a spring along x: omega = 10 1/s, damping ratio 0.05."""
    scene = mbd.Scene(gravity=(0, 0))
    mass = scene.add(mbd.Particle(1.0, (1.2, 0)))
    scene.add(mbd.Spring(mass.at(), scene.ground.at(0, 0), stiffness=100.0, damping=1.0, length=1.0))
    return scene, {"mass": mass.at()}


def oscillation(t: Array) -> Array:
    wd = np.sqrt(100.0 - 0.25)
    x = 1.0 + 0.2 * np.exp(-0.5 * t) * (np.cos(wd * t) + 0.5 / wd * np.sin(wd * t))
    return np.stack((x, np.zeros_like(t)), axis=-1)


TOP_I, TOP_I3, TOP_W = 2.0, 1.0, np.array((1.0, 0.0, 8.0))


def free_top() -> tuple[mbd.Scene, dict[str, Any]]:
    scene = mbd.Scene(gravity=(0, 0, 0))
    top = scene.add(mbd.RigidBody(mass=1.0, inertia=(TOP_I, TOP_I, TOP_I3), position=(0, 0, 0), angular_velocity=TOP_W))
    return scene, {"rotation": top, "nose": top.at(0, 0, 1)}


def free_rotation(t: Array) -> Array:
    """[k, 3, 3]: the body turns about its axis e3, which precesses about the angular momentum at |L| / I."""
    momentum = np.array((TOP_I, TOP_I, TOP_I3)) * TOP_W
    own = (1.0 - TOP_I3 / TOP_I) * TOP_W[2]
    return np.array([_turn(momentum / TOP_I * s) @ _turn(np.array((0.0, 0.0, own * s))) for s in np.asarray(t)])


def _turn(vector: Array) -> Array:
    """Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def rolling() -> tuple[mbd.Scene, dict[str, Any]]:
    """A uniform disc that rolls on a line under a gravity that is inclined to it by 0.3 rad: a = 2/3 g sin 0.3."""
    scene = mbd.Scene(gravity=9.81 * np.array((np.sin(0.3), -np.cos(0.3))))
    disc = scene.add(mbd.RigidBody(mass=2.0, inertia=0.5 * 2.0 * 0.2**2, position=(0, 0.2)))
    scene.add(mbd.Rolling(disc.at(), scene.ground.at(0, 0), axis=(1, 0), radius=0.2))
    return scene, {"centre": disc.at(), "angle": disc}


def double_pendulum() -> tuple[mbd.Scene, dict[str, Any]]:
    """Two particles on two massless rods, horizontal at rest."""
    scene = mbd.Scene()
    first, second = scene.add(mbd.Particle(1.0, (1, 0))), scene.add(mbd.Particle(1.0, (2, 0)))
    scene.add(mbd.Distance(first.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Distance(second.at(), first.at()))
    return scene, {"tip": second.at(), "energy": lambda result: result.energy.kinetic}


def long_chain(links: int = 4) -> tuple[mbd.Scene, dict[str, Any]]:
    """Uniform rods of 1 m and 1 kg in series, horizontal at rest."""
    scene = mbd.Scene()
    before = scene.ground.at(0, 0)
    for k in range(links):
        body = scene.add(mbd.RigidBody.rod((k, 0), (k + 1, 0), mass=1.0))
        pin = scene.add(mbd.Pin(body.at(-0.5, 0), before))
        before = body.at(0.5, 0)
    return scene, {"tip": before, "angle": body, "force": pin}


CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], dtype=float)
AXES = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)], dtype=float)


def bricard() -> tuple[mbd.Scene, dict[str, Any]]:
    """IFToMM A04: six hinges along the edges of a cube, one of whose equations is redundant."""
    scene = mbd.Scene(gravity=(0.0, -9.81, 0.0))
    before, rods = scene.ground.at(*CORNERS[0]), []
    for k in range(5):
        size, arm = np.where(CORNERS[k] == CORNERS[k + 1], 0.1, 1.0), 0.5 * (CORNERS[k + 1] - CORNERS[k])
        rods.append(scene.add(mbd.RigidBody.box(size, mass=1.0, position=CORNERS[k] + arm)))
        scene.add(mbd.Pin(rods[-1].at(*-arm), before, axis=AXES[k]))
        before = rods[-1].at(*arm)
    scene.add(mbd.Pin(before, scene.ground.at(*CORNERS[5]), axis=AXES[5]))
    return scene, {"corner": rods[2].at(*(0.5 * (CORNERS[3] - CORNERS[2]))), "rotation": rods[2]}


def motor() -> tuple[mbd.Scene, dict[str, Any]]:
    """A rod on a motor that swings, with a second one hinged to it and a rotational spring between them."""
    scene = mbd.Scene()
    arm = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    hand = scene.add(mbd.RigidBody.rod((1, 0), (1, -1), mass=1.0))
    drive = scene.add(mbd.Motor(arm.at(-0.5, 0), scene.ground.at(0, 0), angle=lambda t: 0.5 * np.sin(2.0 * t)))
    scene.add(mbd.Pin(arm.at(-0.5, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(hand.at(-0.5, 0), arm.at(0.5, 0)))
    scene.add(mbd.TorsionSpring(hand.at(), arm.at(), stiffness=20.0, damping=0.1))
    return scene, {"tip": hand.at(0.5, 0), "drive": drive}


def rope() -> tuple[mbd.Scene, dict[str, Any]]:
    """A damped cable in space that swings from a ball joint with a weight at its end."""
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    cable = scene.add(mbd.AncfCable((0, 0, 0), (1, 0, 0), n_elements=8, E=1e7, A=1e-4, I=1e-9, rho=1000.0, damping=1e-3))
    scene.add(mbd.Ball(cable.start, scene.ground.at(0, 0, 0)))
    weight = scene.add(mbd.Particle(0.2, (1, 0, 0), (0, 1, 0)))
    scene.add(mbd.Ball(weight.at(), cable.end))
    return scene, {"weight": weight.at(), "middle": cable.at(0.5)}


def _marked(case: scenes.Case) -> Callable[[], tuple[mbd.Scene, dict[str, Any]]]:
    def build() -> tuple[mbd.Scene, dict[str, Any]]:
        scene, marker = case.build()
        return scene, {"point": marker}

    return build


def soft_pendulum(elements: int = 30) -> tuple[mbd.Scene, dict[str, Any]]:
    scene, tip = scenes.pendulum(machines.SOFT, elements)
    return scene, {"tip": tip, "force": scene.items[-1]}


def _benchmark(name: str, **changes: Any) -> Case:
    case = scenes.BY_NAME[name]
    return Case(case.name, _marked(case), case.t_end, **({"elastic": case.beam, "rtols": BEAM_RTOLS if case.beam else RTOLS} | changes))


def _flat(exact: Callable[[Array], Array]) -> Exact:
    return lambda t: exact(t).reshape(len(t), -1) / np.sqrt(2.0)


G = 9.81
STEPS = (mbd.GeneralizedAlpha(step=8e-3), mbd.GeneralizedAlpha(step=4e-3), mbd.Gauss(step=0.02), mbd.Gauss(step=0.01), mbd.Gauss(0.04, stages=3),
         mbd.Radau(3, step=0.02))  # fmt: skip

CASES = [
    Case("A01 pendulum", simple_pendulum, 10.0, {"bob": pendulum_path, "force": pendulum_force}),
    Case("A01 pendulum, fixed steps", simple_pendulum, 3.0, {"bob": pendulum_path, "force": pendulum_force}, (1e-10,), STEPS),
    Case("IVP pendulum", turning_pendulum, 20.0, {"energy": lambda t: np.full((len(t), 1), 0.5)}),
    Case("free fall", free_fall, 2.0, {
        "place": lambda t: np.stack((3.0 * t, 4.0 * t - 0.5 * G * t**2), axis=-1), "angle": lambda t: 5.0 * t[:, None]}),
    Case("oscillator", oscillator, 5.0, {"mass": oscillation}),
    Case("free top", free_top, 10.0, {"rotation": _flat(free_rotation), "nose": lambda t: free_rotation(t)[:, :, 2]}),
    Case("rolling disc", rolling, 3.0, {
        "centre": lambda t: np.stack((G * np.sin(0.3) * t**2 / 3.0, np.full(len(t), 0.2)), axis=-1),
        "angle": lambda t: -G * np.sin(0.3) * t[:, None] ** 2 / 0.6}),
    Case("double pendulum", double_pendulum, 4.0),
    Case("double pendulum, fixed steps", double_pendulum, 2.0, {}, (1e-10,), STEPS),
    Case("chain of 4", long_chain, 2.0),
    _benchmark("chain 10"),
    _benchmark("heavy top"),
    _benchmark("four-bar 1"),
    _benchmark("four-bar 2"),
    Case("Bricard", bricard, 5.0),
    _benchmark("squeezer"),
    _benchmark("slider-crank"),
    Case("motor", motor, 5.0),
    Case("soft pendulum", soft_pendulum, 1.1, elastic=True, rtols=RTOLS[:5]),
    _benchmark("steel pendulum"),
    _benchmark("spaghetti"),
    _benchmark("spin-up"),
    _benchmark("flexible slider-crank"),
    Case("rope in space", rope, 2.0, elastic=True, rtols=BEAM_RTOLS),
]  # fmt: skip
BY_NAME = {case.name: case for case in CASES}
