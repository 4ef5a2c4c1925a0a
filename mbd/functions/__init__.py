"""Functions as data: kinds that can be written to files, pickled and compared, with exact derivatives for drives.

    Expression("2 * sin(3 * t)")                           a formula, parsed, never evaluated as Python
    Sine(amplitude, frequency), Ramp(start, end, after=), SmoothStep(start, end, after=)
    Table(times, values), Spline(times, values)            through given points

They are callables of t [s] like any other, and may be given wherever a description takes a function of t; ``Motion`` and ``piecewise`` of
them are data too. An ``Expression`` of other variables is a law for ``ForceLaw`` and ``UserMeasure``.
"""

from __future__ import annotations

from typing import Any

from ..signal import Piecewise
from ..target import Motion
from .expression import Expression
from .kinds import Ramp, Sine, SmoothStep
from .points import Spline, Table

KINDS: dict[str, Any] = {kind.__name__: kind for kind in (Expression, Sine, Ramp, SmoothStep, Table, Spline, Motion, Piecewise)}

__all__ = ["KINDS", "Expression", "Ramp", "Sine", "SmoothStep", "Spline", "Table"]
