"""The runs behind ``verify``: three of one scene, from coarse to fine, at times that all of them share.

Adaptive solvers take the tolerances 1000 rtol, rtol and rtol/10, so far apart that errors follow them in spite of their irregularities. The first
is cheap. It is not looser than LOOSEST, above which other things than the tolerance limit steps, and left out where that is too near. The last is
taken less tight where work grows so fast that all three would cost more than SPENT times the one in the middle, and by the same method. Solvers
with fixed steps take 2 h, h and h/2, which would cost 3.5 times the one in the middle before anything is compared:
2 h goes only as far as is paid for.

Values between steps cost as much as steps: runs are compared at steps of the finest one, as many as can be afforded, the coarsest at some of them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..affine import Array
from ..errors import SimulationError
from ..result import Result
from ..run import simulate
from ..state import State

if TYPE_CHECKING:
    from ..scene import Scene

LOOSER, TIGHTER, LEAST_TIGHTER, LOOSEST, TIGHTEST = 1000.0, 10.0, 3.0, 1e-3, 1e-14
APART = 30.0
"""The coarsest run's tolerance is at least so many times rtol, or there is none."""
SHORT = 20
"""Steps: shorter runs leave nothing to pay a third one with."""
SPENT, BY_STEPS, IN_ALL = 2.75, 3.2, 3.05
"""Work of all runs over that of the one asked for, by forecast, with tolerances and with fixed steps; and with their comparison, which is free
where steps are fixed."""
LEAST_SHARE = 0.25
"""Of the time, that the coarsest of fixed steps goes through."""
FEWEST, MOST = 6, 400
"""Runs are compared at so many times at least and at most."""
BETWEEN = 1.2
"""What a value between two steps costs, in steps."""
FACTORISATION = 8
"""What a factorisation with the derivatives in it costs, in Newton iterations."""
EVERY = 4
"""Of the times of comparison, the last among them, one in so many serves the coarsest run; but FEWEST at least, as an order seen at two is noise."""


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
        """Of comparison: steps of the finest run that are spread evenly; of fixed steps, those of the coarsest, which all have, and go on so."""
        own = self.runs[1].trajectory.t if self.order is None else self._shared()
        affordable = MOST if self.order is not None else self._affordable()
        count = min(max(affordable, FEWEST), MOST, own.size)
        return own[np.unique(np.round(np.linspace(0, own.size - 1, count)).astype(int))]

    def _shared(self) -> Array:
        middle = self.runs[0].trajectory.t
        if self.coarse is None:
            return middle
        coarse = self.coarse.trajectory.t
        return np.concatenate((coarse, middle[middle > coarse[-1]][1::2]))

    def _affordable(self) -> int:
        """So many times of comparison cost what the runs have left of IN_ALL."""
        works = [_work(run) for run in (self.coarse, *self.runs) if run is not None]
        readings = 1.0 if self.coarse is None else 1.0 + 1.0 / EVERY
        left = IN_ALL - sum(works) / _work(self.runs[0])
        return round(left * self.runs[0].stats["steps"] / (BETWEEN * readings))


def climb(scene: Scene, t_end: float, rtol: float, solver: Any, t_eval: ArrayLike | None, start: State | None) -> Ladder:
    """The three runs. Raises SimulationError where one of the two finer ones stops."""
    step = getattr(solver, "step", None)
    if step is None:
        return _by_tolerance(_alike(scene, solver, rtol), rtol, t_eval, partial(simulate, scene, t_end, start=start, solver=solver))

    def run(setting: float, until: float = t_end, times: ArrayLike | None = None) -> Result:
        return simulate(scene, until, rtol=rtol, solver=replace(solver, step=setting), t_eval=times, start=start)

    return _by_step(float(step), int(solver.integrator(rtol).order), t_eval, run)


def _by_tolerance(finest: Any, rtol: float, t_eval: ArrayLike | None, run: Callable[..., Result]) -> Ladder:
    """``finest``: the solver of the last run."""
    result, loosest = run(rtol=rtol), min(LOOSER * rtol, LOOSEST)
    worth = loosest >= APART * rtol and result.stats["steps"] >= SHORT
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # all runs would warn of the same
        coarse = _unless_it_fails(partial(run, rtol=loosest)) if worth else None
        fine = max(rtol / _factor(coarse, result, loosest / rtol), TIGHTEST)
        return Ladder(coarse, (result, run(rtol=fine, solver=finest, t_eval=t_eval)), (loosest, rtol, fine), None)


