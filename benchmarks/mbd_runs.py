"""Runs of mbd: each solver over a sweep of tolerances or steps, and the time of its solver alone."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

import mbd

from .scenes import Case
from .work import FINEST, Ladder, Rung, Sample

RTOLS = tuple(10.0**-k for k in range(2, 13))
COUNTED = ("steps", "rejected", "failed", "newton iterations", "factorizations")
VERSION = f"mbd {mbd.__version__}"


def run(case: Case, solver: Any, rtol: float) -> Sample:
    """One run, built anew: nothing is carried over from the last. Warnings become a note."""
    scene, marker = case.build()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = mbd.simulate(scene, case.t_end, rtol=rtol, solver=solver)
        except mbd.SimulationError as error:
            seconds = error.result.stats["wall time"] if error.result else 0.0
            return Sample(seconds, None, note=f"stopped at {error.time:.4g} s")
    noted = ", ".join(sorted({_short(str(warning.message)) for warning in caught}))
    counts = {name: int(result.stats[name]) for name in COUNTED if name in result.stats}
    return Sample(result.stats["wall time"], np.array(result.position(marker)[-1]), counts, noted, _imbalance(result.audit))


def _imbalance(audit: Any) -> float | None:
    """The energy's error over what was exchanged; None where nothing was."""
    return float(audit.energy_error / audit.energy_scale) if audit.energy_scale > 0.0 else None


def _short(message: str) -> str:
    return "energy off" if "energy" in message else message[:40]


def tolerances(case: Case, solver: Any, rtols: Sequence[float]) -> Iterator[Rung]:
    for rtol in rtols:
        yield Rung(f"rtol {rtol:.0e}", lambda rtol=rtol: run(case, solver, rtol), rtol)


def _steps(case: Case, solver: Callable[[float], Any]) -> Iterator[Rung]:
    for k in range(FINEST):
        steps = case.steps * 2**k
        step = case.t_end / steps
        yield Rung(f"{steps} steps", lambda step=step: run(case, solver(step), 1e-6))


def adaptive(case: Case) -> dict[str, Any]:
    """The methods with error control, by name. None is the choice of the library."""
    found: dict[str, Any] = {"default": None, "Radau": mbd.Radau(), **{f"Radau {s}": mbd.Radau(s) for s in (3, 5, 7)}}
    return found if case.beam else found | {"Dormand-Prince": mbd.DormandPrince()}


def ladders(case: Case) -> list[Ladder]:
    found = [Ladder("mbd", name, tolerances(case, solver, RTOLS)) for name, solver in adaptive(case).items()]
    fixed = {"generalized-alpha": lambda h: mbd.GeneralizedAlpha(step=h), "Gauss 3": lambda h: mbd.Gauss(step=h, stages=3)}
    return found + [Ladder("mbd", name, _steps(case, solver)) for name, solver in fixed.items()]
