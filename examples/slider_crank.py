"""A slider-crank whose connecting rod bends: a motor takes the crank to constant speed, the rod's own inertia bends it aside.

    python examples/slider_crank.py [--out DIR]

Prints the rod's largest deflection and the motor's torque, and draws the machine, and both over time. Returns the share of the energy that
the run does not account for.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

CRANK, ROD, SPEED = 0.15, 0.3, 60.0  # [m], [m], [rad/s]
STARTING, T_END = 0.1, 0.25  # [s]
ALUMINIUM = {"E": 70e9, "A": 3e-3 * 12e-3, "I": 12e-3 * (3e-3) ** 3 / 12, "rho": 2700.0, "damping": 2e-4}  # 3 mm thick, 12 mm wide


def speed(t: float) -> float:
    """The crank's speed [rad/s], from rest."""
    return SPEED * np.sin(0.5 * np.pi * t / STARTING) ** 2 if t < STARTING else SPEED


def machine() -> tuple[mbd.Scene, dict]:
    """The scene, and its items by name. Everything lies along the x axis at the start."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (CRANK, 0), mass=0.4, name="crank"))
    rod = scene.add(mbd.AncfCable((CRANK, 0), (CRANK + ROD, 0), n_elements=4, **ALUMINIUM, name="rod"))
    block = scene.add(mbd.RigidBody.box((0.06, 0.04), mass=0.1, position=(CRANK + ROD, 0), name="block"))
    scene.add(mbd.Pin(crank.at(-0.5 * CRANK, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(rod.start, crank.at(0.5 * CRANK, 0)))
    scene.add(mbd.Pin(rod.end, block.at(0, 0)))
    scene.add(mbd.Slider(block.at(0, 0), scene.ground.at(0, 0), axis=(1, 0)))
    motor = scene.add(mbd.Motor(crank, scene.ground, speed=mbd.piecewise(speed, at=[STARTING])))
    return scene, {"rod": rod, "motor": motor}


def deflection(result: mbd.Result, rod) -> np.ndarray:
    """How far [m] the middle of the rod lies beside the line between its ends."""
    a, m, b = (result.position(marker) for marker in (rod.start, rod.at(0.5), rod.end))
    chord = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    return chord[:, 0] * (m - a)[:, 1] - chord[:, 1] * (m - a)[:, 0]


def main(out: str = ".") -> float:
    scene, items = machine()
    result = mbd.simulate(scene, T_END, rtol=1e-7, t_eval=np.linspace(0.0, T_END, 251))
    bent, torque = deflection(result, items["rod"]), result.reaction(items["motor"])[:, 2]
    print(f"largest deflection of the rod: {1e3 * np.abs(bent).max():.2f} mm of {1e3 * ROD:g} mm")
    print(f"torque of the motor: {torque.min():.1f} to {torque.max():.1f} N m")
    print(result.audit)

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 4.5), layout="constrained")
    result.plot(np.linspace(T_END - 2.0 * np.pi / SPEED, T_END, 9), ax=shapes)
    shapes.set_title("the last turn")
    graph.plot(result.t, 1e3 * bent, color="C0")
    graph.axvline(STARTING, color="gray", linewidth=0.8, linestyle=":")
    graph.set(xlabel="t [s]", ylabel="deflection of the rod's middle [mm]", title="bending and torque (dotted: full speed from here)")
    graph.yaxis.label.set_color("C0")
    other = graph.twinx()
    other.plot(result.t, torque, color="C1", linewidth=0.8)
    other.set_ylabel("torque of the motor [N m]", color="C1")
    path = Path(out) / "slider_crank.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(result.audit.energy_error / result.audit.energy_scale)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
