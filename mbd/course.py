"""A run on its way: its parts step by step, always the one that is furthest behind, and the result of what they reached."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .assembly import Assembly
from .checkpoint import Checkpoint
from .errors import Interrupted, SimulationError
from .event import Events
from .interruption import quietly
from .leg import Leg
from .progress import Plan, Progress
from .result import Result
from .trajectory import joined

if TYPE_CHECKING:
    from .scene import Scene


class Course:
    """The legs of a scene."""

    def __init__(self, scene: Scene, plan: Plan, assembly: Assembly, legs: Sequence[Leg]):
        self.scene, self.plan, self.assembly, self.legs = scene, plan, assembly, legs

    def finish(self, bar: Callable[[float], None] | None, checkpoint: Checkpoint | None) -> Result:
        """To the end. Raises SimulationError or Interrupted, with the partial result, which is in the checkpoint's file then as well."""
        error: SimulationError | Interrupted | None = None
        try:
            self._go(bar, checkpoint)
            result, error = self._answered()
        except KeyboardInterrupt:
            result = self.result(None)
            error = Interrupted(result)
            quietly()
        if checkpoint:
            checkpoint.write(result)
        if error:
            raise error
        return result

    def _go(self, bar: Callable[[float], None] | None, checkpoint: Checkpoint | None) -> None:
        """Every part to the end, or, where one stops early, to that time."""
        queue, end = [(leg.t, k) for k, leg in enumerate(self.legs)], np.inf
        heapq.heapify(queue)
        while queue:
            t, k = heapq.heappop(queue)
            if t >= end:
                continue
            leg = self.legs[k]
            if leg.advance():
                heapq.heappush(queue, (leg.t, k))
            elif leg.trouble:
                end = min(end, leg.t)
            if bar:
                bar(min(leg.t for leg in self.legs))
            if checkpoint:
                checkpoint.perhaps(lambda: self.result(None))

    def _answered(self) -> tuple[Result, SimulationError | None]:
        """The result at the times that were asked for, or as far as it is, and what stopped it."""
        trouble = min((leg for leg in self.legs if leg.trouble), key=lambda leg: leg.t, default=self.legs[0]).trouble
        try:
            result = self.result(self.plan.t_eval)
        except SimulationError as error:  # no values between steps
            trouble, result = trouble or error, self.result(None)
        if trouble:
            trouble.result, trouble.state = result, result.final
            trouble.time = result.final.t if trouble.time is None else trouble.time
        return result, trouble

    def result(self, t_eval: Array | None) -> Result:
        """Of what was reached."""
        stages = [leg.stage() for leg in self.legs]
        system, watch = self.scene.build(), self.legs[0].watch
        trajectory, stats = joined([stage.trajectory for stage in stages], system.n), _stats(self.legs)
        if watch:
            stats["ended by"] = watch.ended_by
        chosen = None
        if t_eval is not None:
            reached = t_eval[t_eval <= trajectory.t[-1]]
            chosen = (reached, *trajectory.at(reached))
        events = watch.events if watch else Events({}, {})
        return Result(self.scene, system, trajectory, stats, self.assembly, chosen, events, Progress(self.plan, tuple(stages)))


COUNTS = ("steps", "rejected", "failed", "newton iterations", "factorizations", "wall time")


def _stats(legs: Sequence[Leg]) -> dict[str, Any]:
    """Of one part its own; of several the sums, and under "parts" those of each."""
    each = [leg.stats() for leg in legs]
    if len(each) == 1:
        return each[0]
    said = {name: "; ".join(dict.fromkeys(stats[name] for stats in each)) for name in ("solver", "linear algebra", "reason")}
    sums = {name: sum(stats[name] for stats in each) for name in COUNTS}
    parts = [{"items": list(leg.part.items)} | stats for leg, stats in zip(legs, each)]
    worst = {"coarseness": max(stats["coarseness"] for stats in each)}
    leapt = {"leapt over": [name for stats in each for name in stats["leapt over"]]}
    return said | {"rtol": each[0]["rtol"]} | sums | worst | leapt | {"parts": parts}
