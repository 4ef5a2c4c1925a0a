"""What the families share: errors of results that count their audits too."""

from __future__ import annotations

from typing import Any

import numpy as np

import mbd

from .family import Checked


def share(found: Any, wanted: Any, scale: float) -> float:
    """The distance over the scale; infinite for what is not a number."""
    distance = float(np.linalg.norm(np.asarray(found, dtype=float) - wanted)) / scale
    return distance if np.isfinite(distance) else np.inf


def audited(result: mbd.Result, error: float = 0.0) -> Checked:
    """An error, with the largest of what the audit finds: the share of the energy that does not add up, and what joints are open by; infinite
    if anything is not a number."""
    audit = result.audit
    scale = max(audit.energy_scale, audit.moving_energy, 1e-9 * audit.energy_level)
    energy = audit.energy_error / scale if scale > 0.0 else 0.0
    shown = max(energy, audit.position_drift, 1e-3 * audit.velocity_drift)
    finite = np.isfinite([error, shown]).all() and np.isfinite(result.q).all() and np.isfinite(result.v).all()
    return Checked(float(error), float(shown)) if finite else Checked(np.inf, 0.0)


def powers(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10^first ... 10^last."""
    return tuple(float(f"1e{k}") for k in range(first, last + 1, step))
