"""Fig. 8: a cantilever of 2.4 m under a force at its end that rises to F within 1 s and stays; 30 elements, no gravity.

Printed are F = 0.01 N and an unreadable power of ten for E. These cannot give the printed shapes (end near y = -1.2 m at 10 s and -1.7 m at
15 s): even without stiffness 0.01 N moves this beam by 0.67 m at most in 15 s, and with E = 1e11 N/m^2 by 4e-5 m. Chosen: F = 0.1 N and
E = 1e7 N/m^2. The printed force with E = 1e6 N/m^2 is the same motion, slowed down by the root of ten (but for the ramp).

The paper fixes all coordinates of the clamped node, the length of the slope too. ``mbd.Clamp`` leaves that free, as the stretch of
the beam there is not the clamp's matter; a joint of one's own is a list of rows.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lines import REFERENCE, Line, series

import mbd
from mbd.joints.placed import Joint, Pose, points
from mbd.rows import Row, coincide


@dataclass(frozen=True, eq=False)
class FixedNode(Joint):
    """Point and slope vector coincide with a marker's point and axis."""

    a: mbd.Marker
    b: mbd.Marker
    name: str | None = None

    kind = "fixed node"

    def rows(self, a: mbd.Marker, b: mbd.Marker, pose: Pose, scalars: list[int]) -> list[tuple[str, Row]]:
        return points(a, b) + [(f"slope {axis}", row) for axis, row in zip("xy", coincide(a.axes[0], b.axes[0]))]


def cantilever(beam: type = mbd.AncfCable, joint: type = mbd.Clamp, n: int = 30, F: float = 0.1, E: float = 1e7, **words: object):
    scene = mbd.Scene(gravity=(0.0, 0.0))
    rod = scene.add(beam((0, 0), (2.4, 0), n_elements=n, E=E, A=1.8e-3, I=1.215e-8, rho=2770, name="rod", **words))
    scene.add(joint(rod.start, scene.ground.at(0, 0), name="clamp"))
    scene.add(mbd.Force(rod.end, mbd.piecewise(lambda t: (0.0, -0.5 * F * (1 - np.cos(np.pi * t)) if t < 1 else -F), at=[1.0])))
    return scene, rod


def run(folder: Path) -> list[Line]:
    import matplotlib.pyplot as plt

    lines = []
    for what, key, choice in (
        ("Fig. 8, F = 0.1 N, E = 1e7: end at 1, 2, ... 15 s [m]", "tip", {}),
        ("Fig. 8, printed F = 0.01 N, E = 1e6: end to 47.4 s [m]", "printed_force", {"F": 0.01, "E": 1e6}),
    ):
        tips = REFERENCE["cantilever"][key]
        times = [float(t) for t in tips]
        scene, rod = cantilever(joint=FixedNode, elasticity="local_frame", **choice)
        result = mbd.simulate(scene, times[-1], rtol=1e-7)
        lines.append(series(what, "curve", np.array(list(tips.values())), result.position(rod.end, t=times), 2e-6))
        if key == "tip":
            axes = result.plot([0, 5, 8, 10, 12, 15], items=[rod])
            axes.set_title("Fig. 8: the cantilever (F = 0.1 N, E = 1e7 N/m$^2$)")
            axes.figure.savefig(folder / "figure_8.png", dpi=120)
            plt.close(axes.figure)
    return lines
