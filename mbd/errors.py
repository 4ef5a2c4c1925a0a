"""What can go wrong, said in the user's words: bad scenes before a run, failures during one, corrections in between."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .result import Result
    from .state import State


class SceneError(ValueError):
    """A scene that cannot be built. ``complaints`` holds every one of them, a line each."""

    def __init__(self, complaints: Sequence[str]):
        self.complaints = list(complaints)
        super().__init__("\n".join(self.complaints))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.complaints,)


class SimulationError(RuntimeError):
    """A run, or a search for balance, that cannot go on.

    what    what failed;  ``item``: at which joint, body, load or event, by name
    time    [s] when; None where no time is concerned, or the run has not said yet
    advice  three things to try, in this order
    state   the last good state, or None;  ``result``: what was found until then, a whole result but for its end, or None
    """

    def __init__(
        self, what: str, *, item: str, advice: Sequence[str], time: float | None = None, state: State | None = None, result: Result | None = None
    ):
        self.what, self.item, self.advice = what, item, tuple(advice)
        if not item or len(self.advice) != 3 or not all(self.advice):
            raise TypeError(f"SimulationError({what!r}): expected an item and three pieces of advice, found {item!r} and {self.advice!r}")
        self.time = None if time is None else float(time)
        self.state, self.result = state, result
        super().__init__(what)

    def __str__(self) -> str:
        when = "" if self.time is None else f"t = {self.time:.9g}, "
        kept = "" if self.result is None else f" (.result holds the run until t = {self.result.trajectory.t[-1]:.9g})"
        return f"{when}at {self.item}: {self.what}. Try: {'; '.join(f'({k}) {text}' for k, text in enumerate(self.advice, 1))}{kept}"

    def __reduce__(self) -> tuple[Any, ...]:
        details = {"time": self.time, "state": self.state, "result": _portable(self.result)}
        return _failed, (self.what, {"item": self.item, "advice": self.advice} | details)


def _failed(what: str, details: dict[str, Any]) -> SimulationError:
    return SimulationError(what, **details)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run: ``result`` is what it was until ``time`` [s], and ``mbd.resume(stop.result)`` goes on.

    A KeyboardInterrupt, so that loops and ``except Exception`` end as users expect. Where nothing catches it a script ends with one line and
    the exit code 130.
    """

    def __init__(self, result: Result):
        self.result, self.time = result, float(result.trajectory.t[-1])
        super().__init__(f"interrupted at t = {self.time:.9g}; the run until then is in .result, which mbd.resume continues")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.result,)

    def _render_traceback_(self) -> list[str]:
        """What IPython shows instead of a stack of frames."""
        return [f"mbd.Interrupted: {self} (here: sys.last_value.result)"]


def _portable(result: Any) -> Any:
    """The result, or None where its scene holds functions that cannot go to another process: the error itself must."""
    try:
        pickle.dumps(result)
    except (pickle.PicklingError, TypeError, AttributeError):
        return None
    return result


class SceneWarning(UserWarning):
    """Something in the scene that runs but that its author should know: redundant joints, a corrected start."""
