"""A step of the projected explicit method with its error: whole, or in two parts across a singular position.

A step is not made better by ending nearer to a singular position: errors of stages count there by the inverse of a slope that vanishes, and
steps that are only shortened creep up to it, where every method stops. So what goes wrong there is told as NearlySingular, at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .dop853 import NODES, WEIGHTS
from .index_one import Form
from .leap import parts
from .nystrom import END, STAGES
from .places import NEARLY_SINGULAR, NearlySingular
from .protocol import Attempt, State
from .system import Array, System
from .workspace import BETWEEN, Memory, Workspace

OBVIOUS = 100.0
"""Error over tolerance up to which a step is taken for too long in the first place, whatever its stages come near. Beyond, it may be a singular
position that makes it large: shorter steps only creep up to it."""

CLEAR = 3e-3
"""Share of an equation's slope, squared, below which a step starts near a singular position: then it is not its length that makes its error large.
States of long chains leave a hundredth, and are not meant. Nor may it be less than four times what rounding makes a singular position."""

STRICT, LITTLE, COARSE = 0.05, 0.2, 0.1
"""The local error aimed at, as a share of the tolerance: what steps of this size leave adds up over the long spans they cover. Where nothing has
moved by the scene's length, of a tolerance for how far it has, down to LITTLE of it; and as a share of the largest meaningful tolerance."""

ROUNDING = 10.0 * float(np.finfo(float).eps)
"""Of positions, as a share of the length, next to singular positions."""

ORDER = 8.0


@dataclass(frozen=True)
class Stride:
    """Steps of a system, with the tolerance of local errors in positions [m]."""

    system: System
    workspace: Workspace
    tolerance: float

    def _allowed(self, memory: Memory) -> float:
        """The local error [m] of a step: of what moves little in a long scene, a share of its motion."""
        moving = min(1.0, max(LITTLE, memory.extent / self.system.length))
        return min(STRICT * moving * self.tolerance, COARSE * self.workspace.linear.coarsest)

    @property
    def _least(self) -> float:
        """The share of an equation's slope, squared, that others must leave (``places.least_share``): rounding over it is an error in position."""
        return max(NEARLY_SINGULAR, ROUNDING * self.system.length / self.tolerance)

    def remembered(self, state: State) -> Memory:
        """A state in the form prepared for the system. Raises NearlySingular."""
        if isinstance(state.memory, Memory):
            return state.memory
        return self.workspace.remembered(self.system, state.t, self.workspace.form.enter(state.q, state.v), self._least)

    def take(self, memory: Memory, state: State, h: float) -> Attempt:
        """A step of length h from a state and what is remembered of it. Raises Inconsistent, and NearlySingular where two parts do not help."""
        try:
            return self._whole(memory, state, h)
        except NearlySingular as near:
            lengths = parts(near, h)
        return self._parts(memory, state, *lengths)

    def _whole(self, memory: Memory, state: State, h: float) -> Attempt:
        workspace = self.workspace
        end = workspace.step(self.system, memory, state.t, h)
        error = _size(workspace.form, end[1:]) / self._allowed(memory)
        if not error <= 1.0:
            if not error < OBVIOUS:
                workspace.check(BETWEEN, self._least)
            if memory.share < max(CLEAR, 4.0 * self._least):
                raise NearlySingular(0)
            return Attempt(state, error if np.isfinite(error) else 1e8, ORDER, 0.0, 0)
        after = workspace.landed(self.system, memory, state.t + h, end[0], self._least)
        if self.system.n_stresses or self.system.damped:
            after = after._replace(stiffness=h * _fastest(workspace, after))
        return self._accepted(state.t, h, after, error)

    def _parts(self, memory: Memory, state: State, *lengths: float) -> Attempt:
        first = self._whole(memory, state, lengths[0])
        middle = first.state
        if middle is None or first.error > 1.0:
            return first
        second = self._whole(middle.memory, middle, lengths[1])
        return second._replace(state=state) if second.error > 1.0 else _joined(first, second, lengths)

    def _accepted(self, t: float, h: float, after: Memory, error: float) -> Attempt:
        workspace, system = self.workspace, self.system
        all_rows = workspace.form.all_rows
        qs, vs = workspace.form.leave(workspace.states)
        q, v = qs[END].copy(), vs[END].copy()  # those of the stages need not be kept with it
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        there = State(t + h, q, v, all_rows(after.multipliers), stress, after)
        multipliers = all_rows(workspace.places.multipliers[:END]) if system.driven else None
        nodes = (t + NODES * h, qs[:END], vs[:END], WEIGHTS * h)
        return Attempt(there, error, ORDER, 0.0, STAGES, nodes=nodes, multipliers=multipliers)


def _joined(first: Attempt, second: Attempt, lengths: tuple[float, ...]) -> Attempt:
    """Two accepted steps as one. Its error is what the longer one tells of a step as long as both: by it the next is planned."""
    longer, error = max(zip(lengths, (first.error, second.error)))
    whole = min(1.0, max(first.error, second.error, error * (sum(lengths) / longer) ** ORDER))
    assert first.nodes and second.nodes
    t, q, v, weights = (np.concatenate(pair) for pair in zip(first.nodes, second.nodes))
    multipliers = None
    if first.multipliers is not None and second.multipliers is not None:
        multipliers = np.concatenate((first.multipliers, second.multipliers))
    return second._replace(error=whole, solves=first.solves + second.solves, nodes=(t, q, v, weights), multipliers=multipliers)


def _size(form: Form, errors: Array) -> float:
    """The estimate of Hairer, Norsett and Wanner, II.10: the embedded orders 5 and 3 together, each the larger of position and velocity."""
    fifth, third = (max(each) for each in form.lengths(errors).tolist())
    return fifth**2 / np.sqrt(fifth**2 + 0.01 * third**2) if fifth > 0.0 else 0.0


def _fastest(workspace: Workspace, after: Memory) -> float:
    """The rate [1/s] of what oscillates or decays fastest, from two neighbouring states, the last stage and the end: the change of
    acceleration over those of position (oscillations) and velocity (dampers). Hairer and Wanner (1996), IV.2."""
    changes = np.vstack((after.w - workspace.states[END - 1], after.acceleration - workspace.rows[END + 1]))
    position, velocity, acceleration = workspace.form.lengths(changes).tolist()
    return max(np.sqrt(acceleration / position) if position > 0.0 else 0.0, acceleration / velocity if velocity > 0.0 else 0.0)
