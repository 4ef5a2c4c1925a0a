"""``check``: what a scene is made of, how it can move, what its joints hold twice, and how to mend that."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .closing import driven_rows
from .dependence import Spaces, minimal_sets, rank_of, scaled_gradient, spaces
from .diagnosis import Redundancy, Structure
from .edits import propose
from .errors import SceneError
from .magnitudes import hints
from .motions import LISTED, motions
from .parts import Part, components
from .starts import starts, together
from .state import State
from .topology import bodies, joints, loops

if TYPE_CHECKING:
    from .scene import Scene
    from .solvers.linear import Linear

NEARBY = 0.02
"""Poses nearby are this share of the scene's length away."""

POSES = 3
"""So many poses nearby tell what holds everywhere: the least redundant counts."""


def check(scene: Scene, start: State | None = None, *, solver: Any = None) -> Structure:
    """The structure of a scene, at its assembled start or at a given state: bodies, joints, loops, degrees of freedom, redundant joints,
    singular positions, indeterminate reactions, free motions; and hints at likely slips of units. ``print`` it.

    solver    that the scene shall be run with: where its steps are fixed, they too are looked at

    Ranks count singular values of the scaled G above 1e-9 of the largest. Raises SceneError for a scene that cannot be built.
    """
    system, parts = scene.build(), scene.parts()
    state = start or State(system.q0, system.v0)
    state.check(system)
    complaints: list[str] = []
    try:
        state = together(starts(parts, state), parts, system.n).state
    except SceneError as error:
        complaints = error.complaints
    found = [_Pose(scene, part, state) for part in parts]
    driven = int(np.sum(driven_rows(system)))
    return Structure(
        bodies=tuple(bodies(scene)),
        joints=tuple(joints(system)),
        parts=tuple(tuple(item.name for item in group) for group in components(scene)),
        loops=tuple(loops(scene)),
        count=system.n - system.m + driven,
        freedoms=sum(each.freedoms for each in found),
        driven=driven,
        free=sum(each.free for each in found),
        redundant=tuple(set_ for each in found for set_ in each.redundancies()),
        unheld=tuple(name for each in found for name in each.unheld()),
        motions=tuple(line for each in found for line in each.motions()),
        complaints=tuple(complaints),
        hints=hints(scene, getattr(solver, "step", None)),
    )


def indeterminate(scene: Scene, state: State) -> tuple[str, ...]:
    """The joints whose reactions are not unique, in poses near a state on the joints."""
    found = [_Pose(scene, part, state) for part in scene.parts()]
    return tuple(dict.fromkeys(name for each in found for set_ in each.redundancies() if set_.generic for name in set_.joints))


def free_motions(scene: Scene, part: Part, state: State) -> list[str]:
    """The motions of one part, in words, that neither joints nor drives determine."""
    found = _Pose(scene, part, state)
    return found.motions() or [f"{found.free} degrees of freedom of {part.items[0]!r} and others"] * bool(found.free)


def dead_centres(scene: Scene, part: Part, state: State) -> list[str]:
    """The joints and drives of one part that hold something twice at a state, but not nearby."""
    return list(dict.fromkeys(name for each in _Pose(scene, part, state).redundancies() if each.singular for name in each.joints))


