"""The data model of scene files, made of the kinds' own fields, and its JSON Schema."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Annotated, Any, Literal, Union

try:
    from pydantic import BaseModel, ConfigDict, Discriminator, Tag, ValidationError, WrapValidator, create_model
    from pydantic import Field as Constraint
    from pydantic_core import PydanticCustomError
except ImportError as error:
    raise ImportError("scene files need pydantic: python -m pip install 'mbd[files]'") from error

from .kinds import FUNCTIONS, ITEMS, SOLVERS, Field, Kind

URL = "https://json-schema.org/draft/2020-12/schema"
STRICT = ConfigDict(extra="forbid", strict=True, frozen=True)
MOST = {"items": 50_000, "parameters": 1000, "outputs": 100, "name": 200, "text": 1000}


def _told(expected: str) -> WrapValidator:
    """One complaint in our words in place of pydantic's for every alternative."""

    def check(value: Any, handler: Any) -> Any:
        try:
            return handler(value)
        except ValidationError as error:
            raise PydanticCustomError("expected", "{expected}", {"expected": expected}) from error

    return WrapValidator(check)


Formula = Annotated[str, Constraint(max_length=MOST["text"])]
Name = Annotated[str, Constraint(min_length=1, max_length=MOST["name"])]
Finite = Annotated[float, Constraint(allow_inf_nan=False)]
Law = Formula | list[Formula]
Term = Annotated[tuple[Finite | Formula, Name], Constraint(strict=False)]

WORDS: dict[str, tuple[Any, str]] = {
    "number": (Finite | Formula, "a number, or a formula such as '2 * L'"),
    "count": (int | Formula, "a whole number, or a formula such as 'round(25 * L)'"),
    "text": (Name, f"a text of 1 to {MOST['name']} characters"),
    "texts": (list[Name], "a list of texts"),
    "flag": (bool, "true or false"),
    "vector": (list[Finite | Formula], "a list of numbers or formulas"),
    "matrix": (list[list[Finite | Formula]], "a list of rows of numbers or formulas"),
    "constants": (dict[Name, Finite | Formula], "numbers by name"),
    "function": (Finite | Formula | list[Finite | Formula], "a number, a list of numbers, a formula of t, or a table with a kind of function"),
    "law": (Law, "a formula such as '-100 * s', a list of them, or a table with kind = 'Expression'"),
    "marker": (Name, "a marker such as 'rod.end', 'crank.at(0.5, 0)' or 'ground.at(0, 0)'"),
    "measure": (Name, "the name of a measure"),
    "measures": (Name | list[Name], "the name of a measure, or a list of names"),
    "terms": (list[Term], "pairs such as [2.0, 'the name of a measure']"),
    "beam": (Name, "the name of a cable"),
}
"""The form of each word of ``mbd.fields`` in a file, and how to say it."""


def _word(name: str) -> Any:
    kind, told = WORDS[name]
    return Annotated[kind, _told(told)]


def _expected(words: frozenset[str]) -> str:
    return ", or ".join(WORDS[word][1] for word in sorted(words))


def _type(field: Field) -> Any:
    if field.choices:
        words: Any = Literal[field.choices]
        return Annotated[words, _told(f"one of {', '.join(map(repr, field.choices))}")]
    plain: Any = Annotated[_any_of(WORDS[word][0] for word in sorted(field.words)), _told(_expected(field.words))]
    named = ("Expression",) if "law" in field.words else tuple(FUNCTIONS) if "function" in field.words else ()
    if not named:
        return plain
    return Annotated[_any_of([Annotated[plain, Tag("plain")], *(Annotated[name, Tag(name)] for name in named)]), Discriminator(_tag)]


def _any_of(types: Iterable[Any]) -> Any:
    return Union[tuple(types)]  # noqa: UP007


def _tag(value: Any) -> Any:
    """Which alternative a function is: tables tell, all else is plain."""
    return getattr(value, "kind", None) if isinstance(value, BaseModel) else value.get("kind") if isinstance(value, dict) else "plain"


def _models(kinds: Mapping[str, Kind]) -> dict[str, type[BaseModel]]:
    return {name: _model(name, kind) for name, kind in kinds.items()}


def _model(name: str, kind: Kind) -> type[BaseModel]:
    """The fields of a kind, with ``kind``, which names it."""
    entries = {key: (_type(field), ... if field.required else field.default) for key, field in kind.fields.items()}
    told = inspect.cleandoc(kind.make.__doc__ or "")
    return _table(name, told, kind=(Literal[name], ...), **entries)


def _one_of(models: dict[str, type[BaseModel]]) -> Any:
    return Annotated[_any_of(models.values()), Constraint(discriminator="kind")]


@cache
def document() -> type[BaseModel]:
    """The model of a whole file."""
    functions = _models(FUNCTIONS)
    items, solvers = _models(ITEMS), _models(SOLVERS)
    for model in (*functions.values(), *items.values()):
        model.model_rebuild(_types_namespace=functions)
    outputs: Any = dict[Name, _word("marker")]  # type: ignore[misc]
    numbers: Any = dict[Name, _word("number")]  # type: ignore[misc]
    several: Any = list[_one_of(items)]  # type: ignore[misc]
    simulate = _table(
        "simulate",
        "How `mbd run` and the other commands run the scene, unless told otherwise; `outputs` names markers.",
        t_end=(_word("number"), None),
        rtol=(_word("number"), None),
        solver=(_one_of(solvers), None),
        outputs=(_limited(outputs, "outputs"), None),
    )
    return _table(
        "scene",
        "A scene of mbd: gravity with two components (planar) or three (spatial), and items in an order in which each names earlier ones.",
        gravity=(_word("vector"), ...),
        parameters=(_limited(numbers, "parameters"), None),
        items=(_limited(several, "items", 1), ...),
        simulate=(simulate, None),
    )


def _table(title: str, told: str, /, **entries: Any) -> type[BaseModel]:
    return create_model(title, __config__=STRICT, __doc__=told, **entries)  # type: ignore[call-overload]


def _limited(kind: Any, name: str, least: int = 0) -> Any:
    return Annotated[kind, Constraint(min_length=least, max_length=MOST[name])]


def schema() -> dict[str, Any]:
    """The JSON Schema of scene files."""
    return {"$schema": URL} | _plain(document().model_json_schema())


def _plain(part: Any) -> Any:
    """Without titles that repeat names, and without null, which is no value in a file."""
    if isinstance(part, list):
        return [_plain(inner) for inner in part]
    if not isinstance(part, dict):
        return part
    return {
        name: {key: _plain(inner) for key, inner in value.items()} if name == "properties" else _plain(value)
        for name, value in part.items()
        if name != "title" and not (name == "default" and value in (None, [], {}))
    }
