"""From a file to data, with limits on what it may hold; and back to the lines of the file, for complaints.

    LARGEST bytes, VALUES values, DEPTH levels: a file that is larger is refused before anything is made of it.
"""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

from .. import validate
from ..errors import SceneError

LARGEST = {".toml": 1_000_000, ".json": 10_000_000}
"""Bytes of a file of each format: what is read in about a second."""
VALUES, DEPTH, DOTS = 1_000_000, 12, 12
Key = tuple[str | int, ...]


class Source:
    """A scene file: its ``data`` and where they came from. Raises SceneError for what is no TOML or JSON, OSError where there is no file."""

    def __init__(self, path: str | os.PathLike[str]):
        self.path = Path(path)
        self._toml = self.path.suffix.lower() == ".toml"
        self._text = self._read()
        try:
            self.data: dict[str, Any] = _checked(self._toml_data() if self._toml else _json_data(self._text))
        except RecursionError as error:
            raise self.error(f"expected at most {DEPTH} levels of brackets, found more") from error
        except ValueError as error:
            raise self.error(*self._told(str(error))) from error

    def _told(self, what: str) -> tuple[str, int | None]:
        """A parser's message without the place in it, and the line."""
        if what.endswith(" (at end of document)"):
            return f"{what.removesuffix(' (at end of document)')} at the end of the file", self._text.count("\n") + 1
        found = re.search(r" ?\(at line (\d+), column \d+\)|: line (\d+) column \d+ \(char \d+\)", what)
        return (what.replace(found[0], ""), int(found[1] or found[2])) if found else (what, None)

    def error(self, what: str, line: int | None = None) -> SceneError:
        return SceneError([f"{self.path.name}{f', line {line}' if line else ''}: {what}"])

    def where(self, key: Key) -> str:
        """The place of a key in words: file, line (in TOML) and key path."""
        shown = "".join(f"[{part}]" if isinstance(part, int) else f".{validate.show(part)[1:-1]}" for part in key).lstrip(".")
        line, name = self.line(key), self._name(key)
        return ", ".join([self.path.name, *([f"line {line}"] if line else []), *([shown + name] if shown else [])])

    def line(self, key: Key) -> int:
        """The line of a key or of what holds it; 0 where it is not known."""
        return next((self._lines[key[:k]] for k in range(len(key), 0, -1) if key[:k] in self._lines), 0)

    def _name(self, key: Key) -> str:
        """Of the item that a key belongs to."""
        if len(key) < 2 or key[0] != "items" or not isinstance(self.data["items"], list) or not isinstance(key[1], int):
            return ""
        item = self.data["items"][key[1]]
        name = item.get("name") if isinstance(item, dict) else None
        return f" of {validate.show(name)}" if isinstance(name, str) else ""

    def _read(self) -> str:
        suffix = self.path.suffix.lower()
        if suffix not in LARGEST:
            raise self.error(f"expected a file that ends in .toml or .json, found {suffix!r}")
        with open(self.path, "rb") as file:
            raw = file.read(LARGEST[suffix] + 1)
        if len(raw) > LARGEST[suffix]:
            raise self.error(f"expected at most {LARGEST[suffix]} bytes, found more; split the tables of the file, or build the scene in Python")
        try:
            return raw.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = raw[: error.start].count(b"\n") + 1
            raise self.error(f"expected text in UTF-8, found the byte 0x{raw[error.start]:02x}", line) from error

    def _toml_data(self) -> Any:
        for number, line in enumerate(self._text.splitlines(), 1):
            if any(match[0].count(".") > DOTS for match in DOTTED.finditer(line)):
                raise ValueError(f"expected at most {DOTS} dots in a key, found more (at line {number}, column 1)")
        return tomllib.loads(self._text)

    @cached_property
    def _lines(self) -> dict[Key, int]:
        """The line of every key of a TOML file."""
        return dict(_toml_lines(self._text)) if self._toml else {}


DOTTED = re.compile(r"""[\w"'-]++(?:[ \t]*+\.[ \t]*+[\w"'-]++)*+""")


def _json_data(text: str) -> Any:
    return json.loads(text, object_pairs_hook=_unique, parse_constant=_no_number)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"expected each key once, found {validate.show(twice)} more than once")
    return found


def _no_number(word: str) -> Any:
    raise ValueError(f"expected finite numbers, found {word}")


def _checked(data: Any) -> dict[str, Any]:
    """The data. Raises ValueError where there are too many, or they nest too deep."""
    if not isinstance(data, dict):
        raise ValueError(f"expected a table of gravity, items, ..., found {validate.show(data)}")
    level, count = [data], 0
    for _ in range(DEPTH):
        level = [part for value in level for part in _parts(value)]
        count += len(level)
        if count > VALUES:
            raise ValueError(f"expected at most {VALUES} values, found more")
    if level:
        raise ValueError(f"expected at most {DEPTH} levels of brackets, found more")
    return data


def _parts(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return value if isinstance(value, list) else []


def _toml_lines(text: str) -> Iterator[tuple[Key, int]]:
    """(key, line) of every statement, which is read by itself; of a table in one line also the keys in it."""
    home: Key = ()
    counts: dict[Key, int] = {}
    for number, statement in _statements(text):
        table = re.match(r"\s*(\[\[?)(?!\[)", statement)
        found = tomllib.loads(statement)
        if table:
            home = _home(found, table[1] == "[[", counts)
            yield home, number
        else:
            yield from ((home + key, number) for key in _keys(found))


def _home(found: dict[str, Any], many: bool, counts: dict[Key, int]) -> Key:
    """The key of a table whose header was read; within arrays of tables that of the last one."""
    key: Key = ()
    while found:
        name, inner = next(iter(found.items()))
        key = (*key, name)
        found = inner[0] if isinstance(inner, list) else inner
        if many and not found:
            counts[key] = counts.get(key, -1) + 1
        if key in counts:
            key = (*key, counts[key])
    return key


def _keys(value: Any, key: Key = ()) -> Iterator[Key]:
    if key:
        yield key
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, inner in pairs:
        yield from _keys(inner, (*key, name))


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """The statements of a TOML file that is known to be one, with their first lines; several lines where one is no statement by itself."""
    kept, start = "", 1
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        if not kept and not line.partition("#")[0].strip():
            continue
        start = start if kept else number
        kept += line
        if len(kept) > len(line) and not re.search(r"""(?:\]|\}|\"{3}|'{3})[ \t]*(?:#.*)?$""", line.rstrip("\r\n")):
            continue
        try:
            tomllib.loads(kept)
        except tomllib.TOMLDecodeError:
            continue
        yield start, kept
        kept = ""
