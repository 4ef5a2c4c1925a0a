"""Results of a run: labelled arrays, computed when asked."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .affine import Array
from .audit import Audit, audit
from .displayed import Displayed
from .errors import SceneWarning
from .event import Events
from .failures import undetermined
from .marker import Marker
from .parts import Index, Part
from .reaction import reaction
from .state import State
from .system import System
from .trajectory import Joined, Trajectory

if TYPE_CHECKING:
    from .assembly import Assembly
    from .outputs import Output
    from .progress import Progress
    from .scene import Scene


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies [n_t] [J]; the potential one is of gravity, zero at the origin."""

    kinetic: Array
    elastic: Array
    potential: Array

    @property
    def total(self) -> Array:
        return self.kinetic + self.elastic + self.potential


class Statistics(Displayed, dict[str, Any]):
    """What a run took: solver, steps, factorizations, wall time and so on."""


class Result(Displayed):
    """A run of a scene.

    t [n_t]: the accepted steps (of several independent parts: of the one that took most), or ``t_eval``; q, v [n_t, n] in order of
    ``scene.coordinates()``. Methods take a marker or item, and optionally other times ``t``, at which values are interpolated and projected
    to the joints. ``events[event]``: when each happened, t, q, v. Where a load jumps, accelerations and reactions are those after the jump.
    """

    def __init__(
        self,
        scene: Scene,
        system: System,
        trajectory: Trajectory | Joined,
        stats: dict[str, Any],
        assembly: Assembly,
        chosen: tuple[Array, Array, Array] | None,
        events: Events,
        progress: Progress | None = None,
    ):
        self.scene, self.system, self.trajectory, self.stats, self.assembly = scene, system, trajectory, Statistics(stats), assembly
        self.chosen, self.events, self.progress = chosen, events, progress
        self._instants: dict[Part, tuple[Array, Array]] = {}
        self._warned: set[str] = set()

    @property
    def t(self) -> Array:
        return self.chosen[0] if self.chosen else self.trajectory.t

    @property
    def q(self) -> Array:
        return self.chosen[1] if self.chosen else self.trajectory.q

    @property
    def v(self) -> Array:
        return self.chosen[2] if self.chosen else self.trajectory.v

    def __repr__(self) -> str:
        return f"<result: {self.trajectory.t[0]:g} to {self.trajectory.t[-1]:g} s in {len(self.trajectory.t) - 1} steps>"

    @property
    def final(self) -> State:
        """The last state: ``simulate(scene, t_end, start=result.final)`` continues."""
        return self.trajectory.end

    def resampled(self, t: ArrayLike, motion: tuple[Array, Array] | None = None) -> Result:
        """The same run with ``t`` at other times [n_t] [s], ascending or not: everything asked of it is at these. motion: q and v there,
        where they are known."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        chosen = (times, *(motion or self.trajectory.at(times)))
        return Result(self.scene, self.system, self.trajectory, self.stats, self.assembly, chosen, self.events)

    def _motion(self, t: ArrayLike | None, columns: Index) -> tuple[Array, Array]:
        """q, v [..., n]; of the parts that these coordinates belong to, at least."""
        if t is not None:
            return self.trajectory.at(np.asarray(t, dtype=float), columns)
        return (self.chosen[1], self.chosen[2]) if self.chosen else self.trajectory.values(columns)

    def position(self, marker: Marker, t: ArrayLike | None = None) -> Array:
        """[n_t, d] [m]."""
        point = _marker(marker).point
        return point.value(self._motion(t, point.columns())[0])

    def velocity(self, marker: Marker, t: ArrayLike | None = None) -> Array:
        """[n_t, d] [m/s]."""
        point = _marker(marker).point
        return point.rate(self._motion(t, point.columns())[1])

    def acceleration(self, marker: Marker, t: ArrayLike | None = None) -> Array:
        """[n_t, d] [m/s^2], from the equations of motion at each instant."""
        point = _marker(marker).point
        return point.rate(self._index_one(t, point.columns())[0])

    def _index_one(self, t: ArrayLike | None, columns: Index) -> tuple[Array, Array]:
        """Accelerations [..., n] and multipliers [..., m], of the parts that these coordinates belong to, at least."""
        times = self.t if t is None else np.asarray(t, dtype=float)
        q, v = self._motion(t, columns)
        a, multipliers = np.full(q.shape, np.nan), np.full((*times.shape, self.system.m), np.nan)
        for piece in self.trajectory.pieces(columns):
            part, known = piece.part, self._instants if t is None else {}
            if part not in known:
                known[part] = _solve_index_one(piece, times, q[..., part.columns], v[..., part.columns])
            a[..., part.columns], multipliers[..., part.rows] = known[part]
        return a, multipliers

    def reaction(self, joint: Any, t: ArrayLike | None = None) -> Array:
        """[n_t, 3] or [n_t, 6]: force [N], then moment [N m], that the joint exerts on its first marker, about it, in inertial axes.
        Of a joint in ``indeterminate``, which is warned of once, the one of least norm."""
        rows = [k for k, (item, _) in enumerate(self.system.joints.labels) if item == getattr(joint, "name", None)]
        if not rows or not hasattr(getattr(joint, "description", None), "rows"):
            raise ValueError(f"reaction({joint!r}): expected a joint of this scene, as scene.add(mbd.Pin(...)) returned it")
        if joint.name in self.indeterminate and joint.name not in self._warned:
            self._warned.add(joint.name)
            about = "other joints hold the same, and this is the one of least norm among all; mbd.check names them"
            warnings.warn(f"the reaction of {joint.name!r} is indeterminate: {about}", SceneWarning, stacklevel=2)
        columns = np.concatenate([marker.point.columns() for marker in joint.description.markers])
        q, _ = self._motion(t, columns)
        return reaction(joint, joint.pose(self.system.q0), q, self._index_one(t, columns)[1][..., rows])

    @cached_property
    def indeterminate(self) -> tuple[str, ...]:
        """The joints whose reactions are not unique because others hold the same, by name."""
        if not self.assembly.redundant:
            return ()
        from .structure import indeterminate

        return indeterminate(self.scene, self.assembly.state)

    def angle(self, item: Any, t: ArrayLike | None = None) -> Array:
        """[n_t] [rad]: of a planar body's or marker's axis, of a cable marker's tangent; counter-clockwise, unwrapped."""
        axis = self._axis(item)
        steps = (*self.trajectory.pieces(axis.columns()), *self.trajectory.pieces())[0]
        q, v = (steps.part.widened(x, self.system.n) for x in (steps.q, steps.v))
        direction, turning = axis.value(q), axis.rate(v)
        principal = np.arctan2(direction[:, 1], direction[:, 0])
        speed = (direction[:, 0] * turning[:, 1] - direction[:, 1] * turning[:, 0]) / np.sum(direction**2, axis=1)
        expected = 0.5 * np.diff(steps.t) * (speed[1:] + speed[:-1])
        turns = np.round((np.diff(principal) - expected) / (2.0 * np.pi))
        angles = principal - 2.0 * np.pi * np.concatenate(([0.0], np.cumsum(turns)))
        times = self.t if t is None else np.asarray(t, dtype=float)
        now = axis.value(self._motion(t, axis.columns())[0])
        near = np.interp(times, steps.t, angles) if len(steps.t) > 1 else np.full(times.shape, angles[0])
        wrapped = np.arctan2(now[..., 1], now[..., 0])
        return wrapped + 2.0 * np.pi * np.round((near - wrapped) / (2.0 * np.pi))

    def _axis(self, item: Any) -> Any:
        axes = getattr(item, "axes", ())
        if self.system.dimension != 2:
            raise ValueError("angle: expected a planar scene; use rotation() and angular_velocity() in space")
        if not axes:
            raise ValueError(f"angle({item!r}): expected a rigid body, or a marker that carries an axis")
        return axes[0]

    def rotation(self, body: Any, t: ArrayLike | None = None) -> Array:
        """[n_t, d, d]: columns are the body axes."""
        axes = self._body_axes(body)
        return _frame(axes, self._motion(t, axes[0].columns())[0])

    def angular_velocity(self, body: Any, t: ArrayLike | None = None) -> Array:
        """[n_t, 3] inertial components (spatial), [n_t] (planar) [rad/s]."""
        axes = self._body_axes(body)
        q, v = self._motion(t, axes[0].columns())
        e = np.stack([axis.value(q) for axis in axes], axis=-2)
        rate = np.stack([axis.rate(v) for axis in axes], axis=-2)
        if self.system.dimension == 2:
            return e[..., 0, 0] * rate[..., 0, 1] - e[..., 0, 1] * rate[..., 0, 0]
        return 0.5 * np.sum(np.cross(e, rate), axis=-2)

    def _body_axes(self, body: Any) -> Any:
        rigid = getattr(body, "rigid", True) and len(getattr(body, "axes", ())) == (1 if self.system.dimension == 2 else 3)
        if not rigid:
            raise ValueError(f"{body!r}: expected a rigid body, or one of its markers")
        return body.axes

    @cached_property
    def energy(self) -> Energy:
        s = self.system
        return Energy(s.kinetic(self.v), s.elastic(self.q), s.potential(self.q))

    @property
    def accounted(self) -> Trajectory | Joined:
        """The accepted steps, with the work done along them."""
        return self.trajectory

    @cached_property
    def audit(self) -> Audit:
        return audit(self.system, self.accounted)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result to an .npz file, whole or not at all; ``mbd.load`` reads it."""
        from .archive import save

        save(self, path)

    def to_xarray(self, outputs: Mapping[str, Output] | None = None, t: ArrayLike | None = None) -> Any:
        """An xarray Dataset over time: q, v, energies and named outputs ({"tip": rod.end, "hinge": pivot}), labelled, with units; at ``t`` or
        other times. Needs xarray."""
        from .export.labelled import to_xarray

        return to_xarray(self, outputs, t)

    def to_dataframe(self, outputs: Mapping[str, Output], t: ArrayLike | None = None) -> Any:
        """A pandas DataFrame over time of named outputs (markers, joints, measures, bodies, functions of the result). Needs pandas."""
        from .export.tables import to_dataframe

        return to_dataframe(self, outputs, t)

    def to_csv(self, path: str | os.PathLike[str], outputs: Mapping[str, Output], t: ArrayLike | None = None) -> None:
        """Writes named outputs over time as text, with headings and units; numbers in full."""
        from .export.tables import to_csv

        to_csv(self, path, outputs, t)

    def to_paraview(self, path: str | os.PathLike[str], t: ArrayLike | None = None) -> None:
        """Writes what ``plot`` shows for ParaView: ``path`` (.pvd) and a folder of one .vtu file a time. Needs meshio."""
        from .export.paraview import to_paraview

        to_paraview(self, path, t)

    def plot(self, times: ArrayLike | None = None, *, items: Sequence[Any] | None = None, ax: Any = None) -> Any:
        """The deformed shapes at times [s] (by default ten), coloured by time; returns the matplotlib Axes."""
        from .plot import plot

        return plot(self, times, items=items, ax=ax)

    def animate(self, path: str | os.PathLike[str] | None = None, *, fps: float = 30, speed: float = 1.0) -> Any:
        """A matplotlib FuncAnimation of the shapes, ``speed`` times as fast as real time; written to a .gif or .mp4 where a path is given."""
        from .plot import animate

        return animate(self, path, fps=fps, speed=speed)

    def report(
        self, path: str | os.PathLike[str], *, outputs: dict[str, Any] | None = None, verification: Any = None, title: str | None = None
    ) -> None:
        """Writes the run as one HTML file: animation, plots, audit, structure, statistics, the scene. It opens in any browser, without a network.

        outputs       what to plot and follow, by name: markers (their paths), joints (reactions), measures, bodies, or functions of a result that
                      return [n_t] or [n_t, k] at its t; None: what moves
        verification  error estimates to show beside: anything that prints as a table, with ``errors`` by name over ``t`` where it has them
        title         of the page; None: the file's name

        Raises ValueError for outputs that are not of this scene, and for a scene that has grown since the run.
        """
        from .report import write

        write(self, path, outputs, verification, title)


def _marker(marker: Any) -> Marker:
    if not isinstance(marker, Marker):
        raise TypeError(f"expected a marker such as rod.end or body.at(x, y), found {marker!r}")
    return marker


def _solve_index_one(piece: Trajectory, times: Array, q: Array, v: Array) -> tuple[Array, Array]:
    """Accelerations and multipliers of one part at q, v [..., n_part] and times [...]."""
    from .solvers.formats import Singular
    from .solvers.start import accelerations, mass_factor

    system, linear = piece.part.system, piece.linear
    a, multipliers = np.empty(q.shape), np.empty((*times.shape, system.m))
    for k in np.ndindex(times.shape):
        try:
            factor = mass_factor(system, linear, q[k])
        except Singular as trouble:
            raise undetermined(system, linear, q[k], float(times[k]), trouble) from trouble
        a[k], multipliers[k] = accelerations(system, factor, q[k], v[k], system.inputs(float(times[k])))
    return a, multipliers


def _frame(axes: Any, q: Array) -> Array:
    if axes[0].dimension == 2:
        return np.stack([axes[0].value(q), axes[0].scaled(1j).value(q)], axis=-1)
    return np.stack([axis.value(q) for axis in axes], axis=-1)
