"""Why a run cannot go on: what failed in its last step, whose fault that is, and what helps against it."""

from __future__ import annotations

from typing import Any

import numpy as np

from .affine import Array
from .errors import SimulationError
from .system import System

NEARLY = 1e-3
"""Singular values of the scaled G below this share of the largest are those of a position that explains why steps fail."""

UNEVEN = 1e13
"""The ratio of masses from which on a failure is laid to it."""

LARGEST = 2000
"""Unknowns up to which the equations that lose their rank are looked for."""

STEPS = ("a smaller rtol, or mbd.Radau(stages=3), whose steps are shorter", "a smaller step, or mbd.Radau(), which adapts its own")
"""For methods that choose their steps, and for those that are given one."""


def stopped(system: System, linear: Any, method: Any, record: Any) -> SimulationError:
    """What stopped a run after the last state of its record."""
    kind = next((found for sign, found in _KINDS if sign in record.failure), _inexact)
    if record.late:
        kind = _late
    elif kind is not _left and uneven(system):
        kind = _uneven
    elif kind is not _left and _nearly_singular(system, linear, record.states[-1].q):
        kind = _singular
    elif kind is _singular and system.n_stresses and system.n + system.m <= LARGEST:  # joints hold their grip: something else is out of proportion
        kind = _stiff
    item, what, advice = kind(system, linear, record, STEPS[method.fixed is not None])
    return SimulationError(what, time=record.states[-1].t, item=item, advice=advice)


Found = tuple[str, str, tuple[str, str, str]]


def _left(system: System, linear: Any, record: Any, steps: str) -> Found:
    item = next(label for label, _ in system.joints.labels if f"{label!r} leaves" in record.failure)
    what = f"there is nothing left to slide on: {record.failure}"
    return item, what, ("end the run before by a terminal mbd.Event", "hold the point by a mbd.Stop at the ends", "make the cable longer")


def _late(system: System, linear: Any, record: Any, steps: str) -> Found:
    t = record.states[-1].t
    tick = np.spacing(abs(t))
    what = f"steps became as short as the clock can tell: numbers near t = {t:.3g} s are {tick:.3g} s apart ({record.failure})"
    zero = "start at t = 0: take the time of the start from that of functions of t, and from t_end"
    return fastest(system, record.states[-1]), what, (zero, "count t in a longer unit, and all that has seconds in it", "a larger rtol: longer steps")


def _uneven(system: System, linear: Any, record: Any, steps: str) -> Found:
    light, heavy, ratio = uneven(system)  # type: ignore[misc]
    state = record.states[-1]
    item = system.label(record.worst) if record.worst >= 0 else weakest(system, linear, state.q) or fastest(system, state)
    what = f"steps became too short between masses too far apart: {heavy!r} has {ratio:.1g} times the mass of {light!r} ({record.failure})"
    give = f"give {light!r} no mass, if joints hold it, or hold {heavy!r} by the ground, if it does not move"
    return item, what, (give, "check units of mass, density and area: print(mbd.check(scene))", steps)


def _singular(system: System, linear: Any, record: Any, steps: str) -> Found:
    item = weakest(system, linear, record.states[-1].q) or fastest(system, record.states[-1])
    what = f"steps became too short, next to a singular position of the joints: {record.failure}"
    look = "see what is in line or held twice there: print(mbd.check(scene, start=error.state))"
    return item, what, (look, "start a little beside that position, or change a length a little", f"{steps}; implicit methods pass most such places")


def _stiff(system: System, linear: Any, record: Any, steps: str) -> Found:
    state = record.states[-1]
    values = np.abs(system.stiffness(state.q, state.v, system.inputs(state.t), state.stress, state.multipliers))
    rows, cols = system.stiffness_rows, system.stiffness_cols
    item = str(system.owners[rows[int(np.argmax(values * linear.scale[rows] * linear.scale[cols]))]][0])
    what = f"steps became too short: stiffnesses are too unequal to be solved for together, the highest in {item!r} ({record.failure})"
    alike = "make elements more alike in length and stiffness; what is far stiffer than all else may be a RigidBody, or a joint"
    return item, what, (alike, "check units of E, A, I and density: print(mbd.check(scene))", steps)


