"""Everything that is derived, by the words of ``python -m mbd derive``: the kinds of items, and what their kernels are made of.

A kind has the steps written for it, if any, then what follows by itself: the laws of its kernels, its masses, and the equations that its own
rows make in specimens of it. So a new joint is covered as soon as it is exported, and a new kernel is asked for its derivation.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from typing import Any

import numpy as np
import sympy as sp

from mbd.affine import Array
from mbd.elements.local_frame import LocalFrame
from mbd.elements.planar_continuum import PlanarContinuum
from mbd.elements.spatial_continuum import SpatialContinuum
from mbd.scene import Scene

from . import body, cable, chord, continuum, kernels, primitives
from .naming import Naming
from .record import Part, Record
from .specimens import Specimen, kinds, specimens
from .step import PAPER, Pairs, Step

WRITTEN: dict[str, Callable[[], list[Step]]] = {"ancf_cable": cable.steps, "rigid_body": body.steps}
"""Steps from a source, by the word of the kind that they belong to."""

PARTS: dict[str, tuple[str, Callable[[], list[Step]], tuple[type, ...]]] = {
    "local_frame": ("ancf_cable", chord.steps, (LocalFrame,)),
    "continuum": ("ancf_cable", continuum.steps, (PlanarContinuum, SpatialContinuum)),
    "rows": ("", primitives.steps, ()),
}
"""Subjects that are no kinds: the kind whose specimens hold their kernels, their steps, the kernels."""

SOURCES: dict[str, str] = {
    "LocalFrame": f"{PAPER}, eqs. 18, 25",
    "PlanarContinuum": continuum.SOURCE,
    "SpatialContinuum": continuum.SOURCE,
    "Corotational": "Belytschko and Hsieh (1973)",
    "GeometricallyExact": "Simo and Vu-Quoc (1986)",
    "Deflection": "Pechstein, Reischl and Gerstmayr (2013)",
}
"""Of the laws of kernels; those without a line follow from the formula in the step itself."""


def word(name: str) -> str:
    """rigid_body for RigidBody."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def words() -> list[str]:
    return [*PARTS, *sorted(map(word, kinds()))]


@cache
def steps(subject: str) -> list[Step]:
    """All steps of a subject; raises KeyError for a word that is none."""
    if subject in PARTS:
        home, written, own = PARTS[subject]
        return written() + (list(_laws(_cases(home), own)) if own else [])
    return WRITTEN.get(subject, list)() + list(_own(subject))


def _cases(subject: str) -> list[Specimen]:
    return specimens(next(kind for name, kind in kinds().items() if word(name) == subject))


def _own(subject: str) -> Iterator[Step]:
    """What follows from the specimens of a kind."""
    cases = _cases(subject)
    kind = next(kind for name, kind in kinds().items() if word(name) == subject)
    own = [part for case in cases for part in _parts(case.scene, kind)]
    elsewhere = {kernel for *_, own in PARTS.values() for kernel in own}
    yield from _laws(cases, [kernel for kernel in dict.fromkeys(part.kernel for part in own) if kernel not in elsewhere])
    yield from _masses(cases, kind)
    for case in cases:
        yield from _equations(case, kind)


def _parts(scene: Scene, kind: type) -> list[Part]:
    own = {item.name for item in scene.items if type(item.description) is kind}
    return [part for part in _all_parts(scene) if part.item in own]


def _laws(cases: Sequence[Specimen], wanted: Sequence[Any]) -> Iterator[Step]:
    """Strains of elastic kernels and their gradient, forces of loads: with these go energy, force, tangents and rates."""
    for kernel in wanted:
        found = [(case.scene, part) for case in cases for part in _all_parts(case.scene) if part.kernel is kernel]
        scenes = list(dict.fromkeys(scene for scene, _ in found))
        name, source, part = f"{kernel.__module__}.{kernel.__name__}", SOURCES.get(kernel.__name__, "here"), found[0][1]
        if hasattr(kernel, "force"):
            law = kernels.load_terms(part, None)[0].law
            title = f"Force on ({_listed(law.w)}), from its virtual work"
            yield Step(title, "Q", law.force, source, name, partial(_in_all, kernels.acting, scenes, kernel))
            continue
        law = kernels.elastic_terms(part)[0].law
        title = f"Strains in terms of ({_listed(law.w)})"
        yield Step(title, r"\varepsilon", law.strains, source, name, partial(_in_all, kernels.elastic, scenes, kernel))
        title = f"Their gradient B; force B' (C eps + H B v), moduli C in {_listed(sorted(law.moduli.free_symbols, key=str))}"
        yield Step(title, "B", law.gradient, source, name, partial(_in_all, kernels.elastic, scenes[:1], kernel))


