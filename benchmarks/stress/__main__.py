"""``python -m benchmarks.stress [--family NAME ...] [--quick] [--alone]``: what passes, where it breaks, and how. About half an hour."""

from __future__ import annotations

import argparse
import importlib.util
import warnings
from collections.abc import Sequence
from pathlib import Path

from .. import report
from . import page
from .families import FAMILIES
from .family import Family, Level, Verdict, judged, peer_judged


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    names = [family.name for family in FAMILIES]
    parser = argparse.ArgumentParser(prog="python -m benchmarks.stress", description=__doc__)
    parser.add_argument("--family", nargs="+", default=names, choices=names, metavar="NAME", help="; ".join(names))
    parser.add_argument("--quick", action="store_true", help="a few levels of each, nothing written unless --out is given")
    parser.add_argument("--alone", action="store_true", help="without Exudyn")
    parser.add_argument("--out", type=Path, help=f"folder of stress.md and stress.json; default {page.OUT}")
    found = parser.parse_args(given)
    found.out = found.out or (None if found.quick else page.OUT)
    return found


def swept(family: Family, quick: bool, alone: bool) -> tuple[dict[Level, Verdict], dict[Level, Verdict]]:
    """The verdicts on every level, mbd's and Exudyn's."""
    levels = [level for level in family.levels if level in family.quick or level == family.nominal] if quick else family.levels
    own = {level: judged(family, level) for level in levels}
    other = not alone and importlib.util.find_spec("exudyn") is not None and family.peer is not None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of deprecated names and of its own overflows; a failure is judged by its result
        return own, {level: peer_judged(family, level) for level in levels} if other else {}


def main() -> None:
    options = arguments()
    where = report.machine()
    print(where, flush=True)
    found = {}
    for family in (family for family in FAMILIES if family.name in options.family):
        found[family.name] = swept(family, options.quick, options.alone)
        print(f"\n{page.overview({family.name: found[family.name]})}", flush=True)
        if options.out:
            page.write(options.out, {family.name: found[family.name]}, where)
    print(f"\n{page.overview(found)}")


if __name__ == "__main__":
    main()
