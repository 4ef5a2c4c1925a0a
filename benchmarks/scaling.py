"""``python -m benchmarks.scaling [--quick] [--out FOLDER]``: what size costs in time and memory, and what a start costs. Below 3 minutes.

Every size is measured in a process of its own (``probes.py``); written to docs/benchmarks/scaling.md and .json. Bars that are not met
are marked with "!".
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import report
from .fits import exponent, marked
from .tables import table

ROOT = Path(__file__).parents[1]
EXPONENT, KILOBYTES, SECONDS = 1.1, 10.0, 0.5
"""The bars: power of size above ``LARGE`` items, kB per coordinate, and seconds to the end of the first steps."""
LARGE = 100
SIZES = {"pendulum": (30, 120, 480, 4800), "chain": (10, 100, 1000, 10000)}
QUICK = {"pendulum": (30, 120), "chain": (10, 100)}
ITEMS = {"pendulum": "elements", "chain": "links"}
STARS = {"100 rigid arms": (100, 0), "200 rigid arms": (200, 0), "200 cables of 4 elements": (200, 4)}
QUICK_STARS = {"20 rigid arms": (20, 0)}
STARTS = 7


def probe(name: str, *numbers: object) -> dict[str, Any]:
    """One measurement in a fresh process; {"failed": why} where it did not succeed."""
    command = [sys.executable, "-W", "ignore", "-m", "benchmarks.probes", name, *map(str, numbers)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        return {"failed": (done.stderr.strip().splitlines() or [f"exit {done.returncode}"])[-1][:80]}
    return json.loads(done.stdout.splitlines()[-1])


def measure(quick: bool) -> dict[str, Any]:
    """All probes, one after the other."""
    starts = [probe("start") for _ in range(3 if quick else STARTS)]
    sizes = {kind: {n: probe("size", kind, n) for n in counts} for kind, counts in (QUICK if quick else SIZES).items()}
    stars = {name: probe("star", *numbers) for name, numbers in (QUICK_STARS if quick else STARS).items()}
    return {"start": starts, "sizes": sizes, "stars": stars}


def page(found: dict[str, Any], where: str) -> str:
    """The page, as Markdown."""
    parts = [
        "# Cost of size",
        f"Written by `python -m benchmarks.scaling`. {where}. Default tolerance, a few steps; solve time over Newton iterations (or right sides "
        "of the explicit method), all else included: tangents, factorisations, error estimates. The fastest of some runs. `!` marks a bar "
        f"that is not met: cost growing with a power above {EXPONENT} beyond {LARGE} items, more than {KILOBYTES:g} kB per coordinate there.",
    ]
    for kind, rows in found["sizes"].items():
        methods = list(dict.fromkeys(name for row in rows.values() for name in row.get("methods", ())))
        parts += [f"## {kind.capitalize()}: microseconds per iteration", times(ITEMS[kind], methods, rows)]
        parts += [
            f"## {kind.capitalize()}: memory, kB per coordinate",
            "Peak resident memory of the process above that with mbd imported and warmed up on two items, stored steps excluded. Later columns "
            "include the peaks of earlier ones.",
            memory(ITEMS[kind], methods, rows),
        ]
    return "\n\n".join([*parts, *_stars(found["stars"]), *_start(found["start"])]) + "\n"


def _cell(row: dict[str, Any], method: str, key: str) -> float:
    return float(row.get("methods", {}).get(method, {}).get(key, float("nan")))


def times(items: str, methods: Sequence[str], rows: dict[int, dict[str, Any]]) -> str:
    """A row for each size, the last one the powers of size above LARGE."""
    head = [items, "coordinates", *(_title(method) for method in methods), "add [ms]", "build [ms]"]
    lines = []
    for n, row in rows.items():
        if "failed" in row:
            lines.append([str(n), row["failed"], *[""] * (len(head) - 2)])
            continue
        cells = [row["methods"][method].get("failed", "")[:40] or f"{row['methods'][method]['us']:.4g}" for method in methods]
        lines.append([str(n), str(row["coordinates"]), *cells, f"{1e3 * row['describe']:.3g}", f"{1e3 * row['build']:.3g}"])
    large = {n: row for n, row in rows.items() if n >= LARGE}
    costs = [[_cell(row, method, "us") for row in large.values()] for method in methods]
    costs += [[row.get(key, float("nan")) for row in large.values()] for key in ("describe", "build")]
    return table(head, [*lines, ["power of size", "", *(marked(exponent(list(large), cost), EXPONENT) for cost in costs)]])


def _title(method: str) -> str:
    return f"{method}, per right side" if method == "Dormand-Prince" else f"{method}, per Newton iteration"


def memory(items: str, methods: Sequence[str], rows: dict[int, dict[str, Any]]) -> str:
    lines = [[str(n), str(row.get("coordinates", "")), *(_kilobytes(n, _cell(row, m, "kB")) for m in methods)] for n, row in rows.items()]
    large = {n: row for n, row in rows.items() if n >= LARGE}
    totals = [[_cell(row, m, "kB") * row.get("coordinates", 0) for row in large.values()] for m in methods]
    return table([items, "coordinates", *methods], [*lines, ["power of size", "", *(marked(exponent(list(large), kB), EXPONENT) for kB in totals)]])


def _kilobytes(count: int, value: float) -> str:
    """Marked for large scenes only: for small ones it is the allocator's pages that are counted."""
    return marked(value, KILOBYTES if count >= LARGE else float("inf"))


