"""Scenes that several tests share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import mbd

DATA = Path(__file__).parent / "data"


def data(name: str) -> dict[str, Any]:
    return json.loads((DATA / f"{name}.json").read_text())


def flexible_pendulum(*, E: float = 0.7e6, n_elements: int = 30, **options: Any) -> tuple[mbd.Scene, Any, Any]:
    """The pendulum of Escalona, Hussien and Shabana (1998): scene, rod, pivot."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=n_elements, E=E, A=1.8e-3, I=1.215e-8, rho=5540, name="rod", **options))
    pivot = scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    return scene, rod, pivot


def double_pendulum() -> tuple[mbd.Scene, Any]:
    """Two particles on two massless rods, horizontal at rest: scene, tip."""
    scene = mbd.Scene()
    first, second = scene.add(mbd.Particle(1.0, (1, 0))), scene.add(mbd.Particle(1.0, (2, 0)))
    scene.add(mbd.Distance(first.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Distance(second.at(), first.at()))
    return scene, second.at()


def simple_pendulum() -> tuple[mbd.Scene, Any, Any]:
    """IFToMM A01: a particle on a massless rod, released at (-1, 0): scene, particle, rod."""
    scene = mbd.Scene()
    bob = scene.add(mbd.Particle(1.0, (-1, 0)))
    rod = scene.add(mbd.Distance(bob.at(), scene.ground.at(0, 0), name="rod"))
    return scene, bob, rod


def chain(links: int) -> tuple[mbd.Scene, list[Any], list[Any]]:
    """Uniform rods of 1 m and 1 kg in series, horizontal at rest: scene, bodies, pins."""
    scene = mbd.Scene()
    before, bodies, pins = scene.ground.at(0, 0), [], []
    for k in range(links):
        bodies.append(scene.add(mbd.RigidBody.rod((k, 0), (k + 1, 0), mass=1.0)))
        pins.append(scene.add(mbd.Pin(bodies[-1].at(-0.5, 0), before, name=f"pin {k}")))
        before = bodies[-1].at(0.5, 0)
    return scene, bodies, pins


def heavy_top() -> tuple[mbd.Scene, Any, Any]:
    """Bruels and Cardona's fast top, fixed at the origin: scene, body, joint."""
    omega, centre = np.array((0.0, 150.0, -4.61538)), np.array((0.0, 1.0, 0.0))
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    top = scene.add(
        mbd.RigidBody(
            mass=15.0, inertia=(0.234375, 0.46875, 0.234375), position=centre, velocity=np.cross(omega, centre), angular_velocity=omega, name="top"
        )
    )
    tip = scene.add(mbd.Ball(top.at(0, -1, 0), scene.ground.at(0, 0, 0), name="tip"))
    return scene, top, tip
