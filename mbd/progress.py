"""What a run was asked and how far it came: all that ``mbd.resume`` and files need to go on with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from .affine import Array
from .event import Event
from .state import State
from .trajectory import Trajectory
from .watch import Seen
from .work import Pending

if TYPE_CHECKING:
    from .solvers.march import Counts
    from .solvers.pace import Rhythm


class Mark(NamedTuple):
    """Where a part is between two steps: all that its further way depends on.

    ``state`` is that of the solver, with what it remembers; ``steps`` those before it; ``seen`` is None in a run without events.
    """

    steps: int
    state: Any
    rhythm: Rhythm
    counts: Counts
    factorizations: int
    pending: Pending
    seen: Seen | None


@dataclass(frozen=True, eq=False)
class Plan:
    """What a run was asked: where it starts (as given, before anything was corrected), t_end [s], rtol, ``t_eval`` [k] or None, and events by
    name: None where only the name is known, from a file."""

    start: State
    t_end: float
    rtol: float
    t_eval: Array | None
    events: Mapping[str, Event | None]

    def __getstate__(self) -> dict[str, Any]:
        """Without the functions of events, which other processes may not know."""
        return vars(self) | {"events": dict.fromkeys(self.events)}


@dataclass(frozen=True, eq=False)
class Stage:
    """What one part did: all its steps, the mark to go on from (None: from its start), whether its matrix allows redundant joints, how many
    factorizations its start took, and why its solver was chosen."""

    trajectory: Trajectory
    fork: Mark | None
    softened: bool
    spent: int
    reason: str


@dataclass(frozen=True, eq=False)
class Progress:
    """How far a run came, for ``mbd.resume`` and for files."""

    plan: Plan
    stages: tuple[Stage, ...]
