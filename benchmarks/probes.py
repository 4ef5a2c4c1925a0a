"""What ``scaling.py`` measures in a process of its own: ``python -m benchmarks.probes NAME NUMBERS...`` prints one line of JSON.

Nothing is imported before the clock of ``start`` runs.
"""

from __future__ import annotations

import gc
import sys
import time
from typing import Any

RTOL = 1e-6
SPENT = 0.5
"""A run is repeated until so many seconds have gone by, at least once more; the fastest counts."""
SPAN = {"pendulum": 0.03, "chain": 0.05}
"""Simulated time [s]: about ten steps, six steps."""


def start() -> dict[str, float]:
    """Seconds to import mbd, to build the main job's scene, and for its first steps; once more in the warm process, for what was imports."""
    begin, used = time.perf_counter(), time.process_time()
    import mbd

    imported = time.perf_counter()

    def through_first_steps() -> None:
        scene = mbd.Scene(gravity=(0.0, -9.81))
        rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=30, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
        scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
        mbd.simulate(scene, t_end=1e-6)

    through_first_steps()
    cold, used = time.perf_counter(), time.process_time() - used
    through_first_steps()
    warm = time.perf_counter() - cold
    parts = {"import mbd": imported - begin, "other imports": cold - imported - warm, "building and stepping": warm}
    return {"total": cold - begin, "on the processor": used} | parts


def size(kind: str, count: str) -> dict[str, Any]:
    """A scene of so many elements or links: seconds to build it, and for each method microseconds per iteration and peak memory."""
    import mbd

    from . import scenes

    make = {"pendulum": lambda n: scenes.pendulum(scenes.machines.SOFT, n)[0], "chain": lambda n: scenes.chain(n)[0]}[kind]
    methods: dict[str, Any] = {"Dormand-Prince": mbd.DormandPrince()} if kind == "chain" else {}
    methods |= {f"Radau {s}": mbd.Radau(s) for s in (3, 5, 7)}
    for solver in methods.values():
        mbd.simulate(make(2), 1e-3, solver=solver)  # loads what is imported late, before memory is counted
    before, clock = peak(), time.perf_counter()
    scene = make(int(count))
    described = time.perf_counter()
    n = scene.build().n
    built = time.perf_counter()
    found: dict[str, Any] = {"coordinates": n, "describe": described - clock, "build": built - described, "methods": {}}
    for name, solver in methods.items():
        found["methods"][name] = _timed(scene, SPAN[kind], solver, before)
    return found


def _timed(scene: Any, t_end: float, solver: Any, before: float | None = None) -> dict[str, Any]:
    """The fastest of some runs; kB per coordinate above ``before`` without the stored steps (later methods also see the peak of earlier)."""
    import mbd

    clock, runs = time.perf_counter(), 0
    best: dict[str, Any] = {}
    while runs < 2 or time.perf_counter() - clock < SPENT:
        try:
            result = mbd.simulate(scene, t_end, rtol=RTOL, solver=solver)
        except mbd.SimulationError as error:
            return {"failed": str(error)}
        runs += 1
        stats, stored = result.stats, _stored(result)
        if not best or stats["wall time"] < best["wall time"]:
            best = {key: stats[key] for key in ("wall time", "steps", "newton iterations", "factorizations", "linear algebra")}
        del result
        gc.collect()  # its cycles, with the states stored in them
    best["us"] = 1e6 * best["wall time"] / best["newton iterations"]
    if before is not None:
        best["kB"] = (peak() - before - stored) / 1024.0 / scene.build().n
    return best


def _stored(result: Any) -> float:
    """Bytes of the accepted steps that a result keeps: each solver state, and q and v once more as arrays."""
    states = result.trajectory.states
    return sum(x.nbytes for state in states for x in (state.q, state.v, state.multipliers, state.stress)) + 2.0 * result.q.nbytes


def peak() -> float:
    """The largest resident memory of this process so far [bytes]. (On Linux getrusage may report the parent's.)"""
    try:
        with open("/proc/self/status") as status:
            return 1024.0 * next(float(line.split()[1]) for line in status if line.startswith("VmHWM"))
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1.0 if sys.platform == "darwin" else 1024.0)


def star(arms: str, elements: str) -> dict[str, Any]:
    """A hub with arms pinned to it, rigid rods or cables: format, entries and fill of the KKT matrix, and the time of its factorisation."""
    import mbd

    scene = _star(int(arms), int(elements))
    found: dict[str, Any] = _matrix(scene)
    default = None if int(elements) else mbd.DormandPrince()
    for name, solver in {"default": default, "Radau 3": mbd.Radau(3), "Radau 7": mbd.Radau(7)}.items():
        found[name] = _timed(scene, 0.01, solver)
    return found


def _star(arms: int, elements: int) -> Any:
    import numpy as np

    import mbd

    scene = mbd.Scene(gravity=(0.0, -9.81))
    hub = scene.add(mbd.RigidBody(mass=1.0, inertia=0.1, position=(0.0, 0.0)))
    scene.add(mbd.Pin(hub.at(0, 0), scene.ground.at(0, 0)))
    for angle in 2.0 * np.pi * np.arange(arms) / arms:
        along = np.array([np.cos(angle), np.sin(angle)])
        if elements:
            arm = scene.add(mbd.AncfCable(0.2 * along, 1.2 * along, n_elements=elements, E=1e7, A=1e-4, I=1e-9, rho=1000.0))
            end = arm.start
        else:
            arm = scene.add(mbd.RigidBody.rod(0.2 * along, 1.2 * along, mass=0.1))
            end = arm.at(-0.5, 0)
        scene.add(mbd.Pin(end, hub.at(*(0.2 * along))))
    return scene


def _matrix(scene: Any) -> dict[str, Any]:
    """Of mass and joints at the start, by scipy alone but for the time."""
    import numpy as np
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee
    from scipy.sparse.linalg import splu

    from mbd.assembly import prepare

    system = scene.build()
    n, m, joints = system.n, system.m, system.joints
    gradient = joints.at(system.q0).gradient
    linear, _ = prepare(system, system.q0)
    tangent = linear.tangent(gradient)
    times = []
    for _ in range(5):
        clock = time.perf_counter()
        linear.factor(tangent)
        times.append(time.perf_counter() - clock)
    rows = np.concatenate((system.mass_rows, joints.rows + n, joints.cols))
    cols = np.concatenate((system.mass_cols, joints.cols, joints.rows + n))
    matrix = coo_array((np.concatenate((system.mass_values, gradient, gradient)), (rows, cols)), shape=(n + m, n + m)).tocsc()
    order = reverse_cuthill_mckee(matrix, symmetric_mode=True)
    place = np.argsort(order)
    half = int(np.max(np.abs(place[rows] - place[cols])))
    lu = splu(matrix, permc_spec="COLAMD")
    return {
        "unknowns": n + m, "format": linear.format.name, "entries": int(matrix.nnz), "fill": int(lu.L.nnz + lu.U.nnz),
        "half bandwidth": half, "band": (n + m) * (3 * half + 1), "factor": min(times)}  # fmt: skip


if __name__ == "__main__":
    name, *numbers = sys.argv[1:]
    known: Any = {"start": start, "size": size, "star": star}
    measured = known[name](*numbers)
    import json

    print(json.dumps(measured))
