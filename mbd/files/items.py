"""Items of a file, one after the other, into a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ..errors import SceneError
from ..functions import Expression
from ..functions.expression import TIME
from ..scene import Scene
from .kinds import ITEMS, Field
from .markers import Finder
from .text import Key
from .values import Leaning, Values

Complain = Callable[[Key, str], None]


class Builder:
    """Adds the items of a file to a scene, and complains of those that cannot be added."""

    def __init__(self, scene: Scene, values: Values, items: list[Any], complain: Complain):
        self.scene, self.values, self.items, self.complain = scene, values, items, complain
        self.finder = Finder(scene, values, [item.get("name") for item in items if isinstance(item, dict)])
        self._homes: dict[str, int] = {}

    def add(self, k: int, fits: bool) -> None:
        """The k-th item; one that does not fit the model is left out, and so is what names it."""
        name = self.items[k].get("name") if isinstance(self.items[k], dict) else None
        description = self._description(k) if fits and not self._taken(k, name) else None
        if description is None:
            self.finder.refuse(name)
            return
        item = self.scene.add(description)
        self._homes[f"{description.kind} {item.name!r}: "] = k
        self.finder.known[item.name] = item

    def _taken(self, k: int, name: Any) -> bool:
        if name in self.finder.known:
            self.complain(("items", k, "name"), f"expected a name that no item before this one has, found {name!r} again; rename one")
        return name in self.finder.known

    def _description(self, k: int) -> Any:
        data = self.items[k]
        values = self._fields(k, data)
        if values is None:
            return None
        try:
            return ITEMS[data["kind"]].make(**values)
        except (SceneError, TypeError, ValueError, ArithmeticError, LookupError) as error:
            for line in str(error).splitlines():
                told = line if isinstance(error, SceneError) else f"expected other values, found some that fail ({line})"
                self.complain(*self._at_field(k, told, f"{ITEMS[data['kind']].noun} {data.get('name')!r}: "))
            return None

    def _fields(self, k: int, data: dict[str, Any]) -> dict[str, Any] | None:
        """The values of an item's fields; None where one is wrong, or leans on what was refused."""
        values: dict[str, Any] = {}
        for name, part in data.items():
            if name == "kind":
                continue
            try:
                values[name] = self._value(ITEMS[data["kind"]].fields[name], part, data)
            except Leaning:
                continue
            except ValueError as error:
                self.complain(("items", k, name), str(error))
        return values if len(values) == len(data) - 1 else None

    def _value(self, field: Field, part: Any, data: dict[str, Any]) -> Any:
        words = field.words
        if "marker" in words:
            return self.finder.marker(part)
        if words & {"measure", "beam"}:
            return self.finder.item(part)
        if "measures" in words:
            return [self.finder.item(name) for name in (part if isinstance(part, list) else [part])]
        if "terms" in words:
            return [(self.values.number(coefficient), self.finder.item(name)) for coefficient, name in part]
        return self._law(field, part, data) if "law" in words else self.values.of(field, part, None)

    def _law(self, field: Field, part: Any, data: dict[str, Any]) -> Any:
        variables = law_variables(data)
        value = self.values.of(field, part, variables)
        if isinstance(value, Expression) and len(value.variables) != len(variables):
            raise ValueError(f"expected {len(variables)} variables such as {', '.join(variables)}; found {', '.join(value.variables)}")
        return value

    def judge(self, complete: bool) -> None:
        """What the scene itself finds wrong; the whole of it only where it is complete."""
        lines = self.scene.complaints
        if complete:
            try:
                self.scene.build()
            except SceneError as error:
                lines = error.complaints
        for line in lines:
            self.complain(*self._home(line))

    def _home(self, line: str) -> tuple[Key, str]:
        """The item, and its field, that a complaint of the scene is about, and the rest of the complaint."""
        if line.startswith("scene: gravity: "):
            return ("gravity",), line.removeprefix("scene: gravity: ")
        for prefix, k in self._homes.items():
            if line.startswith(prefix):
                return self._at_field(k, line, prefix)
        return (), line

    def _at_field(self, k: int, line: str, prefix: str) -> tuple[Key, str]:
        """A complaint without what its place says already: the item, and the field that it names first."""
        line = line.removeprefix(prefix)
        field, _, rest = line.partition(": ")
        return (("items", k, field), rest) if field in self.items[k] else (("items", k), line)


def law_variables(data: dict[str, Any]) -> tuple[str, ...]:
    """What the formulas of a law may name: measures s or s1, s2, ...; of a ForceLaw also t, and with rates ds or ds1, ds2, ..."""
    measures = data.get("measures")
    count = len(measures) if isinstance(measures, list) else 1
    if data["kind"] != "ForceLaw":
        return tuple(_numbered("s", count))
    rates = _numbered("ds", count) if data.get("rates") is True else ()
    return (TIME, *_numbered("s", count), *rates)


def _numbered(stem: str, count: int) -> Iterator[str]:
    yield from [stem] if count == 1 else (f"{stem}{k}" for k in range(1, count + 1))
