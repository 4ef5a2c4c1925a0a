"""A mass slides down a soft cable without friction, over all its elements: the cable sags under it and swings behind it.

    python examples/cable_slider.py [--out DIR]

Prints time and speed of the ride, and draws the cable, the path of the mass and its speed. Returns the share of the energy that the run
does not account for.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

SPAN, DROP, MASS = 10.0, 2.0, 4.0  # [m], [m], [kg]


def main(out: str = ".") -> float:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    cable = scene.add(mbd.AncfCable((0, 0), (SPAN, -DROP), n_elements=8, E=2e8, A=1e-4, I=1e-9, rho=5000.0, damping=5e-3, name="cable"))
    for end, place in ((cable.start, (0, 0)), (cable.end, (SPAN, -DROP))):
        scene.add(mbd.Pin(end, scene.ground.at(*place)))
    mass = scene.add(mbd.Particle(MASS, (0.05 * SPAN, -0.05 * DROP), name="mass"))
    ride = scene.add(mbd.BeamSlider(mass.at(), cable, name="ride"))
    near_end = mbd.Event(lambda state: state.q[ride.coordinate] - 0.97 * cable.length, terminal=True, name="arrived")
    result = mbd.simulate(scene, 10.0, rtol=1e-5, events=[near_end])

    t_end = result.t[-1]
    speed = np.linalg.norm(result.velocity(mass.at()), axis=1)
    slope = np.arctan2(DROP, SPAN)
    straight = np.sqrt(2.0 * 0.92 * cable.length / (9.81 * np.sin(slope)))
    print(f"the ride takes {t_end:.3f} s, along a straight rod {straight:.3f} s; speed up to {speed.max():.2f} m/s")
    print(f"force of the cable on the mass: up to {np.linalg.norm(result.reaction(ride)[:, :2], axis=1).max():.0f} N, weight {9.81 * MASS:.0f} N")
    print(result.audit)

    figure, (shapes, graph) = plt.subplots(2, 1, figsize=(9, 7.5), layout="constrained", height_ratios=(3, 2))
    result.plot(np.linspace(0.0, t_end, 9), ax=shapes)
    shapes.plot(*result.position(mass.at()).T, color="C3", linewidth=1.5, linestyle="--", label="path of the mass")
    shapes.legend(loc="lower left")
    shapes.set_title("nine instants")
    graph.plot(result.t, speed)
    graph.set(xlabel="t [s]", ylabel="speed of the mass [m/s]")
    graph.grid(alpha=0.3)
    path = Path(out) / "cable_slider.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(result.audit.energy_error / result.audit.energy_scale)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