class _Pose:
    """One part of a scene in one pose. ``unlocked``: what its G spans without drives."""

    def __init__(self, scene: Scene, part: Part, state: State):
        from .solvers.linear import Linear
        from .solvers.start import redundancy

        self.scene, self.part, self.q_whole = scene, part, state.q
        self.system, self.q = part.system, state.q[part.columns]
        self.linear: Linear = Linear(self.system, self.q)
        self.driven = driven_rows(self.system)
        self.defect: Any = redundancy(self.system, self.linear, self.q)
        units = self.linear.scale[: self.system.n]
        full = self.system.n - self.system.m
        if self.defect is None and full > LISTED:  # G has full rank, and its motions are too many to be described
            nothing = np.zeros((self.system.m, 0))
            self.found = self.unlocked = Spaces(self.system.m, nothing, np.zeros((self.system.n, 0)), units)
            self.free, self.freedoms = full, full + int(np.sum(self.driven))
            return
        self.gradient, _ = scaled_gradient(self.system, units, self.q)
        self.found = spaces(self.gradient, units)
        self.unlocked = spaces(self.gradient[~self.driven], units) if self.driven.any() else self.found
        self.free, self.freedoms = (self.system.n - each.rank for each in (self.found, self.unlocked))

    def motions(self) -> list[str]:
        return motions(self.scene, self.part, self.found, self.q_whole) if 0 < self.free <= LISTED and self.found.right.shape[1] else []

    def unheld(self) -> list[str]:
        return [self.system.coordinate(k) for k in self.defect.coordinates] if self.defect else []

    def redundancies(self) -> list[Redundancy]:
        if not self.found.left.shape[1]:
            return []
        labels, names = self.system.joints.labels, joints(self.system)
        groups = [np.array([row for row, (name, _) in enumerate(labels) if name == each]) for each in names]
        drives = list(dict.fromkeys(labels[row][0] for row in np.flatnonzero(self.driven)))
        sets, others = [], self._gradients_nearby()
        for members, vectors in minimal_sets(self.found.left, groups):
            involved = [names[i] for i in members]
            taking_part = {
                name: tuple(labels[row][1] for row in groups[names.index(name)] if np.any(np.abs(vectors[row]) > 1e-6)) for name in involved
            }
            own = self._with_bodies(np.concatenate([groups[i] for i in members]))
            usual = max((gradient[own] for gradient in others), key=rank_of, default=None)
            elsewhere = None if usual is None else own.size - rank_of(usual)
            lead_nowhere = usual is None and self.unlocked.right.shape[1] > 0
            found = Redundancy(taking_part, vectors.shape[1], elsewhere, lead_nowhere, tuple(name for name in involved if name in drives), ())
            if found.generic:
                local = self.gradient[own] if usual is None else usual
                basis, told = spaces(local, self.found.units).left, [labels[row] for row in own]
                found = replace(found, edit=propose(self.scene, self.q_whole, local, told, basis, involved, found.drives))
            sets.append(found)
        return sets

    def _with_bodies(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """The equations, and those by which the bodies that they are about hold themselves together."""
        pattern_rows, pattern_cols = self.system.joints.rows, self.system.joints.cols
        touched = np.isin(pattern_cols, pattern_cols[np.isin(pattern_rows, rows)])
        near = np.unique(pattern_rows[touched])
        internal = [row for row in near.tolist() if self.system.label(row) in self.system.internal]
        return np.union1d(rows, np.array(internal, dtype=np.intp))

    def _gradients_nearby(self) -> list[Array]:
        """The scaled G at some poses nearby that the joints allow, drives let go."""
        choice, found, levers = np.random.default_rng(1), [], self.system.levers
        for _ in range(POSES if self.unlocked.right.shape[1] else 0):
            step = self.unlocked.units * (self.unlocked.right @ choice.standard_normal(self.unlocked.right.shape[1]))
            distance = NEARBY * self.system.length
            q = self._closed(self.q + step * distance / max(float(np.max(np.abs(step) * levers)), 1e-300))
            if q is not None and np.max(np.abs(q - self.q) * levers) > 0.1 * distance:
                found.append(scaled_gradient(self.system, self.unlocked.units, q)[0])
        return found

    def _closed(self, q: Array) -> Array | None:
        """q on all equations but the driven ones, by Gauss and Newton's method; None where it does not get there."""
        from .solvers.linear import Linear
        from .solvers.start import Inconsistent, project_positions

        if not self.driven.any():
            linear = Linear(self.system, q)
            linear.soften()
            try:
                return project_positions(self.system, linear, q)
            except Inconsistent:
                return None
        for _ in range(30):
            gap = np.where(self.driven, 0.0, self.system.joints.at(q).value)
            if np.max(np.abs(gap) * self.linear.reach, initial=0.0) < 1e-11 * self.system.length:
                return q
            gradient, sizes = scaled_gradient(self.system, self.unlocked.units, q)
            gradient[self.driven] = 0.0
            q = q - self.unlocked.units * np.linalg.lstsq(gradient, gap / sizes, rcond=1e-9)[0]
        return None
