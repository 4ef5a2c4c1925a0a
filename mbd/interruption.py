"""How a script ends that Ctrl-C interrupted in a run: one line and the exit code of interrupted programs, no stack of frames."""

from __future__ import annotations

import sys
import threading
from types import TracebackType

from .errors import Interrupted

CODE = 130
"""128 + SIGINT, as shells have it."""


def quietly() -> None:
    """Lets an Interrupted that nothing catches end the program in one line. Where the program, or what runs it, shows exceptions in a way
    of its own, that stays."""
    if sys.excepthook is sys.__excepthook__ and threading.current_thread() is threading.main_thread() and not hasattr(sys, "ps1"):
        sys.excepthook = _told


def _told(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not isinstance(error, Interrupted):
        return sys.__excepthook__(kind, error, trace)
    print(f"mbd: {error}", file=sys.stderr)
    raise SystemExit(CODE)
