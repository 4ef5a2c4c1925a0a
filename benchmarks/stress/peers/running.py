"""Runs of Exudyn with the settings that its users would try, one after the other."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import exudyn as exu
import numpy as np

from ...exudyn_scenes import Machine, cable, empty, items, node_position
from ..family import PeerFailure

SHORTEST = 1e-2
"""How far its adaptive steps may shrink, as a share of the step given: runs that go below take minutes."""

MAKE = Callable[[], Machine]
Attempts = Iterator[Callable[[], float]]


def _settings(t_end: float, steps: int, sparse: bool) -> Any:
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 2.0 * t_end
    settings.parallel.numberOfThreads = 1
    settings.linearSolverType = exu.LinearSolverType.EigenSparse if sparse else exu.LinearSolverType.EXUdense
    for part in (settings.timeIntegration, settings.staticSolver):
        part.verboseMode, part.stepInformation = 0, 0
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = t_end, int(steps)
    settings.timeIntegration.minimumStepSize = SHORTEST * t_end / steps
    return settings


def _finished(solve: Callable[[], bool], machine: Machine) -> np.ndarray:
    """The output of a run that Exudyn calls a success."""
    exu.SetWriteToConsole(False)
    try:
        done = solve()
    except Exception as error:  # of several kinds; the text is all there is to tell
        text = re.sub(r" *\[Python file [^\]]*\]", "", str(error))  # where on this machine its caller lies
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        raise PeerFailure(lines[0] if lines else type(error).__name__) from None
    if not done:
        raise PeerFailure("the solver returned False")
    return machine.output()


def dynamic(
    make: MAKE,
    t_end: float,
    steps: int,
    *,
    radius: float | None = 0.9,
    loose: bool = False,
    newton: tuple[float, float] | None = None,
    sparse: bool = False,
    start: float = 0.0,
) -> np.ndarray:
    """The output t_end after the start, by generalized-alpha with a spectral radius (None: the trapezoidal rule, index 2), with its adaptive
    steps; Newton's relative and absolute tolerances by default, given, or loose."""
    machine, settings = make(), _settings(t_end, steps, sparse)
    integration = settings.timeIntegration
    integration.startTime, integration.endTime = start, start + t_end
    if newton or loose:
        integration.newton.relativeTolerance, integration.newton.absoluteTolerance = newton or (1e-6, 1e-5)
    solver = exu.DynamicSolverType.TrapezoidalIndex2
    if radius is not None:
        integration.generalizedAlpha.spectralRadius, solver = radius, exu.DynamicSolverType.GeneralizedAlpha
    return _finished(lambda: machine.system.SolveDynamic(settings, solverType=solver, showHints=False), machine)


def attempts(make: MAKE, t_end: float, steps: int, error: Callable[[np.ndarray], float], *, sparse: bool = False) -> Attempts:
    """Its default, eight times the steps, looser Newton tolerances, more numerical damping with them, and the trapezoidal rule."""
    for options in (
        {"steps": steps},
        {"steps": 8 * steps},
        {"steps": 8 * steps, "loose": True},
        {"steps": 8 * steps, "loose": True, "radius": 0.6},
        {"steps": 8 * steps, "radius": None},
    ):
        yield lambda options=options: float(error(dynamic(make, t_end, sparse=sparse, **options)))  # type: ignore[misc]


def static(make: MAKE, error: Callable[[np.ndarray], float], *, sparse: bool = False) -> Attempts:
    """One load step, then 10 and 100, then 100 with looser tolerances."""

    def solve(steps: int, loose: bool) -> float:
        machine, settings = make(), _settings(1.0, 1, sparse)
        settings.staticSolver.numberOfLoadSteps = steps
        if loose:
            settings.staticSolver.newton.relativeTolerance, settings.staticSolver.newton.absoluteTolerance = 1e-6, 1e-5
        return float(error(_finished(lambda: machine.system.SolveStatic(settings, showHints=False), machine)))

    for steps, loose in ((1, False), (10, False), (100, False), (100, True)):
        yield lambda steps=steps, loose=loose: solve(steps, loose)  # type: ignore[misc]


def hinged(mbs: Any, nodes: Any) -> Machine:
    """A system whose first node is held where it is; the output is the position of the last one."""
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for k in (0, 1):
        held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, held]))
    mbs.Assemble()
    end = node_position(mbs, nodes[-1])
    return Machine(mbs, lambda: end()[:2])


def hinged_cable(given: Any, gravity: float, fractions: Any = None, damping: float = 0.0) -> Callable[[], Machine]:
    """Makes Exudyn's cable with its start held at the origin; the output is its end."""

    def make() -> Machine:
        mbs = empty()
        nodes = cable(mbs, given, gravity, fractions, damping)
        return hinged(mbs, nodes)

    return make
