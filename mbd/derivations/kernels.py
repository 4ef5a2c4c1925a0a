"""The kernels of a scene beside their derivations: (quantity, expected, found) at a random state."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from mbd.affine import Array
from mbd.scatter import Scatter
from mbd.scene import Scene

from . import rows
from .law import Term, Totals
from .laws import TERMS
from .load_laws import INPUTS, LOADS
from .masses import MASSES
from .numbers import evaluated
from .record import Part, Record, Underived
from .step import Pairs

TIME = 0.37
"""At which functions of time are sampled [s]: any but a special one."""


def random_state(scene: Scene, rng: np.random.Generator) -> tuple[Array, Array]:
    """q, v [n] far from rest, no element folded."""
    system = scene.build()
    return system.q0 + 0.15 * rng.standard_normal(system.n), rng.standard_normal(system.n)


def elastic_terms(part: Part) -> list[Term]:
    if part.kernel not in TERMS:
        raise Underived("the elastic kernel", part.kernel, "mbd/derivations/laws.py")
    return [term for n in range(part.size) for term in TERMS[part.kernel](part.key, part.numbers, n)]


def load_terms(part: Part, t: float | None = TIME) -> list[Term]:
    """With the values of their inputs at a time t."""
    if part.kernel not in LOADS:
        raise Underived("the kernel of loads", part.kernel, "mbd/derivations/load_laws.py")
    terms = [LOADS[part.kernel](part.key, part.numbers, n) for n in range(part.size)]
    if t is None:
        return terms
    return [term._replace(numbers=tuple(inputs_at(part, n, t)[: len(term.law.inputs)])) for n, term in enumerate(terms)]


def inputs_at(part: Part, n: int, t: float) -> list[float]:
    """The inputs of the n-th item of a part."""
    if part.kernel in INPUTS:
        return INPUTS[part.kernel](part.numbers, n, np.asarray(t))
    return np.ravel(part.numbers["signals"][n].sample(np.asarray(t))).tolist()


def elastic(scene: Scene, kernel: Any, rng: np.random.Generator) -> Pairs:
    """An elastic kernel beside its energy: stresses of elasticity and damping, force, tangents, derivatives of rates."""
    system, expected = scene.build(), Totals(scene.build().n)
    (q, v), (dq, _) = random_state(scene, rng), random_state(scene, rng)
    for term in _elastic_terms(scene, kernel):
        expected.add(term, q, v)
    found = [_elastic(measure, q, v, dq, system.n) for measure in system.measures if type(measure) is kernel]
    total = {name: sum(part[name] for part in found) for name in found[0]}
    yield "energy", expected.energy, total["energy"]
    yield "force", expected.vectors["force"], total["force"]
    yield "stiffness", expected.matrices["stiffness"], total["stiffness"]
    yield "damping", expected.matrices["damping"], total["damping"]
    yield "swirl", expected.matrices["swirl"], total["swirl"]
    yield "swirl_times", expected.matrices["swirl"] @ dq, total["swirl_times"]


@cache
def _elastic_terms(scene: Scene, kernel: Any) -> list[Term]:
    return [term for part in Record(scene).elastic if part.kernel is kernel for term in elastic_terms(part)]


def _elastic(kernel: Any, q: Array, v: Array, dq: Array, n: int) -> dict[str, Any]:
    at, scatter = kernel.at(q), Scatter(kernel.dofs, n)
    stress = kernel.modulus * at.value + kernel.viscosity * at.push(v)

    def vector(local: Array) -> Array:
        return scatter(local.reshape(-1))

    def square(local: Array) -> Array:
        out = np.zeros((n, n))
        np.add.at(out, (kernel.dofs[:, :, None] % n, kernel.dofs[:, None, :] % n), local)
        return out

    columns = np.moveaxis(kernel.viscosity[..., None] * at.swirl(v), -1, 0)
    swirl = np.moveaxis(at.pull(columns), 0, -1)
    return {
        "energy": float(at.energy()),
        "force": vector(at.pull(stress)),
        "stiffness": square(at.stiffness(stress, kernel.modulus) + swirl),
        "damping": square(at.stiffness(np.zeros_like(stress), kernel.viscosity)),
        "swirl": square(swirl),
        "swirl_times": vector(at.pull(kernel.viscosity * at.swirl_times(v, dq))),
    }


def acting(scene: Scene, kernel: Any, rng: np.random.Generator) -> Pairs:
    """A kernel of loads beside its virtual work."""
    record, system = Record(scene), scene.build()
    q, v = random_state(scene, rng)
    expected = Totals(system.n)
    for part in record.acting:
        for term in load_terms(part) if part.kernel is kernel else ():
            expected.add(term, q, v)
    rated = getattr(kernel, "depends_on_rate", False)
    force, gradient, rate_gradient = np.zeros(system.n), np.zeros((system.n, system.n)), np.zeros((system.n, system.n))
    for load in system.loads:
        if type(load) is kernel:
            inputs = load.inputs(np.asarray(TIME))
            state = (q, v, inputs) if rated else (q, inputs)
            at = load.dofs[:, :, None] % system.n, load.dofs[:, None, :] % system.n
            np.add.at(force, load.dofs % system.n, load.force(*state))
            if not load.constant_in_q:
                np.add.at(gradient, at, load.gradient(*state))
            if rated:
                np.add.at(rate_gradient, at, load.rate_gradient(*state))
    yield "force", expected.vectors["force"], force
    yield "gradient", expected.matrices["gradient"], gradient
    yield "rate gradient", expected.matrices["rate gradient"], rate_gradient


def closures(scene: Scene, rng: np.random.Generator) -> Pairs:
    """Every kernel of equations of a scene beside the expressions of its joints."""
    q, v = random_state(scene, rng)
    for kernel, exact in zip(scene.build().joints.kernels, _differentiated(scene)):
        for what, expected, found in rows.evaluate(exact, kernel, q, v, rng):
            yield f"{type(kernel).__name__}.{what}", expected, found


@cache
def _differentiated(scene: Scene) -> list[rows.Differentiated]:
    """The expressions of each kernel of equations."""
    system = scene.build()
    q, v = symbols("q", system.n), symbols("v", system.n)
    g = equations(Record(scene), system, q, v)
    slips = set(system.joints.slips.tolist())
    closures = [rows.nonholonomic(g[k], v) if k in slips else rows.holonomic(g[k], q) for k in range(system.m)]
    return [rows.Differentiated(closures[span], q) for span in system.joints.spans]


def equations(record: Record, system: Any, q: rows.Coordinates, v: rows.Coordinates) -> list[sp.Expr]:
    """gamma(q) [m], of nonholonomic rows A(q) v; refuses systems with equations of a kind that has no derivation."""
    found = rows.equations(record, q) + rows.slips(record, q, v)
    if len(found) != system.m:
        raise Underived("the kernel of equations", type(system.joints.kernels[-1]), "mbd/derivations/rows.py")
    return found


def symbols(letter: str, n: int) -> list[sp.Symbol]:
    return [sp.Symbol(f"{letter}_{k}") for k in range(n)]


def masses(scene: Scene) -> Pairs:
    """The mass matrix and the weight of a scene beside those of its items."""
    system, d = scene.build(), scene.dimension
    mass, weight = np.zeros((system.n, system.n)), np.zeros(system.n)
    for rows_, block, pull, values in massive(Record(scene)):
        at = d * rows_[:, None] + np.arange(d)
        whole, load = evaluated(sp.Matrix(block), values), evaluated(sp.Matrix(pull), values)
        for axis in range(d):
            np.add.at(mass, (at[:, axis][:, None], at[:, axis][None, :]), whole)
        np.add.at(weight, at, load * np.asarray(scene.gravity))
    found = np.zeros_like(mass)
    np.add.at(found, (system.mass_rows, system.mass_cols), system.mass_values)
    yield "mass matrix", mass, found
    yield "mass times the unit vectors", mass, system.mass(np.eye(system.n)).T
    yield "weight", weight, system.weight


def massive(record: Record) -> Iterator[Any]:
    """The masses of all items."""
    for item in dict.fromkeys(record.massive):
        kind = type(item.description)
        if kind not in MASSES:
            raise Underived("the mass of", kind, "mbd/derivations/masses.py")
        yield from MASSES[kind](item)
