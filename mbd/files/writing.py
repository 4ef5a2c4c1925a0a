"""Writing scene files: what a scene was made of, in the layout of a file. Reading it gives the same scene, every float included."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..archive import replacing
from ..descriptions import arguments, described, functions
from ..errors import SceneError
from ..functions import Expression
from ..functions.expression import TIME
from ..functions.language import names_in
from ..marker import Marker
from ..scene import Scene
from .kinds import FUNCTIONS, ITEMS, SOLVERS, Kind
from .markers import marker_text, short

WIDE = 100
"""Lists longer than this take a line for each entry."""


def write_scene(
    scene: Scene,
    path: str | os.PathLike[str],
    *,
    t_end: float | None = None,
    rtol: float | None = None,
    solver: Any = None,
    outputs: Mapping[str, Marker] | None = None,
) -> None:
    """Writes a scene to a TOML or JSON file, by the ending of its name; what is given besides becomes the file's table ``simulate``.

    Numbers are written as they are, to the last digit; parameters and formulas of a file that the scene came from are not kept. Raises
    SceneError for a scene that cannot be built or has functions of the user's own (those of ``mbd.functions`` can be written), by item, and
    ValueError for another ending.
    """
    target = Path(path)
    if target.suffix.lower() not in (".toml", ".json"):
        raise ValueError(f"expected a path that ends in .toml or .json, found {target.name!r}")
    data = scene_data(scene) | _simulate(scene, t_end, rtol, solver, outputs)
    text = json.dumps(data, indent=1, ensure_ascii=False) + "\n" if target.suffix.lower() == ".json" else toml(data)
    with replacing(target.resolve()) as file:
        file.write(text.encode())


def scene_data(scene: Scene) -> dict[str, Any]:
    """What a file of the scene holds, without a table ``simulate``. Raises SceneError as ``write_scene``."""
    scene.build()
    items = described(scene)
    if unknown := functions(items):
        advice = "use mbd.Expression, mbd.Sine, ... instead"
        raise SceneError([f"{name!r}: expected functions that can be written, found one of the user's own; {advice}" for name in unknown])
    names = _Names(scene)
    return {"gravity": _part(scene.gravity.tolist(), names), "items": [_table(item["class"], ITEMS, item["fields"], names) for item in items]}


class _Names:
    """Of a scene's items, for the texts of markers."""

    def __init__(self, scene: Scene):
        self._all = {item.name for item in scene.items}
        self._beams = {item.name for item in scene.items if hasattr(item, "start")}

    def marker(self, item: str, numbers: list[float]) -> str:
        for ends in (item in self._beams, False):
            text = marker_text(item, numbers, ends)
            if text == item or text not in self._all:
                return text
        raise SceneError([f"{text!r}: expected names that are no markers of other items, found one; rename it"])


def _table(name: str, kinds: Mapping[str, Kind], values: dict[str, Any], names: _Names) -> dict[str, Any]:
    """A kind and those of its fields that are not what they would be anyway."""
    known = kinds[name].fields
    told = {key: _part(value, names) for key, value in values.items() if value is not None}
    first = {"kind": name} | ({"name": told.pop("name")} if "name" in told else {})
    return first | {key: value for key, value in told.items() if known[key].required or value != _plain(known[key].default)}


def _plain(default: Any) -> Any:
    return list(default) if isinstance(default, tuple) else default


def _part(value: Any, names: _Names) -> Any:
    """A described value in the words of a file."""
    if isinstance(value, list):
        return [_part(part, names) for part in value]
    if not isinstance(value, dict):
        return short(value)
    if "marker" in value:
        return names.marker(value["marker"], value["at"])
    if "item" in value:
        return value["item"]
    if "function" not in value:
        return {key: _part(part, names) for key, part in value.items()}
    found = _table(value["function"], FUNCTIONS, value["fields"], names)
    return found["text"] if _is_formula(found) else found


def _is_formula(data: dict[str, Any]) -> bool:
    """Whether the text alone is read as the same function of t."""
    text, more = data.get("text"), data.keys() - {"kind", "text", "discontinuities"}
    if data["kind"] != "Expression" or not isinstance(text, str) or more or TIME not in names_in(text):
        return False
    return list(Expression(text).discontinuities) == data.get("discontinuities", [])


def _simulate(scene: Scene, t_end: Any, rtol: Any, solver: Any, outputs: Mapping[str, Marker] | None) -> dict[str, Any]:
    names = _Names(scene)
    told = {"t_end": _part(t_end, names), "rtol": rtol}
    if solver is not None:
        name = type(solver).__name__
        told["solver"] = _table(name, SOLVERS, {field.name: getattr(solver, field.name) for field in fields(solver)}, names)
    if outputs:
        told["outputs"] = {name: _output(scene, names, name, marker) for name, marker in outputs.items()}
    given = {name: value for name, value in told.items() if value is not None}
    return {"simulate": given} if given else {}


def _output(scene: Scene, names: _Names, name: str, marker: Marker) -> str:
    if marker.scene is not scene:
        raise ValueError(f"outputs: {name}: expected a marker of this scene, found one of another")
    return names.marker(marker.item, arguments(marker, f"outputs: {name}"))


def toml(data: Mapping[str, Any]) -> str:
    """A TOML text of a table of values, tables and lists of tables, one level of each."""
    plain = {key: value for key, value in data.items() if not _has_tables(value)}
    lines = [*_entries(plain)]
    for key in (key for key in data if key not in plain):
        tables = data[key] if isinstance(data[key], list) else [data[key]]
        header = f"[[{key}]]" if isinstance(data[key], list) else f"[{key}]"
        for table in tables:
            lines += ["", header, *_entries(table)]
    return "\n".join(lines) + "\n"


def _has_tables(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _entries(table: Mapping[str, Any]) -> Iterator[str]:
    return (f"{_key(key)} = {_inline(value)}" for key, value in table.items())


def _key(key: str) -> str:
    return key if key.isascii() and key.replace("_", "a").replace("-", "a").isalnum() else _text(key)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_inline(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list):
        parts = [_inline(part) for part in value]
        line = f"[{', '.join(parts)}]"
        return line if len(line) <= WIDE else "[\n" + "".join(f"    {part},\n" for part in parts) + "]"
    if isinstance(value, str):
        return _text(value)
    return ("true" if value else "false") if isinstance(value, bool) else repr(value)


def _text(value: str) -> str:
    """A TOML string: JSON's but for the one control character that JSON lets pass."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
