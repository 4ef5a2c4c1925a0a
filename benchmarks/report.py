"""What a run of the benchmark prints and writes: a page for each scene, and a summary of all that were written."""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import os
import platform
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import mbd

from . import tables
from .fits import marked
from .fronts import ERRORS, Front
from .scenes import CASES, Case
from .work import Row

BESIDE = 1e-6
FACTOR = 1.5
"""What the default may take at rtol BESIDE, in units of the time of the best method at the error it reaches."""
OUT = Path(__file__).parents[1] / "docs" / "benchmarks"
COMMAND = 'python -m pip install ".[bench]" && python -m benchmarks'


def machine() -> str:
    """One line: processor, cores, load, versions, date."""
    versions = ", ".join([f"mbd {mbd.__version__}", *(f"{name} {_version(name)}" for name in ("exudyn", "numpy", "scipy"))])
    load = f"load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "load unknown"
    return f"{_processor()}, {os.cpu_count()} cores, {load} at the start; Python {platform.python_version()}, {versions}; {datetime.date.today()}"


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "absent"


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or sys.platform


def page(case: Case, rows: Sequence[Row], fronts: dict[str, Front], excluded: Sequence[str], length: float, options: Any, where: str) -> str:
    """The page of a scene, as Markdown; length [m] is what rtol is relative to."""
    reference = ", ".join(f"{program} {np.array2string(case.reference(program), precision=12)}" for program in ("mbd", "Exudyn"))
    parts = [
        f"# {case.name}",
        f"{where}. Medians of {options.repeats} runs, solve time only; a sweep ends with the first run longer than "
        f"{case.patience * options.budget:g} s. {case.t_end:g} s simulated. Errors: distance of the output from the reference over "
        f"{case.scale:g} m, not below what the reference is known to. References [m]: {reference}.",
        *[f"**Left out:** {text}." for text in excluded],
        f"![run time against error]({case.key}.png)",
        "## Best of each program at an error",
        tables.ratios(fronts),
        "## Observed error over (rtol x scene length), and work of looser over tighter runs",
        "Above 30: marked with !. Last line: the most that a looser run's Newton iterations (or steps) exceed a tighter one's."
        + (" Errors of this scene grow exponentially; nothing is promised." if case.chaotic else ""),
        tables.tolerances(rows, case.scale, length),
        "## All runs",
        tables.runs(rows),
    ]
    return "\n\n".join(parts) + "\n"


def record(case: Case, rows: Sequence[Row], fronts: dict[str, Front], excluded: Sequence[str], where: str) -> dict[str, object]:
    """What the summary needs of a scene."""
    cells = {peer: [tables.ratio(fronts, peer, error) for error in ERRORS] for peer in ("Exudyn", "Exudyn tree")}
    best = {program: front.best for program, front in fronts.items()}
    return {
        "scene": case.name, "where": where, "ratios": cells, "best": best, "excluded": list(excluded),
        "default": default_beside_best(rows, fronts["mbd"])}  # fmt: skip


def default_beside_best(rows: Sequence[Row], front: Front) -> dict[str, object] | None:
    """The default's run at rtol 1e-6, and the time of mbd's front at the same error; None where it failed."""
    for row in rows:
        if row.program == "mbd" and row.method == "default" and row.rung.rtol == BESIDE and np.isfinite(row.error):
            best = front.at(row.error)
            assert best is not None  # the front is no worse than the row
            return {"error": row.error, "seconds": row.time, "best": best.seconds, "by": best.by}
    return None


def write(out: Path, case: Case, text: str, entry: dict[str, object]) -> None:
    """The scene's page and its entry; then the summary of all entries."""
    out.mkdir(parents=True, exist_ok=True)
    (out / f"{case.key}.md").write_text(text)
    path = out / "summary.json"
    entries = json.loads(path.read_text()) if path.exists() else {}
    entries[case.name] = entry
    path.write_text(json.dumps(entries, indent=1) + "\n")
    (out / "README.md").write_text(summary(entries))


def summary(entries: dict[str, dict]) -> str:
    """All scenes on one page: ratios of solve time, mbd over Exudyn and over its kinematic tree."""
    head = ["scene", *(f"{error:.0e}" for error in ERRORS), "mbd's best", "peer's best"]
    parts = [
        "# Run time against error",
        f"Written by `{COMMAND}`. Cells: solve time of mbd over that of the peer, each on its best front at that error (log-log interpolation "
        "between runs); `only mbd`: the peer cannot reach the error. Errors are shares of each scene's scale. Beside this page: "
        "[what size costs](scaling.md), by `python -m benchmarks.scaling`, and [what the default does with a tolerance](accuracy.md), by "
        "`python -m benchmarks.accuracy`.",
    ]
    for peer in ("Exudyn", "Exudyn tree"):
        lines = [
            [f"[{name}]({case.key}.md)", *entry["ratios"][peer], f"{entry['best']['mbd']:.0e}", f"{entry['best'][peer]:.0e}"]
            for case in CASES
            if (entry := entries.get(name := case.name)) and peer in entry["best"]
        ]
        if lines:
            parts += [f"## mbd / {peer}", tables.table(head, lines)]
    parts += _defaults(entries)
    left = [f"- {name}: {text}" for name, entry in entries.items() for text in entry["excluded"]]
    parts += ["## Left out\n\n" + "\n".join(left)] if left else []
    places = dict.fromkeys(entry["where"] for entry in entries.values())
    parts += ["## Machine", "\n".join(f"- {place}: {', '.join(n for n, e in entries.items() if e['where'] == place)}" for place in places)]
    return "\n\n".join(parts) + "\n"


def _defaults(entries: dict[str, dict]) -> list[str]:
    lines = [
        [case.name, f"{found['error']:.1e}", f"{1e3 * found['seconds']:.4g}", f"{1e3 * found['best']:.4g}", found["by"],
         marked(found["seconds"] / found["best"], FACTOR)]
        for case in CASES
        if (found := entries.get(case.name, {}).get("default"))
    ]  # fmt: skip
    note = f"What the default reaches at rtol {BESIDE:g}, and the fastest of mbd's methods at that error. Bar: {FACTOR:g}, `!` above."
    head = ["scene", "error", "default [ms]", "best [ms]", "by", "default / best"]
    return ["## The default beside the best of mbd's methods", note, tables.table(head, lines)] if lines else []
