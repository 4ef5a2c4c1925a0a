"""A beam on a hub that spins up from rest to 6 rad/s in 15 s (Simo and Vu-Quoc, 1986): it lags behind, then centrifugal forces straighten it.

    python examples/spin_up_beam.py [--out DIR]

Prints the tip's deflection in the hub's frame beside reference values, and draws it with the shapes. Returns the largest difference [m].
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

LENGTH, EA, EI, LINE_MASS = 10.0, 2.8e7, 1.4e4, 1.2  # [m], [N], [N m^2], [kg/m]
AREA = 1e-2
# Deflection [m] of the tip across the hub's axis at 1, 2, ... 15 s, computed apart from this library by B-splines (no shear).
REFERENCE = [
    -0.020543108, -0.102372441, -0.217254110, -0.342253843, -0.468441976, -0.543559322, -0.571261713, -0.542795967, -0.460226616, -0.362765373,
    -0.257321107, -0.150886404, -0.069196944, -0.020284291, 0.001290269,
]  # fmt: skip


def hub(t: float) -> float:
    """The hub's angle [rad]."""
    return 0.4 * (t**2 / 2.0 + (7.5 / np.pi) ** 2 * (np.cos(2.0 * np.pi * t / 15.0) - 1.0))


def main(out: str = ".") -> float:
    scene = mbd.Scene(gravity=(0.0, 0.0))
    section = {"E": EA / AREA, "A": AREA, "I": EI * AREA / EA, "rho": LINE_MASS / AREA}
    beam = scene.add(mbd.AncfCable((0, 0), (LENGTH, 0), n_elements=8, gauss_points=3, **section, name="beam"))
    scene.add(mbd.Prescribed(beam.start, (0.0, 0.0), angle=hub))
    times = np.linspace(0.0, 15.0, 151)
    result = mbd.simulate(scene, 15.0, rtol=1e-6, t_eval=times)

    aside = (result.position(beam.end) @ (1, 1j) * np.exp(-1j * np.array([hub(t) for t in times]))).imag  # of the hub's axis
    error = np.abs(aside[10::10] - REFERENCE).max()
    print(f"the tip lags by up to {-aside.min():.4f} m of {LENGTH:g} m; within {error:.1e} m of the reference at every second")
    stretch = np.linalg.norm(result.position(beam.end)[-1]) - LENGTH
    print(f"at 15 s the beam is straight again and {1e3 * stretch:.4f} mm longer; tan(k L)/k - L = 0.5143 mm for k = speed / speed of sound")

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    result.plot(np.arange(0.0, 8.1, 0.5), ax=shapes)
    shapes.set_title("every 0.5 s up to 8 s")
    graph.plot(times, aside, label="8 elements")
    graph.plot(times[10::10], REFERENCE, "k.", label="reference")
    graph.set(xlabel="t [s]", ylabel="tip, across the hub's axis [m]", title="lag of the tip")
    graph.legend(loc="lower right")
    path = Path(out) / "spin_up_beam.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
