"""Run time against error on the user's own scene: solvers x tolerances, a table and a plot.

Errors are distances of one marker from a reference: given, or a run that is a hundred times tighter than all others by a method that is
not among them. How near the best of the others came to it bounds what is known of the reference itself.
"""

from __future__ import annotations

import statistics
import warnings
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .errors import SimulationError
from .extras import need
from .marker import Marker
from .run import simulate

if TYPE_CHECKING:
    from .scene import Scene

RTOLS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)


class Row(NamedTuple):
    """A run: solver and its rtol (None for fixed steps), median wall time of the solver [s], largest error at the times [m] (infinite where
    it stopped), steps, Newton iterations (of explicit methods: evaluations), and what it warned of."""

    solver: str
    rtol: float | None
    wall_time: float
    error: float
    steps: int
    newton_iterations: int
    note: str = ""


@dataclass(frozen=True, eq=False)
class WorkPrecision:
    """The rows of ``work_precision``; ``reference`` [n_times, d] [m] at ``times`` [s], and ``source``, where it comes from. Prints as a table."""

    rows: list[Row]
    times: Array
    reference: Array
    source: str

    def __str__(self) -> str:
        head = ("solver", "rtol", "wall time [s]", "error [m]", "steps", "Newton", "")
        lines = [head, *(_cells(row) for row in self.rows)]
        widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
        text = "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)
        return f"{text}\nreference: {self.source}"

    def plot(self, ax: Any = None) -> Any:
        """Wall time over error, a curve for each solver; returns the matplotlib Axes (a new one where none is given)."""
        axes = need("matplotlib.pyplot", "plot").figure(layout="constrained").add_subplot() if ax is None else ax
        for solver in dict.fromkeys(row.solver for row in self.rows):
            points = [(row.error, row.wall_time) for row in self.rows if row.solver == solver and 0.0 < row.error < np.inf]
            if points:
                axes.loglog(*zip(*points), marker="o", label=solver)
        if not axes.xaxis_inverted():
            axes.invert_xaxis()
        axes.set(xlabel="error [m]", ylabel="wall time [s]")
        axes.grid(True, alpha=0.3)
        if axes.lines:
            axes.legend()
        return axes


def work_precision(
    scene: Scene,
    t_end: float,
    *,
    output: Marker,
    solvers: Sequence[Any] = (None,),
    rtols: Sequence[float] = RTOLS,
    reference: ArrayLike | None = None,
    times: ArrayLike | None = None,
    repeats: int = 1,
) -> WorkPrecision:
    """Runs a scene with every solver at every tolerance, and tells what each run took and how far its output was off.

    output     a marker of the scene: its position is compared
    solvers    such as mbd.Radau(5); None is the library's choice. One with a step of its own runs once: give one for each step
    rtols      tolerances of the others
    reference  positions [d] or [n_times, d] [m]; None: the tightest run, of a method not among the solvers
    times      [s] at which errors are taken, the largest counting; None: t_end
    repeats    runs of each setting; the median of their wall times counts

    Raises ValueError for arguments that make no sense. A run that stops early has an infinite error and says when in its note.
    """
    at = np.atleast_1d(np.array(t_end if times is None else times, dtype=float))
    given = None if reference is None else np.atleast_2d(np.array(reference, dtype=float))
    _check(scene, t_end, output, solvers, rtols, given, at, repeats)
    exact, source = (given, "given") if given is not None else _reference(scene, t_end, output, solvers, min(rtols), at)
    rows = []
    for solver in solvers:
        for rtol in (None,) if _fixed(solver) else sorted(rtols, reverse=True):
            rows.append(_measured(scene, t_end, output, solver, rtol, min(rtols), exact, at, repeats))
    if given is None:
        nearest = min((row.error for row in rows), default=np.inf)
        source += f"; the nearest other run differs by {nearest:.1e} m"
    return WorkPrecision(rows, at, exact, source)


