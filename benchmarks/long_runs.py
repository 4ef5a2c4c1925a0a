"""``python -m benchmarks.long_runs [--case NAME ...] [--periods N] [--budget S] [--out FILE]``: pendulums over very many periods.

A rigid rod falls from the horizontal; a rod that bends and stretches swings from 0.5 rad. How far the phase is off, and how far energy and
joints went astray on the way, by each method. The rigid phase is compared with elliptic integrals at the end, the elastic one, after 20
periods, with a run of shorter steps and higher order on the same mesh. Rows are merged into docs/long_runs.json, from which long_runs.md is
written: an interrupted run goes on with --case and --method.
"""

from __future__ import annotations

import argparse
import json
import re
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ellipk

import mbd

from . import report
from .tables import table

OUT = Path(__file__).resolve().parents[1] / "docs" / "long_runs.md"
LOST = 0.1, 1.0
"""A phase farther off, in periods, or where energy errors times periods exceed this, is no longer told: it may be whole periods off, as periods
change by less than half the share that energies are off by."""

GRAVITY, CHUNK = 9.81, 100
"""Runs go on from their last state after so many periods: nothing but what is asked for is kept."""


@dataclass(frozen=True)
class Pendulum:
    """A case: a scene and what turns in it; a period [s] of the rigid one; for how many of them it runs; after how many the phase is compared,
    None: a quarter beyond the end, with the exact one, a rod that hangs down."""

    build: Callable[[], tuple[mbd.Scene, Any]]
    period: float
    periods: int
    compared: float | None


@dataclass(frozen=True)
class Row:
    """What one method did. ``energy`` relative to what is exchanged, joints as in an audit; the angle where the phase is compared, and its rate."""

    case: str
    method: str
    periods: float
    energy: float
    position_drift: float
    velocity_drift: float
    steps: int
    seconds: float
    angle: float
    rate: float
    where: str


def rigid() -> tuple[mbd.Scene, Any]:
    scene = mbd.Scene((0, -GRAVITY))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="rod"))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    return scene, rod


