"""One step of a derivation: what is derived, from where, and how far the library's numbers are from it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from . import shown
from .numbers import difference

PAPER = "Escalona, Hussien and Shabana (1998)"

EXACT = 1e-12
"""Relative differences below this are rounding: kernels sum some hundred products of 1e-16 each."""

Pairs = Iterable[tuple[str, Any, Any]]
"""(quantity, expected, found) at one random state."""


class Outcome(NamedTuple):
    """The worst relative difference, and of which quantity."""

    difference: float
    quantity: str

    @property
    def exact(self) -> bool:
        return self.difference < EXACT


@dataclass(frozen=True, eq=False)
class Step:
    """An equation ``left = right``.

    title     in words
    left      LaTeX
    right     expression or matrix
    source    author, year, equation number; "here" for what follows from the steps before
    kernel    the code that returns these numbers
    compare   random generator -> (quantity, value by the formula, what the kernel returns) at a random state
    names     LaTeX of symbols whose names do not tell it
    """

    title: str
    left: str
    right: sp.Basic
    source: str
    kernel: str
    compare: Callable[[np.random.Generator], Pairs]
    names: Mapping[sp.Symbol, str] = field(default_factory=dict)

    @property
    def latex(self) -> list[str]:
        """The equation, and definitions of what occurs in it more than once."""
        return shown.latex(self.left, self.right, symbol_names=dict(self.names))

    def worst(self, seed: int = 1, states: int = 2) -> Outcome:
        """Of all quantities at random states."""
        rng = np.random.default_rng(seed)
        found = [Outcome(difference(exact, seen), name) for _ in range(states) for name, exact, seen in self.compare(rng)]
        return max(found)

    def check(self, seed: int = 1, states: int = 2) -> float:
        """The worst relative difference between formula and kernel at random states."""
        return self.worst(seed, states).difference

    def __str__(self) -> str:
        body = "\n".join(f"    {line}" for line in shown.text(self.right).splitlines())
        return f"{self.title}  [{self.source}]\n  {self.left} =\n{body}"
