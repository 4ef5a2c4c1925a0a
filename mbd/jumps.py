"""Jumps of users' own functions of time that nobody declared: looked for before a run, so that steps land on them.

A function is called at SAMPLES times of the run, a little off an even grid so that nothing keeps in step with them. Where it leaves its
course, the change is followed by bisection: a jump persists down to neighbouring times on the clock, a kink or a steep
slope does not. What is shorter than the samples are apart shows where the function compares its time with numbers (``thresholds``): there
it is looked at as well, and where it jumps or gets far steeper than the samples show, steps land. What neither shows stays
unseen, such as a smooth bump by a formula. All depends on the function and the span alone.
Functions that are data (``functions``) or declare their discontinuities are believed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .signal import BESIDE as BESIDE_JUMP
from .signal import Signal, same
from .thresholds import thresholds

SAMPLES = 2048

FAR = 8.0
"""A change is followed where it is so many times as far off the course around it as those before and those behind it are."""

BESIDE = 4
"""Changes on each side that tell this course and, by their median, how far off it is usual."""

MOST = 100
"""Changes that are followed at most, the largest."""

LOST, HALVINGS = 0.2, 6
"""Where the larger half of a change, halved so often, keeps less than this share of it, the function is continuous there."""

COMPARED = 64
"""Samples at which it is noted what a function compares its time with."""

ROUNDING = 1e-9
"""Smaller changes, as a share of a function's value, are none."""

FEW = 16
"""Times that tell a function's size."""

STILL = 1e-12
"""Changes of a drive that move nothing, in metres (of a scene longer than one) and radians: of a smooth start they are what rounding leaves."""

MOST_STEPS = sys.maxsize
"""More often than any run has steps."""

RESTLESS = 0.5
"""Share of the samples at which a function turns round from which on they do not show its course: less than four in a period."""


class Found(NamedTuple):
    """The times [k] at which functions jump, of each jump the first time with the new value, or where they get steep between samples; and how
    often functions whose course the samples do not show turn round in them, by the names of their items."""

    times: Array
    restless: dict[str, int]


def look(system: Any, start: float, end: float) -> Found:
    """Through all functions of loads and drives that are their user's own and silent about jumps. Of drives, whose jumps no motion could
    follow, only those that lie between samples are told, as restless."""
    at = grid(start, end)
    times, restless = [], {}
    for signal in _silent(kernel.signals for kernel in system.loads):
        found, turns = _seen(signal, at, 0.0)
        times += found
        if turns:
            restless[signal.item] = turns
    for signal in _silent(target.signals for _, target in system.joints.drives):
        found, turns = _seen(signal, at, STILL * min(1.0, system.length))
        if np.any(np.diff(np.unique(found)) < np.min(np.diff(at))):
            turns = MOST_STEPS
        if turns:
            restless[signal.item] = turns
    return Found(np.unique(np.array(times)), restless)


def _silent(signals: Iterable[Iterable[Signal]]) -> Iterator[Signal]:
    return (signal for each in signals for signal in each if signal.function and not _tells(signal.function))


def _seen(signal: Signal, at: Array, least: float) -> tuple[list[float], int]:
    """The jumps of one function, and how often it turns round, by more than ``least``, if that is more often than samples or comparisons can
    show, else 0."""
    assert signal.function is not None
    with np.errstate(all="ignore"):
        try:
            values = np.array([signal.function(t) for t in at.tolist()], dtype=float).reshape(SAMPLES, -1)
            if not np.isfinite(values).all():
                return [], 0
            turns = reversals(values, least)
            if turns > RESTLESS * SAMPLES:
                return [], turns
            hidden, turns = _hidden(signal, values, at)
            return [*hidden, *(t for k in suspects(values, at) for t in followed(signal, at[k], at[k + 1]))], turns
        except Exception:  # the run tells what a function does wrong, with the time and the item, if it comes there
            return [], 0


