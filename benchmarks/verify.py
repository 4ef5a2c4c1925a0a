"""``python -m benchmarks.verify [--case NAME ...] [--out FOLDER]``: what the estimates of ``mbd.verify`` are worth, and what they cost.

True errors are those against closed forms or runs far tighter by another method. Each case is merged into docs/verify.json, from which
docs/verify.md is written: an interrupted run goes on with --case. Bars that are not met are marked with "!".
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import mbd
from mbd.verification.outputs import Output, outputs_of
from mbd.verification.runs import sampled

from . import report, verify_meshes
from .tables import table
from .verify_cases import BY_NAME, Case

OUT = Path(__file__).parent.parent / "docs"
MOST, LEAST = 3.0, 0.01
"""What the true error may be, in units of the estimate."""
PRICE = 3.5
"""What ``verify`` may take, in units of one run."""
TIMES = 60
"""Instants of the result at which true errors are taken."""
REPEATED, FEW = (3, 12), 1.0
"""Times are taken in turn, so often at least and at most; more than at least only within so many seconds of processor time."""
TOGETHER = 3
"""Single runs timed as one, which takes about as long as ``verify``: of shorter spells the fastest is luckier on a busy machine."""
MESHES = "meshes"
"""Stands for the table of the errors of meshes."""
NAMES = (*BY_NAME, MESHES)

Entry = dict[str, Any]


class Reference:
    """The values of a case's outputs, and what they are known to: closed forms to rounding, runs to the difference between two of them."""

    def __init__(self, case: Case):
        self.case = case
        solvers = (mbd.Radau(7), mbd.Radau(5) if case.elastic else None)
        self.runs = [self._run(solver) for solver in solvers]

    def _run(self, solver: Any) -> tuple[list[Output], mbd.Result]:
        scene, outputs = self.case.build()
        return outputs_of(scene, outputs), mbd.simulate(scene, self.case.t_end, rtol=1e-10 if self.case.elastic else 1e-12, solver=solver)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, float]]:
        """Those times at which they are known, the values [k, m], and their errors."""
        times, runs = sampled([run for _, run in self.runs], times)
        one, other = ({output.name: output.values(run) for output in outputs} for (outputs, _), run in zip(self.runs, runs))
        known = {name: float(np.max(np.linalg.norm(one[name] - other[name], axis=1))) for name in one}
        for name, exact in self.case.exact.items():
            one[name], known[name] = exact(times), 1e-14 * float(np.max(np.abs(exact(times))))
        return times, one, known


def measure(case: Case, priced: bool = True) -> list[Entry]:
    """A row for every output at every setting, with what it cost unless only errors are asked for."""
    entries: list[Entry] = []
    reference = Reference(case)
    for solver in case.solvers:
        for rtol in case.rtols:
            rows = _rows(case, reference, rtol, solver, priced)
            print(*(f"{case.name}: {_cells(row)}" for row in rows), sep="\n", flush=True)
            entries += rows
    return entries


def _rows(case: Case, reference: Reference, rtol: float, solver: Any, priced: bool) -> list[Entry]:
    scene, outputs = case.build()
    price = cost(scene, outputs, case.t_end, rtol, solver) if priced else np.nan
    found = mbd.verify(scene, case.t_end, outputs=outputs, rtol=rtol, solver=solver)
    steps = found.t[np.unique(np.round(np.linspace(0, found.t.size - 1, TIMES)).astype(int))]
    times, exact, known = reference.at(steps)
    kept, (result,) = np.isin(found.t, times), sampled([found.result], times)[1]
    kinds = {output.name: output for output in outputs_of(scene, outputs)}
    rows = []
    for row in found.rows:
        error = np.linalg.norm(kinds[row.output].values(result) - exact[row.output], axis=1)
        shares = error / np.maximum(found.errors[row.output][kept], 1e-300)
        rows.append({
            "setting": f"rtol {rtol:.0e}" if solver is None else repr(solver), "output": row.output, "unit": row.unit, "verdict": row.verdict,
            "true": float(np.max(error)), "estimate": row.worst, "known": known[row.output], "order": row.order, "anywhere": float(np.max(shares)),
            "price": price, "exponent": found.growth.exponent, "exponential": found.growth.exponential})  # fmt: skip
    return rows