def _check(scene: Scene, t_end: float, output: Any, solvers: Any, rtols: Any, given: Array | None, times: Array, repeats: int) -> None:
    found = []
    if not isinstance(output, Marker):
        found.append(f"output: expected a marker such as rod.end or body.at(x, y), found {output!r}")
    elif output.scene is not scene:
        found.append(f"output: expected a marker of this scene, found {output!r} of another")
    if not len(solvers):
        found.append("solvers: expected at least one, such as mbd.Radau(), found none")
    for solver in solvers:
        if solver is not None and not callable(getattr(solver, "integrator", None)):
            found.append(f"solvers: expected solvers such as mbd.Radau(5), or None, found {solver!r}")
    if not len(rtols) or not all(np.isfinite(rtol) and 1e-14 <= rtol < 1.0 for rtol in rtols):
        found.append(f"rtols: expected tolerances from 1e-14 to below 1, found {list(rtols)!r}")
    if not times.size or not np.isfinite(times).all() or not np.all((times >= 0.0) & (times <= t_end)):
        found.append(f"times: expected times from 0 to {t_end:g} s, found {times.tolist()!r}")
    if given is not None and (given.shape != (times.size, scene.dimension) or not np.isfinite(given).all()):
        found.append(f"reference: expected finite positions of shape {(times.size, scene.dimension)}, found shape {given.shape}")
    if repeats < 1:
        found.append(f"repeats: expected 1 or more, found {repeats!r}")
    if found:
        raise ValueError("\n".join(found))


def _fixed(solver: Any) -> bool:
    return getattr(solver, "step", None) is not None


def _label(solver: Any) -> str:
    """Such as Radau(stages=5): the class and what was not left at its default."""
    if solver is None:
        return "default"
    if not is_dataclass(solver):
        return type(solver).__name__
    set_ = [f"{f.name}={getattr(solver, f.name)!r}" for f in fields(solver) if f.default is MISSING or getattr(solver, f.name) != f.default]
    return f"{type(solver).__name__}({', '.join(set_)})"


def _reference(scene: Scene, t_end: float, output: Marker, solvers: Sequence[Any], rtol: float, times: Array) -> tuple[Array, str]:
    """Positions [n_times, d] of a run hundred times tighter than rtol, or as tight as it goes, and which run it was."""
    from .solvers import DormandPrince, Radau

    used = {_label(solver) for solver in solvers}
    candidates = [Radau(7), Radau(5), Radau(3), DormandPrince()]
    another = next((solver for solver in candidates if _label(solver) not in used), candidates[0])
    tightest = max(1e-13, 1e-2 * rtol)
    for tolerance in (tightest, 10.0 * tightest, 100.0 * tightest):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = simulate(scene, t_end, rtol=tolerance, solver=another)
            return np.array(result.position(output, t=times)), f"{_label(another)} at rtol {tolerance:.0e}"
        except SimulationError as error:
            failure = error
    raise failure


def _measured(
    scene: Scene, t_end: float, output: Marker, solver: Any, rtol: float | None, tightest: float, exact: Array, times: Array, repeats: int
) -> Row:
    seconds: list[float] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for _ in range(repeats):
            try:
                result = simulate(scene, t_end, rtol=rtol or tightest, solver=solver)
            except SimulationError as stop:
                stats = stop.result.stats if stop.result else {}
                counts = int(stats.get("steps", 0)), int(stats.get("newton iterations", 0))
                return Row(_label(solver), rtol, float(stats.get("wall time", np.nan)), np.inf, *counts, f"stopped at {stop.time or 0.0:.4g} s")
            seconds.append(float(result.stats["wall time"]))
    error = float(np.max(np.linalg.norm(result.position(output, t=times) - exact, axis=1)))
    note = "; ".join(sorted({str(warning.message) for warning in caught}))
    counts = int(result.stats["steps"]), int(result.stats["newton iterations"])
    return Row(_label(solver), rtol, statistics.median(seconds), error, *counts, note)


def _cells(row: Row) -> tuple[str, ...]:
    tolerance = "fixed" if row.rtol is None else f"{row.rtol:.0e}"
    note = row.note if len(row.note) <= 60 else f"{row.note[:57]}..."
    return row.solver, tolerance, f"{row.wall_time:.4g}", f"{row.error:.2e}", str(row.steps), str(row.newton_iterations), note
