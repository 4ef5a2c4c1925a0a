"""All elastic measures of a scene at once: kernels side by side, their stresses in one array."""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from .affine import Array
from .slopes import Frozen, Slopes

if TYPE_CHECKING:
    from .system import System


SMALL = 2**13
"""Entries of B up to which one product with all of it takes less time than those of each element."""


class Strains:
    """All elastic measures at configurations [...]. Those of each kernel have ``value``, ``gradient`` B [..., n, m, k], its products ``push`` and
    ``pull``, ``stiffness``, ``swirl`` and ``swirl_times``, and ``energy``."""

    def __init__(self, system: System, q: Array):
        self.system = system
        self.parts = [kernel.at(q) for kernel in system.measures]
        self.batch = q.shape[:-1]

    def _join(self, parts: list[Array], batch: tuple[int, ...]) -> Array:
        if len(parts) == 1:
            return parts[0].reshape(*batch, -1)
        return np.concatenate([part.reshape(*batch, -1) for part in parts], axis=-1)

    def _split(self, stress: Array) -> list[Array]:
        batch = stress.shape[:-1]
        return [stress[..., span].reshape(*batch, *shape) for span, shape in self.system.stress_places]

    @property
    def value(self) -> Array:
        return self._join([part.value for part in self.parts], self.batch)

    def pull(self, stress: Array) -> Array:
        """B' sigma [..., n]."""
        local = [part.pull(s) for part, s in zip(self.parts, self._split(stress))]
        return self.system.scatter(self._join(local, local[0].shape[:-2]))

    def push(self, change: Array) -> Array:
        """B dq [..., n_stresses]."""
        return self._join([part.push(change) for part in self.parts], np.broadcast_shapes(self.batch, change.shape[:-1]))

    def frozen(self) -> Strains | Slopes:
        """These strains for many products with B: ``push`` and ``pull`` only."""
        system, gradients = self.system, [part.gradient for part in self.parts]
        if system.n * system.n_stresses <= SMALL:
            entries = gradients[0].ravel() if len(gradients) == 1 else np.concatenate([gradient.ravel() for gradient in gradients])
            return Slopes(system.whole_gradient(entries).reshape(system.n, system.n_stresses))
        other = copy(self)
        other.parts = [Frozen(kernel, gradient) for kernel, gradient in zip(system.measures, gradients)]
        return other

    def stiffness(self, stress: Array, modulus: Array, v: Array | None) -> Array:
        """Values of B' diag(modulus) B + sigma . d2(strain)/dq2, and with a velocity B' eta d(B v)/dq."""
        out = []
        eta = [None] * len(self.parts) if v is None else self._split(self.system.viscosity)  # type: ignore[arg-type]
        for part, s, c, viscosity in zip(self.parts, self._split(stress), self._split(modulus), eta):
            matrix: Any = part.stiffness(s, c)
            if viscosity is not None:
                assert v is not None
                columns = np.moveaxis(viscosity[..., None] * part.swirl(v), -1, 0)
                matrix = matrix + np.moveaxis(part.pull(columns), 0, -1)
            out.append(matrix.reshape(*matrix.shape[:-3], -1))
        return out[0] if len(out) == 1 else np.concatenate(out, axis=-1)

    def swirl_times(self, v: Array, change: Array) -> Array:
        """d(B v)/dq dq [..., n_stresses]."""
        parts = [part.swirl_times(v, change) for part in self.parts]
        return self._join(parts, np.broadcast_shapes(self.batch, v.shape[:-1], change.shape[:-1]))
