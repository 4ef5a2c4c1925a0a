"""Fig. 2: a beam of 2.4 m falls from rest, its weight distributed (eq. 27) or concentrated at midspan (eq. 28).

The paper prints neither I nor the number of elements. One element and I = 1.215e-8 m^4, the section of the later examples, give the
printed ranges (ends up to +0.003 m, a sag of 0.02 m); the deviation falls with the square of the number of elements.
"""

from pathlib import Path

import numpy as np
from lines import Line, series

import mbd

L, A, I, E, RHO, G = 2.4, 0.0018, 1.215e-8, 0.7e11, 2770.0, 9.81  # noqa: E741
TIMES = np.linspace(0.0, 0.1, 101)


def fall(gravity: str) -> np.ndarray:
    """Heights [n_t, 3] of start, middle and end."""
    scene = mbd.Scene(gravity=(0, -G))
    beam = scene.add(mbd.AncfCable((0, 0), (L, 0), n_elements=1, E=E, A=A, I=I, rho=RHO, elasticity="local_frame", gravity=gravity))
    result = mbd.simulate(scene, 0.1, rtol=1e-12)
    return np.stack([result.position(beam.at(s), t=TIMES)[:, 1] for s in (0.0, 0.5, 1.0)], axis=1)


def closed_form() -> np.ndarray:
    """Of one element: the chord stays horizontal, so the bending oscillation is exact."""
    mass = RHO * A * L
    slope = -mass * G * L**2 / (48 * E * I) * (1 - np.cos(np.sqrt(720 * E * I / (mass * L**3)) * TIMES))
    end, middle = -0.5 * G * TIMES**2 - slope * L / 6, -0.5 * G * TIMES**2 + slope * L / 12
    return np.stack((end, middle, end), axis=1)


def run(folder: Path) -> list[Line]:
    import matplotlib.pyplot as plt

    distributed, concentrated, free = fall("consistent"), fall("lumped"), -0.5 * G * TIMES**2
    figure, axes = plt.subplots(layout="constrained")
    axes.plot(TIMES, free, "k", label="distributed: all points")
    axes.plot(TIMES, concentrated[:, 0], "--", label="concentrated: ends")
    axes.plot(TIMES, concentrated[:, 1], ":", label="concentrated: middle")
    axes.set(xlabel="t [s]", ylabel="y [m]", title="Fig. 2: a falling beam")
    axes.legend()
    figure.savefig(folder / "figure_2.png", dpi=120)
    plt.close(figure)
    return [
        series("Fig. 2, distributed weight: y of ends and middle [m]", "curve", np.stack([free] * 3, axis=1)[:, :2], distributed[:, :2], 1e-12),
        series("Fig. 2, concentrated weight: y of ends and middle [m]", "curve", closed_form()[:, :2], concentrated[:, :2], 1e-12),
    ]
