"""A deep arch, clamped at one end and hinged at the other, under a growing load at its crown (DaDeppo and Schmidt, 1975): it leans over and
snaps through. The path of equilibrium is followed by arc length, past the limit point, where the load falls again.

    python examples/deep_arch.py [--out DIR]

Prints the limit load, and draws shapes along the path and load against displacement. Returns the relative error of the limit load.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

RADIUS, HALF = 100.0, np.radians(107.5)
LIMIT = 897.2949473806923  # [N], by a shooting method
LOADS = [(9.0, 206.6482), (27.0, 409.8831), (45.0, 526.5424), (63.0, 623.3192), (81.0, 720.6976), (99.0, 826.6740), (117.0, 879.5076)]


def arch() -> tuple[mbd.Scene, mbd.Marker, mbd.Force]:
    """The scene, the crown and the load of 1000 N on it."""
    angle = np.linspace(HALF, -HALF, 97)
    nodes = RADIUS * np.stack((-np.sin(angle), np.cos(angle)), axis=1)
    tangents = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    scene = mbd.Scene(gravity=(0.0, 0.0))
    beam = scene.add(mbd.AncfCable(nodes=nodes, tangents=tangents, E=1e8, A=1.0, I=1e-2, rho=1.0, gauss_points=3, name="arch"))
    scene.add(mbd.Clamp(beam.start, scene.ground.at(*nodes[0])))
    scene.add(mbd.Pin(beam.end, scene.ground.at(*nodes[-1])))
    return scene, beam, scene.add(mbd.Force(beam.at(0.5), (0.0, -1000.0), name="load"))


def main(out: str = ".") -> float:
    scene, beam, load = arch()
    crown = beam.at(0.5)
    deep = mbd.Event(lambda point: point.position(crown)[1] + 17.0, terminal=True)
    path = mbd.continuation(scene, load, until=None, events=[deep])
    (limit,) = path.limits
    force, sink = 1000.0 * path.factor, RADIUS - path.position(crown)[:, 1]
    error = abs(1000.0 * limit.factor / LIMIT - 1.0)
    print(f"limit load {1000.0 * limit.factor:.3f} N (reference {LIMIT:.3f} N) where the crown has sunk {RADIUS - limit.position(crown)[1]:.3f} m")
    print(f"{len(path)} points of the path, {path.stable.sum()} of them stable")

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5.5), layout="constrained")
    fractions = np.linspace(0.0, 1.0, 201)
    for k in np.searchsorted(sink, (0.0, 30.0, 60.0, 90.0, sink[-1])):
        curve = np.stack([path.position(beam.at(s))[k] for s in fractions])
        shapes.plot(*curve.T, label=f"{force[k]:.0f} N", color=plt.cm.viridis(sink[k] / sink[-1]))
    shapes.set(xlabel="x [m]", ylabel="y [m]", title="shapes along the path", aspect="equal")
    shapes.legend(title="load", loc="center left", bbox_to_anchor=(1.0, 0.5))
    graph.plot(sink[path.stable], force[path.stable], color="C0", label="stable")
    graph.plot(sink[~path.stable], force[~path.stable], color="C3", label="unstable")
    graph.plot(*np.transpose(LOADS), "k.", label="reference")
    graph.plot(RADIUS - limit.position(crown)[1], 1000.0 * limit.factor, "o", color="C3", fillstyle="none", label="limit point")
    graph.set(xlabel="crown's displacement [m]", ylabel="load [N]", title="load and displacement")
    graph.legend(loc="lower right")
    picture = Path(out) / "deep_arch.png"
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=120)
    plt.close(figure)
    print(f"picture in {picture}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
