"""Consistent starts of all parts of a scene, and their report as one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .assembly import Assembly, consistent
from .errors import SceneError
from .parts import Part
from .state import State


def starts(parts: Sequence[Part], state: State) -> list[Assembly]:
    """A consistent start of each part near a state of the scene. Raises SceneError with the complaints of all of them."""
    found, complaints = [], []
    for part in parts:
        try:
            found.append(consistent(part.system, State(state.q[part.columns], state.v[part.columns], state.t)))
        except SceneError as error:
            complaints += error.complaints
    if complaints:
        raise SceneError(complaints)
    return found


def together(assemblies: Sequence[Assembly], parts: Sequence[Part], n: int) -> Assembly:
    """The assembly of a scene of n coordinates; one of several parts has no linear algebra of its own."""
    if len(parts) == 1:
        return assemblies[0]
    q, v = np.empty(n), np.empty(n)
    for part, each in zip(parts, assemblies):
        q[part.columns], v[part.columns] = each.state.q, each.state.v
    corrections = tuple(correction for each in assemblies for correction in each.corrections)
    redundant = tuple(name for each in assemblies for name in each.redundant)
    no_matrix: Any = None
    return Assembly(State(q, v, assemblies[0].state.t), corrections, redundant, no_matrix)
