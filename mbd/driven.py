"""Kinematics and inverse dynamics of mechanisms whose every motion is driven: no integration, each instant is solved for by itself."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .assembly import Assembly, announce
from .errors import SceneError, SimulationError
from .event import Events
from .kinematic_path import KinematicPath, work
from .parts import Part
from .result import Result
from .starts import starts, together
from .state import State
from .structure import dead_centres, free_motions
from .trajectory import Joined, Trajectory, joined

if TYPE_CHECKING:
    from .scene import Scene


def kinematics(scene: Scene, times: ArrayLike, *, start: State | None = None) -> KinematicResult:
    """Positions, velocities, accelerations, reactions and drive torques of a mechanism whose drives determine all of its motion.

    times   [n_t] [s], ascending: ``result.t``; values at other times within are solved for as well, not interpolated
    start   a state to set out from; None: the positions as described, at t = 0. It decides between the ways in which joints can close

    From there positions are followed continuously. ``result.reaction(motor)`` is the torque that the drive must exert: inverse dynamics.
    Raises SceneError where a motion is left free (it is named), or the start is a dead centre; SimulationError, with the partial result,
    where the mechanism cannot follow its drives or comes to a dead centre.
    """
    system, wanted = scene.build(), _checked(times)
    state = start or State(system.q0, system.v0)
    state.check(system)
    parts, clock = scene.parts(), time.perf_counter()
    begin = starts(parts, state)
    assembly = together(begin, parts, system.n)
    faults = [line for part in parts for line in _undriven(scene, part, assembly.state)]
    if faults:
        raise SceneError(faults)
    announce(assembly)
    pieces, trouble = _pieces(parts, begin, wanted)
    if not pieces:
        assert trouble is not None
        trouble.state = assembly.state
        raise trouble
    stats = {
        "solver": KinematicPath.name,
        "reason": "every motion is driven",
        "steps": len(wanted) - 1,
        "factorizations": sum(piece.linear.factorizations for piece in pieces),
        "wall time": time.perf_counter() - clock,
    }
    result = KinematicResult(scene, system, joined(pieces, system.n), stats, assembly, None, Events({}, {}))
    if trouble:
        trouble.result, trouble.state = result, result.final
        raise trouble
    return result


class KinematicResult(Result):
    """What ``kinematics`` found: a result like that of a run."""

    @cached_property
    def accounted(self) -> Trajectory | Joined:  # type: ignore[override]
        """The work of drives is integrated between the times with ten points of Gauss each."""
        return joined([replace(piece, work=work(piece)) for piece in self.trajectory.pieces()], self.system.n)

    def save(self, path: Any) -> None:
        raise ValueError("save: expected the result of mbd.simulate, found one of mbd.kinematics; solve again, or save result.t, .q and .v")


def _checked(times: ArrayLike) -> Array:
    wanted = np.atleast_1d(np.array(times, dtype=float))
    if wanted.ndim != 1 or not wanted.size or not np.isfinite(wanted).all() or np.any(np.diff(wanted) <= 0.0):
        raise SceneError(["times: expected one or more ascending finite times, found others; sort them"])
    return wanted


def _undriven(scene: Scene, part: Part, state: State) -> list[str]:
    """Complaints about motions that the drives of a part do not determine."""
    system = part.system
    free = free_motions(scene, part, state)
    if not free:
        return []
    stuck = dead_centres(scene, part, state)
    if stuck and system.m >= system.n:
        names = ", ".join(map(repr, stuck))
        return [f"joints {names}: expected a start away from dead centres, found one at which they leave free: {'; '.join(free)}; move the start"]
    return [f"scene: expected a drive for every motion, found free: {'; '.join(free)}; drive it by a Motor or Prescribed, or use mbd.simulate"]


def _pieces(parts: Sequence[Part], begin: Sequence[Assembly], times: Array) -> tuple[list[Trajectory], SimulationError | None]:
    """The way of every part; where one cannot follow, the others go on to that time only."""
    pieces, trouble = [], None
    for part, assembly in zip(parts, begin):
        path = KinematicPath(part, assembly)
        states = []
        try:
            states.append(path.reach(path.first(), float(times[0])))
            for t in times[1:]:
                states.append(path.reach(states[-1], float(t)))
        except SimulationError as error:
            trouble = error
        if not states:
            return [], trouble
        times = times[: len(states)]
        t, q, v = (np.array([getattr(state, name) for state in states]) for name in "tqv")
        pieces.append(Trajectory(part, t, q, v, np.zeros(len(t)), states, KinematicPath.name, path, assembly.linear))
    return pieces, trouble
