"""A four-bar linkage and the curve that a point of its coupler draws: a crank that turns, a rocker that swings (Grashof).

    python examples/four_bar.py [--out DIR]

Prints the swing of the rocker, and draws the linkage, the coupler curve and the rocker's angle. Returns the largest distance [m] between
the curve and the one by circles that meet.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

GROUND, CRANK, COUPLER, ROCKER = 1.0, 0.4, 1.1, 0.9  # [m]
TRACER = np.array((0.6, 0.5))  # of the coupler, along it from its first pin and across [m]
SPEED = 2.0 * np.pi  # [rad/s]


def by_circles(turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The coupler's pins [n, 2] as complex numbers, for angles of the crank: the second one is where two circles meet."""
    a = CRANK * np.exp(1j * turn)
    across = GROUND - a
    gap = np.abs(across)
    foot = (gap**2 + COUPLER**2 - ROCKER**2) / (2.0 * gap)
    return a, a + across / gap * (foot + 1j * np.sqrt(COUPLER**2 - foot**2))


def main(out: str = ".") -> float:
    a, b = by_circles(np.zeros(1))
    (ax, ay), (bx, by) = (a[0].real, a[0].imag), (b[0].real, b[0].imag)
    scene = mbd.Scene(gravity=(0.0, -9.81))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (ax, ay), mass=0.4, name="crank"))
    coupler = scene.add(mbd.RigidBody.rod((ax, ay), (bx, by), mass=1.1, name="coupler"))
    rocker = scene.add(mbd.RigidBody.rod((GROUND, 0), (bx, by), mass=0.9, name="rocker"))
    scene.add(mbd.Pin(crank.at(-0.5 * CRANK, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(coupler.at(-0.5 * COUPLER, 0), crank.at(0.5 * CRANK, 0)))
    scene.add(mbd.Pin(coupler.at(0.5 * COUPLER, 0), rocker.at(0.5 * ROCKER, 0)))
    scene.add(mbd.Pin(rocker.at(-0.5 * ROCKER, 0), scene.ground.at(GROUND, 0)))
    motor = scene.add(mbd.Motor(crank, scene.ground, speed=SPEED))
    times = np.linspace(0.0, 1.0, 181)
    result = mbd.simulate(scene, 1.0, rtol=1e-9, t_eval=times)

    tracer = coupler.at(TRACER[0] - 0.5 * COUPLER, TRACER[1])
    a, b = by_circles(SPEED * times)
    exact = a + complex(*TRACER) * (b - a) / COUPLER
    curve = result.position(tracer)
    error = np.abs(curve @ (1, 1j) - exact).max()
    swing, torque = np.degrees(result.angle(rocker)), result.reaction(motor)[:, 2]
    print(f"the rocker swings between {swing.min():.2f} and {swing.max():.2f} degrees; torque {torque.min():.1f} to {torque.max():.1f} N m")
    print(f"coupler curve: within {error:.1e} m of the one by circles")

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    result.plot(times[:-1:30], ax=shapes)
    shapes.plot(*curve.T, color="C3", linewidth=2, label="coupler curve")
    shapes.plot(*curve[:-1:30].T, "o", color="C3", markersize=5)
    shapes.set_title("one turn of the crank")
    shapes.legend(loc="upper right")
    graph.plot(360.0 * times, swing)
    graph.set(xlabel="angle of the crank [degrees]", ylabel="angle of the rocker [degrees]", title="the rocker's swing", xticks=range(0, 361, 60))
    graph.grid(alpha=0.3)
    path = Path(out) / "four_bar.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
