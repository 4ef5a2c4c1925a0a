"""Andrews' squeezer of the IVP test set, from its statement: each body described where it stands, in axes parallel to the ground's."""

from __future__ import annotations

from typing import Any

import numpy as np

import mbd

from .. import machines

BOOK = machines.data("andrews_ivp")
"""Letters as in Hairer and Wanner (1996), VI.9."""


def along(a: float) -> np.ndarray:
    return np.array((np.cos(a), np.sin(a)))


def across(a: float) -> np.ndarray:
    return np.array((np.sin(a), -np.cos(a)))


def points(q: np.ndarray) -> tuple[dict[str, np.ndarray], list[np.ndarray]]:
    """Named points and the seven mass centres at the angles beta, theta, gamma, phi, delta, Omega, eps."""
    p, (beta, theta, gamma, phi, delta, omega, eps) = BOOK["parameters"], q
    a, b, f = np.array(p["A"]), np.array(p["B"]), p["rr"] * along(beta)
    h = a + p["zt"] * along(delta)
    g = a + p["u"] * across(eps)
    named = {
        "O": np.zeros(2), "A": a, "B": b, "C": np.array(p["C"]), "F": f, "G": g, "H": h, "E": f - p["d"] * along(beta + theta),
        "D": b + p["sd"] * along(gamma) + p["sc"] * across(gamma),
    }  # fmt: skip
    centres = [
        p["ra"] * along(beta),
        f - p["da"] * along(beta + theta),
        b + p["sb"] * along(gamma) + p["sa"] * across(gamma),
        h + (p["e"] - p["ea"]) * across(phi + delta),
        a + p["ta"] * along(delta) + p["tb"] * across(delta),
        g + (p["zf"] - p["fa"]) * along(omega + eps),
        a + p["ua"] * across(eps) - p["ub"] * along(eps),
    ]
    return named, centres


def turns(q: np.ndarray) -> np.ndarray:
    """The angles [..., 7] of the bodies from the relative ones."""
    beta, theta, gamma, phi, delta, omega, eps = np.moveaxis(q, -1, 0)
    return np.stack((beta, beta + theta, gamma, phi + delta, delta, omega + eps, eps), axis=-1)


def squeezer() -> tuple[mbd.Scene, list[Any], list[Any]]:
    """Scene, bodies, and the three pins at E between body 2 and bodies 3, 4 and 6, which come first in them."""
    p, scene = BOOK["parameters"], mbd.Scene(gravity=(0, 0))
    q = np.array(p["q0"], dtype=float)
    named, centres = points(q)
    bodies = [scene.add(mbd.RigidBody(mass=m, inertia=j, position=c)) for m, j, c in zip(p["m"], p["I"], centres)]

    def at(body: int, name: str) -> mbd.Marker:
        return bodies[body - 1].at(*(named[name] - centres[body - 1])) if body else scene.ground.at(*named[name])

    for a, b, name in ((1, 0, "O"), (2, 1, "F"), (3, 0, "B"), (5, 0, "A"), (7, 0, "A"), (4, 5, "H"), (6, 7, "G")):
        scene.add(mbd.Pin(at(a, name), at(b, name), name=f"{name} of {a}"))
    closures = [scene.add(mbd.Pin(at(a, "E"), at(2, "E"), name=f"E of {a}")) for a in (3, 4, 6)]
    scene.add(mbd.Spring(at(3, "D"), scene.ground.at(*p["C"]), stiffness=p["spring_c0"], length=p["spring_l0"]))
    scene.add(mbd.Torque(bodies[0].at(0, 0), p["motor_torque"]))
    return scene, bodies, closures
