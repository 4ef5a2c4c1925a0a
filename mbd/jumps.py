"""Jumps of users' own functions of time that nobody declared: looked for before a run, so that steps land on them.

A function is called at SAMPLES times of the run, a little off an even grid so that nothing keeps in step with them. Where it changes far more
than on either side, the change is followed by bisection: a jump persists down to neighbouring times on the clock, a kink or a steep
slope does not. What is shorter than the samples are apart stays unseen. All depends on the function and the span alone.
Functions that are data (``functions``) or declare their discontinuities are believed, and so are those that drives follow.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from .affine import Array
from .signal import Signal

SAMPLES = 2048

FAR = 8.0
"""A change is followed where it is so many times as large as the typical one before and that behind it."""

BESIDE = 6
"""Changes on each side that these are the medians of."""

MOST = 100
"""Changes that are followed at most, the largest."""

LOST, HALVINGS = 0.2, 6
"""Where the larger half of a change, halved so often, keeps less than this share of it, the function is continuous there."""

RESTLESS = 0.5
"""Share of the samples at which a function turns round from which on they do not show its course: less than four in a period."""


class Found(NamedTuple):
    """The times [k] at which functions jump: of each jump the first time with the new value; and how often functions whose course the samples
    do not show turn round in them, by the names of their items."""

    times: Array
    restless: dict[str, int]


def look(system: Any, start: float, end: float) -> Found:
    """Through all functions of loads that are their user's own and silent about jumps."""
    times, restless, at = [], {}, grid(start, end)
    for signal in (signal for kernel in system.loads for signal in kernel.signals if signal.function and not _tells(signal.function)):
        with np.errstate(all="ignore"):
            try:
                values = np.array([signal.function(t) for t in at.tolist()], dtype=float).reshape(SAMPLES, -1)
                if not np.isfinite(values).all():
                    continue
                turns = reversals(values)
                if turns > RESTLESS * SAMPLES:
                    restless[signal.item] = turns
                else:
                    times += [t for k in suspects(values) for t in followed(signal, at[k], at[k + 1])]
            except Exception:  # the run tells what a function does wrong, with the time and the item, if it comes there
                continue
    return Found(np.unique(np.array(times)), restless)


def _tells(function: Any) -> bool:
    """Whether jumps are declared, or there are none: functions as data are smooth where they say nothing."""
    from .functions.function import AsData

    return isinstance(function, AsData) or hasattr(function, "discontinuities")


def grid(start: float, end: float) -> Array:
    """[SAMPLES] ascending times from start to end; those between are moved at random, each time the same."""
    k = np.arange(SAMPLES)
    moved = k + 0.5 * np.random.default_rng(1).random(SAMPLES) * (k > 0) * (k < SAMPLES - 1)
    return start + (end - start) * moved / (SAMPLES - 1)


def reversals(values: Array) -> int:
    """At how many samples [k, d] the component that turns round most does so, by more than rounding."""
    changes = np.diff(values, axis=0)
    changes[np.abs(changes) <= 1e-12 * np.max(np.abs(values), axis=0)] = 0.0
    return int(np.max(np.sum(changes[1:] * changes[:-1] < 0.0, axis=0)))


def suspects(values: Array) -> list[int]:
    """The intervals of samples [k, d] in which a function changes far more than on either side of them."""
    changes = np.linalg.norm(np.diff(values, axis=0), axis=1)
    least = 1e-12 * np.max(np.abs(values), initial=0.0)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(changes, BESIDE, mode="reflect"), BESIDE)
    before, behind = np.median(windows[: changes.size], axis=1), np.median(windows[BESIDE + 1 :], axis=1)
    far = np.flatnonzero((changes > FAR * np.maximum(before, behind)) & (changes > least))
    return sorted(far[np.argsort(-changes[far], kind="stable")][:MOST].tolist())


def followed(signal: Signal, a: float, b: float) -> Iterator[float]:
    """The first time with the new value, of one jump between a and b; none where the change turns out to be none."""

    def ask(t: float) -> Array:
        return np.asarray(signal.function(t), dtype=float)  # type: ignore[misc]

    a, b, before, after, halvings = float(a), float(b), ask(float(a)), ask(float(b)), 0
    whole = float(np.linalg.norm(after - before))
    while a < (middle := 0.5 * (a + b)) < b:
        value = ask(middle)
        left, right = float(np.linalg.norm(value - before)), float(np.linalg.norm(after - value))
        a, b, before, after = (a, middle, before, value) if left >= right else (middle, b, value, after)
        halvings += 1
        if halvings >= HALVINGS and max(left, right) < LOST * whole:
            return
    yield b