def elastic() -> tuple[mbd.Scene, Any]:
    """Two elements, a thousand times as stiff as the soft pendulum of Escalona, Hussien and Shabana (1998)."""
    scene, end = mbd.Scene((0, -GRAVITY)), 1.2 * np.array((np.sin(0.5), -np.cos(0.5)))
    rod = scene.add(mbd.AncfCable((0, 0), end, n_elements=2, E=0.7e9, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    return scene, rod.start


def period(length: float, amplitude: float) -> float:
    """Of a uniform rigid rod, by the complete elliptic integral."""
    return float(4.0 * ellipk(np.sin(0.5 * amplitude) ** 2) / np.sqrt(1.5 * GRAVITY / length))


CASES = {
    "rigid": Pendulum(rigid, period(1.0, 0.5 * np.pi), 10000, None),
    "elastic": Pendulum(elastic, period(1.2, 0.5), 1000, 20.25),
}


def methods(case: str) -> dict[str, tuple[Any, float]]:
    """(solver, rtol) of each; steps are shares of a period."""
    T = CASES[case].period
    if case == "rigid":
        return {
            "default, rtol 1e-6": (None, 1e-6),
            "default, rtol 1e-10": (None, 1e-10),
            "Radau, rtol 1e-8": (mbd.Radau(), 1e-8),
            "Gauss, 4 stages, T/20": (mbd.Gauss(T / 20, stages=4), 1e-6),
            "generalized alpha, rho 1, T/100": (mbd.GeneralizedAlpha(T / 100, rho_inf=1.0), 1e-6),
            "generalized alpha, rho 0.8, T/100": (mbd.GeneralizedAlpha(T / 100, rho_inf=0.8), 1e-6),
        }
    return {
        REFERENCE: (mbd.Gauss(T / 320, stages=4, samples=8), 1e-6),
        "default, rtol 1e-6": (None, 1e-6),
        "Radau, rtol 1e-8": (mbd.Radau(), 1e-8),
        "Gauss, 2 stages, 8 samples, T/80": (mbd.Gauss(T / 80, stages=2, samples=8), 1e-6),
        "generalized alpha, rho 1, T/200": (mbd.GeneralizedAlpha(T / 200, rho_inf=1.0), 1e-6),
        "generalized alpha, rho 0.8, T/200": (mbd.GeneralizedAlpha(T / 200, rho_inf=0.8), 1e-6),
    }


REFERENCE, SHORT = "Gauss, 4 stages, 8 samples, T/320 (reference)", 21
"""It runs for so many periods only."""


def swing(case: str, method: str, periods: int | None = None, budget: float = np.inf) -> Row:
    """One run, in chunks, to a quarter of a period beyond a whole number, or to the chunk in which the budget [s] of processor time ends."""
    pendulum, (solver, rtol) = CASES[case], methods(case)[method]
    count = periods or (SHORT if method == REFERENCE else pendulum.periods)
    (scene, item), state, clock = pendulum.build(), None, time.process_time()
    first = exchanged = energy = position = velocity = angle = rate = 0.0
    steps = 0
    for start in range(0, count, CHUNK):
        reached = min(start + CHUNK, count)
        end = (reached + (0.25 if reached == count else 0.0)) * pendulum.period
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mbd.SceneWarning)  # an imbalance is what is measured here
            result = mbd.simulate(scene, t_end=end, rtol=rtol, solver=solver, start=state)
        total, state = result.energy.total, result.final
        if start == 0:
            first, exchanged = float(total[0]), float(np.ptp(result.energy.potential))
        energy = max(energy, float(np.max(np.abs(total - first))) / exchanged)
        position, velocity = max(position, result.audit.position_drift), max(velocity, result.audit.velocity_drift)
        steps += result.stats["steps"]
        over = time.process_time() - clock > budget
        if pendulum.compared is None and (over or reached == count):
            angle, rate = _turning(result, item, end if reached == count else (reached - 0.75) * pendulum.period)
        elif start == 0 and pendulum.compared is not None and pendulum.compared * pendulum.period <= end:
            angle, rate = _turning(result, item, pendulum.compared * pendulum.period)
        if over and reached < count:
            count = reached
            break
    return Row(case, method, count, energy, position, velocity, steps, time.process_time() - clock, angle, rate, report.machine())


def _turning(result: mbd.Result, item: Any, t: float) -> tuple[float, float]:
    """Angle and angular velocity at a time; the latter, which need not be accurate, by differences."""
    h = 1e-4 * (result.t[-1] - result.t[-2])
    now, before = result.angle(item, [t, t - h])
    return float(now), float((now - before) / h)


def peer(periods: int | None = None) -> Row:
    """Exudyn's generalized alpha on the rigid pendulum with 100 steps to a period."""
    import exudyn as exu

    from .exudyn_scenes import Out, _Planar

    pendulum = CASES["rigid"]
    count, plane = periods or pendulum.periods, _Planar(GRAVITY)
    body = plane.body(1.0, 1.0 / 12.0, (0.5, 0.0))
    plane.pin(plane.point(plane.ground_body, (0, 0)), plane.point(body, (-0.5, 0)))
    mbs = plane.mbs
    words = {"bodyNumber": body, "storeInternal": True, "writeToFile": False}
    kinds = (Out.Rotation, Out.AngularVelocity)
    sensors = [mbs.AddSensor(exu.itemInterface.SensorBody(outputVariableType=kind, **words)) for kind in kinds]
    mbs.Assemble()
    settings, end = exu.SimulationSettings(), (count + 0.25) * pendulum.period
    settings.timeIntegration.numberOfSteps = 100 * count + 25
    settings.timeIntegration.endTime = end
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
    settings.solutionSettings.sensorsWritePeriod = end / (100 * count + 25)
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.newton.relativeTolerance, settings.timeIntegration.newton.absoluteTolerance = 1e-10, 1e-12
    clock = time.process_time()
    mbs.SolveDynamic(settings)
    seconds = time.process_time() - clock
    angles, speeds = (np.array(mbs.GetSensorStoredData(sensor))[:, -1] for sensor in sensors)
    total = speeds**2 / 6.0 + 0.5 * GRAVITY * np.sin(angles)
    energy = float(np.max(np.abs(total - total[0]))) / (0.5 * GRAVITY)
    steps = 100 * count + 25
    return Row("rigid", EXUDYN, count, energy, np.nan, np.nan, steps, seconds, float(angles[-1]), float(speeds[-1]), report.machine())


EXUDYN = "Exudyn, generalized alpha, rho 0.8, T/100"


def page(rows: Sequence[Row]) -> str:
    """All rows measured so far, as Markdown."""
    parts = [
        "# Pendulums over very many periods",
        "Written by `python -m benchmarks.long_runs`. Phase: how much the pendulum is ahead (+) or behind (-), in periods. Energy: its largest "
        "error over what is exchanged in a swing. Positions, velocities: drift of the joints, of the length and of the speed. A run whose number "
        "of periods is less than the case's was ended by `--budget`.",
    ]
    for case, pendulum in CASES.items():
        shown = [row for row in rows if row.case == case]
        lowest = -0.5 * np.pi if pendulum.compared is None else next((row.angle for row in shown if row.method == REFERENCE), np.nan)
        what = "the exact solution" if pendulum.compared is None else f"the reference run of the same mesh, after {pendulum.compared:g} periods"
        parts.append(f"## The {case} pendulum: {pendulum.periods} periods of {pendulum.period:.4g} s, phase against {what}")
        head = ["method", "periods", "phase", "energy", "positions", "velocities", "steps", "processor [s]"]
        parts.append(table(head, [_cells(row, lowest, pendulum.period) for row in shown]))
    return "\n\n".join([*parts, "## Machine", "\n".join(f"- {place}" for place in dict.fromkeys(map(_machine, rows)))]) + "\n"


def _machine(row: Row) -> str:
    """Without its load: processor time is what is told."""
    return re.sub(r"load \S+ at the start; ", "", row.where)


def _cells(row: Row, lowest: float, period: float) -> list[str]:
    phase = np.nan if row.method == REFERENCE else (row.angle - lowest) / row.rate / period
    if abs(phase) > LOST[0] or row.energy * (CASES[row.case].compared or row.periods) > LOST[1]:
        phase = np.inf
    numbers = [phase, row.energy, row.position_drift, row.velocity_drift]
    shown = ["lost" if x == np.inf else "" if not np.isfinite(x) else f"{x:.1e}" for x in numbers]
    return [row.method, f"{row.periods:g}", *shown, f"{row.steps}", f"{row.seconds:.0f}"]


def main(given: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.long_runs", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", nargs="+", default=list(CASES), choices=list(CASES))
    parser.add_argument("--method", nargs="+", help="parts of methods' names; default: all")
    parser.add_argument("--periods", type=int, help="instead of 10000 and 1000; nothing is written then unless --out is given")
    parser.add_argument("--budget", type=float, default=np.inf, help="a run ends after so many seconds of processor time, and says how far it got")
    parser.add_argument("--out", type=Path, help=f"the page; default {OUT.relative_to(OUT.parents[1])}")
    options = parser.parse_args(given)
    out = options.out or (None if options.periods else OUT)
    store = out.with_suffix(".json") if out else None
    rows = {(row["case"], row["method"]): Row(**row) for row in (json.loads(store.read_text()) if store and store.exists() else [])}
    for case in options.case:
        names = [*methods(case), *([EXUDYN] if case == "rigid" else [])]
        for name in (name for name in names if not options.method or any(part in name for part in options.method)):
            row = peer(options.periods) if name == EXUDYN else swing(case, name, options.periods, options.budget)
            rows[case, name] = row
            print(row, flush=True)
            if out and store:
                store.write_text(json.dumps([asdict(each) for each in rows.values()], indent=1) + "\n")
                out.write_text(page(list(rows.values())))
    print(page(list(rows.values())))


if __name__ == "__main__":
    main()
