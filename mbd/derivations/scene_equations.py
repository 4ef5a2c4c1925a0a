"""``mbd.equations(scene)``: the equations of a small scene as expressions with its own names.

    M dv/dt = f(q, v, t) - G(q)' lambda,   g(q, t) = 0,   G = dg/dq,   G(q) v = 0 in the nonholonomic rows

Built from what the items say of themselves and from the laws of this folder, not from the arrays of the system, with which it compares itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from mbd.errors import SceneError
from mbd.scene import Scene

from . import kernels
from .law import LoadLaw, Term, stacked
from .load_laws import INPUTS
from .masses import lengths
from .naming import Naming
from .numbers import difference, evaluated, number
from .record import Part, Record
from .shown import latex

LETTERS = {"stiffness": "k", "damping": "c", "length": "L", "angle": "phi0"}
"""Of the parameters of springs."""

MOST = 40
"""Coordinates: expressions of larger scenes help nobody, and take minutes."""


class Equations:
    """The equations of motion of a scene.

    q, v      symbols [n], named as in ``scene.coordinates()``; t the time
    M [n, n], f [n], g [m], G [m, n]   sympy matrices; f holds weight, loads, elastic and damping forces
    values    the numbers of the parameters in them
    labels    the joint and row behind each entry of g
    slips     the numbers of nonholonomic rows (knife edges, wheels): constraints of velocities, G v = 0, where g is 0 and G not its gradient
    """

    def __init__(self, scene: Scene):
        system = scene.build()
        if system.n > MOST:
            expected = f"expected at most {MOST} coordinates for equations as expressions, found {system.n}"
            raise SceneError([f"scene: {expected}; take fewer elements or bodies, or ask a part of it"])
        self._scene, self._system = scene, system
        self._names = Naming(scene)
        self.q, self.v, self.t = self._names.q, self._names.v, sp.Symbol("t", real=True)
        self.labels = [f"{item} {label}" for item, label in system.joints.labels]
        self.values: dict[sp.Symbol, Any] = {}
        self._functions: dict[sp.Expr, Any] = {}
        record = Record(scene)
        self.M, weight = self._mass(record)
        self.f = weight + self._applied(record) - self._elastic(record)
        self.slips: list[int] = system.joints.slips.tolist()
        self.g, self.G = self._closures(record)

    def __repr__(self) -> str:
        return f"<equations of motion of {len(self.q)} coordinates and {len(self.labels)} joint equations>"

    def _mass(self, record: Record) -> tuple[sp.Matrix, sp.Matrix]:
        n, d = len(self.q), self._scene.dimension
        mass, weight = sp.zeros(n, n), sp.zeros(n, 1)
        gravity = [self._parameter(f"g_{axis}", x) for axis, x in zip("xyz", self._scene.gravity)]
        for rows, block, pull, values in kernels.massive(record):
            self.values |= values
            for a, row in enumerate(rows):
                for axis in range(d):
                    weight[d * row + axis] += pull[a] * gravity[axis]
                    for b, other in enumerate(rows):
                        mass[d * row + axis, d * other + axis] += block[a, b]
        return mass, weight

    def _parameter(self, name: str, value: Any) -> sp.Expr:
        """A symbol for a number; nothing for 0."""
        if not float(value):
            return sp.Integer(0)
        symbol = sp.Symbol(name.replace(" ", "_"), real=True)
        self.values[symbol] = number(value)
        return symbol

    def _elastic(self, record: Record) -> sp.Matrix:
        total = sp.zeros(len(self.q), 1)
        for part in record.elastic:
            for term in kernels.elastic_terms(part._replace(numbers=self._named(part))):
                law = term.law
                local = dict(zip(law.w, term.of(self.q))) | dict(zip(law.rates, term.rate(self.v)))
                local |= dict(zip(law.parameters, map(number, term.numbers)))
                self._add(total, term, law.force.xreplace(local))
        return total

    def _named(self, part: Part) -> dict[str, Any]:
        """The numbers of a part with symbols for its parameters: arrays of one float for each item."""
        cable, named = "nodes" in part.numbers, {}
        for field, values in part.numbers.items():
            if not (isinstance(values, np.ndarray) and values.ndim == 1 and values.dtype == float):
                named[field] = values
            elif cable and field == "length":
                named[field] = lengths(part.item, values)
                self.values |= {symbol: number(x) for symbol, x in zip(named[field], values)}
            else:
                letter = "tau" if cable and field == "damping" else LETTERS.get(field, field)
                numbered = [letter] * len(values) if np.ptp(values) == 0.0 else [f"{letter}{k + 1}" for k in range(len(values))]
                named[field] = [self._parameter(f"{name}_{part.item}", x) for name, x in zip(numbered, values)]
        return named | {"stored": part.numbers}

    def _applied(self, record: Record) -> sp.Matrix:
        total = sp.zeros(len(self.q), 1)
        for item, point, force in record.constant:
            symbols = [self._parameter(f"F{axis}_{item}", x) for axis, x in zip("xyz", force)]
            columns, matrix, constant = stacked([point])
            self._add(total, Term(None, columns, matrix, constant, ()), sp.Matrix(symbols))
        for part in record.acting:
            for n, term in enumerate(kernels.load_terms(part, None)):
                inputs = dict(zip(term.law.inputs, self._inputs(part, n, term.law)))
                local = dict(zip(term.law.w, term.of(self.q))) | dict(zip(term.law.rates, term.rate(self.v)))
                self._add(total, term, term.law.force.xreplace(local | inputs))
        return total

    def _inputs(self, part: Part, n: int, law: LoadLaw) -> list[sp.Expr]:
        if law.inputs == [self.t]:
            return [self.t]
        names, signals = [f"{x.name.replace('_', '')}_{part.item}" for x in law.inputs], part.numbers["signals"]
        if part.kernel not in INPUTS and signals[n].function is None:
            return [self._parameter(name, x) for name, x in zip(names, np.ravel(signals[n].constant))]
        return [self._function(name, lambda t, k=k: kernels.inputs_at(part, n, t)[k]) for k, name in enumerate(names)]

    def _function(self, name: str, of_time: Any) -> sp.Expr:
        function = sp.Function(name.replace(" ", "_"), real=True)(self.t)
        self._functions[function] = of_time
        return function

    def _add(self, total: sp.Matrix, term: Term, local: sp.Matrix) -> None:
        for k, value in zip(term.columns, term.matrix.T * local):
            total[int(k) % len(self.q)] += value

    def _closures(self, record: Record) -> tuple[sp.Matrix, sp.Matrix]:
        """g and G; a nonholonomic row is linear in the rates, and G their coefficients."""
        g = kernels.equations(record, self._system, self.q, self.v)
        for rows, target in record.drives:
            for k in range(rows.start, rows.stop):
                name = "_".join(("c", *self.labels[k].split()))
                g[k] -= self._function(name, lambda t, target=target, i=k - rows.start: target.value(np.asarray(t))[..., i])
        gradient = sp.Matrix(len(g), len(self.q), lambda k, i: sp.diff(g[k], (self.v if k in self.slips else self.q)[i]))
        return sp.Matrix(len(g), 1, lambda k, _: sp.Integer(0) if k in self.slips else g[k]), gradient

    def check(self, seed: int = 1) -> float:
        """The worst relative difference of M, f, g and G to the assembled numbers at a random state, from 30 digits."""
        system, rng = self._system, np.random.default_rng(seed)
        q, v = kernels.random_state(self._scene, rng)
        t, values = kernels.TIME, dict(self.values)
        stand_ins = {function: sp.Dummy() for function in self._functions}
        values |= {stand_ins[function]: float(of_time(t)) for function, of_time in self._functions.items()}
        values |= dict(zip(self.q, q)) | dict(zip(self.v, v)) | {self.t: t}
        inputs, gradient = system.inputs(t), np.zeros((system.m, system.n))
        joints = system.joints.at(q)
        np.add.at(gradient, (system.joints.rows, system.joints.cols), joints.gradient)
        found = [system.mass(np.eye(system.n)), system.force(q, v, inputs)[:, None], (joints.value - inputs.targets.value)[:, None], gradient]
        pairs = zip((self.M, self.f, self.g, self.G), found)
        return max(difference(evaluated(x.xreplace(stand_ins), values).reshape(y.shape), y) for x, y in pairs if y.size)

    def latex(self) -> str:
        """M, f, g and G as LaTeX, a line each; long ones with definitions of what occurs in them more than once."""
        shown = (("M", self.M), ("f", self.f), ("g", self.g), ("G", self.G))
        return "\n".join(rf"{line} \\" for name, x in shown if x.rows for line in latex(name, x, symbol_names=self._names.written))


def equations(scene: Scene) -> Equations:
    """The equations of motion of a scene as sympy expressions; raises SceneError for one of more than 40 coordinates."""
    return Equations(scene)
