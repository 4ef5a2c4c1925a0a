"""All equations of a scene at once: the quadratic rows of the joints, some of which follow targets, the turning angles, the points on cables,
and coordinates that are functions of others."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .affine import Array
from .constraint import Quadratic
from .model import Model
from .relation import Relations
from .slip import Slip
from .sums import sums
from .target import Targets
from .track import OnTrack
from .turn import Turn


class Joints:
    """All equations of a scene, gamma(q) = c(t): the quadratic rows, then the turning angles, points that slide along cables, relations, and
    rows that hold for velocities only (their numbers: ``slips``), whose gamma is zero.

    ``linear``: G is constant and nothing is driven, so that g = 0 at all times implies G v = 0. ``quadratic``: no row is of another kind.
    """

    def __init__(self, model: Model):
        self.kernels: list[Any] = []  # Quadratic, Turn, OnTrack, Relations: each prepares what its own methods take
        self.labels = [(item, label) for item, label, _ in model.equations] + [(item, "turn") for item, _ in model.turns]
        self.labels += [(item, f"position {axis}") for item, _ in model.tracks for axis in "xyz"[: model.dimension]]
        self.labels += [(item, "relation") for item, _ in model.relations]
        self.labels += [(item, label) for item, label, _ in model.slips]
        if model.equations:
            self.kernels.append(Quadratic([row for *_, row in model.equations], model.n))
        if model.turns:
            self.kernels.append(Turn([turn for _, turn in model.turns], model.n))
        self.kernels += [OnTrack(track, item, model.n) for item, track in model.tracks]
        self.kernels += [Relations(relation, model.n) for _, relation in model.relations]
        if model.slips:
            self.kernels.append(Slip([row for *_, row in model.slips], model.n))
        first = np.concatenate(([0], np.cumsum([kernel.m for kernel in self.kernels], dtype=int)))
        self.m, self.n = int(first[-1]), model.n
        self.slips = np.arange(self.m - len(model.slips), self.m)
        self.spans = [slice(int(a), int(b)) for a, b in zip(first[:-1], first[1:])]
        empty = [np.zeros(0, np.intp)]
        ends = np.cumsum([kernel.rows.size for kernel in self.kernels], dtype=int).tolist()
        self.parts = [slice(a, b) for a, b in zip([0, *ends], ends)]  # of the pattern of G
        self.rows = np.concatenate([kernel.rows + a for kernel, a in zip(self.kernels, first)] or empty)
        self.cols = np.concatenate([kernel.cols for kernel in self.kernels] or empty)
        self.curvature_rows = np.concatenate([kernel.curvature_rows for kernel in self.kernels] or empty)
        self.curvature_cols = np.concatenate([kernel.curvature_cols for kernel in self.kernels] or empty)
        self.drives = model.drives  # quadratic rows come first: their numbers are those of the model's equations
        self.linear = all(kernel.linear for kernel in self.kernels) and not self.drives
        self.quadratic = all(isinstance(kernel, Quadratic) for kernel in self.kernels)
        self.to_rows, self.to_cols = sums(self.rows, self.m), sums(self.cols, model.n)

    def at(self, q: Array) -> JointsAt:
        return JointsAt(self, q)

    @property
    def constant_rows(self) -> NDArray[np.bool_]:
        """[m]: the rows whose gradient is constant and that nothing drives."""
        parts = [kernel.constant_rows if isinstance(kernel, Quadratic) else np.zeros(kernel.m, bool) for kernel in self.kernels]
        found = np.concatenate(parts or [np.zeros(0, bool)])
        for rows, _ in self.drives:
            found[rows] = False
        return found

    def targets(self, times: Array) -> Targets:
        """c, c' and c'' at times [...]."""
        return Targets(self.drives, self.m, times)


class JointsAt:
    """All equations at configurations [...]."""

    def __init__(self, joints: Joints, q: Array):
        self.joints, self.batch = joints, q.shape[:-1]
        self.states = [(kernel, kernel.prepare(q)) for kernel in joints.kernels]

    @cached_property
    def gradient(self) -> Array:
        """Values of G [..., nnz] on the pattern (rows, cols); [nnz] where they are constant."""
        values = [kernel.gradient(z) for kernel, z in self.states]
        if len(values) == 1:
            return values[0]
        out = np.empty((*self.batch, self.joints.rows.size))
        for part, own in zip(self.joints.parts, values):  # some are the same for all configurations
            out[..., part] = own
        return out

    def _joined(self, values: list[Array]) -> Array:
        if len(values) == 1:
            return values[0]
        return np.concatenate(values, axis=-1) if values else np.zeros((*self.batch, 0))

    @property
    def value(self) -> Array:
        """gamma [..., m]: g without what drives ask for."""
        return self._joined([kernel.value(z) for kernel, z in self.states])

    def pull(self, multipliers: Array) -> Array:
        """G' lambda [..., n]."""
        return self.joints.to_cols(self.gradient * multipliers.take(self.joints.rows, axis=-1))

    def push(self, v: Array) -> Array:
        """G v [..., m]."""
        return self.joints.to_rows(self.gradient * v.take(self.joints.cols, axis=-1))

    def swirl(self, v: Array) -> Array:
        """Values of d(G v)/dq on the pattern of G."""
        return self._joined([kernel.swirl(z, v) for kernel, z in self.states])

    def bias(self, v: Array) -> Array:
        """v' d2(gamma)/dq2 v [..., m]: c'' minus this is what G a must be."""
        return self._joined([kernel.bias(z, v) for kernel, z in self.states])

    def curvature(self, multipliers: Array) -> Array:
        """Values of d(G' lambda)/dq on (curvature_rows, curvature_cols)."""
        return self._joined([kernel.curvature(z, multipliers[..., span]) for (kernel, z), span in zip(self.states, self.joints.spans)])
