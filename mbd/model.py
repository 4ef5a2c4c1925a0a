"""What the items of a scene put together: masses, weights, strains, equations and loads, gathered by kind for the system."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .affine import Affine, Array
from .layout import Layout
from .relation import Relation
from .rows import Row, shifted
from .slip import SlipRow
from .target import Target
from .track import Track
from .turn import Turning


class Named(Protocol):
    name: str
    description: Any


class Model:
    """Filled by ``assemble(model)`` of every item, read by ``System``."""

    def __init__(self, layout: Layout, gravity: Array, length: float):
        self.dimension, self.n_rows, self.n = layout.dimension, layout.n_rows, layout.n
        self.q0, self.v0 = layout.start()
        self.levers, self.lengths, self.arm, self.owners = layout.levers(length), layout.lengths(), layout.smallest_arm(), layout.owners()
        self.gravity, self.length = gravity, length
        self.masses: list[tuple[NDArray[np.intp], Array]] = []
        self.weights = np.zeros((layout.n_rows, layout.dimension))
        self.dead_forces = np.zeros(self.n)
        self.equations: list[tuple[str, str, Row]] = []
        self.drives: list[tuple[slice, Target]] = []
        self.internal: set[str] = set()
        self.turns: list[tuple[str, Turning]] = []
        self.relations: list[tuple[str, Relation]] = []
        self.slips: list[tuple[str, str, SlipRow]] = []
        self.tracks: list[tuple[str, Track]] = []
        self.strains: dict[tuple[type, tuple], list[dict[str, Any]]] = {}
        self.loads: dict[tuple[type, tuple], list[dict[str, Any]]] = {}
        self.complaints: list[str] = []

    def mass(self, rows: NDArray[np.intp], blocks: Array) -> None:
        """Mass blocks [n, k, k] on rows [n, k] of the table."""
        self.masses.append((rows, blocks))

    def weight(self, rows: NDArray[np.intp], masses: Array) -> None:
        """Gravity on rows [n, k]: masses [n, k] times the scene's gravity."""
        np.add.at(self.weights, rows, masses[..., None] * self.gravity)

    def dead(self, point: Affine, force: Array) -> None:
        """A constant force [d] at a point."""
        np.add.at(self.dead_forces, point.columns(), point.matrix().T @ force)

    def equation(self, item: str, label: str, row: Row, *, internal: bool = False) -> None:
        """A constraint g(q) = 0 of a joint, or an internal one of a body."""
        self.equations.append((item, label, row))
        if internal:
            self.internal.add(item)

    def drive(self, item: str, rows: list[tuple[str, Row]], target: Target | Array) -> None:
        """Constraints gamma(q) = c(t): c is a target, or numbers [rows]."""
        first = len(self.equations)
        if isinstance(target, np.ndarray):
            rows = [(label, shifted(row, -float(c))) for (label, row), c in zip(rows, np.atleast_1d(target))]
        else:
            self.drives.append((slice(first, first + len(rows)), target))
        for label, row in rows:
            self.equation(item, label, row)

    def turn(self, item: str, a: Affine, b: Affine, phi: int) -> None:
        """phi follows the angle from axis b to axis a since the start, in the plane."""
        relative = complex(*a.value(self.q0)) / complex(*b.value(self.q0))
        ahead = b.scaled(relative / abs(relative))
        self.turning(item, Turning(a, ahead, ahead.scaled(1j), phi))

    def turning(self, item: str, turning: Turning) -> None:
        """An angle as a coordinate, between axes that its item chose."""
        self.turns.append((item, turning))

    def relation(self, item: str, relation: Relation) -> None:
        """A coordinate that is a function of others."""
        self.relations.append((item, relation))

    def slip(self, item: str, label: str, row: SlipRow) -> None:
        """A constraint on velocities alone."""
        self.slips.append((item, label, row))

    def track(self, item: str, track: Track) -> None:
        """A point that slides along a cable: d equations."""
        self.tracks.append((item, track))

    def strain(self, kernel: type, key: tuple, labels: list[str], **numbers: Any) -> None:
        """An elastic measure: items of one kernel and key share one object."""
        self.strains.setdefault((kernel, key), []).append(numbers)

    def load(self, kernel: type, key: tuple, **numbers: Any) -> None:
        self.loads.setdefault((kernel, key), []).append(numbers)

    def complain(self, item: Named, text: str) -> None:
        self.complaints.append(f"{item.description.kind} {item.name!r}: {text}")


def build(kinds: dict[tuple[type, tuple], list[dict[str, Any]]]) -> list[Any]:
    """One kernel for each kind: arrays of its items concatenated, lists joined."""
    kernels = []
    for (kernel, key), parts in kinds.items():
        merged = {}
        for field in parts[0]:
            values = [part[field] for part in parts]
            merged[field] = np.concatenate(values) if isinstance(values[0], np.ndarray) else [x for value in values for x in value]
        kernels.append(kernel(*key, **merged))
    return kernels
