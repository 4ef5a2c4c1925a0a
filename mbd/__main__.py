"""``python -m mbd COMMAND``: every command is a module of ``mbd.commands`` with ``HELP``, ``arguments(parser)`` and ``run(options)``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

COMMANDS = ("derive",)


def main(words: Sequence[str] | None = None) -> int:
    """Runs a command; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m mbd", description="Multibody dynamics with large deformations.")
    choices = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in COMMANDS:
        module = import_module(f"mbd.commands.{name}")
        command = choices.add_parser(name, help=module.HELP, description=module.__doc__)
        module.arguments(command)
        command.set_defaults(run=module.run, parser=command)
    options = parser.parse_args(words)
    return options.run(options)


if __name__ == "__main__":
    sys.exit(main())