def _stars(found: dict[str, Any]) -> list[str]:
    head = ["star", "unknowns", "format", "entries", "in L and U", "a band would hold", "factor [ms]", "default [us]", "Radau 3 [us]", "Radau 7 [us]"]
    lines = []
    for name, row in found.items():
        if "failed" in row:
            lines.append([name, row["failed"], *[""] * (len(head) - 2)])
            continue
        counts = [str(row[key]) for key in ("unknowns", "format", "entries", "fill", "band")]
        costs = [row[m].get("failed", "")[:40] or f"{row[m]['us']:.4g}" for m in ("default", "Radau 3", "Radau 7")]
        lines.append([name, *counts, f"{1e3 * row['factor']:.3g}", *costs])
    return [
        "## A star: arms pinned to one hub",
        "The KKT matrix of mass and joints at the start: stored format, entries, entries of its factors (SuperLU), what the band of reverse "
        "Cuthill-McKee would hold, time of a factorisation; then microseconds per iteration of the default and of Radau.",
        table(head, lines),
    ]


def _start(found: Sequence[dict[str, Any]]) -> list[str]:
    failed = [row["failed"] for row in found if "failed" in row]
    if failed:
        return ["## Start", f"Failed: {failed[0]}"]
    median = {key: statistics.median(row[key] for row in found) for key in found[0]}
    share = 1.0 - median["building and stepping"] / median["total"]
    line = [marked(median["total"], SECONDS), *(f"{median[key]:.3g}" for key in list(median)[1:]), f"{100.0 * share:.0f} %"]
    return [
        "## Start",
        f"Seconds from a fresh interpreter to the end of the first steps of the main job, the flexible pendulum of 30 elements; bar {SECONDS:g} s. "
        f"Medians of {len(found)} processes. What is not spent a second time in the same process is imports.",
        table(["total [s]", *list(median)[1:], "share of imports"], [line]),
    ]


def main(given: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scaling", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes only, nothing written unless --out is given")
    parser.add_argument("--out", type=Path, help=f"folder for the page; default {report.OUT}")
    options = parser.parse_args(given)
    where, found = report.machine(), measure(options.quick)
    text = page(found, where)
    print(text)
    out = options.out or (None if options.quick else report.OUT)
    if out:
        out.mkdir(parents=True, exist_ok=True)
        (out / "scaling.md").write_text(text)
        (out / "scaling.json").write_text(json.dumps({"where": where, **found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
