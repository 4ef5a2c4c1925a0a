"""Reading scene files: the data become a scene, or a list of everything that is wrong with them, each with its place in the file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..errors import SceneError
from ..job import Job
from ..scene import Scene
from .items import Builder
from .kinds import SOLVERS
from .mistakes import mistakes
from .overrides import override
from .text import Key, Source
from .values import Leaning, Values, parameters

MOST_COMPLAINTS = 100


def read_scene(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> Scene:
    """The scene in a TOML or JSON file (docs/guide/scene_files.md). Nothing in a file is executed.

    overrides  values that replace those in the file, by the name of a parameter, an item's field or another key: {"L": 2.0, "rod.E": 1e6}

    Raises SceneError with every complaint, each with its place in the file; OSError where there is no file; ImportError without pydantic.
    """
    return read(path, overrides).scene


def read(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> Job:
    """The scene in a file, and how the file says that it be run; see ``read_scene``."""
    reading = _Reading(Source(path))
    for key, value in (overrides or {}).items():
        reading.attempt((), lambda key=key, value=value: override(reading.data, key, value))  # type: ignore[misc]
    with np.errstate(all="ignore"):  # what overflows is complained of as not finite
        job = reading.job()
    if reading.complaints:
        raise SceneError(reading.told())
    return job


class _Reading:
    """One file on its way to a scene."""

    def __init__(self, source: Source):
        self.source, self.data = source, source.data
        self.complaints: list[tuple[Key, str]] = []

    def complain(self, key: Key, what: str) -> None:
        self.complaints.append((key, what))

    def told(self) -> list[str]:
        """The complaints with their places, in the order of the lines."""
        ordered = sorted(self.complaints, key=lambda one: self.source.line(one[0]))
        lines = [f"{self.source.where(key)}: {what}" for key, what in ordered[:MOST_COMPLAINTS]]
        return lines + (["and more: correct these first"] if self.tired else [])

    @property
    def tired(self) -> bool:
        """Whether there are more complaints than anyone reads: the rest of the file is left alone then."""
        return len(self.complaints) >= MOST_COMPLAINTS

    def attempt(self, key: Key, action: Callable[[], Any], otherwise: Any = None) -> Any:
        """What an action returns, or a complaint about its place."""
        try:
            return action()
        except Leaning:
            pass
        except ValueError as error:
            self.complain(key, str(error))
        return otherwise

    def job(self) -> Job:
        wrong = mistakes(self.data, MOST_COMPLAINTS)
        for place, what in wrong:
            self.complain(place, what)
        self.wrong = {place[:k] for place, _ in wrong for k in (1, 2, 3)}
        values = self._values()
        zero = (0.0, 0.0)
        scene = Scene(zero if ("gravity",) in self.wrong else self.attempt(("gravity",), lambda: values.numbers(self.data["gravity"]), zero))
        items = self.data.get("items")
        builder = Builder(scene, values, items if isinstance(items, list) else [], self.complain)
        for k in range(len(builder.items)):
            if not self.tired:
                builder.add(k, ("items", k) not in self.wrong)
        builder.judge(complete=not self.complaints)
        return Job(scene, dict(values.constants), **self._simulate(values, builder))

    def _values(self) -> Values:
        given = self.data.get("parameters", {})
        given = given if isinstance(given, dict) else {}
        sound = {name: value for name, value in given.items() if ("parameters", name) not in self.wrong}
        found = parameters(sound, lambda name, what: self.complain(("parameters", name), what), set(given) - set(sound))
        return Values(found, set(given) - set(found))

    def _simulate(self, values: Values, builder: Builder) -> dict[str, Any]:
        """The fields of the table ``simulate``; those that do not fit the model are left out."""
        data = self.data.get("simulate", {})
        sound = {} if not isinstance(data, dict) else {name: part for name, part in data.items() if ("simulate", name) not in self.wrong}
        makers: dict[str, Callable[[Any], Any]] = {
            "t_end": values.number,
            "rtol": values.number,
            "solver": lambda part: _solver(part, values),
            "outputs": lambda part: {name: builder.finder.marker(text) for name, text in part.items()},
        }
        return {name: self.attempt(("simulate", name), lambda name=name, part=part: makers[name](part)) for name, part in sound.items()}  # type: ignore[misc]


def _solver(data: dict[str, Any], values: Values) -> Any:
    kind = SOLVERS[data["kind"]]
    return kind.make(**{name: values.of(kind.fields[name], part, None) for name, part in data.items() if name != "kind"})
