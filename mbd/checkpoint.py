"""Partial results in a file while a run goes on."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .result import Result
    from .scene import Scene

RARELY = 20.0
"""Writing takes one part in this of a run at most."""


class Checkpoint:
    """A file that is written anew, whole or not at all, every so many seconds of wall time; and at the end of the run, whatever ends it.

    Raises ValueError for a scene that cannot be stored, at once.
    """

    def __init__(self, scene: Scene, path: Any, every: float):
        from .descriptions import described

        described(scene)
        self._path, self._pause, self._every, self._last = path, every, every, time.perf_counter()

    def perhaps(self, result: Callable[[], Result]) -> None:
        """Writes the result if it is time."""
        if (begun := time.perf_counter()) - self._last >= self._pause:
            self.write(result())
            self._last = time.perf_counter()
            self._pause = max(self._every, RARELY * (self._last - begun))

    def write(self, result: Result) -> None:
        from .archive import write

        write(result, self._path)
