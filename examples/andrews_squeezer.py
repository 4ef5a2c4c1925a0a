"""Andrews' squeezer: seven bodies of a few grams in a plane, a spring and a motor, three closed loops, all over in 30 ms (IVP test set).

    python examples/andrews_squeezer.py [--out DIR]

Prints the angles at 0.03 s beside a solution in quadruple precision, and draws the mechanism and the crank's angle. Returns the largest
difference [rad].
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

# Hairer and Wanner (1996), VI.9. Bodies: mass [kg], inertia [kg m^2], mass centre [m] in axes of the body at the joint named first.
BODIES = {
    "crank": (0.04325, 2.194e-6), "rod": (0.00365, 4.41e-7), "plate": (0.02373, 5.255e-6), "upper link": (0.00706, 5.667e-7),
    "upper arm": (0.0705, 1.169e-5), "lower link": (0.00706, 5.667e-7), "lower arm": (0.05498, 1.912e-5),
}  # fmt: skip
START = np.array((-0.06171389001427645, 0.0, 0.45527981916307037, 0.22266839016588587, 0.48736497954384254, -0.22266839016588587, 1.2305474445498212))
END = np.array(
    (15.810771195153707, -15.756371058411839, 0.04082224011964580, -0.53473011634207960, 0.52440996587995407, 0.53473011634207960, 1.0480807410419379)
)
TURNING = np.array([[1, 0, 0, 0, 0, 0, 0], [1, 1, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0, 0], [0, 0, 0, 1, 1, 0, 0],
                    [0, 0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 0, 1, 1], [0, 0, 0, 0, 0, 0, 1]])  # fmt: skip
"""Angles of the bodies from the book's beta, theta, gamma, phi, delta, Omega, epsilon."""


def geometry() -> tuple[dict[str, complex], list[complex]]:
    """The joints and the mass centres [m] at the start, as complex numbers."""
    crank, rod, plate, upper_link, upper, lower_link, lower = np.exp(1j * TURNING @ START)
    a, b = -0.06934 - 0.00227j, -0.03635 + 0.03273j
    f, h, g = 0.007 * crank, a + 0.04 * upper, a - 0.04j * lower
    points = {"O": 0j, "A": a, "B": b, "C": 0.014 + 0.072j, "F": f, "G": g, "H": h, "E": f - 0.028 * rod, "D": b + (0.02 - 0.018j) * plate}
    centres = [0.00092 * crank, f - 0.0115 * rod, b + (0.01043 - 0.01874j) * plate, h - 0.00579j * upper_link,
               a + (0.02308 - 0.00916j) * upper, g + 0.00579 * lower_link, a - (0.00449 + 0.01228j) * lower]  # fmt: skip
    return points, centres


def main(out: str = ".") -> float:
    points, centres = geometry()
    scene = mbd.Scene(gravity=(0.0, 0.0))
    bodies = [scene.add(mbd.RigidBody(mass=m, inertia=j, position=(c.real, c.imag), name=name)) for (name, (m, j)), c in zip(BODIES.items(), centres)]

    def at(body: int, point: str) -> mbd.Marker:
        """The marker of a body (0: the ground) that lies at a named point; body axes are parallel to the ground's at the start."""
        place = points[point] - (centres[body - 1] if body else 0.0)
        return (bodies[body - 1] if body else scene.ground).at(place.real, place.imag)

    for first, second, point in (
        (1, 0, "O"),
        (2, 1, "F"),
        (3, 0, "B"),
        (5, 0, "A"),
        (7, 0, "A"),
        (4, 5, "H"),
        (6, 7, "G"),
        (3, 2, "E"),
        (4, 2, "E"),
        (6, 2, "E"),
    ):
        scene.add(mbd.Pin(at(first, point), at(second, point)))
    scene.add(mbd.Spring(at(3, "D"), at(0, "C"), stiffness=4530.0, length=0.07785))
    scene.add(mbd.Motor(bodies[0], scene.ground, torque=0.033))
    times = np.linspace(0.0, 0.03, 151)
    result = mbd.simulate(scene, 0.03, rtol=1e-12, t_eval=times)

    turned = np.array([result.angle(body)[-1] for body in bodies])
    error = np.abs(np.linalg.solve(TURNING, turned + TURNING @ START) - END).max()
    print(f"the crank has turned by {turned[0]:.9f} rad; all angles within {error:.1e} rad of the reference")
    print(result.audit)

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    result.plot([0.0, 0.011], ax=shapes)
    shapes.set_title("at the start and after 11 ms")
    for body, label in zip(bodies, BODIES):
        if label in ("plate", "upper link", "upper arm", "lower arm"):
            graph.plot(1e3 * times, np.degrees(result.angle(body)), label=label)
    graph.set(xlabel="t [ms]", ylabel="turn since the start [degrees]", title="turns of four of the bodies")
    graph.legend()
    path = Path(out) / "andrews_squeezer.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