def cost(scene: mbd.Scene, outputs: dict[str, Any], t_end: float, rtol: float, solver: Any) -> float:
    """Processor time of ``verify`` over that of one run with the same outputs read at its steps, each the fastest of several."""
    watched = outputs_of(scene, outputs)

    def single() -> None:
        run = mbd.simulate(scene, t_end, rtol=rtol, solver=solver)
        for output in watched:
            output.values(run)

    scene.parts()
    times: list[tuple[float, float]] = []
    while len(times) < REPEATED[0] or (np.sum(times) < FEW and len(times) < REPEATED[1]):
        alone = _seconds(lambda: [single() for _ in range(TOGETHER)]) / TOGETHER
        times.append((alone, _seconds(lambda: mbd.verify(scene, t_end, outputs=outputs, rtol=rtol, solver=solver))))
    alone, whole = np.min(times, axis=0)
    return float(whole / alone)


def _seconds(work: Callable[[], Any]) -> float:
    clock = time.process_time()
    work()
    return time.process_time() - clock


def share(row: Entry) -> float | None:
    """The worst true error over the worst estimate; None where the true one is not known well enough."""
    return None if row["true"] <= 3.0 * row["known"] and row["estimate"] <= 30.0 * row["known"] else row["true"] / row["estimate"]


def page(entries: dict[str, list[Entry]], where: str) -> str:
    """All cases measured so far, as Markdown."""
    rows = [row for name in BY_NAME for row in entries.get(name, [])]
    shares = [value for row in rows if row["verdict"] == "ok" and (value := share(row)) is not None]
    prices = [row["price"] for row in rows]
    parts = [
        "# What the errors of `mbd.verify` are worth",
        "Written by `python -m benchmarks.verify`. True errors are those of the result, against closed forms or against runs far tighter by another "
        "method (Radau IIA, 7 stages, at rtol 1e-12, of beams 1e-10); `!` marks a bar that is not met.",
        f"Worst true error over worst estimate: bars {LEAST:g} and {MOST:g}; found {min(shares):.3g} to {max(shares):.3g} in {len(shares)} "
        f"estimates of {len(entries.keys() & BY_NAME.keys())} cases. Anywhere: the largest ratio of a true error to the estimate at that very "
        f"time; bar {MOST:g}. "
        f"Price: processor time over that of one run at the rtol or step asked for, the fastest of at least {REPEATED[0]} takes of each in turn; "
        f"bar {PRICE:g}; found {min(prices):.2f} to {max(prices):.2f}.",
        "Empty: below what is known of the reference." + _exceptions(entries),
        table(["case", "setting", "output", "worst estimate", "true / estimate", "anywhere", "order", "price", "verdict"],
              [[name, *_cells(row)] for name in BY_NAME for row in entries.get(name, [])]),
        *(verify_meshes.section(entries[MESHES], LEAST, MOST) if MESHES in entries else []),
        f"Measured on: {where}",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _exceptions(entries: dict[str, list[Entry]]) -> str:
    """Where no error is quoted, and where the price is not kept."""
    rows = [(f"{name} at {row['setting']}", row) for name in BY_NAME for row in entries.get(name, [])]
    refused = dict.fromkeys(place for place, row in rows if row["verdict"] != "ok")
    dear = dict.fromkeys(place for place, row in rows if row["price"] > PRICE)
    told = {"Refused": refused, "Dearer than promised": dear}
    return "".join(f" {what}: {', '.join(places)}." for what, places in told.items() if places)


def _cells(row: Entry) -> list[str]:
    value, quoted = share(row), np.isfinite(row["estimate"])
    ratio = "" if value is None or not quoted else f"{value:.2g}" + ("" if LEAST <= value <= MOST else " !")
    anywhere = "" if value is None or not quoted else f"{row['anywhere']:.2g}" + (" !" if row["anywhere"] > MOST else "")
    estimate = f"{row['estimate']:.1e} {row['unit']}".strip() if quoted else ""
    order = "" if np.isnan(row["order"]) else f"{row['order']:.2f}"
    price = f"{row['price']:.2f}" + (" !" if row["price"] > PRICE else "")
    return [row["setting"], row["output"], estimate, ratio, anywhere, order, price, row["verdict"]]


def main(given: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.verify", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", nargs="+", default=list(NAMES), choices=NAMES, metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the page")
    options = parser.parse_args(given)
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "verify.json"
    entries: dict[str, list[Entry]] = json.loads(path.read_text()) if path.exists() else {}
    warnings.simplefilter("ignore", mbd.SceneWarning)
    for name in (name for name in NAMES if name in options.case):
        entries[name] = verify_meshes.measure() if name == MESHES else measure(BY_NAME[name])
        path.write_text(json.dumps(entries, indent=1) + "\n")
        path.with_suffix(".md").write_text(page(entries, report.machine()))


if __name__ == "__main__":
    main()
