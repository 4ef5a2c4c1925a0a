"""What a user should know of a run that ended well before believing it: each reason a text."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .errors import SceneWarning

if TYPE_CHECKING:
    from .result import Result

COARSE = 0.03
"""The sum of the errors estimated in fixed steps, as a share of the length, above which a run is not to be trusted."""


def caution(result: Result) -> None:
    """Warns, in the name of who called the function that calls this."""
    for reasons in (imbalances, coarse_steps, leaps, singular_positions, doubts):
        for text in reasons(result):
            warnings.warn(text, SceneWarning, stacklevel=3)


def imbalances(result: Result) -> Iterator[str]:
    """An energy that does not add up is the one sign of an unstable or far too coarse run that every scene gives."""
    audit = result.audit
    pieces = result.trajectory.pieces()
    for piece, part in zip(pieces, audit.parts or (audit,)):
        if not part.balanced:
            where = f" of {', '.join(map(repr, piece.part.items[:3]))}" if len(pieces) > 1 else ""
            yield (
                f"the energy{where} is off by {part.energy_error:.3g} J where {part.energy_scale:.3g} J were exchanged: "
                "do not trust this run; lower rtol or the step"
            )


def coarse_steps(result: Result) -> Iterator[str]:
    """Nothing controls fixed steps: their errors are added up instead."""
    worst = result.stats["coarseness"]
    if worst > COARSE:
        yield (
            f"the fixed steps are too long: errors estimated in them add up to {worst:.2g} of the scene's length: "
            "do not trust this run; take shorter steps or a solver with error control"
        )


def leaps(result: Result) -> Iterator[str]:
    """Steps see a function of time where they call it; between that it may do anything."""
    if names := result.stats["leapt over"]:
        yield (
            f"the functions of t of {', '.join(map(repr, names))} change more often, or for a shorter time, than the run has steps: these may have "
            "leapt over what they do. If it matters, do not trust this run: tell the times by mbd.piecewise, or run shorter spans, and compare"
        )


def singular_positions(result: Result) -> Iterator[str]:
    """Where joints lose their grip a mechanism may go on in two ways, and equations do not say in which."""
    from .passages import passages

    found = sorted(passage for piece in result.trajectory.pieces() for passage in passages(piece))
    if found:
        t, items = found[0]
        yield (
            f"joints {', '.join(map(repr, items))} went through a singular position at t = {t:.6g} s: there they hold less than elsewhere, and "
            "the motion may go on in another way too; the smooth one was followed. If no such position is meant to be reached, do not trust this "
            "run: lower rtol; mbd.check(scene, state) tells more"
        )


def doubts(result: Result) -> Iterator[str]:
    """What items know of the limits of their own formulation."""
    for item in result.scene.items:
        if hasattr(item, "doubts"):
            yield from item.doubts(result.q)
