"""What the families share: errors of results that count their audits too."""

from __future__ import annotations

from typing import Any

import numpy as np

import mbd


def share(found: Any, wanted: Any, scale: float) -> float:
    """The distance over the scale; infinite for what is not a number."""
    distance = float(np.linalg.norm(np.asarray(found, dtype=float) - wanted)) / scale
    return distance if np.isfinite(distance) else np.inf


def audited(result: mbd.Result, error: float = 0.0) -> float:
    """The largest of an error, the energy's share that does not add up, and what joints are open by; infinite if anything is not a number."""
    audit = result.audit
    scale = max(audit.energy_scale, audit.moving_energy, 1e-9 * audit.energy_level)
    energy = audit.energy_error / scale if scale > 0.0 else 0.0
    worst = max(error, energy, audit.position_drift, 1e-3 * audit.velocity_drift)
    return float(worst) if np.isfinite(worst) and np.isfinite(result.q).all() and np.isfinite(result.v).all() else np.inf


def powers(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10^first ... 10^last."""
    return tuple(float(f"1e{k}") for k in range(first, last + 1, step))
