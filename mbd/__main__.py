"""``mbd COMMAND``, or ``python -m mbd COMMAND``: every command is a module of ``mbd.commands`` with ``HELP``, ``arguments(parser)`` and
``run(options)``, which returns the exit code.

    0    done
    1    a run stopped early, or a check found something wrong; what there is of the result is written
    2    nothing was run: wrong words on the command line, a wrong scene, no such file, a package missing
    130  stopped from the keyboard (Ctrl-C); what there is of the result is written
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from .errors import Interrupted, SceneError, SceneWarning, SimulationError

COMMANDS = ("run", "check", "statics", "modes", "verify", "work-precision", "derive", "examples", "schema")
STOPPED, REFUSED, INTERRUPTED = 1, 2, 130


def main(words: Sequence[str] | None = None) -> int:
    """Runs a command; returns the exit code."""
    options = _parser().parse_args(words)
    with warnings.catch_warnings():
        warnings.showwarning = _shown
        try:
            return options.run(options)
        except (SceneError, SimulationError, OSError, ImportError) as error:
            _tell(error)
            return STOPPED if isinstance(error, SimulationError) else REFUSED
        except KeyboardInterrupt as error:
            _tell(error)
            return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="mbd", description="Multibody dynamics with large deformations.", epilog=EPILOG)
    choices = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in COMMANDS:
        module = import_module(f"mbd.commands.{name.replace('-', '_')}")
        command = choices.add_parser(name, help=module.HELP, description=module.__doc__)
        module.arguments(command)
        command.set_defaults(run=module.run, parser=command)
    return parser


EPILOG = "Exit codes: 0 done; 1 stopped early, or something was found; 2 nothing was run; 130 stopped from the keyboard."


def _tell(error: BaseException) -> None:
    """What is wrong, on standard error, without a traceback."""
    if isinstance(error, KeyboardInterrupt):
        what = f"stopped from the keyboard at t = {error.time:g} s" if isinstance(error, Interrupted) else "stopped from the keyboard"
    else:
        what = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) and error.filename else str(error)
    for line in what.splitlines():
        print(f"mbd: {line}", file=sys.stderr)


def _shown(message: Any, category: type[Warning], *place: Any, **more: Any) -> None:
    what = "warning" if issubclass(category, SceneWarning) else category.__name__
    print(f"mbd: {what}: {message}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
