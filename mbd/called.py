"""Calls of users' functions: whatever they raise or return is told with the item, the time, and what the function was given."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .affine import Array
from .errors import SimulationError

ANYWHERE = "define it wherever steps may look: some are tried beyond the motion that is found, and refused"
AGAIN = "go on from the partial result with the corrected scene: mbd.resume(error.result, scene=...)"


def called(
    function: Callable[..., Any], *arguments: Any, fits: Callable[[Any, Array], bool], expected: str, what: str, item: str, time: float | None
) -> Array:
    """The value as an array of finite floats. ``what`` is the function to the user, ``expected`` what it should return, and ``fits``
    whether it did, seen as it was returned and as an array.

    Raises SimulationError, by the name of the item. KeyboardInterrupt and the like pass.
    """
    try:
        given = function(*arguments)
        value = np.asarray(given, dtype=float)
    except Exception as error:
        found = f"{what} raised {type(error).__name__}: {error}"
        advice = ("call the function by itself with the arguments it had then, and correct it", ANYWHERE, AGAIN)
        raise SimulationError(found, time=time, item=item, advice=advice) from error
    if not fits(given, value):
        shape = repr(given) if isinstance(given, (bool, np.bool_)) else f"an array of shape {value.shape}"
        advice = (f"return {expected}", "look at every branch of the function: others may have returned what is expected", AGAIN)
        raise SimulationError(f"{what} returned {shape}, expected {expected}", time=time, item=item, advice=advice)
    if not all(map(math.isfinite, value.flat)):  # of few numbers: a tenth of what NumPy's calls cost
        at = ", ".join(f"{x:.9g}" for x in arguments if isinstance(x, float))
        found = f"{what} returned {value.tolist()}{f' at {at}' if at else ''}, expected {expected}"
        advice = ("look for a division by zero, the root of a negative number or an overflow there", ANYWHERE, AGAIN)
        raise SimulationError(found, time=time, item=item, advice=advice)
    return value
