"""Runs of Exudyn: its settings, its sweeps, and the time of its solver alone."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import exudyn as exu
import numpy as np

from . import exudyn_scenes
from .exudyn_scenes import Machine
from .scenes import Case
from .work import FINEST, Ladder, Rung, Sample

EXPLICIT = {"RK44": exu.DynamicSolverType.RK44, "RK67": exu.DynamicSolverType.RK67}
VERSION = f"Exudyn {exu.__version__}"


def _settings(case: Case, steps: int) -> Any:
    """One thread, no files, modified Newton, no adaptive steps; sparse or dense algebra and updates of the Jacobian by the kind of scene."""
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 2.0 * case.t_end
    settings.parallel.numberOfThreads = 1
    settings.linearSolverType = exu.LinearSolverType.EigenSparse if case.sparse else exu.LinearSolverType.EXUdense
    integration = settings.timeIntegration
    integration.verboseMode, integration.stepInformation = 0, 0
    integration.endTime, integration.numberOfSteps = case.t_end, steps
    integration.adaptiveStep = False
    integration.newton.useModifiedNewton = True
    integration.newton.modifiedNewtonJacUpdatePerStep = not case.beam
    return settings


def _timed(machine: Machine, settings: Any, solver: Any) -> Sample:
    """Exudyn reports success by True alone; whatever else happens is a failed run."""
    clock = time.perf_counter()
    try:
        done = machine.system.SolveDynamic(settings, solverType=solver, showHints=False, storeSolver=True)
    except Exception as error:  # of several kinds; the note is all there is to tell
        return Sample(time.perf_counter() - clock, None, note=f"{type(error).__name__}")
    seconds = time.perf_counter() - clock
    value = machine.output()
    if not done or not np.isfinite(value).all():
        return Sample(seconds, None, note="failed")
    solver_object = machine.system.sys["dynamicSolver"]
    counts = {"steps": settings.timeIntegration.numberOfSteps, "newton iterations": solver_object.it.newtonStepsCount}
    return Sample(seconds, value, counts)


def implicit(case: Case, steps: int, tolerances: tuple[float, float], radius: float | None) -> Sample:
    """Generalized-alpha with a spectral radius; None: the trapezoidal rule with constraints on velocities."""
    settings = _settings(case, steps)
    newton = settings.timeIntegration.newton
    newton.relativeTolerance, newton.absoluteTolerance = tolerances
    solver = exu.DynamicSolverType.TrapezoidalIndex2
    if radius is not None:
        settings.timeIntegration.generalizedAlpha.spectralRadius, solver = radius, exu.DynamicSolverType.GeneralizedAlpha
    return _timed(getattr(exudyn_scenes, case.peer)(*case.arguments), settings, solver)


def tree(case: Case, steps: int, method: str) -> Sample:
    settings = _settings(case, steps)
    return _timed(exudyn_scenes.chain_tree(case.chain), settings, EXPLICIT[method])


def _grid(first: int, run: Callable[[int], Sample]) -> Iterator[Rung]:
    for k in range(FINEST):
        steps = first * 2**k
        yield Rung(f"{steps} steps", lambda steps=steps: run(steps))


def ladders(case: Case) -> list[Ladder]:
    """Implicit methods with tight and loose Newton tolerances; for chains also the kinematic tree with explicit Runge-Kutta methods."""
    found = [
        Ladder("Exudyn", f"{method}, {NAMES[tolerances[0]]}", _grid(case.steps, lambda n, t=tolerances, r=radius: implicit(case, n, t, r)))
        for method, radius in METHODS.items()
        for tolerances in case.newton
    ]
    if 0 < case.chain <= LONGEST_TREE:
        first = max(case.steps, case.chain) // 4
        found += [Ladder("Exudyn tree", name, _grid(first, lambda n, m=name: tree(case, n, m))) for name in EXPLICIT]
    return found


NAMES = {1e-8: "tight", 1e-6: "steel", 1e-5: "loose"}
"""Newton tolerances by the relative one; tight is Exudyn's default, steel what stiff beams need."""
METHODS = {"gen. alpha 0.9": 0.9, "gen. alpha 0.6": 0.6, "trapezoidal, index 2": None}
"""Spectral radii: Exudyn's default 0.9 fails at coarse steps of some rigid scenes, where 0.6 succeeds."""
LONGEST_TREE = 100  # its mass matrix is dense: one evaluation of a tree of 1000 links takes 0.5 s, a run would take minutes