def _by_step(step: float, order: int, t_eval: ArrayLike | None, run: Callable[..., Result]) -> Ladder:
    result = run(step)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        runs = result, run(0.5 * step, times=t_eval)
        coarse = _unless_it_fails(partial(run, 2.0 * step, _until(*runs)))
        return Ladder(coarse, runs, (2.0 * step, step, 0.5 * step), order)


def _until(result: Result, finest: Result) -> float:
    """How far twice the step goes for what is left of the price: halving steps has multiplied work by ``growth``, doubling divides it."""
    t, growth = result.trajectory.t, _work(finest) / _work(result)
    share = np.clip((BY_STEPS - 1.0 - growth) * growth, LEAST_SHARE, 1.0)
    return float(t[-1] if share == 1.0 or t.size <= 3 else t[max(2 * round(0.5 * share * (t.size - 1)), 2)])


def _unless_it_fails(run: Callable[[], Result]) -> Result | None:
    try:
        return run()
    except SimulationError:
        return None


def _alike(scene: Scene, solver: Any, rtol: float) -> Any:
    """The solver with the stages that it takes at rtol: with more of them, errors would fall by far more than the tolerance."""
    from ..solvers import Radau
    from ..solvers.automatic import default

    adaptive = Radau()
    by_itself = solver == adaptive or (solver is None and all(default(part.system)[0] == adaptive for part in scene.parts()))
    return Radau(adaptive.integrator(rtol).table.stages) if by_itself else solver


def _work(run: Result) -> int:
    """In Newton iterations, of explicit methods evaluations: not processor time, as the same scene has to give the same runs."""
    return max(int(run.stats["newton iterations"]) + FACTORISATION * int(run.stats["factorizations"]), 1)


def _factor(loose: Result | None, result: Result, ratio: float) -> float:
    """How much tighter the finest run may be: as work has grown from the loose run to this one, forecast to go on; but enough for errors to
    tell tolerances apart."""
    if loose is None:
        return TIGHTER
    work = _work(result) / _work(loose)
    per_decade = max(work ** (1.0 / np.log10(ratio)), 1.0 + 1e-9)
    left = max(SPENT - 1.0 - 1.0 / work, 1.0)
    return float(np.clip(10.0 ** min(np.log(left) / np.log(per_decade), 1.0), LEAST_TIGHTER, TIGHTER))


class Compared(NamedTuple):
    """Runs as results at common times [k]: the middle and the finest one, and others, of other meshes; the coarsest, if there is one, only
    at those which ``seldom`` counts. ``density``: of these times, as a share of the finest run's steps."""

    times: Array
    coarse: Result | None
    seldom: NDArray[np.intp]
    middle: Result
    fine: Result
    others: list[Result]
    density: float


def compared(ladder: Ladder, others: Sequence[Result]) -> Compared:
    """Times at which one of the runs has no values (a singular position between steps) are left out."""
    times, (middle, fine, *more) = sampled([*ladder.runs, *others], ladder.times())
    seldom = times[:: -min(EVERY, max(times.size // FEWEST, 1))][::-1]
    few, coarse = (seldom, []) if ladder.coarse is None else sampled([ladder.coarse], seldom[seldom <= ladder.coarse.trajectory.t[-1]])
    density = min(times.size / fine.trajectory.t.size, 1.0)
    return Compared(times, coarse[0] if coarse else None, np.searchsorted(times, few), middle, fine, more, density)


def sampled(runs: Sequence[Result], times: Array) -> tuple[Array, list[Result]]:
    """Runs as results at those of the times at which all of them have values."""
    motions = [_motion(run, times) for run in runs]
    good = np.all([np.ones(times.size, dtype=bool), *(np.isfinite(q).all(axis=1) for q, _ in motions)], axis=0)
    return times[good], [run.resampled(times[good], (q[good], v[good])) for run, (q, v) in zip(runs, motions)]


def _motion(run: Result, times: Array) -> tuple[Array, Array]:
    """q, v [k, n]; NaN where they cannot be found. One time after another: where one fails, near a singular position, none is solved twice."""
    q, v = np.full((2, times.size, run.system.n), np.nan)
    for k in range(times.size):
        with suppress(SimulationError):
            q[k : k + 1], v[k : k + 1] = run.trajectory.at(times[k : k + 1])
    return q, v
