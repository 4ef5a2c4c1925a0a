"""From the data of a file to values: numbers, formulas of parameters, functions. Everything that is wrong is a ValueError in words."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any

from .. import validate
from ..functions import Expression
from ..functions.expression import TIME
from ..functions.language import names_in, number
from ..functions.translation import RESERVED
from ..nearest import nearest
from .kinds import FUNCTIONS, Field, Kind

HUGE, ALL = 1e50, 100_000
"""Numbers beyond this are refused, so that products of several do not overflow; and more elements than this in the whole file."""


class Leaning(ValueError):
    """It needs an item or a parameter that was refused, which is complained of already."""


def parameters(given: Mapping[str, Any], complain: Callable[[str, str], None], refused: Collection[str] = ()) -> dict[str, float]:
    """The parameters' values. Those that have none are complained of by name; those that need them, or refused ones, are left out."""
    needs = {name: _needed(name, value, [*given, *refused], complain) for name, value in given.items()}
    waiting = {name: need for name, need in needs.items() if need is not None}
    found: dict[str, float] = {}
    while ready := [name for name, need in waiting.items() if need <= found.keys()]:
        for name in ready:
            del waiting[name]
            try:
                found[name] = Values(found).number(given[name])
            except ValueError as error:
                complain(name, str(error))
    try:
        TopologicalSorter({name: need & waiting.keys() for name, need in waiting.items()}).prepare()
    except CycleError as error:
        first, *others = reversed(error.args[1])
        shown = [first, *(others if len(others) <= 8 else [*others[:4], "...", *others[-3:]])]
        complain(first, f"expected parameters that do not need each other in a circle, found {' -> '.join(shown)}")
    return found


def _needed(name: str, value: Any, given: Collection[str], complain: Callable[[str, str], None]) -> set[str] | None:
    """The other parameters that a formula mentions; None for one that is wrong."""
    try:
        if not re.fullmatch(r"[A-Za-z_][A-Za-z_0-9]*", name) or name in (TIME, *RESERVED):
            raise ValueError(f"expected a name of letters, digits and _, other than {', '.join((TIME, *RESERVED))}; found {validate.show(name)}")
        names = names_in(value) if isinstance(value, str) else set()
        if unknown := sorted(names - set(given)):
            raise ValueError(f"expected names of parameters in the formula, found {validate.show(unknown[0])}{nearest(unknown[0], given)}")
        return names
    except ValueError as error:
        complain(name, str(error))
        return None


class Values:
    """Data with formulas of known constants, as numbers and functions; ``refused`` holds the names of constants without a value."""

    def __init__(self, constants: Mapping[str, float], refused: Collection[str] = ()):
        self.constants, self.refused = constants, set(refused)
        self._counted = 0

    def number(self, data: Any) -> float:
        if isinstance(data, str):
            self._lean(data)
            value = number(data, self.constants)
        elif isinstance(data, (int, float)) and not isinstance(data, bool):
            value = float(data) if abs(data) <= HUGE else HUGE * 10.0
        else:
            raise ValueError(f"expected a number or a formula, found {validate.show(data)}")
        if not abs(value) <= HUGE:
            raise ValueError(f"expected a number up to {HUGE:g}, found a larger one")
        return value

    def count(self, data: Any, most: int) -> int:
        value = self.number(data)
        if value != round(value) or not abs(value) <= most:
            raise ValueError(f"expected a whole number up to {most}, found {value:g}; round it in the formula, or lower it")
        self._counted += abs(round(value))
        if self._counted > ALL:
            raise ValueError(f"expected at most {ALL} elements in a file, found more by this item; build the scene in Python")
        return round(value)

    def numbers(self, data: Any) -> Any:
        """A number, or a list of them, or of lists."""
        return [self.numbers(part) for part in data] if isinstance(data, list) else self.number(data)

    def of(self, field: Field, data: Any, variables: tuple[str, ...] | None) -> Any:
        """What data mean in a field, of laws with these variables."""
        words = field.words
        if "law" in words or "function" in words:
            return self.function(data, (TIME,) if "function" in words else variables or (), law="law" in words)
        if "count" in words:
            return self.count(data, field.most)
        if "constants" in words:
            return {name: self.number(value) for name, value in data.items()}
        return self.numbers(data) if {"number", "vector", "matrix"} & words else data

    def function(self, data: Any, variables: tuple[str, ...], law: bool = False) -> Any:
        """Numbers stay numbers unless a law is wanted; formulas of the variables and tables with a kind become functions."""
        if isinstance(data, dict):
            return self._kind(data["kind"], FUNCTIONS[data["kind"]], {key: part for key, part in data.items() if key != "kind"}, variables)
        texts = data if isinstance(data, list) else [data]
        if not law and not any(set(variables) & names_in(text) for text in texts if isinstance(text, str)):
            return self.numbers(data)
        return self._expression([text if isinstance(text, str) else repr(self.number(text)) for text in texts], not isinstance(data, list), variables)

    def _lean(self, text: str) -> None:
        if self.refused and self.refused & names_in(text):
            raise Leaning(text)

    def _expression(self, texts: list[str], single: bool, variables: tuple[str, ...], **others: Any) -> Expression:
        """With the parameters that it mentions, and with constants of its own."""
        own = others.pop("constants", {})
        for text in texts:
            self._lean(text)
        used = {name: self.constants[name] for text in texts for name in sorted(names_in(text)) if name in self.constants}
        constants = {name: value for name, value in used.items() if name not in variables} | own
        return Expression(texts[0] if single else texts, variables, constants, **others)

    def _kind(self, name: str, kind: Kind, data: dict[str, Any], variables: tuple[str, ...]) -> Any:
        values = {key: self.of(kind.fields[key], part, variables) for key, part in data.items()}
        if name != "Expression":
            return kind.make(**values)
        text = values.pop("text")
        chosen = tuple(values.pop("variables", variables))
        return self._expression(text if isinstance(text, list) else [text], isinstance(text, str), chosen, **values)
