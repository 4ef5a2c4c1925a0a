"""What a row of measurements says: the power of size that a cost grows with, and whether looser runs cost more than tighter ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """p of the power law cost ~ size^p, by least squares in logarithms over all positive, finite pairs; NaN with fewer than two sizes."""
    x, y = np.array(sizes, dtype=float), np.array(costs, dtype=float)
    good = np.isfinite(x) & np.isfinite(y) & (x > 0.0) & (y > 0.0)
    x, y = np.log(x[good]), np.log(y[good])
    if x.size < 2 or np.ptp(x) == 0.0:
        return float("nan")
    x = x - x.mean()
    return float(x @ y / (x @ x))


def excess(work: Sequence[float]) -> float:
    """The largest ratio of a run's work to that of any later one, 1 where work only grows; runs come from loose to tight. Zeros (runs
    that counted nothing) are left out."""
    counted = [x for x in work if x > 0.0]
    return max((counted[k] / min(counted[k:]) for k in range(len(counted))), default=1.0)


def marked(value: float, bar: float, digits: str = ".3g") -> str:
    """The number, with "!" behind it where it exceeds the bar; empty for NaN."""
    return "" if np.isnan(value) else f"{value:{digits}}" + (" !" if value > bar else "")
