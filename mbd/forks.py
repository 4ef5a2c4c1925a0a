"""Where the parts of a run go on from, in files: numbers in the head, arrays of all parts in one row."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .affine import Array
from .parts import Part
from .progress import Mark, Stage
from .watch import Seen
from .work import Nodes, Pending

VECTORS = ("q", "v", "multipliers", "stress")


def written(stage: Stage) -> tuple[dict[str, Any] | None, list[Array]]:
    """The fork of a part: for the head, with the shapes of its arrays, and these; None where it never began."""
    mark = stage.fork
    if mark is None:
        return None, []
    waiting = [[array for array in nodes if array is not None] for nodes in mark.pending.waiting]
    arrays = [getattr(mark.state, name) for name in VECTORS] + list(mark.state.memory.values()) + [array for nodes in waiting for array in nodes]
    head = {
        "steps": mark.steps,
        "t": mark.state.t,
        "method": int(mark.state.method),
        "rhythm": mark.rhythm,
        "counts": mark.counts,
        "factorizations": mark.factorizations,
        "memory": {name: np.shape(leaf) for name, leaf in mark.state.memory.items()},
        "done": mark.pending.done,
        "waiting": [[array.shape for array in nodes] for nodes in waiting],
        "seen": mark.seen,
    }
    return head, [np.asarray(array, dtype=float) for array in arrays]


class Row:
    """A row of numbers that is read array by array."""

    def __init__(self, numbers: Array):
        self._numbers, self._at = numbers, 0

    def take(self, shape: Sequence[int]) -> Array:
        """The next ones. Raises ValueError where there are not so many."""
        if not all(isinstance(size, int) and size >= 0 for size in shape) or (size := math.prod(shape)) > self._numbers.size - self._at:
            raise ValueError(f"fork: expected arrays within {self._numbers.size} numbers, found one of shape {tuple(shape)} at {self._at}")
        self._at += size
        return self._numbers[self._at - size : self._at].reshape(shape)

    def end(self) -> None:
        if self._at != self._numbers.size:
            raise ValueError(f"fork: expected {self._at} numbers, found {self._numbers.size}")


def read(head: dict[str, Any] | None, row: Row, part: Part) -> Mark | None:
    """The fork of a part. Raises ValueError, and what damaged numbers raise."""
    from .solvers.march import Counts
    from .solvers.pace import Rhythm
    from .solvers.protocol import State

    if head is None:
        return None
    system = part.system
    widths = dict(zip(VECTORS, (system.n, system.n, system.m, system.n_stresses)))
    vectors = [row.take((widths[name],)) for name in VECTORS]
    if not all(np.isfinite(vector).all() for vector in vectors):
        raise ValueError("fork: expected finite numbers, found NaN or infinity among them")
    memory = {str(name): row.take(shape) for name, shape in head["memory"].items()}
    start, h, ceiling, last = head["rhythm"]
    rhythm = Rhythm(float(start), float(h), float(ceiling), None if last is None else (float(last[0]), float(last[1])))
    *steps, error = head["counts"]
    counts = [_count(value) for value in (*steps, head["factorizations"], head["done"], head["steps"], head["method"])]
    pending = Pending(counts[5], tuple(_nodes([row.take(shape) for shape in shapes], system) for shapes in head["waiting"]))
    if not (rhythm.h > 0.0 and np.isfinite(rhythm.start + rhythm.h + float(error)) and counts[5] + len(pending.waiting) == counts[6] == counts[0]):
        raise ValueError("fork: expected a positive step and counts that agree, found others")
    seen = None
    if head["seen"] is not None:
        numbers, last_values = head["seen"]
        seen = Seen({name: _count(value) for name, value in numbers.items()}, {name: float(value) for name, value in last_values.items()})
    q, v, multipliers, stress = vectors
    state = State(float(head["t"]), q, v, multipliers, stress, memory, counts[7])
    return Mark(counts[6], state, rhythm, Counts(counts[0], counts[1], counts[2], counts[3], float(error)), counts[4], pending, seen)


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**53:
        raise ValueError(f"fork: expected a count, found {value!r}")
    return value


def _nodes(arrays: list[Array], system: Any) -> Nodes:
    """Raises ValueError unless they are a step's quadrature."""
    nodes = Nodes(*arrays, *[None] * (5 - len(arrays)))
    k = nodes.t.size
    shapes = [(k,), (k, system.n), (k, system.n), (k,), (k, system.m)]
    if any(array.shape != shape or not np.isfinite(array).all() for array, shape in zip(arrays, shapes)):
        raise ValueError(f"fork: expected finite numbers of shapes {shapes}, found {[array.shape for array in arrays]}")
    return nodes
