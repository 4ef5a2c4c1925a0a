"""Markers as texts: ``rod.end``, ``crank.at(-L / 2, 0)``, ``ground.at(0, 0)``; a body, a particle or the ground alone stands for its ``at()``."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from .. import validate
from ..errors import SceneError
from ..functions.language import arguments
from ..marker import Marker
from ..nearest import nearest
from ..scene import Scene
from .values import Leaning, Values

ENDS = {"start": 0.0, "end": 1.0}
WHOLE = 1e15
PATTERN = re.compile(r"(?P<item>.+)\.(?:(?P<end>start|end)|at\((?P<numbers>[^;]*)\))", re.DOTALL)


class Finder:
    """Finds items and markers in a scene under construction; ``names`` are those that the file gives to items, now or later."""

    def __init__(self, scene: Scene, values: Values, names: Collection[Any]):
        self.values, self.names = values, set(filter(None, (name if isinstance(name, str) else None for name in names)))
        self.known: dict[str, Any] = {"ground": scene.ground}
        self.refused: set[str] = set()
        self.nameless = False

    def refuse(self, name: Any) -> None:
        """An item of this name, if any, is left out of the scene."""
        self.refused |= {name} if isinstance(name, str) else set()
        self.nameless |= name is None

    def item(self, name: str) -> Any:
        """Raises ValueError, in words, where there is none."""
        if name in self.known:
            return self.known[name]
        if name in self.refused or (self.nameless and re.search(r" \d+$", name)):
            raise Leaning(name)
        advice = "; items name earlier ones, move it up" if name in self.names else nearest(name, {*self.known, *self.names})
        raise ValueError(f"expected the name of an item before this one, found {validate.show(name)}{advice}")

    def marker(self, text: str) -> Marker:
        match = PATTERN.fullmatch(text.strip())
        if match is None or text in self.known:
            return self._at(self.item(text.strip()), text, ())
        item = self.item(match["item"])
        if match["end"]:
            return self._end(item, text, match["end"])
        return self._at(item, text, tuple(self.values.number(part) for part in arguments(match["numbers"])))

    def _end(self, item: Any, text: str, end: str) -> Marker:
        if not isinstance(getattr(item, end, None), Marker):
            raise ValueError(f"expected .at(...) of {item.name!r}, found {validate.show(text)}; only cables and beams have a start and an end")
        return getattr(item, end)

    def _at(self, item: Any, text: str, numbers: tuple[float, ...]) -> Marker:
        try:
            return item.at(*numbers)
        except SceneError as error:
            raise ValueError(str(error)) from error
        except (AttributeError, TypeError) as error:
            expected = "'.start', '.end' or '.at(s)' behind a cable or a beam, '.at(x, y)' or '.at(x, y, z)' behind a body, none behind a particle"
            raise ValueError(f"expected {expected}; found {validate.show(text)}") from error


def short(value: Any) -> Any:
    """A float without a fraction as a whole number: numbers are read as floats anyway. The sign of -0.0 stays."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < WHOLE and str(value) != "-0.0"
    return int(value) if whole else value


def marker_text(item: str, numbers: list[float], ends: bool) -> str:
    """The shortest text that is read as the marker; ``ends`` tells that 0 and 1 are the start and the end of a beam."""
    if ends:
        for end, s in ENDS.items():
            if numbers == [s]:
                return f"{item}.{end}"
    alone = not numbers and not PATTERN.fullmatch(item) and item == item.strip()
    return item if alone else f"{item}.at({', '.join(repr(short(number)) for number in numbers)})"
