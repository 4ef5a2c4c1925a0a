"""The report of ``verify`` in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .verification import Row, Verification


def text(report: Verification) -> str:
    """The table, then what was compared, how neighbouring motions part, and what can be done where something is lost."""
    mesh = bool(report.mesh_errors)
    head = ["output", "unit", "worst error", "at t [s]", "of range", "order", *(["mesh order"] if mesh else []), "verdict"]
    lines = [head, *(_cells(row, mesh) for row in report.rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    table = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines]
    return "\n".join([*table, *remarks(report)])


def remarks(report: Verification) -> list[str]:
    """What was compared, how neighbouring motions part, and what can be done where something is lost."""
    return [_compared(report), *_parting(report), *_advice(report)]


def _cells(row: Row, mesh: bool) -> list[str]:
    quoted = np.isfinite(row.worst)
    share = f"{row.worst / row.range:.1e}" if quoted and row.range > 0.0 else ""
    worst, at = (f"{row.worst:.1e}", f"{row.at:.4g}") if quoted else ("", "")
    return [row.output, row.unit, worst, at, share, _order(row.order), *([_order(row.mesh_order)] if mesh else []), row.verdict]


def _order(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.2g}"


def _compared(report: Verification) -> str:
    what = "steps of {} s" if report.fixed else "rtol {}"
    return f"compared: runs with {what.format(', '.join(f'{x:.2g}' for x in report.settings))}; the result is the last"


def _parting(report: Verification) -> list[str]:
    exponent, exponential = report.growth
    if np.isnan(exponent):
        return []
    how = f"exponentially, by a factor of e in {1.0 / exponent:.3g} s" if exponential else "no faster than a power of time"
    return [f"neighbouring motions part {how} (finite-time exponent {exponent:.2g} 1/s)"]


def _advice(report: Verification) -> list[str]:
    """What it would take to reach the end."""
    until, t = report.predictable_until, report.result.trajectory.t
    if until >= t[-1] or not any("beyond" in row.verdict for row in report.rows):
        return []
    exponent, exponential = report.growth
    if not exponential:
        return ["beyond, errors exceed a tenth of an output's range: try a smaller rtol, or a smaller step"]
    needed = report.settings[-2] * float(np.exp(-min(exponent * (t[-1] - until), 700.0)))
    if report.fixed:
        return [f"t = {t[-1]:.4g} s needs errors {needed / report.settings[-2]:.0e} times as large"]
    if needed >= 1e-13:
        return [f"t = {t[-1]:.4g} s needs about rtol {needed:.0e}"]
    return [f"t = {t[-1]:.4g} s is out of reach of any tolerance, as rounding grows as much"]
