"""Explicit Runge-Kutta of order 8 on the accelerations, projected to the joints after each step: for systems where nothing is stiff.

Dormand and Prince's method (``nystrom.py``) for q'' = a(q, q', t) with index-1 accelerations (``index_one.py``); positions, then
velocities, are projected at the end of each step. Hairer, Norsett and Wanner (1993), II.10; Eich (1993), SIAM J. Numer. Anal. 30.
A step that comes near a singular position of the joints fails and says so: it is for an implicit method to go on (``automatic.py``).
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .dop853 import NODES, WEIGHTS
from .formats import Singular
from .index_one import Form, index_one
from .linear import Linear
from .nystrom import END, STAGES, combinations
from .protocol import Attempt, State
from .start import Inconsistent
from .system import Array, System

STRICT = 0.1
"""The local error aimed at, as a share of the tolerance: what steps of this size leave adds up over the long spans they cover."""

OBVIOUS = 100.0
"""Error over tolerance up to which a step is taken for too long in the first place, whatever its stages come near. Beyond, it may be a singular
position that makes it large: shorter steps only creep up to it."""


@dataclass(frozen=True)
class DormandPrince:
    """Explicit, order 8, with projection to the joints and error control; for scenes without stiff elements."""

    def integrator(self, rtol: float) -> ProjectedExplicit:
        """The method for a tolerance."""
        return ProjectedExplicit()


class Memory(NamedTuple):
    """The state in the form prepared for the system, with its accelerations and multipliers.

    ``stiffness`` is the last step times the fastest rate seen in it, of elastic systems: near 6 stability limits steps, not accuracy.
    """

    w: Array
    acceleration: Array
    multipliers: Array
    stiffness: float = 0.0


_BETWEEN, _AT_END, _ALL = slice(1, END), slice(END, END + 1), slice(1, END + 1)


class Bench:
    """A form of a system, and room for one step: its states at stages and end [stages + 1, 2, ...], and rows of position and velocity at its
    start and the accelerations of all states [3 + stages, ...], of which states are sums."""

    def __init__(self, linear: Linear, form: Form):
        self.linear, self.form = linear, form
        self.rows, self.states = np.zeros((3 + STAGES, form.width)), np.zeros((STAGES + 1, 2, form.width))
        self.places = form.places(self.states, self.rows[2:])
        self._table = self.rows[: 2 + STAGES]
        self._sums = np.empty((STAGES + 3, 2, 2 + STAGES))
        self._ends = self._sums[END:].reshape(-1, 2 + STAGES)
        self._plan = [(self._sums[i, :, : i + 2], self.rows[: i + 2], self.states[i], i, float(NODES[i])) for i in range(1, STAGES)]

    def step(self, system: System, memory: Memory, t: float, h: float) -> Array:
        """[3, 2, ...]: the state at the end, not yet moved to the joints, and two estimates of its error, velocities times h. Raises Singular
        where a state is; nearly singular ones show in a check."""
        combinations(h, self._sums)
        self.states[0] = self.rows[:2] = memory.w
        self.rows[2], self.places.multipliers[0] = memory.acceleration, memory.multipliers
        rates = self.places.rates
        for weights, rows, state, place, node in self._plan:
            np.dot(weights, rows, state)
            rates(system, place, t + node * h)
        return self._ends.dot(self._table).reshape(3, 2, -1)

    def remembered(self, system: System, t: float, w: Array) -> Memory:
        """Of a state to start from. Raises Singular."""
        self.states[END] = w
        self.places.rates(system, END, t)
        self.places.check(_AT_END)
        return self._end()

    def landed(self, system: System, t: float, w: Array) -> Memory:
        """The end of the last step, moved to the joints. Raises Inconsistent where there are none near, and Singular."""
        self.states[END] = w
        self.places.land(system, END, t)
        self.places.check(_ALL)
        return self._end()

    def _end(self) -> Memory:
        return Memory(self.states[END].copy(), self.rows[-1].copy(), self.places.multipliers[END].copy())


class _Prepared(threading.local):
    """What a method has prepared for the system asked last, in each thread its own; its making costs as much as a step."""

    bench: Bench | None = None


class ProjectedExplicit:
    """The method."""

    name = "projected Dormand-Prince (order 8, explicit)"
    fixed: float | None = None

    def __init__(self) -> None:
        self._prepared = _Prepared()

    def __reduce__(self) -> tuple[type, tuple[()]]:
        return ProjectedExplicit, ()

    def first_step(self, system: System, state: State, acceleration: Array, span: float, tolerance: float) -> float:
        """A step over which velocities and accelerations move things by a modest part of the length."""
        speed = float(np.max(np.abs(state.v) * system.levers, initial=0.0))
        pull = float(np.max(np.abs(acceleration) * system.levers, initial=0.0))
        reach = system.length * (tolerance / system.length) ** (1.0 / 8.0)
        steps = [span, *([reach / speed] if speed > 0.0 else []), *([np.sqrt(2.0 * reach / pull)] if pull > 0.0 else [])]
        return 0.1 * min(steps)

    def kept(self, memory: Memory | None) -> None:
        """Nothing: values inside a step are the ends of shorter ones."""

    def step(self, system: System, linear: Linear, state: State, h: float, tolerance: float) -> Attempt:
        """One step of length h; ``tolerance`` is a length: the local error allowed in positions."""
        bench = self._bench(system, linear)
        try:
            memory = self._remembered(system, bench, state)
            end = bench.step(system, memory, state.t, h)
            error = _size(bench.form, end[1:]) / (STRICT * min(tolerance, linear.coarsest))
            if not error <= 1.0:
                if not error < OBVIOUS:
                    bench.places.check(_BETWEEN)
                return Attempt(state, error if np.isfinite(error) else 1e8, 8.0, 0.0, 0)
            after = bench.landed(system, state.t + h, end[0])
        except (Singular, Inconsistent) as trouble:
            return Attempt(None, np.inf, 1.0, 0.0, 0, f"singular equations ({trouble})")
        if system.n_stresses or system.damped:
            after = after._replace(stiffness=h * _fastest(bench, after))
        return self._accepted(system, bench, state.t, h, after, error)

    def _accepted(self, system: System, bench: Bench, t: float, h: float, after: Memory, error: float) -> Attempt:
        all_rows = bench.form.all_rows
        qs, vs = bench.form.leave(bench.states)
        q, v = qs[END].copy(), vs[END].copy()  # those of the stages need not be kept with it
        stress = system.stress(system.strains(q), v) if system.n_stresses else np.zeros(0)
        there = State(t + h, q, v, all_rows(after.multipliers), stress, after)
        multipliers = all_rows(bench.places.multipliers[:END]) if system.driven else None
        nodes = (t + NODES * h, qs[:END], vs[:END], WEIGHTS * h)
        return Attempt(there, error, 8.0, 0.0, STAGES, nodes=nodes, multipliers=multipliers)

    def _bench(self, system: System, linear: Linear) -> Bench:
        bench = self._prepared.bench
        if bench is None or bench.linear is not linear:
            bench = self._prepared.bench = Bench(linear, index_one(system, linear))
        return bench

    def _remembered(self, system: System, bench: Bench, state: State) -> Memory:
        if isinstance(state.memory, Memory):
            return state.memory
        return bench.remembered(system, state.t, bench.form.enter(state.q, state.v))

    def inside(self, system: System, linear: Linear, before: State, after: State, times: Array) -> tuple[Array, Array]:
        """q, v [n_t, n] at times within a step: the ends of steps of their own from its start, as accurate as the step itself."""
        q, v = np.empty((times.size, system.n)), np.empty((times.size, system.n))
        bench = self._bench(system, linear)
        try:
            start = self._remembered(system, bench, before)
            for k, t in enumerate(times.tolist()):
                end = bench.step(system, start, before.t, t - before.t)
                q[k], v[k] = bench.form.leave(bench.landed(system, t, end[0]).w)
        except (Singular, Inconsistent) as trouble:
            raise ArithmeticError(f"no interpolation at {t:.9g} s: the joints are in a nearly singular position ({trouble})") from None
        return q, v


def _size(form: Form, errors: Array) -> float:
    """The estimate of Hairer, Norsett and Wanner, II.10: the embedded orders 5 and 3 together, each the larger of position and velocity."""
    fifth, third = (max(each) for each in form.lengths(errors).tolist())
    return fifth**2 / np.sqrt(fifth**2 + 0.01 * third**2) if fifth > 0.0 else 0.0


def _fastest(bench: Bench, after: Memory) -> float:
    """The rate [1/s] of what oscillates or decays fastest, from two neighbouring states, the last stage and the end: the change of
    acceleration over those of position (oscillations) and velocity (dampers). Hairer and Wanner (1996), IV.2."""
    changes = np.vstack((after.w - bench.states[END - 1], after.acceleration - bench.rows[END + 1]))
    position, velocity, acceleration = bench.form.lengths(changes).tolist()
    return max(np.sqrt(acceleration / position) if position > 0.0 else 0.0, acceleration / velocity if velocity > 0.0 else 0.0)
