"""The data model of scene files, made of the kinds' own fields; its JSON Schema, and the complaints about data that do not fit, in words."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Literal, Union

try:
    from pydantic import BaseModel, ConfigDict, Discriminator, Tag, ValidationError, WrapValidator, create_model
    from pydantic import Field as Constraint
    from pydantic_core import PydanticCustomError
except ImportError as error:
    raise ImportError("scene files need pydantic: python -m pip install 'mbd[files]'") from error

from .. import validate
from ..nearest import listed, nearest
from .kinds import FUNCTIONS, ITEMS, SOLVERS, Field, Kind
from .text import Key

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
Number = Annotated[Finite | Formula, _told("a number, or a formula such as '2 * L'")]
Vector = Annotated[list[Finite | Formula], _told("a list of numbers or formulas")]
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


def expected(words: frozenset[str]) -> str:
    return ", or ".join(WORDS[word][1] for word in sorted(words))


def _type(field: Field) -> Any:
    if field.choices:
        return Annotated[Literal[field.choices], _told(f"one of {', '.join(map(repr, field.choices))}")]
    plain = Annotated[_any_of(WORDS[word][0] for word in sorted(field.words)), _told(expected(field.words))]
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
    return create_model(name, __config__=STRICT, __doc__=told, kind=(Literal[name], ...), **entries)  # type: ignore[call-overload]


def _one_of(models: dict[str, type[BaseModel]]) -> Any:
    return Annotated[_any_of(models.values()), Constraint(discriminator="kind")]


@cache
def document() -> type[BaseModel]:
    """The model of a whole file."""
    functions = _models(FUNCTIONS)
    items, solvers = _models(ITEMS), _models(SOLVERS)
    for model in (*functions.values(), *items.values()):
        model.model_rebuild(_types_namespace=functions)
    outputs = dict[Name, Annotated[Name, _told(WORDS["marker"][1])]]
    simulate = create_model(
        "simulate",
        __config__=STRICT,
        __doc__="How `mbd run` and the other commands run the scene, unless told otherwise; `outputs` names markers.",
        t_end=(Number, None),
        rtol=(Number, None),
        solver=(_one_of(solvers), None),
        outputs=(Annotated[outputs, Constraint(max_length=MOST["outputs"])], None),
    )
    return create_model(
        "scene",
        __config__=STRICT,
        __doc__="A scene of mbd: gravity with two components (planar) or three (spatial), and items in an order in which each names earlier ones.",
        gravity=(Vector, ...),
        parameters=(Annotated[dict[Name, Number], Constraint(max_length=MOST["parameters"])], None),
        items=(Annotated[list[_one_of(items)], Constraint(min_length=1, max_length=MOST["items"])], ...),  # type: ignore[misc]
        simulate=(simulate, None),
    )


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


def complaints(data: dict[str, Any], most: int) -> list[tuple[Key, str]]:
    """(key, what is wrong) of everything that does not fit the model, but not of more than ``most``."""
    try:
        document().model_validate(data)
    except ValidationError as error:
        return list(_in_words(data, error.errors(include_url=False, include_input=False)[:most]))
    return []


def _in_words(data: Any, errors: Sequence[Any]) -> Iterator[tuple[Key, str]]:
    for one in errors:
        key, found = _key(data, one["loc"], one["type"])
        yield key, _sentence(one, key, found, one["loc"])


def _key(data: Any, loc: tuple[int | str, ...], what: str) -> tuple[Key, Any]:
    """The key in the file, and what is there: pydantic's path without the names of alternatives."""
    key: Key = ()
    for part in loc:
        inside = part in data if isinstance(data, dict) else isinstance(data, list) and isinstance(part, int)
        if inside:
            key, data = (*key, part), data[part]
    return ((*key, loc[-1]) if what == "missing" else key), data


def _sentence(one: Any, key: Key, found: Any, loc: tuple[int | str, ...]) -> str:
    shown, context = validate.show(found), one.get("ctx", {})
    if one["type"] == "missing":
        return "expected a value, found none; give one"
    if one["type"] == "extra_forbidden":
        known = _fields_at(loc)
        return f"expected one of {listed(known)}; found {validate.show(key[-1])}{nearest(str(key[-1]), known)}"
    if one["type"] in ("union_tag_invalid", "union_tag_not_found"):
        known = _kinds_at(loc)
        kind = found.get("kind") if isinstance(found, dict) else None
        shown = validate.show(kind) if kind is not None else "none" if isinstance(found, dict) else shown
        return f"kind: expected one of {listed(known)}; found {shown}{nearest(kind, known) if isinstance(kind, str) else ''}"
    if one["type"] == "expected":
        return f"expected {context['expected']}; found {shown}"
    if one["type"] in ("too_short", "too_long"):
        limit = f"at least {context['min_length']}" if one["type"] == "too_short" else f"at most {context['max_length']}"
        return f"expected {limit}; found {len(found) if isinstance(found, (list, dict)) else 'others'}"
    what = {"list_type": "a list", "dict_type": "a table", "model_type": "a table", "model_attributes_type": "a table"}.get(one["type"])
    return f"expected {what or 'other data (' + one['msg'] + ')'}; found {shown}"


def _kinds_at(loc: tuple[int | str, ...]) -> list[str]:
    if loc[0] == "simulate":
        return list(SOLVERS)
    return list(ITEMS) if len(loc) == 2 else list(FUNCTIONS)


def _fields_at(loc: tuple[int | str, ...]) -> list[str]:
    """The names known beside an unknown one: those of the innermost kind on the way to it, else of the section or the file."""
    for part in reversed(loc[:-1]):
        for kinds in (FUNCTIONS, ITEMS, SOLVERS):
            if part in kinds:
                return ["kind", *kinds[str(part)].fields]
    home = document() if len(loc) == 1 else document().model_fields["simulate"].annotation
    return list(home.model_fields)  # type: ignore[union-attr]