def _hidden(signal: Signal, values: Array, at: Array) -> tuple[list[float], int]:
    """Jumps and steep places where the function compares its time with numbers; and how often it turns round there, if more often than
    can be looked at, or faster than the clock tells, else 0."""
    assert signal.function is not None
    try:
        between, every = thresholds(signal.function, at[:: SAMPLES // COMPARED].tolist(), float(at[-1]))
    except Exception:  # it takes plain numbers only
        between, every = [], True
    if not between:
        return [], 0
    changes, beside = np.linalg.norm(np.diff(values, axis=0), axis=1), BESIDE_JUMP * float(np.spacing(max(abs(at[0]), abs(at[-1]))))
    size = float(np.max(np.linalg.norm(values, axis=1)))
    steep, small = FAR * float(np.max(changes / np.diff(at))), max(ROUNDING * size, 0.0 if every else float(np.median(changes)))
    room = np.minimum(np.diff(np.array([at[0], *between, at[-1]])), np.min(np.diff(at))).tolist()
    found = []
    for t, before, after in zip(between, room, room[1:]):
        found += [*_jump(signal, t, beside, small), *_steep(signal, t, (-before, after), steep)]
    lost = any(same(b, a) and _sticks_out(signal, a, b, size) for a, b in zip(between, between[1:]))
    return found, MOST_STEPS if lost or (found and not every) else 0


def _jump(signal: Signal, t: float, beside: float, small: float) -> list[float]:
    """A jump that is neither small nor rounding, that near to a time."""
    before, after = _value(signal, t - beside), _value(signal, t + beside)
    rounding = ROUNDING * max(float(np.linalg.norm(before)), float(np.linalg.norm(after)))
    return list(followed(signal, t - beside, t + beside)) if np.linalg.norm(after - before) > max(small, rounding) else []


def _steep(signal: Signal, t: float, room: tuple[float, float], most: float) -> list[float]:
    """The time where the function is steeper on one of its sides than at most so much."""
    for width in (0.125 * each for each in room):
        near, far = _value(signal, t + width), _value(signal, t + 2.0 * width)
        if np.linalg.norm(far - near) > most * abs(width) + ROUNDING * np.linalg.norm(near):
            return [t]
    return []


def _tells(function: Any) -> bool:
    """Whether jumps are declared, or there are none: functions as data are smooth where they say nothing."""
    from .functions.function import AsData

    return isinstance(function, AsData) or hasattr(function, "discontinuities")


def grid(start: float, end: float) -> Array:
    """[SAMPLES] ascending times from start to end; those between are moved at random, each time the same."""
    k = np.arange(SAMPLES)
    moved = k + 0.5 * np.random.default_rng(1).random(SAMPLES) * (k > 0) * (k < SAMPLES - 1)
    return start + (end - start) * moved / (SAMPLES - 1)


def reversals(values: Array, least: float) -> int:
    """At how many samples [k, d] the component that turns round most does so, by more than rounding and more than ``least``."""
    changes = np.diff(values, axis=0)
    changes[np.abs(changes) <= np.maximum(1e-12 * np.max(np.abs(values), axis=0), least)] = 0.0
    return int(np.max(np.sum(changes[1:] * changes[:-1] < 0.0, axis=0)))


def suspects(values: Array, times: Array) -> list[int]:
    """The intervals of samples [k, d] in which a function leaves the course that those around them have."""
    steps = np.diff(times)
    slopes = np.diff(values, axis=0) / steps[:, None]
    off = np.linalg.norm(slopes - np.median(_around(slopes), axis=-1), axis=1)
    beside = _around(off)
    usual = np.maximum(np.median(beside[:, :BESIDE], axis=1), np.median(beside[:, BESIDE + 1 :], axis=1))
    far = np.flatnonzero((off > FAR * usual) & (off * steps > 1e-12 * np.max(np.abs(values), initial=0.0)))
    return sorted(far[np.argsort(-off[far], kind="stable")][:MOST].tolist())


def _around(x: Array) -> Array:
    """[k, ..., 2 BESIDE + 1] each of the entries of x [k, ...] with its neighbours, mirrored at both ends."""
    wide = np.pad(x, ((BESIDE, BESIDE), *((0, 0),) * (x.ndim - 1)), mode="reflect")
    return np.lib.stride_tricks.sliding_window_view(wide, 2 * BESIDE + 1, axis=0)


def lost(system: Any, start: float, end: float) -> list[str]:
    """Complaints about declared pulses within a run that are too short for its clock: steps take both ends of such a one for the same time."""
    found = []
    for signal in (signal for kernel in system.loads for signal in kernel.signals):
        declared = signal.discontinuities
        for a, b in zip(declared, declared[1:]):
            if start <= a < end and same(b, a) and _sticks_out(signal, a, b, _size(signal, start, end)):
                found.append(
                    f"{signal.item!r}: expected times of jumps that differ by more than rounding, found a pulse of {b - a:.3g} s at t = {a:.9g} s, "
                    f"where the clock tells {np.spacing(a):.3g} s; give it as velocities at a start= there, or make it longer and weaker"
                )
    return found


def _size(signal: Signal, start: float, end: float) -> float:
    """The largest value at a few times of a run; 0 where there is none."""
    try:
        return max(float(np.linalg.norm(_value(signal, t))) for t in np.linspace(start, end, FEW).tolist())
    except Exception:  # as above
        return 0.0


def _sticks_out(signal: Signal, a: float, b: float, size: float) -> bool:
    """Whether a function of that size is elsewhere between two times than on the way from before to behind them."""
    far = 2.0 * BESIDE_JUMP * np.spacing(max(abs(a), abs(b)))
    try:
        before, within, behind = (_value(signal, float(t)) for t in (a - far, 0.5 * (a + b), b + far))
    except Exception:  # as above
        return False
    return bool(np.linalg.norm(within - before) > 2.0 * np.linalg.norm(behind - before) + 1e-3 * max(size, float(np.linalg.norm(before))))


def _value(signal: Signal, t: float) -> Array:
    assert signal.function is not None
    return np.asarray(signal.function(t), dtype=float)


def followed(signal: Signal, a: float, b: float) -> Iterator[float]:
    """The first time with the new value, of one jump between a and b; none where the change turns out to be none."""
    a, b, halvings = float(a), float(b), 0
    before, after = _value(signal, a), _value(signal, b)
    whole = float(np.linalg.norm(after - before))
    while a < (middle := 0.5 * (a + b)) < b:
        value = _value(signal, middle)
        left, right = float(np.linalg.norm(value - before)), float(np.linalg.norm(after - value))
        a, b, before, after = (a, middle, before, value) if left >= right else (middle, b, value, after)
        halvings += 1
        if halvings >= HALVINGS and max(left, right) < LOST * whole:
            return
    yield b
