"""A quick-return mechanism: a crank's pin slides in a slotted lever that pushes a ram slowly one way and fast back (Whitworth's shaper).

    python examples/quick_return.py [--out DIR]

Prints the times of the two strokes, found as events, and draws the mechanism and the ram's motion. Returns the error of the ratio of
times, which is (pi + 2 asin(r/d)) / (pi - 2 asin(r/d)): the lever turns back where the crank stands at right angles to it.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mbd

CRANK, APART, LEVER, RAM = 0.12, 0.3, 0.6, 0.35  # crank radius, distance of the pivots, lever, height of the ram above the crank's pivot [m]
SPEED = np.pi  # [rad/s]


def main(out: str = ".") -> float:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    tip = np.array((0.0, LEVER - APART))
    link = np.array((-np.sqrt(0.25**2 - (RAM - tip[1]) ** 2), RAM))  # of 0.25 m, to the ram's pin
    crank = scene.add(mbd.RigidBody.rod((0, 0), (0, CRANK), mass=0.3, name="crank"))
    lever = scene.add(mbd.RigidBody.rod((0, -APART), tip, mass=1.0, name="lever"))
    bar = scene.add(mbd.RigidBody.rod(tip, link, mass=0.3, name="link"))
    ram = scene.add(mbd.RigidBody.box((0.12, 0.04), mass=2.0, position=link, name="ram"))
    scene.add(mbd.Pin(crank.at(-0.5 * CRANK, 0), scene.ground.at(0, 0)))
    scene.add(mbd.Pin(lever.at(-0.5 * LEVER, 0), scene.ground.at(0, -APART)))
    slot = scene.add(mbd.PointOnLine(crank.at(0.5 * CRANK, 0), lever.at(0, 0), axis=(1, 0), name="slot"))
    scene.add(mbd.Pin(bar.at(-0.125, 0), lever.at(0.5 * LEVER, 0)))
    scene.add(mbd.Pin(bar.at(0.125, 0), ram.at(0, 0)))
    scene.add(mbd.Slider(ram.at(0, 0), scene.ground.at(0, RAM), axis=(1, 0)))
    scene.add(mbd.Motor(crank, scene.ground, speed=SPEED))
    back = mbd.Event(lambda state: state.velocity(lever.at(0.5 * LEVER, 0))[0], name="the lever turns back")
    times = np.linspace(0.0, 4.0, 201)
    result = mbd.simulate(scene, 4.0, rtol=1e-9, events=[back], t_eval=times)

    turns = result.events[back].t
    strokes = np.diff(turns)
    ratio, swing = max(strokes[:2]) / min(strokes[:2]), 2.0 * np.arcsin(CRANK / APART)
    error = abs(ratio - (np.pi + swing) / (np.pi - swing))
    print(f"strokes of {max(strokes):.4f} s and {min(strokes):.4f} s: ratio {ratio:.6f}, by geometry {(np.pi + swing) / (np.pi - swing):.6f}")
    speed = result.velocity(ram.at(0, 0))[:, 0]
    print(f"speed of the ram {speed.min():.3f} to {speed.max():.3f} m/s; force in the slot up to {np.abs(result.reaction(slot)[:, :2]).max():.0f} N")

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5.5), layout="constrained")
    result.plot(np.linspace(0.0, 1.8, 10), ax=shapes)
    shapes.set_title("one turn of the crank")
    graph.plot(times, speed, label="speed of the ram [m/s]")
    graph.plot(times, result.position(ram.at(0, 0))[:, 0], label="place of the ram [m]")
    for t in turns:
        graph.axvline(t, color="gray", linewidth=0.8, linestyle=":")
    graph.set(xlabel="t [s]", ylabel="place [m], speed [m/s]", ylim=(-0.65, 1.65), title="slow one way, fast back (dotted: the lever turns back)")
    graph.legend(loc="upper center")
    path = Path(out) / "quick_return.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(f"picture in {path}")
    return float(error)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=".", help="folder of the picture")
    main(**vars(parser.parse_args()))
