"""Whether two programs solve the same problem: their errors against one reference fall as they refine, and end small.

Beams are meshes with different quadratures, each compared with its own exact solution; then these two solutions must lie close together.
"""

from __future__ import annotations

import numpy as np

from .fronts import Front
from .scenes import Case

CLOSE = 1e-3
"""Of the scale: what two meshes' solutions may differ by, and what the best run of a program must reach."""
FALLING = 0.1
"""The best run must have at most this share of the coarsest one's error, unless that is tiny itself."""
TINY = 1e-5


def disagreement(case: Case, program: str, front: Front) -> str:
    """Why a program's rows cannot be compared, or ""."""
    apart = float(np.linalg.norm(case.reference("mbd") - case.reference(program))) / case.scale
    if apart > CLOSE:
        return f"its mesh converges to a point {apart:.1e} away: not the same problem"
    if not front.rows:
        return "no run succeeded"
    if front.best > CLOSE:
        return f"its best error is {front.best:.1e}: not the same problem, or not converging"
    if len(front.rows) > 1 and front.rows[0].error > TINY and front.best > FALLING * front.rows[0].error:
        return f"its errors do not fall: {front.rows[0].error:.1e} to {front.best:.1e}"
    return ""
