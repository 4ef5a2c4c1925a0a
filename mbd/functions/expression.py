"""Formulas as functions of t, or as laws of several variables, with exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import validate
from ..affine import Array
from ..fields import Constants, Text, Texts, Vector
from .function import AsData
from .jets import Jet, jet
from .language import parse
from .translation import RESERVED, finite

TIME = "t"


@dataclass(frozen=True)
class Expression(AsData):
    """A formula, such as ``Expression("2 * sin(3 * t)")``: a function of t [s] with its exact rate and acceleration, for loads and drives.

    text             the formula, or d of them for a vector; see the language below
    variables        what the formula is a function of, in the order of the arguments; of laws (``ForceLaw``, ``UserMeasure``) t and the measures
    constants        numbers by name that the formula may use
    discontinuities  times [s] at which it or a derivative jumps, beside those where t is compared with a number, which are found

    The language: numbers, + - * / **, pi, e, tau, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, exp, log, log10, sqrt, abs, sign,
    floor, ceil, round, min, max, and ``a if t < 0.4 else b`` with <, <=, >, >=, and, or, not. At most 1000 characters. It is parsed, never evaluated
    as Python. Raises ValueError, in words, for any other text.
    """

    text: Text | Texts
    variables: Texts = (TIME,)
    constants: Constants = field(default_factory=dict)
    discontinuities: Vector = ()

    def __post_init__(self) -> None:
        single = isinstance(self.text, str)
        texts = [self.text] if single else list(self.text) if isinstance(self.text, (list, tuple)) else []
        if not texts or not all(isinstance(text, str) for text in texts):
            raise self._wrong("text", "a formula, or a list of them", self.text)
        self._set(text=self.text if single else tuple(texts), variables=tuple(self.variables))
        self._check_names()
        self._set(constants={name: float(value) for name, value in dict(self.constants).items()})
        self._numbers("discontinuities")
        try:
            formulas = [parse(text, self.variables, self.constants) for text in texts]
        except ValueError as error:
            raise ValueError(f"Expression({validate.show(self.text)}): {error}") from error
        kinks = {t for formula in formulas for t in formula.kinks}
        self._set(discontinuities=tuple(sorted(kinks.union(np.atleast_1d(self.discontinuities).tolist()))))
        self._set(_closures=[formula.closure for formula in formulas])

    def _check_names(self) -> None:
        names = [*self.variables, *dict(self.constants)]
        for name in names:
            if not isinstance(name, str) or not name.isidentifier() or name in RESERVED or names.count(name) > 1:
                raise self._wrong("variables, constants", f"names, each once, other than {', '.join(RESERVED)}", name)

    def __call__(self, *values: float) -> Any:
        """A number, or numbers [d] where the text is a list."""
        self._check_count(values)
        found = [finite(closure, values) for closure in self._closures]  # type: ignore[attr-defined]
        return found[0] if isinstance(self.text, str) else np.array(found)

    def rate(self, t: float) -> Any:
        """The first derivative of a function of t."""
        return self._derivative([t], [1.0], 1)

    def acceleration(self, t: float) -> Any:
        """The second derivative of a function of t."""
        return self._derivative([t], [1.0], 2)

    def gradient(self, *values: float) -> Array:
        """[d, k]: derivatives by the k variables other than t."""
        axes = self._axes()
        return np.stack([np.atleast_1d(self._derivative(values, axis, 1)) for axis in axes], axis=-1)

    def hessian(self, *values: float) -> Array:
        """[d, k, k]: second derivatives by the k variables other than t; mixed ones from those along diagonals."""
        axes = self._axes()
        own = [np.atleast_1d(self._derivative(values, axis, 2)) for axis in axes]
        out = np.zeros((len(self._closures), len(axes), len(axes)))  # type: ignore[attr-defined]
        for i, a in enumerate(axes):
            out[:, i, i] = own[i]
            for j, b in enumerate(axes[:i]):
                out[:, i, j] = out[:, j, i] = 0.5 * (np.atleast_1d(self._derivative(values, a + b, 2)) - own[i] - own[j])
        return out

    def _axes(self) -> list[Array]:
        return [axis for axis, name in zip(np.eye(len(self.variables)), self.variables) if name != TIME]

    def _derivative(self, values: Sequence[float], direction: Any, order: int) -> Any:
        """The first or second derivative along a direction."""
        self._check_count(values)
        point = [Jet(float(x), float(way), 0.0) if way else float(x) for x, way in zip(values, direction)]
        found = [jet(finite(closure, point))[order] for closure in self._closures]  # type: ignore[attr-defined]
        return found[0] if isinstance(self.text, str) else np.array(found)

    def _check_count(self, values: Sequence[float]) -> None:
        if len(values) != len(self.variables):
            expected = f"{len(self.variables)} numbers ({', '.join(self.variables)})"
            raise TypeError(f"Expression({validate.show(self.text)}): expected {expected}, found {len(values)}")
