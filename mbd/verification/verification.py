"""``verify``: a result with an estimated error of each output, or the reason why none can be quoted.

The runs are those of ``runs.py``; what their differences say is in ``estimates.py``, other meshes in ``mesh_error.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..affine import Array
from ..displayed import Displayed
from ..result import Result
from ..state import State
from .estimates import Estimate, Growth, Values, envelope, estimate, growth, plausible
from .mesh_error import Build, Mesh, MeshEstimate, mesh_estimate, other_meshes
from .outputs import Output, outputs_of
from .runs import Compared, Ladder, climb, compared

if TYPE_CHECKING:
    from ..scene import Scene


class Row(NamedTuple):
    """An output: its unit, the worst of the errors quoted and when [s], its range over the run, the observed powers of the tolerance (of fixed
    steps: the order) and of the mesh (NaN: not observed), the time until which it is predictable [s], and "ok" or what is wrong."""

    output: str
    unit: str
    worst: float
    at: float
    range: float
    order: float
    mesh_order: float
    until: float
    verdict: str


@dataclass(frozen=True, eq=False)
class Verification(Displayed):
    """What ``verify`` found. Prints as a table.

    result       the finest run, a mbd.Result
    errors       estimated errors [n_t] of each output at ``t``, of time steps and mesh together; infinite where none is quoted
    time_errors  those of the time steps alone;  mesh_errors: of the mesh alone, empty where no other was asked for
    rows         a row for each output, as in the table
    growth       how neighbouring motions part: the finite-time ``exponent`` [1/s], and whether that is ``exponential``
    settings     tolerances of the three runs (of two where there was none to observe an order by), or their steps [s] where those are ``fixed``
    """

    result: Result
    errors: dict[str, Array]
    time_errors: dict[str, Array]
    mesh_errors: dict[str, Array]
    rows: list[Row]
    growth: Growth
    settings: tuple[float, ...]
    fixed: bool

    @property
    def t(self) -> Array:
        """[n_t] [s]: result.t."""
        return self.result.t

    @property
    def ok(self) -> bool:
        """Whether every output has an error quoted over the whole run."""
        return all(row.verdict == "ok" for row in self.rows)

    @property
    def predictable_until(self) -> float:
        """The time [s] until which all outputs are predictable: the end of the run, or an earlier one."""
        return min(row.until for row in self.rows)

    def remarks(self) -> list[str]:
        """What was compared, how neighbouring motions part, and what can be done where something is lost."""
        from .text import remarks

        return remarks(self)

    def __str__(self) -> str:
        from .text import text

        return text(self)


def verify(
    scene: Scene,
    t_end: float,
    *,
    outputs: Mapping[str, Any],
    rtol: float = 1e-6,
    solver: Any = None,
    t_eval: ArrayLike | None = None,
    start: State | None = None,
    meshes: bool | Build = False,
) -> Verification:
    """The motion of a scene to t_end [s] with an estimate of the global error of each output, for at most 3.5 times the cost of one run.

    outputs  names, each with a marker (its position), a body (its angle, in space its rotation [rad]), a joint (force and moment of its
             reaction), or a function of a mbd.Result that returns [n_t] or [n_t, k] at its times
    rtol     as of ``simulate``; further runs take 1000 rtol and about rtol/10, and the tightest is the result. Solvers with fixed steps take
             half of theirs, and twice for as much of the time as the price allows: orders are observed until then
    meshes   True: runs on two other meshes as well, with half and twice as many elements in all beams (where a number is odd, twice and four
             times), each for a price of its own. Or a function that makes a scene and its outputs for a factor 0.5 and 2 of all elements: needed
             where outputs are functions. The result is still that of the scene as it is; its errors are then those to an endlessly fine mesh
    solver, t_eval, start: as of ``simulate``

    Errors are those of solving the equations described. True ones were between 1/100 of the estimate and 3 times it on all reference cases
    (docs/verify.md). None is quoted where the observed order contradicts the method's, nor from where an output is lost: where its error
    exceeds a tenth of its range, as neighbouring motions part or rtol is too large. With rtol above 3e-5, and
    in runs of a few steps, no order is observed.

    Raises ValueError for arguments that make no sense, SceneError and SimulationError as ``simulate``.
    """
    _check(rtol, start, meshes)
    watched = outputs_of(scene, outputs)
    ladder = climb(scene, float(t_end), float(rtol), solver, t_eval, start)
    others = other_meshes(scene, outputs, meshes if callable(meshes) else None, float(t_end), float(rtol), solver) if meshes else []
    runs = compared(ladder, [mesh.run for mesh in others])
    found = [_judged(ladder, output, values, _by_level(output, values, others, runs)) for output, values in _values(watched, runs)]
    return Verification(
        result=ladder.runs[1],
        errors={one.row.output: one.by_time + one.by_mesh for one in found},
        time_errors={one.row.output: one.by_time for one in found},
        mesh_errors={one.row.output: one.by_mesh for one in found if others},
        rows=[one.row for one in found],
        growth=growth(runs.times, _apart(runs)),
        settings=ladder.settings if ladder.coarse else ladder.settings[1:],
        fixed=ladder.order is not None,
    )


def _check(rtol: float, start: State | None, meshes: Any) -> None:
    found = []
    if not (np.isfinite(rtol) and 1e-13 <= rtol <= 1e-2):
        found.append(f"rtol: expected a tolerance from 1e-13 to 1e-2, which leaves room for runs around it, found {rtol!r}")
    if meshes and start is not None:
        found.append("start: expected none with meshes, found a state of one mesh; describe the start in the scene")
    if found:
        raise ValueError("\n".join(found))


def _values(watched: list[Output], runs: Compared) -> list[tuple[Output, Values]]:
    """The outputs with their values in each run."""
    found = []
    for output in watched:
        coarse = None if runs.coarse is None else output.values(runs.coarse)
        values = Values(runs.times, coarse, runs.seldom, output.values(runs.middle), output.values(runs.fine), runs.density)
        if not output.optional or np.any(values.fine):
            found.append((output, values))
    return found


def _by_level(output: Output, values: Values, others: list[Mesh], runs: Compared) -> dict[int, Array]:
    """The values [k, m] on each mesh, that of the scene being level 0."""
    return {0: values.fine} | {mesh.level: mesh.outputs[output.name].values(run) for mesh, run in zip(others, runs.others)}


def _apart(runs: Compared) -> Array:
    """Distances [k] of the two finer runs' positions, as shares of the scene's length."""
    system = runs.fine.system
    return np.array(np.linalg.norm((runs.middle.q - runs.fine.q) * system.levers, axis=1) / system.length)


class _Judged(NamedTuple):
    row: Row
    by_time: Array
    by_mesh: Array


def _judged(ladder: Ladder, output: Output, values: Values, by_level: dict[int, Array]) -> _Judged:
    """The errors of an output at the times of the result, and its row of the table."""
    t, times = ladder.runs[1].t, values.times
    steps = estimate(values, ladder.ratios, ladder.order, output.size(values.fine))
    mesh = mesh_estimate(by_level, steps.errors) if len(by_level) > 1 else MeshEstimate(np.zeros(times.size), np.nan)
    wrong = _wrong(ladder.order, steps, mesh)
    lost = -np.inf if wrong else steps.lost
    by_time, by_mesh = (envelope(t, times, errors, lost) for errors in (steps.errors, mesh.errors))
    kept = times[times < lost]
    total = (steps.errors + mesh.errors)[times < lost]
    until = float(kept[-1]) if kept.size else float(times[0])
    worst, at = (float(np.max(total)), float(kept[np.argmax(total)])) if kept.size else (np.inf, until)
    verdict = wrong or ("ok" if np.isinf(lost) else f"not predictable beyond t = {until:.4g} s")
    row = Row(output.name, output.unit, worst, at, steps.range, steps.order, mesh.order, until, verdict)
    return _Judged(row, by_time, by_mesh)


def _wrong(order: int | None, steps: Estimate, mesh: MeshEstimate) -> str:
    """What the observed orders say against the estimate, or ""."""
    if not plausible(steps.order, order):
        expected = f"{order} in the step" if order else "about 1 in the tolerance"
        return f"observed order wrong: {steps.order:.2g}, expected {expected}"
    if not mesh.converges:
        return f"meshes do not converge: observed order {mesh.order:.2g}"
    return ""