def _all_parts(scene: Scene) -> list[Part]:
    record = Record(scene)
    return record.elastic + record.acting


def _listed(names: Sequence[sp.Symbol]) -> str:
    return ", ".join(x.name for x in names)


def _in_all(compare: Any, scenes: Sequence[Scene], kernel: type, rng: np.random.Generator) -> Pairs:
    for scene in scenes:
        yield from compare(scene, kernel, rng)


def _masses(cases: Sequence[Specimen], kind: type) -> Iterator[Step]:
    for case in cases:
        record = Record(case.scene)
        own = [item for item in dict.fromkeys(record.massive) if type(item.description) is kind]
        if own:
            blocks = [mass.block for mass in kernels.massive(record)]
            title = f"{case.what}: masses on the rows of {own[0].name!r}"
            yield Step(title, "M", blocks[0], "here", "mbd.system.System.mass", partial(_massive, case.scene))


def _massive(scene: Scene, rng: np.random.Generator) -> Pairs:
    return kernels.masses(scene)


def _equations(case: Specimen, kind: type) -> Iterator[Step]:
    """The rows of a joint with the names of its specimen."""
    system, record = case.scene.build(), Record(case.scene)
    own = {item.name for item in case.scene.items if type(item.description) is kind}
    rows = [k for k, (item, _) in enumerate(system.joints.labels) if item in own]
    if not rows or kind.__module__.startswith("mbd.elements.rigid"):
        return
    naming = Naming(case.scene)
    g = kernels.equations(record, system, naming.q, naming.v)
    title = f"{case.what}: {', '.join(system.joints.labels[k][1] for k in rows)}"
    slips = bool(rows) and rows[0] in system.joints.slips  # then A(q) v is shown, which is the rate of nothing
    what = "slips" if slips else "rows" if hasattr(kind, "rows") else "place"
    name = f"{kind.__module__}.{kind.__name__}.{what}"
    right = sp.Matrix([g[k] for k in rows])
    yield Step(title, "A v" if slips else "g", right, "here, from its own rows", name, partial(kernels.closures, case.scene), naming.written)
    sides = [side for item in case.scene.items if item.name in own for side in getattr(item.description, "sides", ())]
    if "body-body" in case.what and not record.drives and not any(side.fixed for side in sides):
        title = f"{case.what}: still closed when both sides move together"
        yield Step(title, "g", sp.zeros(len(rows), 1), "here", name, partial(_carried, case.scene))


def _carried(scene: Scene, rng: np.random.Generator) -> Pairs:
    """An assembled scene of bodies, turned and shifted as a whole: lengths of the scene are compared, so that 0 is not divided by."""
    from mbd.assembly import assemble

    system, q = scene.build(), assemble(scene).state.q
    turn, _ = np.linalg.qr(rng.standard_normal((scene.dimension, scene.dimension)))
    turn[:, 0] *= np.linalg.det(turn)
    gap = system.joints.at(_moved(scene, q, turn, rng.standard_normal(scene.dimension))).value
    yield "closure", np.full(gap.shape, system.length), system.length + gap


def _moved(scene: Scene, q: Array, turn: Array, shift: Array) -> Array:
    """Positions move, axes only turn, scalar coordinates stay."""
    d, count = scene.dimension, scene.layout.n_rows
    out, table = q.copy(), q[: d * count].reshape(count, d) @ turn.T
    table[[label == "mass centre" for label in scene.layout.row_labels()]] += shift
    out[: d * count] = table.ravel()
    return out
