"""Explicit steps across a singular position of the joints: in two parts, so that it lies where none of their stages does.

What moves is smooth there, only the equations for its acceleration are not. Next to such a position a stage's small error becomes a large
one of its acceleration; the widest gaps between stages leave it room. Which stage came too near tells where the position is.
"""

from __future__ import annotations

import numpy as np

from .dop853 import NODES
from .places import NearlySingular

FIRST = np.linspace(0.1, 0.9, 81)
"""Lengths of the first part that are looked at, as shares of the step."""

NO_ROOM = 0.03
"""Distance from a singular position to the nearest stage, as a share of the step, below which two parts do not avoid it any better."""


def _division(place: float) -> float:
    """The length of the first part that puts a place, both as shares of the step, farthest from all stages; 0 where that is near one."""
    nodes, first = np.append(NODES, 1.0), FIRST[:, None]
    free = np.abs(np.hstack((first * nodes, first + (1.0 - first) * nodes)) - place).min(axis=1)
    return float(FIRST[free.argmax()]) if free.max() > NO_ROOM else 0.0


DIVISIONS = tuple(_division(place) for place in (*NODES.tolist(), 1.0))
"""By the stage that is nearest to a singular position, the end last."""


def parts(near: NearlySingular, h: float) -> tuple[float, float]:
    """The lengths of the two parts of a step of length h, of which a stage came too near; raises that again where two parts do not avoid it."""
    first = DIVISIONS[near.place] * h
    if not first:
        raise near
    return first, h - first
