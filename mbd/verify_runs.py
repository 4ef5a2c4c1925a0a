"""The runs behind ``verify``: three of one scene, from coarse to fine, at times that all of them share.

Adaptive solvers take the tolerances 100 rtol, rtol and rtol/10, so far apart that errors follow them in spite of their irregularities. The first
is cheap; above LOOSEST, where other things than the tolerance limit steps, it is left out. The last is taken less tight where work grows so fast
that all three would cost more than SPENT times the one in the middle. Solvers with fixed steps take 2 h, h and h/2.

Values between steps cost as much as steps: runs are compared at few times, steps of the finest one, and the coarsest at every third of them only.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .affine import Array
from .errors import SimulationError
from .result import Result
from .run import simulate
from .state import State

if TYPE_CHECKING:
    from .scene import Scene

LOOSER, TIGHTER, LOOSEST, TIGHTEST = 100.0, 10.0, 1e-3, 1e-14
APART = 30.0
"""The coarsest run's tolerance is at least so many times rtol, or there is none."""
SPENT = 2.85
"""Work of all runs over that of the one asked for, by forecast; comparing them comes on top."""
SHARE, FEWEST, MOST = 0.1, 6, 200
"""Runs are compared at this share of the finest one's steps, within these numbers."""
EVERY = 3
"""Of these times, the last among them, one in so many serves the coarsest run."""


@dataclass(frozen=True, eq=False)
class Ladder:
    """Runs from coarse to fine, the coarsest None where it failed or was left out; their tolerances or steps [s]; the order of fixed steps,
    None of others."""

    coarse: Result | None
    runs: tuple[Result, Result]
    settings: tuple[float, float, float]
    order: int | None

    @property
    def ratios(self) -> tuple[float, float]:
        return self.settings[0] / self.settings[1], self.settings[1] / self.settings[2]

    def times(self) -> Array:
        """Of comparison: steps of the finest run that are spread evenly; of fixed steps, those of the coarsest, which all have."""
        own = (self.runs[1] if self.order is None else self.coarse or self.runs[0]).trajectory.t
        count = min(max(round(SHARE * own.size), FEWEST), MOST, own.size)
        return own[np.unique(np.round(np.linspace(0, own.size - 1, count)).astype(int))]


def climb(scene: Scene, t_end: float, rtol: float, solver: Any, t_eval: ArrayLike | None, start: State | None) -> Ladder:
    """The three runs. Raises SimulationError where one of the two finer ones stops."""
    step = getattr(solver, "step", None)

    def run(setting: float, times: ArrayLike | None = None) -> Result:
        chosen = solver if step is None else replace(solver, step=setting)
        return simulate(scene, t_end, rtol=setting if step is None else rtol, solver=chosen, t_eval=times, start=start)

    middle = rtol if step is None else float(step)
    result = run(middle)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # all runs would warn of the same
        coarse = min(LOOSER * rtol, LOOSEST) if step is None else 2.0 * middle
        first: Result | None = None
        if step is not None or coarse >= APART * rtol:
            with suppress(SimulationError):
                first = run(coarse)
        fine = max(middle / _factor(first, result, coarse / rtol), TIGHTEST) if step is None else 0.5 * middle
        finest = run(fine, t_eval)
    return Ladder(first, (result, finest), (coarse, middle, fine), _order(solver, rtol) if step is not None else None)


def _order(solver: Any, rtol: float) -> int:
    return int(solver.integrator(rtol).order)


def _factor(loose: Result | None, result: Result, ratio: float) -> float:
    """How much tighter the finest run may be: as work has grown from the loose run to this one, forecast to go on."""
    if loose is None:
        return TIGHTER
    work = result.stats["newton iterations"] / max(loose.stats["newton iterations"], 1)
    per_decade = max(work ** (1.0 / np.log10(ratio)), 1.0 + 1e-9)
    left = SPENT - 1.0 - 1.0 / work
    return float(10.0 ** min(1.0, np.log(left) / np.log(per_decade))) if left > 1.0 else TIGHTER**0.5


class Compared(NamedTuple):
    """Runs as results at common times [k]: the middle and the finest one, and others, of other meshes; the coarsest, if there is one, only
    at those which ``seldom`` counts."""

    times: Array
    coarse: Result | None
    seldom: NDArray[np.intp]
    middle: Result
    fine: Result
    others: list[Result]


def compared(ladder: Ladder, others: Sequence[Result]) -> Compared:
    """Times at which one of the runs has no values (a singular position between steps) are left out."""
    times, (middle, fine, *more) = sampled([*ladder.runs, *others], ladder.times())
    seldom = np.arange(times.size)[::-EVERY][::-1]
    if ladder.coarse is None:
        return Compared(times, None, seldom, middle, fine, more)
    few, (coarse,) = sampled([ladder.coarse], times[seldom])
    return Compared(times, coarse, np.searchsorted(times, few), middle, fine, more)


def sampled(runs: Sequence[Result], times: Array) -> tuple[Array, list[Result]]:
    """Runs as results at those of the times at which all of them have values."""
    motions = [_motion(run, times) for run in runs]
    good = np.all([np.isfinite(q).all(axis=1) for q, _ in motions], axis=0)
    return times[good], [
        Result(run.scene, run.system, run.trajectory, run.stats, run.assembly, (times[good], q[good], v[good]), run.events)
        for run, (q, v) in zip(runs, motions)
    ]


def _motion(run: Result, times: Array) -> tuple[Array, Array]:
    """q, v [k, n]; NaN where they cannot be found."""
    try:
        return run.trajectory.at(times)
    except ArithmeticError:
        q, v = np.full((times.size, run.system.n), np.nan), np.full((times.size, run.system.n), np.nan)
        for k in range(times.size):
            with suppress(ArithmeticError):
                q[k : k + 1], v[k : k + 1] = run.trajectory.at(times[k : k + 1])
        return q, v
