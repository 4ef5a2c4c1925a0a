"""Expressions as text and as LaTeX; long ones with names for what occurs in them more than once."""

from __future__ import annotations

from typing import Any

import sympy as sp

WIDTH = 150
LONG = 60
"""Operations above which an expression is shortened."""


def shortened(expressions: list[Any]) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[Any]]:
    """Definitions z_1 = ..., z_2 = ... and the expressions in terms of them; none where they are short."""
    if sum(sp.count_ops(x) for x in expressions) <= LONG or any(isinstance(x, sp.MatrixExpr) for x in expressions):
        return [], expressions
    return sp.cse(expressions, symbols=sp.numbered_symbols("z_", start=1))


def text(expression: Any) -> str:
    """Over several lines, as it is written; folded where that is too wide."""
    expression = _dotted(expression)
    whole = sp.pretty(expression, use_unicode=True, wrap_line=False)
    if _fits(whole):
        return whole
    definitions, (short,) = shortened([expression])
    lines = [_folded(f"{symbol} = {sp.sstr(value)}") for symbol, value in definitions]
    written = sp.pretty(short, use_unicode=True, wrap_line=False)
    if _fits(written):
        return "\n".join([written, *(["with", *lines] if lines else [])])
    entries = list(short) if isinstance(short, sp.MatrixBase) else [short]
    return "\n".join([*(_folded(f"[{k + 1}]  {sp.sstr(x)}") for k, x in enumerate(entries)), *(["with", *lines] if lines else [])])


def _dotted(expression: Any) -> Any:
    """Long names with dots: an underscore would be printed as a subscript."""
    long = {x: sp.Symbol(x.name.replace("_", "."), **x.assumptions0) for x in expression.free_symbols if getattr(x, "name", "").count("_") > 1}
    return expression.xreplace(long) if long else expression


def _fits(block: str) -> bool:
    return max(map(len, block.splitlines()), default=0) <= WIDTH


def _folded(line: str) -> str:
    """Broken at sums, which a long line has many of."""
    lines, start = [], ""
    for part in line.replace(" + ", "\n+ ").replace(" - ", "\n- ").split("\n"):
        if start and len(start) + len(part) >= WIDTH:
            lines.append(start)
            start = "     "
        start += f" {part}" if start else part
    return "\n".join([*lines, start])


def latex(left: str, expression: Any, **options: Any) -> list[str]:
    """Lines "left = right" and, for a long one, the definitions of what is in it."""
    definitions, (short,) = shortened([expression])
    words = {"mat_delim": "[", "mat_str": "matrix"} | options
    return [f"{left} = {sp.latex(short, **words)}", *(f"{sp.latex(symbol)} = {sp.latex(value, **words)}" for symbol, value in definitions)]
