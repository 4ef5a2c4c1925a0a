"""What to change where joints hold the same thing twice: the fewest joints, loosened just enough, proved by rank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .dependence import ZERO, independent_rows, rank_of
from .reaction import reaction

if TYPE_CHECKING:
    from .scene import Scene

NAMES = {
    2: {(2, 0): "pin", (1, 1): "slider", (1, 0): "point on line"},
    3: {
        (3, 2): "pin",
        (3, 1): "universal joint",
        (3, 0): "ball joint",
        (2, 3): "slider",
        (2, 2): "cylindrical joint",
        (2, 0): "point on line",
        (1, 2): "planar joint",
    },
}
"""What joints are called, by the number of translations and of rotations that they hold."""


@dataclass(frozen=True)
class Edit:
    """The equations of one joint to release, and what it then is: the name of a joint, "" where nothing is left of it, None for others."""

    joint: str
    release: tuple[str, ...]
    becomes: str | None

    def __str__(self) -> str:
        released = ", ".join(self.release)
        if self.becomes == "":
            return f"leave out {self.joint!r}"
        if self.becomes:
            return f"replace {self.joint!r} by a {self.becomes} (which releases its {released})"
        return f"release {released} of {self.joint!r}"


def propose(
    scene: Scene, q: Array, gradient: Array, labels: list[tuple[str, str]], vectors: Array, joints: list[str], drives: tuple[str, ...]
) -> tuple[Edit, ...]:
    """Edits that leave the same motions and no dependence among these joints; none where no choice of equations proves to do so.

    q [n] of the whole scene; gradient [m, n_part] scaled; vectors [m, k]: the dependences.
    """
    rows = {joint: [row for row, (name, _) in enumerate(labels) if name == joint] for joint in joints}
    alone = [joint for joint in reversed(joints) if len(_loose(vectors, rows[joint])) == vectors.shape[1]]
    order = alone[:1] or sorted(joints, key=lambda joint: (-len(_loose(vectors, rows[joint])), -joints.index(joint)))
    chosen = independent_rows(vectors, [row for joint in order for row in reversed(rows[joint])])
    kept = np.delete(np.arange(len(gradient)), chosen)
    if len(chosen) != vectors.shape[1] or rank_of(gradient[kept]) != rank_of(gradient):
        return ()
    edits = []
    for joint in joints:
        gone = [row for row in rows[joint] if row in chosen]
        if gone:
            becomes = None if joint in drives else _becomes(scene, joint, q, [row not in gone for row in rows[joint]])
            edits.append(Edit(joint, tuple(labels[row][1] for row in gone), becomes))
    return tuple(edits)


def _loose(vectors: Array, rows: list[int]) -> list[int]:
    return independent_rows(vectors[rows], range(len(rows)))


def _becomes(scene: Scene, name: str, q: Array, kept: list[bool]) -> str | None:
    """By the forces and moments that the equations kept can exert."""
    if not any(kept):
        return ""
    joint: Any = scene[name]
    if not hasattr(joint, "pose") or getattr(joint, "scalars", None):
        return None
    d = scene.dimension
    wrenches = np.array([reaction(joint, joint.pose(scene.build().q0), q, unit) for unit in np.eye(len(kept))[kept]])
    wrenches /= np.maximum(np.linalg.norm(wrenches, axis=1), 1e-300)[:, None]
    total, forces = (int(np.sum(np.linalg.svd(part, compute_uv=False) > ZERO)) for part in (wrenches, wrenches[:, :d]))
    return NAMES[d].get((forces, total - forces))
