"""What the items of a scene put together, remembered by item: the same calls that make the system's arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbd.affine import Affine, Array
from mbd.model import Model
from mbd.scene import Scene


class Part(NamedTuple):
    """One call of ``Model.strain`` or ``Model.load``."""

    item: str
    kernel: type
    key: tuple
    numbers: dict[str, Any]

    @property
    def size(self) -> int:
        """How many items of the kernel."""
        return len(next(iter(self.numbers.values())))


class Record(Model):
    """A model that remembers which item said what."""

    def __init__(self, scene: Scene):
        super().__init__(scene.layout, np.asarray(scene.gravity), 1.0)
        self.item: Any = None
        self.massive: list[Any] = []
        self.elastic: list[Part] = []
        self.acting: list[Part] = []
        self.constant: list[tuple[str, Affine, Array]] = []
        for item in scene.items:
            self.item = item
            item.assemble(self)

    def mass(self, rows: NDArray[np.intp], blocks: Array) -> None:
        self.massive.append(self.item)
        super().mass(rows, blocks)

    def dead(self, point: Affine, force: Array) -> None:
        self.constant.append((self.item.name, point, force))
        super().dead(point, force)

    def strain(self, kernel: type, key: tuple, labels: list[str], **numbers: Any) -> None:
        self.elastic.append(Part(self.item.name, kernel, key, numbers))
        super().strain(kernel, key, labels, **numbers)

    def load(self, kernel: type, key: tuple, **numbers: Any) -> None:
        self.acting.append(Part(self.item.name, kernel, key, numbers))
        super().load(kernel, key, **numbers)


class Underived(LookupError):
    """A kind of which there is no derivation."""

    def __init__(self, what: str, kind: type, table: str):
        super().__init__(f"{what} {kind.__module__}.{kind.__qualname__} has no derivation: add one to {table}")
