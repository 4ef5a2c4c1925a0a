"""The language of formulas in files: numbers, names, + - * / **, functions of FUNCTIONS, comparisons in ``a if t < 0.4 else b``.

A text is parsed by Python's own parser and translated, node by node, to closures: what is not listed here is refused by name, nothing is
evaluated as Python, and the cost of a formula is bounded by its length. Numbers are floats: 9**9**9 overflows at once and is refused.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .translation import CONSTANTS, Closure, Translation, finite, shown

LONGEST, DEEPEST = 1000, 100
"""Characters in a formula, and operations within each other."""

PLAIN = re.compile(r" *-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)? *", re.ASCII)


class Formula(NamedTuple):
    """A parsed text: ``closure`` of the variables' values (numbers or jets), the ``names`` it mentions, and the ``kinks``: times at which
    a comparison of t with a number changes its mind."""

    closure: Closure
    names: frozenset[str]
    kinks: tuple[float, ...]


def parse(text: str, variables: Sequence[str] = (), constants: Mapping[str, float] | None = None) -> Formula:
    """A formula of variables and named constants. Raises ValueError, in words, for any other text."""
    tree = _tree(text)
    translation = Translation(variables, dict(constants or {}) | CONSTANTS)
    closure = translation.number(tree)
    return Formula(closure, frozenset(translation.names), tuple(sorted(translation.kinks)))


def names_in(text: str) -> set[str]:
    """The names of constants and variables in a text, whatever they mean."""
    tree = _tree(text)
    called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and id(node) not in called} - set(CONSTANTS)


def number(text: str, constants: Mapping[str, float] | None = None) -> float:
    """The value of a formula without variables. Raises ValueError."""
    if PLAIN.fullmatch(text) and math.isfinite(value := float(text)):
        return value  # what is a number already needs no parser
    return finite(parse(text, (), constants).closure, ())


def arguments(text: str) -> list[str]:
    """The texts between commas that are not in brackets."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return parts if text.strip() else []


def _tree(text: str) -> ast.expr:
    if len(text) > LONGEST:
        raise ValueError(f"expected a formula of at most {LONGEST} characters, found {len(text)}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ValueError(f"expected a formula such as '2 * L', found {shown(text)} ({getattr(error, 'msg', None) or error})") from error
    level: list[ast.AST] = [tree]
    depth = 0
    while level and depth < DEEPEST:
        level, depth = [child for node in level for child in ast.iter_child_nodes(node)], depth + 1
    if level:
        raise ValueError(f"expected at most {DEEPEST} operations within each other, found more in {shown(text)}")
    return tree
