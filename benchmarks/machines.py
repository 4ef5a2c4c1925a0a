"""Numbers that both programs' scenes are made of: lengths [m], masses [kg], inertias [kg m^2], loads [N], [N m], starts."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

DATA = Path(__file__).parent / "data"
GRAVITY = 9.81


def data(name: str) -> dict[str, Any]:
    return json.loads((DATA / f"{name}.json").read_text())


class Cable(NamedTuple):
    """A straight cable between two points, the same words as ``mbd.AncfCable``'s."""

    start: tuple[float, float]
    end: tuple[float, float]
    n_elements: int
    E: float
    A: float
    I: float  # noqa: E741
    rho: float


SOFT, STEEL = 0.7e6, 2.07e11


def pendulum_cable(E: float, elements: int = 30) -> Cable:
    """Escalona, Hussien and Shabana (1998)."""
    return Cable((0.0, 0.0), (1.2, 0.0), elements, E, 1.8e-3, 1.215e-8, 5540.0)


# Simo and Vu-Quoc (1986) as a thin cable, with a smooth pulse of the same impulse. EA 1e4, EI 500, 1 kg/m; no shear, no rotary inertia.
SPAGHETTI = Cable((6.0, 0.0), (0.0, 8.0), 16, 1e4, 1.0, 0.05, 1.0)
PULSE = 2.5


def _pulse(t: float) -> float:
    return math.sin(math.pi * t / PULSE) ** 2 if t < PULSE else 0.0


def spaghetti_force(t: float) -> float:
    return 16.0 * _pulse(t)


def spaghetti_moment(t: float) -> float:
    return -160.0 * _pulse(t)


# Simo and Vu-Quoc (1986), without shear and rotary inertia: EA 2.8e7, EI 1.4e4, 1.2 kg/m, clamped to a hub at the origin.
SPINUP = Cable((0.0, 0.0), (10.0, 0.0), 8, 2.8e7, 1.0, 5e-4, 1.2)
TURNING, FASTEST = 15.0, 6.0  # the hub speeds up for so long [s], to this speed [rad/s]


def hub_angle(t: float) -> float:
    if t >= TURNING:
        return FASTEST * t - 0.5 * FASTEST * TURNING
    w = 2.0 * math.pi / TURNING
    return FASTEST / TURNING * (0.5 * t * t + (math.cos(w * t) - 1.0) / (w * w))


def hub_speed(t: float) -> float:
    w = 2.0 * math.pi / TURNING
    return FASTEST if t >= TURNING else FASTEST / TURNING * (t - math.sin(w * t) / w)


def hub_acceleration(t: float) -> float:
    return 0.0 if t >= TURNING else FASTEST / TURNING * (1.0 - math.cos(2.0 * math.pi / TURNING * t))


# A crank of 0.5 m and a rod of 1 m, both uniform, push a particle along the x axis: from rest, by a constant torque against gravity.
CRANK, ROD, PISTON, CRANK_ANGLE, CRANK_TORQUE = 0.5, 1.0, 0.5, math.pi / 3.0, 10.0
CRANK_MASS, ROD_MASS = 1.0, 2.0


def slider_crank_points() -> tuple[tuple[float, float], tuple[float, float]]:
    """Crank pin and piston at the start."""
    pin = CRANK * math.cos(CRANK_ANGLE), CRANK * math.sin(CRANK_ANGLE)
    return pin, (pin[0] + math.sqrt(ROD**2 - pin[1] ** 2), 0.0)


# The slider-crank of the IVP test set (Simeon 1996), 8 mm square steel, without gravity; its modal rod is a cable here. Stretched out and at
# rest at the start, it is turned by a constant torque. Nothing damps the mesh's vibrations, from 216 Hz to 70 kHz.
FLEXIBLE_CRANK, FLEXIBLE_CRANK_MASS, FLEXIBLE_CRANK_INERTIA = 0.15, 0.36, 0.002727
FLEXIBLE_PISTON, FLEXIBLE_TORQUE = 0.075552, 10.0
FLEXIBLE_ROD = Cable((0.15, 0.0), (0.45, 0.0), 4, 2e11, 0.008**2, 0.008**4 / 12.0, 7870.0)


LINK = 0.1  # length of a chain's links, 1 kg each

# The fast top of Bruels and Cardona: fixed at the origin, body axes along the inertial ones at the start.
TOP_MASS, TOP_INERTIA = 15.0, (0.234375, 0.46875, 0.234375)
TOP_CENTRE, TOP_SPIN = (0.0, 1.0, 0.0), (0.0, 150.0, -4.61538)


def squeezer_numbers() -> dict[str, Any]:
    """Andrews' squeezer of the IVP test set; the letters are those of Hairer and Wanner (1996), VI.9."""
    return data("andrews")["parameters"]


# A joint: (body, point), (body, point). Bodies 0 to 6, and 7 for the ground.
SQUEEZER_PINS = (
    ((0, "O"), (7, "O")), ((0, "F"), (1, "F")), ((1, "E"), (2, "E")), ((2, "B"), (7, "B")), ((3, "E"), (1, "E")),
    ((3, "P"), (4, "P")), ((4, "A"), (7, "A")), ((5, "E"), (1, "E")), ((5, "Q"), (6, "Q")), ((6, "A"), (7, "A")),
)  # fmt: skip
SQUEEZER_SPRING = ((7, "C"), (2, "D"))


def squeezer_points(p: dict[str, Any]) -> list[dict[str, tuple[float, float]]]:
    """Points in body axes from the mass centre; the first axis is e(angle) of the body."""
    return [
        {"O": (-p["ra"], 0.0), "F": (p["rr"] - p["ra"], 0.0)},
        {"F": (p["da"], 0.0), "E": (p["da"] - p["d"], 0.0)},
        {"B": (-p["sb"], p["sa"]), "E": (-p["sb"], p["sa"] - p["ss"]), "D": (p["sd"] - p["sb"], p["sa"] - p["sc"])},
        {"P": (0.0, p["e"] - p["ea"]), "E": (0.0, -p["ea"])},
        {"A": (-p["ta"], p["tb"]), "P": (p["zt"] - p["ta"], p["tb"])},
        {"Q": (p["fa"] - p["zf"], 0.0), "E": (p["fa"], 0.0)},
        {"A": (p["ub"], p["ua"]), "Q": (p["ub"], p["ua"] - p["u"])},
        {name: tuple(p[name]) for name in "OABC"},
    ]


def squeezer_poses(p: dict[str, Any]) -> list[tuple[tuple[float, float], float]]:
    """Mass centre and angle of every body at the start."""
    beta, theta, gamma, phi, delta, omega, eps = (float(x) for x in p["q0"])
    angles = [beta, beta + theta, gamma, phi + delta, delta, omega + eps, eps]
    points = squeezer_points(p)
    known = {"O": tuple(p["O"]), "A": tuple(p["A"]), "B": tuple(p["B"])}
    poses: dict[int, tuple[tuple[float, float], float]] = {}
    for body, anchor in ((0, "O"), (1, "F"), (2, "B"), (4, "A"), (3, "P"), (6, "A"), (5, "Q")):
        c, s = math.cos(angles[body]), math.sin(angles[body])
        turned = {name: (c * x - s * y, s * x + c * y) for name, (x, y) in points[body].items()}
        centre = (known[anchor][0] - turned[anchor][0], known[anchor][1] - turned[anchor][1])
        known |= {name: (centre[0] + x, centre[1] + y) for name, (x, y) in turned.items()}
        poses[body] = centre, angles[body]
    return [poses[body] for body in range(7)]
