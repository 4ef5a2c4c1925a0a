"""``python -m benchmarks.accuracy [--scene NAME ...] [--quick] [--out FOLDER]``: what the default does with a tolerance, on every scene.

Observed errors over (rtol times the scene's length), work against tolerance, and the aligned four-bars. Each scene is run once for each
tolerance and merged into docs/benchmarks/accuracy.json, from which accuracy.md is written: an interrupted run goes on with --scene.
Bars that are not met are marked with "!".
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import mbd_runs, report
from .fits import excess, exponent, marked
from .scenes import BY_NAME, CASES, Case
from .tables import ALLOWED, SLACK, table
from .work import Ladder, sweep

RTOLS = tuple(10.0**-k for k in range(2, 12))
QUICK = RTOLS[:5]
PROPORTION = 0.8
"""Errors fall in proportion where the power of rtol that they follow is at least this."""
BRANCH = 0.1
"""A four-bar whose bar ends farther than this share of its length from the exact solution has left the parallelogram."""
PASSING = RTOLS[1:9]

Entry = dict[str, Any]


def measure(case: Case, rtols: Sequence[float], budget: float) -> Entry:
    """The default at each tolerance, until a run takes longer than the budget [s]; None stands for what failed."""
    rungs = mbd_runs.tolerances(case, None, rtols)
    rows = sweep([Ladder("mbd", "default", rungs)], lambda program, value: case.error(program, value), 1, case.patience * budget)
    length = case.build()[0].build().length
    kept = [
        {
            "rtol": row.rung.rtol,
            "error": row.error if np.isfinite(row.error) else None,
            "work": row.sample.counts.get("newton iterations", 0),
            "energy": row.sample.energy,
            "seconds": row.time,
            "note": row.sample.note,
        }
        for row in rows
    ]
    return {"length": length, "scale": case.scale, "known": case.known("mbd"), "rows": kept}


def _share(entry: Entry, row: Entry) -> float:
    return float(row["error"] * entry["scale"] / (row["rtol"] * entry["length"]))


def page(entries: dict[str, Entry]) -> str:
    """All scenes measured so far, as Markdown."""
    shown = {case.name: entries[case.name] for case in CASES if case.name in entries and not case.chaotic}
    places = dict.fromkeys(entry["where"] for entry in shown.values())
    parts = [
        "# What the default does with a tolerance",
        "Written by `python -m benchmarks.accuracy`. The default solver, one run for each tolerance; `!` marks a bar that is not met.",
        "## Observed error over (rtol x scene length)",
        f"Bar: {ALLOWED:g}. Power: of rtol, that errors follow by least squares, where they are above what is known of the reference; bar: at "
        f"least {PROPORTION}. Rise: the most that a tighter tolerance gave a larger error than a looser one.",
        errors(shown),
        "## Newton iterations, or right sides of the explicit method",
        f"Bar: no run needs more than {SLACK:g} times the work of any tighter one; last, the largest of these ratios, and all runs' time together.",
        work(shown),
        "## Four-bars whose bars come into line",
        f"N windows, twice in each turn. Error: of the first bar's end after 10 s, as a share of its length; energy: the largest error of its "
        f"balance over what was exchanged. Passes: within {BRANCH} of the exact parallelogram solution and energy within rtol.",
        aligned(shown),
        "## Machine",
        "\n".join(f"- {place}: {', '.join(name for name, entry in shown.items() if entry['where'] == place)}" for place in places),
    ]
    return "\n\n".join(parts) + "\n"


def _levels(entries: dict[str, Entry]) -> list[float]:
    return sorted({row["rtol"] for entry in entries.values() for row in entry["rows"]}, reverse=True)


def errors(entries: dict[str, Entry]) -> str:
    """A row for each scene, a column for each tolerance."""
    levels, lines = _levels(entries), []
    for name, entry in entries.items():
        rows = {row["rtol"]: row for row in entry["rows"]}
        cells = [_observed(entry, rows.get(level)) for level in levels]
        good = [row for row in entry["rows"] if row["error"] and row["error"] > 2.0 * entry["known"]]
        power = exponent([row["rtol"] for row in good], [row["error"] for row in good])
        rise = excess([row["error"] for row in reversed(good)])
        lines.append([name, *cells, f"{power:.2f}" + (" !" if power < PROPORTION else ""), f"{rise:.2g}"])
    return table(["scene", *(f"{level:.0e}" for level in levels), "power", "rise"], lines)


def _observed(entry: Entry, row: Entry | None) -> str:
    if row is None:
        return ""
    return "failed !" if row["error"] is None else marked(_share(entry, row), ALLOWED, ".2g")


def work(entries: dict[str, Entry]) -> str:
    levels, lines = _levels(entries), []
    for name, entry in entries.items():
        good = [row for row in entry["rows"] if row["error"] is not None]
        cells = {row["rtol"]: marked_work(row["work"], [other["work"] for other in good if other["rtol"] < row["rtol"]]) for row in good}
        most, seconds = excess([row["work"] for row in good]), sum(row["seconds"] for row in entry["rows"])
        lines.append([name, *(cells.get(level, "") for level in levels), marked(most, SLACK, ".2f"), f"{seconds:.3g}"])
    return table(["scene", *(f"{level:.0e}" for level in levels), "loose/tight", "total [s]"], lines)


def marked_work(own: float, tighter: Sequence[float]) -> str:
    """A run's work, with "!" where a tighter run needs so much less that the bar is not met."""
    return f"{own:g}" + (" !" if tighter and own > SLACK * min(tighter) else "")


def aligned(entries: dict[str, Entry]) -> str:
    lines = [
        [name, f"{row['rtol']:.0e}", _number(row["error"]), _number(row["energy"]), verdict(row)]
        for name, entry in entries.items()
        if BY_NAME[name].peer == "four_bar"
        for row in entry["rows"]
        if row["rtol"] in PASSING
    ]
    return table(["scene", "rtol", "error", "energy", ""], lines)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.1e}"


def verdict(row: Entry) -> str:
    """Whether a run passes the singular positions as it should."""
    if row["error"] is None:
        return f"{row['note'] or 'failed'} !"
    if row["error"] > BRANCH:
        return "left the branch !"
    if row["energy"] is None or row["energy"] > row["rtol"]:
        return "passes, energy above rtol !"
    return "passes"


def main(given: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=list(BY_NAME), choices=list(BY_NAME), metavar="NAME", help=", ".join(BY_NAME))
    parser.add_argument("--budget", type=float, help="a scene ends with the first run that takes longer [s]; default 60, with --quick 0.3")
    parser.add_argument("--quick", action="store_true", help="five tolerances, nothing written unless --out is given")
    parser.add_argument("--out", type=Path, help=f"folder for the page; default {report.OUT}")
    options = parser.parse_args(given)
    out = options.out or (None if options.quick else report.OUT)
    path = out / "accuracy.json" if out else None
    entries: dict[str, Entry] = json.loads(path.read_text()) if path and path.exists() else {}
    where, rtols, budget = report.machine(), QUICK if options.quick else RTOLS, options.budget or (0.3 if options.quick else 60.0)
    for case in (case for case in CASES if case.name in options.scene and not case.chaotic):
        entries[case.name] = {"where": where} | measure(case, rtols, budget)
        print(errors({case.name: entries[case.name]}), flush=True)
        if path:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(entries, indent=1) + "\n")
            path.with_suffix(".md").write_text(page(entries))
    print(page({case.name: entries[case.name] for case in CASES if case.name in options.scene and case.name in entries}))


if __name__ == "__main__":
    main()