def _newton(system: System, linear: Any, record: Any, steps: str) -> Found:
    item = system.label(record.worst) if record.worst >= 0 else fastest(system, record.states[-1])
    what = f"steps became too short: {record.failure}"
    look = f"look at the last states: error.result.plot(), and what acts on {item!r}: a stiffness or a force that sets in all at once?"
    return item, what, (look, steps, "declare the times at which functions of t jump: mbd.piecewise(function, at=[...])")


def _inexact(system: System, linear: Any, record: Any, steps: str) -> Found:
    item = fastest(system, record.states[-1])
    what = f"steps became too short: {record.failure}"
    rough = "see that functions of t and of measures are smooth, without noise; declare where they jump: mbd.piecewise(function, at=[...])"
    return item, what, (rough, f"look whether {item!r} is driven to infinity: error.result.energy.total", "a larger rtol, if less accuracy will do")


_KINDS = ((" leaves ", _left), ("singular equations", _singular), ("Newton's iteration", _newton))
"""Told by words of the solvers' own reasons."""


def uneven(system: System) -> tuple[str, str, float] | None:
    """The lightest and the heaviest item that have mass and their ratio, where rounding of the heavier is more than the lighter."""
    places = (system.mass_rows == system.mass_cols) & (system.levers[system.mass_rows] == 1.0)
    rows, masses = system.mass_rows[places], system.mass_values[places]
    if not masses.size or masses.max() < UNEVEN * masses.min():
        return None
    light, heavy = (system.owners[rows[k]][0] for k in (int(np.argmin(masses)), int(np.argmax(masses))))
    return light, heavy, float(masses.max() / masses.min())


def _nearly_singular(system: System, linear: Any, q: Array) -> bool:
    sizes = _decomposed(system, linear, q)[1]
    return bool(sizes.size and not linear.softened and sizes[-1] < NEARLY * sizes[0])


def fastest(system: System, state: Any) -> str:
    """The item that moves fastest."""
    return str(system.owners[int(np.argmax(np.abs(state.v) * system.levers))][0])


def weakest(system: System, linear: Any, q: Array) -> str | None:
    """The joint whose equation is nearest to following from the others; None where there are none, or too many to look."""
    left, sizes = _decomposed(system, linear, q)
    if not sizes.size:
        return None
    order = np.argsort(-np.abs(left[:, sizes.size - 1]))
    names = [system.label(int(row)) for row in order]
    return next((name for name in names if name not in system.internal), names[0])


def _decomposed(system: System, linear: Any, q: Array) -> tuple[Array, Array]:
    """Left singular vectors and singular values of the scaled G; none where there are no joints, or too many unknowns."""
    from .solvers.start import scaled_gradient

    if not system.m or system.n + system.m > LARGEST:
        return np.zeros((0, 0)), np.zeros(0)
    left, sizes, _ = np.linalg.svd(scaled_gradient(system, linear, q))
    return left, sizes


def undetermined(system: System, linear: Any, q: Array, t: float, trouble: Exception) -> SimulationError:
    """No accelerations and multipliers in a position."""
    item = weakest(system, linear, q) or system.owners[0][0]
    advice = (
        "see what is in line or held twice there: print(mbd.check(scene, start=mbd.State(q, v, t)))",
        "take a position a little beside: another time, or another start=mbd.State(q, v)",
        "give what no joint holds some mass, and take away what holds a second time",
    )
    return SimulationError(f"accelerations and reactions are not determined there ({trouble})", time=t, item=item, advice=advice)


def unknown_between(system: System, linear: Any, before: Any, after: Any, trouble: ArithmeticError) -> SimulationError:
    """No values between two steps."""
    rows = getattr(getattr(trouble, "defect", None), "rows", [])
    item = system.label(rows[0]) if rows else weakest(system, linear, before.q) or fastest(system, before)
    advice = (
        "ask for times of the steps themselves, without t= and t_eval=: they are known",
        f"run again with a smaller rtol or step: that from {before.t:.9g} to {after.t:.9g} s is too long to be solved anew",
        "run again with mbd.Radau(), whose values between steps stand nearly singular positions",
    )
    return SimulationError(f"no values between two steps: {trouble}", time=before.t, item=item, advice=advice)
