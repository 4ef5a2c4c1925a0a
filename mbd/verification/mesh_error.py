"""The error of a mesh from two others, by Richardson: where differences fall with the observed order p,

    |y(n) - exact| = |y(n) - y(2 n)| 2^p / (2^p - 1),        p = log2 |y(n/2) - y(n)| / |y(n) - y(2 n)|, not above that of cubic elements, 4.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..affine import Array
from ..result import Result
from ..run import simulate
from .estimates import order_of
from .meshes import carried_outputs, doublings, remeshed
from .outputs import Output, outputs_of

if TYPE_CHECKING:
    from ..scene import Scene

Build = Callable[[float], "tuple[Scene, Mapping[str, Any]]"]

CUBIC, LEAST = 4.0, 1.0
"""The order of cubic elements, and the least that counts as convergence."""


class MeshEstimate(NamedTuple):
    """Of one output: raw errors [k] of the scene's own mesh at the times of comparison, and the observed order (NaN where the differences
    between meshes drown in the errors of the time steps)."""

    errors: Array
    order: float

    @property
    def converges(self) -> bool:
        return np.isnan(self.order) or self.order >= LEAST


class Mesh(NamedTuple):
    """A run on a mesh with 2^level times as many elements as the scene's own, and the outputs there, by name."""

    level: int
    outputs: dict[str, Output]
    run: Result


def other_meshes(scene: Scene, outputs: Mapping[str, Any], build: Build | None, t_end: float, rtol: float, solver: Any) -> list[Mesh]:
    """Runs on two other meshes with the same solver and tolerance."""
    found = []
    for level in doublings(scene) if build is None else (-1, 1):
        other, wanted = _made(scene, outputs, build, level)
        watched = {output.name: output for output in outputs_of(other, wanted)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the scene's own runs have warned of the same
            found.append(Mesh(level, watched, simulate(other, t_end, rtol=rtol, solver=solver)))
    return found


def _made(scene: Scene, outputs: Mapping[str, Any], build: Build | None, level: int) -> tuple[Scene, Mapping[str, Any]]:
    if build is not None:
        other, wanted = build(2.0**level)
        if set(wanted) != set(outputs):
            raise ValueError(f"meshes: expected a function that returns a scene and outputs named {sorted(outputs)}, found {sorted(wanted)}")
        return other, wanted
    other = remeshed(scene, level)
    return other, carried_outputs(outputs, other)


def mesh_estimate(by_level: dict[int, Array], noise: Array) -> MeshEstimate:
    """From the values [k, m] on the scene's own mesh, which is level 0, and on two others; ``noise`` [k]: errors of the time steps."""
    coarse, middle, fine = (by_level[level] for level in sorted(by_level))
    first, second = (np.linalg.norm(a - b, axis=1) for a, b in ((coarse, middle), (middle, fine)))
    to_finer = second if min(by_level) < 0 else first
    if np.max(second) <= 3.0 * np.max(noise):
        return MeshEstimate(to_finer + noise, np.nan)
    order = order_of(first, second, (2.0, 2.0))
    share = 2.0 ** min(max(order, LEAST), CUBIC)
    return MeshEstimate(to_finer * share / (share - 1.0), order)
