"""What may stand in a scene file: kinds of items, functions and solvers, with their fields, as the classes themselves declare them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import MISSING, fields
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

from .. import functions, solvers
from ..descriptions import KINDS
from ..elements import RigidBody
from ..marker import Marker

MANY = 20_000
LIMITS = {"gauss_points": 50, "FloatingFrameBeam.n_elements": 400}
"""Counts size arrays, those of modes and Gauss points square ones: the most of each field, ``MANY`` of others."""
PLAIN = {int: "count", float: "number", str: "text", bool: "flag", Marker: "marker"}


class Field(NamedTuple):
    """``words`` of ``mbd.fields`` say what it holds; ``choices`` are the texts that it may be, if any; ``most`` the largest count."""

    words: frozenset[str]
    choices: tuple[str, ...]
    required: bool
    default: Any = None
    most: int = MANY


class Kind(NamedTuple):
    """``noun`` is what messages call it."""

    make: Callable[..., Any]
    fields: dict[str, Field]
    noun: str


def _kind(cls: Any) -> Kind:
    hints = get_type_hints(cls, include_extras=True)
    found = {field.name: _field(hints[field.name], _default(field), _most(cls, field.name)) for field in fields(cls)}
    return Kind(cls, found, getattr(cls, "kind", cls.__name__))


def _default(field: Any) -> Any:
    return field.default_factory() if field.default_factory is not MISSING else field.default


def _most(cls: Any, field: str) -> int:
    return LIMITS.get(f"{cls.__name__}.{field}", LIMITS.get(field, MANY))


def _field(hint: Any, default: Any, most: int = MANY) -> Field:
    words, choices = frozenset(_words(hint)), get_args(hint) if get_origin(hint) is Literal else ()
    return Field(words, choices, default in (MISSING, inspect.Parameter.empty), default, most)


def _words(hint: Any) -> Iterator[str]:
    if get_origin(hint) in (Union, UnionType):
        for part in get_args(hint):
            yield from _words(part)
    elif get_origin(hint) is Annotated:
        yield get_args(hint)[1]
    elif get_origin(hint) is Literal:
        yield "choice"
    elif hint is not NoneType:
        if hint not in PLAIN:
            raise TypeError(f"expected an annotation of mbd.fields, found {hint!r}")
        yield PLAIN[hint]


def _constructor(name: str, *motion: str) -> Kind:
    """A class method of RigidBody, with what it passes on."""
    make = getattr(RigidBody, name)
    hints, body = get_type_hints(make, include_extras=True), _kind(RigidBody).fields
    given = {p.name: _field(hints[p.name], p.default) for p in inspect.signature(make).parameters.values() if p.kind is not p.VAR_KEYWORD}
    return Kind(make, given | {other: body[other] for other in (*motion, "velocity", "angular_velocity", "name")}, RigidBody.kind)


ITEMS: dict[str, Kind] = {name: _kind(cls) for name, cls in KINDS.items()} | {
    "RigidBody.rod": _constructor("rod"),
    "RigidBody.box": _constructor("box", "angle", "rotation"),
}
FUNCTIONS: dict[str, Kind] = {name: _kind(cls) for name, cls in functions.KINDS.items()}
SOLVERS: dict[str, Kind] = {name: _kind(getattr(solvers, name)) for name in solvers.__all__}
