"""The arrays of a trajectory in files: of a whole scene as they are, of its parts all of a name in one row."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .affine import Array
from .parts import Part
from .system import System
from .trajectory import Trajectory

STATE = ("t", "q", "v", "multipliers", "stress", "method")
"""What is kept of the solver's states, in their order: all but what it remembers to predict the next step."""
ARRAYS = (*STATE, "work")
CHOSEN = ("chosen_t", "chosen_q", "chosen_v")
"""The times that ``t_eval`` asked for and the values there; only in results that have them."""
START, FORK, WANTED = ("start_q", "start_v"), "fork", "wanted"
"""The start as it was given, what going on needs, and the times that ``t_eval`` asked for, where it did."""
EVENTS = ("event_t", "event_q", "event_v")
"""Times and states of all events, one after the other; the head says how many belong to which."""


def gathered(pieces: Sequence[Trajectory], divided: bool) -> dict[str, Array]:
    """The arrays of all parts, or where the scene was not divided those of the one that it is."""
    each = [{name: np.array([getattr(state, name) for state in piece.states]) for name in STATE} | {"work": piece.work} for piece in pieces]
    return each[0] if not divided else {name: np.concatenate([own[name].ravel() for own in each]) for name in ARRAYS}


def divided(arrays: dict[str, Array], parts: list[Part], steps: list[int]) -> list[dict[str, Array]]:
    """The arrays of each part, checked. They are in one row, and ``steps`` says how many are whose; none: the whole scene's."""
    if not steps:
        pieces = [{name: arrays[name] for name in ARRAYS}]
    else:
        if not all(isinstance(count, int) and count > 0 for count in steps):
            raise ValueError(f"parts: expected counts of steps, found {steps!r}")
        pieces = [{} for _ in parts]
        for name in ARRAYS:
            shapes = [(count, *_widths(part.system)[name]) for count, part in zip(steps, parts)]
            ends = np.cumsum([math.prod(shape) for shape in shapes])
            if arrays[name].shape != (ends[-1],):
                raise ValueError(f"{name}: expected {ends[-1]} numbers in one row, found shape {arrays[name].shape}")
            for piece, shape, values in zip(pieces, shapes, np.split(arrays[name], ends[:-1])):
                piece[name] = values.reshape(shape)
    for piece, part in zip(pieces, parts):
        check_shapes(piece, part.system)
        if not len(piece["t"]) or np.any(np.diff(piece["t"]) <= 0.0):
            raise ValueError("t: expected one time or more, ascending, found others")
    return pieces


def check_shapes(arrays: dict[str, Array], system: System) -> None:
    """Raises ValueError unless all are finite and fit the system."""
    widths = _widths(system) | {WANTED: ()}
    for name, array in arrays.items():
        first = CHOSEN[0] if name in CHOSEN else EVENTS[0] if name in EVENTS else WANTED if name == WANTED else "t"
        length = () if name in START else (len(arrays[first]),)
        shape = (*length, *widths[name.removeprefix("chosen_").removeprefix("event_").removeprefix("start_")])
        if not (array.shape == shape and np.isfinite(array).all()):
            raise ValueError(f"{name}: expected finite numbers of shape {shape}, found shape {array.shape}, or NaN among them")


def _widths(system: System) -> dict[str, tuple[int, ...]]:
    """What follows the number of steps in the shapes of arrays."""
    own: dict[str, tuple[int, ...]] = {"t": (), "work": (), "method": (), "multipliers": (system.m,), "stress": (system.n_stresses,)}
    return own | {"q": (system.n,), "v": (system.n,)}
