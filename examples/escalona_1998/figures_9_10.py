"""Figs 9 and 10: a stiffer pendulum of 0.4 m by the paper's element and by a floating frame of reference.

Printed: E = 1e9 N/m^2, 10 elements, 42 coordinates. Not printed and chosen: I = 1.215e-8 m^4, a horizontal start at rest; with these the
end's offset stays within the printed axis of 6 mm. The floating frame carries the 10 lowest modes of that mesh.

With the shortening by bending the two agree. Without it, in the plain linear formulation, the bending vibration drifts in phase until the
offset is wrong by as much as it is large, while the angle still looks right on Fig. 9. The stiffened reference drops the terms of
third order from the inertia, which is then nearly singular; mbd keeps them, the mass matrix stays positive, and is nearer to ANCF.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from lines import REFERENCE, Line, bound, series

import mbd


class Motion(NamedTuple):
    angle: np.ndarray
    offset: np.ndarray


class Swing:
    """A run of the pendulum: the angle of the slope at the pin [rad], and the end's offset from the tangent there [m]."""

    def __init__(self, beam: type, rtol: float, **words: object):
        scene = mbd.Scene(gravity=(0.0, -9.81))
        self.rod = scene.add(beam((0, 0), (0.4, 0), n_elements=10, E=1e9, A=1.8e-3, I=1.215e-8, rho=5540, **words))
        scene.add(mbd.Pin(self.rod.start, scene.ground.at(0, 0)))
        self.result = mbd.simulate(scene, 1.0, rtol=rtol)

    def at(self, times: np.ndarray) -> Motion:
        angle, tip = self.result.angle(self.rod.start, t=times), self.result.position(self.rod.end, t=times)
        return Motion(angle, np.cos(angle) * tip[:, 1] - np.sin(angle) * tip[:, 0])


def run(folder: Path) -> list[Line]:
    ancf = Swing(mbd.AncfCable, 2e-11, elasticity="local_frame")
    linear = Swing(mbd.FloatingFrameBeam, 1e-10, modes="cantilever", stiffening=False)
    stiff = Swing(mbd.FloatingFrameBeam, 1e-6, modes="cantilever")
    reference = REFERENCE["floating_frame"]
    lines = []
    for what, swing, key, limits in (
        ("ANCF", ancf, "ancf", (1e-8, 1e-8)),
        ("linear floating frame", linear, "linear", (1e-8, 1e-8)),
        ("stiffened, reference to second order", stiff, "stiffened", (5e-4, 1.5e-4)),
    ):
        numbers = reference[key]
        motion = swing.at(np.array(numbers["t"]))
        angle, offset = (numbers["th_tan"], numbers["v_tan"]) if key == "ancf" else (numbers["th"], numbers["v"])
        lines.append(series(f"Fig. 9, {what}: angle [rad]", "curve", np.array(angle), motion.angle, limits[0]))
        lines.append(series(f"Fig. 10, {what}: offset [m]", "curve", np.array(offset), motion.offset, limits[1]))
    times = np.linspace(0.0, 1.0, 1001)
    motions = [swing.at(times) for swing in (ancf, linear, stiff)]
    apart = [np.abs(np.array(motion) - np.array(motions[0])) for motion in motions]
    lines += [
        series("Fig. 10, ANCF: end at 0, 0.05, ... 1 s [m]", "curve", np.array(reference["ancf"]["tip"]), _tip(ancf), 1e-8),
        bound("Fig. 9, stiffened floating frame against ANCF: angle [rad]", "agree", "below 5e-4", float(apart[2][0].max()), 5e-4),
        bound("Fig. 10, stiffened floating frame against ANCF: offset [m]", "agree", "below 1.5e-4", float(apart[2][1].max()), 1.5e-4),
        bound("Fig. 9, linear floating frame against ANCF: angle [rad]", "agree", "about 0.010", float(apart[1][0].max()), 0.0125),
        *(drift(times, apart[1][1], until, expected) for until, expected in ((0.1, 2.3e-4), (0.3, 2.4e-3), (0.8, 5.1e-3))),
    ]
    picture(times, motions, folder)
    return lines


def _tip(swing: Swing) -> np.ndarray:
    return swing.result.position(swing.rod.end, t=REFERENCE["floating_frame"]["ancf"]["t"])


def drift(times: np.ndarray, apart: np.ndarray, until: float, expected: float) -> Line:
    """The linear formulation's error, which grows."""
    found = float(apart[times <= until].max())
    what = f"Fig. 10, linear floating frame: error until {until} s [m]"
    return Line(what, "drift", f"{expected:.1e}", f"{found:.2e}", abs(found - expected), 0.1 * expected)


def picture(times: np.ndarray, motions: list[Motion], folder: Path) -> None:
    import matplotlib.pyplot as plt

    for k, (name, label) in enumerate((("figure_9", "angle at the pin [rad]"), ("figure_10", "offset of the end [m]"))):
        figure, axes = plt.subplots(layout="constrained")
        for motion, style, who in zip(motions, ("-", ":", "--"), ("ANCF", "floating frame, linear", "floating frame, stiffened")):
            axes.plot(times, motion[k], style, label=who)
        axes.set(xlabel="t [s]", ylabel=label, title=f"Fig. {name.split('_')[1]}: 0.4 m pendulum, E = 1e9 N/m$^2$")
        axes.legend()
        figure.savefig(folder / f"{name}.png", dpi=120)
        plt.close(figure)
