"""The families of ``families/settings.py`` in Exudyn: its Newton tolerance for rtol, and its steps."""

from __future__ import annotations

import numpy as np

from .. import exact
from ..common import share
from ..families import settings as of
from .frames import _rod
from .running import Attempts, dynamic


def tolerance(rtol: float) -> Attempts:
    """20 000 steps at this Newton tolerance: right where the error is below 1e-3, which its time discretisation allows."""
    yield lambda: share(dynamic(_hanging, of.SPAN, 20000, newton=(rtol, 1e-2 * rtol)), exact.flat(of.SPAN), 1.2) / max(of.ALLOWED * rtol, 1e-3)


def _hanging() -> object:
    return _rod(1.2, 0.5 * np.pi)


def alpha_step(step: float) -> Attempts:
    yield lambda: share(dynamic(_hanging, of.SPAN, max(round(of.SPAN / step), 1)), exact.flat(of.SPAN), 1.2)
