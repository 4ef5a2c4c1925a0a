"""What can go wrong, said in the user's words: bad scenes before a run, failures during one, corrections in between."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .result import Result


class SceneError(ValueError):
    """A scene that cannot be built. ``complaints`` holds every one of them, a line each."""

    def __init__(self, complaints: list[str]):
        self.complaints = list(complaints)
        super().__init__("\n".join(self.complaints))


class SimulationError(RuntimeError):
    """A run that stopped early: ``time`` [s], the ``item`` concerned (its name, or None) and the partial ``result`` (or None)."""

    def __init__(self, what: str, *, time: float, item: str | None = None, advice: str = "", result: Result | None = None):
        self.what, self.time, self.item, self.advice, self.result = what, float(time), item, advice, result
        where = f", at {item}" if item else ""
        hint = f". {advice}" if advice else ""
        super().__init__(f"t = {self.time:.9g}{where}: {what}{hint}")


class Interrupted(SimulationError):
    """A run that was stopped from the keyboard; ``result`` holds what it had reached."""


class SceneWarning(UserWarning):
    """Something in the scene that runs but that its author should know: redundant joints, a corrected start."""
