"""One scene, one word changed: every formulation that the paper discusses, on its pendulums and its cantilever.

Errors are distances of the end from the mesh-converged continuum (ANCF with continuum strains on the mesh given), the largest at 0.1, 0.2,
... 0.6 s (soft), 0.05, 0.1, ... 0.5 s (stiff) and 1, 2, ... 15 s (cantilever). Run times are of one run and of this machine.

The floating frame is for small deflections: right for the stiff pendulum, out of its range in the others. The large rotation vector shears
and its sections have inertia, which the others neglect: what is left on the fine mesh of the stiff pendulum and of the cantilever is that.
"""

from functools import partial
from time import perf_counter

import numpy as np
from figure_8 import cantilever
from figures_4_5 import pendulum

import mbd

WORDS = {
    "ANCF, continuum strains": (mbd.AncfCable, {}),
    "ANCF, local frame (1998)": (mbd.AncfCable, {"elasticity": "local_frame"}),
    "corotational (incremental)": (mbd.CorotationalBeam, {}),
    "large rotation vector": (mbd.GeometricallyExactBeam, {}),
    "floating frame, stiffened": (mbd.FloatingFrameBeam, {}),
    "floating frame, linear": (mbd.FloatingFrameBeam, {"stiffening": False}),
}
SCENES = {
    "soft pendulum": (pendulum, np.linspace(0.1, 0.6, 6), 120),
    "stiff pendulum": (partial(pendulum, L=0.4, E=1e9), np.linspace(0.05, 0.5, 10), 60),
    "cantilever": (cantilever, np.arange(1.0, 16.0), 120),
}


def compare(meshes: tuple[int, ...] = (10, 30)) -> dict[tuple[str, str, int], tuple[int, int, int, float, float]]:
    """(scene, formulation, elements): coordinates, degrees of freedom, steps, seconds, error [m]."""
    found = {}
    for scene_name, (make, times, finest) in SCENES.items():
        scene, rod = make(n=finest)
        limit = mbd.simulate(scene, float(times[-1]), rtol=1e-7).position(rod.end, t=times)
        for name, (beam, words) in WORDS.items():
            for n in meshes:
                scene, rod = make(beam=beam, n=n, **words)
                system, started = scene.build(), perf_counter()
                result = mbd.simulate(scene, float(times[-1]), rtol=1e-6)
                seconds = perf_counter() - started
                error = np.linalg.norm(result.position(rod.end, t=times) - limit, axis=1).max()
                found[scene_name, name, n] = (system.n, system.n - system.m, int(result.stats["steps"]), seconds, float(error))
    return found


def show(found: dict[tuple[str, str, int], tuple[int, int, int, float, float]]) -> str:
    lines = [f"{'scene':<14} {'formulation':<27} {'elements':>8} {'coordinates':>11} {'freedoms':>8} {'steps':>6} {'time [s]':>9} {'error [m]':>10}"]
    for (scene, name, n), (coordinates, freedoms, steps, seconds, error) in found.items():
        lines.append(f"{scene:<14} {name:<27} {n:>8} {coordinates:>11} {freedoms:>8} {steps:>6} {seconds:>9.2f} {error:>10.1e}")
    return "\n".join(lines)
