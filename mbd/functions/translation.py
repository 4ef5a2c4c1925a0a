"""From Python's syntax tree to closures of numbers or jets: the words of the language, and what each becomes."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from ..nearest import listed, nearest
from .jets import SLOPES, Jet, atan2, chain, power

Closure = Callable[[Sequence[Any]], Any]
CONSTANTS = {"pi": math.pi, "e": math.e, "tau": math.tau}


def _chosen(which: Callable[..., Any], *values: Any) -> Any:
    return which(values, key=lambda x: x.value if isinstance(x, Jet) else x)


VALUES: dict[str, Callable[[float], float]] = {name: getattr(math, name) for name in SLOPES if hasattr(math, name)} | {
    "abs": abs,
    "round": round,
    "sign": lambda x: float((x > 0.0) - (x < 0.0)),
}
SEVERAL: dict[str, Callable[..., Any]] = {"atan2": atan2, "min": partial(_chosen, min), "max": partial(_chosen, max)}
FUNCTIONS = (*VALUES, *SEVERAL)
RESERVED = (*CONSTANTS, *FUNCTIONS)

OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: power,
    ast.USub: operator.neg,
    ast.UAdd: lambda x: x,
}
COMPARISONS: dict[type, Callable[[float, float], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


def finite(closure: Closure, values: Sequence[Any]) -> Any:
    """The value of a closure. Raises ValueError where it has none that is a finite number, or finite derivatives."""
    try:
        value = closure(values)
    except (ArithmeticError, ValueError, TypeError) as error:
        raise ValueError(f"expected a finite value, found none ({error})") from error
    if not all(map(math.isfinite, value if isinstance(value, Jet) else (value,))):
        raise ValueError(f"expected a finite value, found {value}")
    return value


class Translation:
    """From Python's syntax tree to closures."""

    def __init__(self, variables: Sequence[str], constants: dict[str, float]):
        self.variables, self.constants = list(variables), constants
        self.names: set[str] = set()
        self.kinks: set[float] = set()

    def number(self, node: ast.expr) -> Closure:
        found = getattr(self, f"_{type(node).__name__.lower()}", None)
        if found is None:
            raise ValueError(f"expected numbers, names, + - * / ** and functions, found {_text(node)}{_advice(node)}")
        return found(node)

    def _constant(self, node: ast.Constant) -> Closure:
        if type(node.value) not in (int, float):
            raise ValueError(f"expected a number, found {_text(node)}")
        try:
            value = float(node.value)  # type: ignore[arg-type]
        except OverflowError:
            value = math.inf
        if math.isinf(value):
            raise ValueError("expected a number below 1e308, found a larger one")
        return lambda x: value

    def _name(self, node: ast.Name) -> Closure:
        self.names.add(node.id)
        if node.id in self.variables:
            return operator.itemgetter(self.variables.index(node.id))
        if node.id not in self.constants:
            known = [*self.variables, *self.constants]
            raise ValueError(f"expected one of {listed(known)}; found {shown(node.id)}{nearest(node.id, known)}")
        value = self.constants[node.id]
        return lambda x: value

    def _binop(self, node: ast.BinOp) -> Closure:
        operation, a, b = self._operator(node.op, node), self.number(node.left), self.number(node.right)
        return lambda x: operation(a(x), b(x))

    def _unaryop(self, node: ast.UnaryOp) -> Closure:
        operation, a = self._operator(node.op, node), self.number(node.operand)
        return lambda x: operation(a(x))

    def _operator(self, kind: ast.AST, node: ast.expr) -> Callable[..., Any]:
        if type(kind) not in OPERATORS:
            raise ValueError(f"expected + - * / or **, found {_text(node)}{_advice(kind)}")
        return OPERATORS[type(kind)]

    def _call(self, node: ast.Call) -> Closure:
        name = node.func.id if isinstance(node.func, ast.Name) else None
        if name not in FUNCTIONS:
            raise ValueError(f"expected a function among {', '.join(FUNCTIONS)}; found {_text(node.func)}{nearest(name or '', FUNCTIONS)}")
        least, most = (1, 1) if name in VALUES else (2, 2 if name == "atan2" else 20)
        if node.keywords or not least <= len(node.args) <= most:
            raise ValueError(f"{name}: expected {least if least == most else 'two or more'} number{'s' * (most > 1)}, found {_text(node)}")
        parts = [self.number(part) for part in node.args]
        if name in VALUES:
            return partial(_applied, VALUES[name], SLOPES[name], parts[0])
        if name != "atan2" and len(node.args) == 2:
            self._compared(*node.args)
        several = SEVERAL[name]
        return lambda x: several(*(part(x) for part in parts))

    def _ifexp(self, node: ast.IfExp) -> Closure:
        test, then, other = self._condition(node.test), self.number(node.body), self.number(node.orelse)
        return lambda x: then(x) if test(x) else other(x)

    def _condition(self, node: ast.expr) -> Closure:
        if isinstance(node, ast.BoolOp):
            parts, every = [self._condition(part) for part in node.values], all if isinstance(node.op, ast.And) else any
            return lambda x: every(part(x) for part in parts)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            inner = self._condition(node.operand)
            return lambda x: not inner(x)
        if not isinstance(node, ast.Compare) or any(type(sign) not in COMPARISONS for sign in node.ops):
            raise ValueError(f"expected a condition with <, <=, > or >=, found {_text(node)}")
        sides = [node.left, *node.comparators]
        parts = [self.number(side) for side in sides]
        for pair in zip(sides, sides[1:]):
            self._compared(*pair)
        signs = [COMPARISONS[type(sign)] for sign in node.ops]
        return lambda x: _in_order(signs, [part(x) for part in parts])

    def _compared(self, a: ast.expr, b: ast.expr) -> None:
        """A kink where t passes a number."""
        for one, other in ((a, b), (b, a)):
            if isinstance(one, ast.Name) and one.id == "t" and "t" in self.variables:
                try:
                    self.kinks.add(float(finite(Translation((), self.constants).number(other), ())))
                except ValueError:  # compared with what varies
                    continue


def _applied(value: Callable[[float], float], slopes: Any, inner: Closure, x: Sequence[Any]) -> Any:
    u = inner(x)
    return chain(float(value(u.value)), slopes(u.value), u) if isinstance(u, Jet) else float(value(u))


def _in_order(signs: list[Callable[[float, float], bool]], values: list[Any]) -> bool:
    plain = [value.value if isinstance(value, Jet) else value for value in values]
    return all(sign(a, b) for sign, a, b in zip(signs, plain, plain[1:]))


def _text(node: ast.AST) -> str:
    return shown(ast.unparse(node)) if isinstance(node, ast.expr) else type(node).__name__


def _advice(node: ast.AST) -> str:
    if isinstance(node, ast.BitXor):
        return "; write a power as **"
    return "; a condition stands in 'a if t < 1 else b' only" if isinstance(node, (ast.Compare, ast.BoolOp)) else ""


def shown(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")
