"""Tables as Markdown: every run, run time at given errors with ratios, errors against tolerances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .fits import excess
from .fronts import ERRORS, Front
from .work import Row

ALLOWED = 30.0
"""What the observed error may be, in units of rtol times the scene's length."""
SLACK = 1.2
"""A looser tolerance may cost this many times the Newton iterations of a tighter one."""


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table, its columns aligned for terminals."""
    widths = [max(len(line[k]) for line in [head, *rows]) for k in range(len(head))]
    lines = [head, ["-" * width for width in widths], *rows]
    return "\n".join("| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in lines)


def runs(rows: Sequence[Row]) -> str:
    """Every run: median time, error, counters."""
    lines = []
    for row in rows:
        error = f"{row.error:.1e}" if np.isfinite(row.error) else "failed"
        counts = [str(int(row.sample.counts[name])) if name in row.sample.counts else "" for name in ("steps", "newton iterations")]
        spread = f"{1e3 * min(row.seconds):.3g} to {1e3 * max(row.seconds):.3g}" if len(row.seconds) > 1 else ""
        lines.append([row.program, row.method, row.rung.setting, f"{1e3 * row.time:.4g}", spread, error, *counts, row.sample.note])
    return table(["program", "method", "setting", "median [ms]", "range [ms]", "error", "steps", "Newton iterations", "note"], lines)


def ratios(fronts: dict[str, Front], errors: Sequence[float] = ERRORS) -> str:
    """Times of each program's best front at errors, and mbd's over each peer's."""
    mbd, peers = fronts["mbd"], [program for program in fronts if program != "mbd"]
    head = ["error", "mbd [ms]", "mbd by"] + [text for peer in peers for text in (f"{peer} [ms]", f"{peer} by", f"mbd / {peer}")]
    lines = []
    for error in errors:
        own = mbd.at(error)
        cells = [f"{error:.0e}", *_cost(own)]
        for peer in peers:
            cells += [*_cost(fronts[peer].at(error)), ratio(fronts, peer, error)]
        lines.append(cells)
    return table(head, lines)


def ratio(fronts: dict[str, Front], peer: str, error: float) -> str:
    """mbd's time over a peer's at an error; who cannot reach it where one cannot."""
    own, other = fronts["mbd"].at(error), fronts[peer].at(error) if peer in fronts else None
    if own is None:
        return "mbd cannot reach" if other else "neither reaches"
    return "" if peer not in fronts else f"{own.seconds / other.seconds:.3g}" if other else "only mbd"


def _cost(cost: object) -> list[str]:
    return [f"{1e3 * cost.seconds:.4g}", cost.by] if hasattr(cost, "seconds") and hasattr(cost, "by") else ["cannot reach", ""]


def tolerances(rows: Sequence[Row], scale: float, length: float) -> str:
    """Observed error over (rtol x the scene's length), and Newton iterations over the fewest at any tighter tolerance, by method.

    scale and length [m]: what errors are shares of, and what rtol is relative to.
    """
    kept = [row for row in rows if row.program == "mbd" and row.rung.rtol is not None]
    methods = list(dict.fromkeys(row.method for row in kept))
    levels = sorted({row.rung.rtol for row in kept if row.rung.rtol}, reverse=True)
    cells = {(row.method, row.rung.rtol): row for row in kept}
    lines = []
    for rtol in levels:
        found = [cells.get((method, rtol)) for method in methods]
        lines.append([f"{rtol:.0e}", *(_observed(row, rtol, scale / length) for row in found)])
    worst = [f"{costlier([row for row in kept if row.method == method]):.2f}" for method in methods]
    lines.append(["loose/tight", *worst])
    return table(["rtol", *methods], lines)


def _observed(row: Row | None, rtol: float, scale: float) -> str:
    if row is None:
        return ""
    if not np.isfinite(row.error):
        return "failed"
    share = row.error * scale / rtol
    return f"{share:.2g}" + (" !" if share > ALLOWED else "")


def costlier(rows: Sequence[Row]) -> float:
    """The largest ratio of a looser run's work to a tighter one's, 1 where work is monotone. Work: Newton iterations, or steps."""
    return excess([max(row.sample.counts.get("newton iterations", 0), row.sample.counts.get("steps", 0)) for row in rows if row.sample.counts])
