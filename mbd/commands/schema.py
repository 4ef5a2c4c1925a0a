"""Prints the JSON Schema of scene files, with which editors complete and check them."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

HELP = "the JSON Schema of scene files"


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, metavar="FILE", help="write it there")


def run(options: argparse.Namespace) -> int:
    from ..files.model import schema

    text = json.dumps(schema(), indent=1, ensure_ascii=False)
    if options.out:
        options.out.write_text(text + "\n", encoding="utf-8")
    else:
        print(text)
    return 0
