"""Bricard's mechanism (IFToMM benchmark A04): five rods and the ground in a closed chain of six hinges along the edges of a cube.

Counted by Gruebler's formula it cannot move; its hinges are so placed that one of their 30 equations follows from the others, and it does.

    python examples/bricard.py [--out DIR]

Prints what is said of the redundant joint, and a point beside reference values, and draws the mechanism and the point's path. Returns the
largest distance [m] from the references.
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], dtype=float)  # [m], of the hinges
AXES = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)], dtype=float)
SIDE = 0.1  # of the rods' square section [m]
# The fourth corner [m] at 1, 2, ... 5 s, from a closed form in quadruple precision.
REFERENCE = [
    (0.5105014612, -1.6491675994, 0.1401231146),
    (-0.9693403448, -1.2212468950, 0.7542780108),
    (-0.9671998000, -1.2280202147, 0.7459831762),
    (0.5248995934, -1.6438760013, 0.1488358461),
    (0.9999999977, -1.0000672577, 0.9999327400),
]


def main(out: str = ".") -> float:
    scene = mbd.Scene(gravity=(0.0, -9.81, 0.0))
    before = scene.ground.at(*CORNERS[0])
    for k in range(5):
        size, arm = np.where(CORNERS[k] == CORNERS[k + 1], SIDE, 1.0), 0.5 * (CORNERS[k + 1] - CORNERS[k])
        rod = scene.add(mbd.RigidBody.box(size, mass=1.0, position=CORNERS[k] + arm, name=f"rod {k}"))
        scene.add(mbd.Pin(rod.at(*-arm), before, axis=AXES[k], name=f"hinge {k}"))
        before = rod.at(*arm)
    scene.add(mbd.Pin(before, scene.ground.at(*CORNERS[5]), axis=AXES[5], name="hinge 5"))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", mbd.SceneWarning)
        result = mbd.simulate(scene, 5.0, rtol=1e-9, t_eval=np.linspace(0.0, 5.0, 101))
    print(*[warning.message for warning in said], sep="\n")
    corner = result.position(scene["rod 2"].at(*(0.5 * (CORNERS[3] - CORNERS[2]))))
    error = np.abs(corner[20::20] - REFERENCE).max()
    print(f"the fourth corner: within {error:.1e} m of the reference, up to 5 s")
    print(result.audit)

    figure = plt.figure(figsize=(12, 5.5), layout="constrained")
    shapes, graph = figure.add_subplot(1, 2, 1, projection="3d"), figure.add_subplot(1, 2, 2)
    result.plot(np.linspace(0.0, 1.5, 5), ax=shapes)
    shapes.plot(*corner.T, color="C3", linewidth=1.5, label="path of a corner")
    shapes.view_init(elev=20, azim=-60, vertical_axis="y")
    shapes.locator_params(nbins=4)
    shapes.legend(loc="upper left")
    for values, label in zip(corner.T, "xyz"):
        graph.plot(result.t, values, label=label)
    graph.plot(np.repeat(np.arange(1.0, 6.0), 3), np.ravel(REFERENCE), "k.", label="reference")
    graph.set(xlabel="t [s]", ylabel="place of the corner [m]")
    graph.legend()
    path = Path(out) / "bricard.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
