"""Newton's method for the stages with every stage's own G: for steps across a singular position of the joints.

Where bars come into line, G loses rank for an instant: along some direction of motion an equation's slope passes through zero and changes
its sign within the step. A correction with the slope in the middle of the step multiplies the error of a stage by 1 - slope there / slope
in the middle, which is above 1 on the far side: the iteration of ``stages.Linearised`` cannot converge on a step across, and the shorter
the step, the nearer is its middle and the faster does it diverge. With slopes of their own the stages are as regular as they are far from
that position, and a long step across it is better than a short one. The price is that the eigenvectors of A^-1 no longer decouple the
stages: one sparse system with s (n + m) unknowns,

    [ sum_j (z^2)_ij M dQ_j + z_ij D dQ_j + K dQ_i + G_i' y_i ]  = top_i,     z = A^-1 / h
    [ G_i dQ_i                                                ]  = bottom_i.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .formats import Solve, cheapest
from .linear import SOFTENING, Factor, Linear
from .stages import Derivatives, Middle, StageEquations, Stages
from .system import Array, Index


class EachStage:
    """The mass KKT matrices of all stages."""

    def __init__(self, factors: list[Factor]):
        self.factors = factors

    def solve(self, top: Array, bottom: Array) -> tuple[Array, Array]:
        """x [s, n], y [s, m] from right sides [s, n] and [s, m]."""
        x, y = zip(*(factor.solve(*right) for factor, *right in zip(self.factors, top, bottom)))
        return np.array(x), np.array(y)


class Coupled(Derivatives):
    """As ``Linearised``, but with G and d(G v)/dq at the stages x. Raises Singular."""

    def __init__(self, equations: StageEquations, linear: Linear, x: Stages, middle: Middle, inputs: Any):
        system, gamma = equations.system, equations.table.gamma / equations.h
        super().__init__(system, middle, inputs)
        self.joints, self.v = system.joints.at(equations.q0 + x.dq), x.v
        self._gradient = np.broadcast_to(self.joints.gradient, (len(x.dq), system.joints.rows.size))  # [entries] where G is constant but driven
        tangents = [linear.tangent(gradient, self.stiffness, self.damping) for gradient in self._gradient]
        self.mass_factor = EachStage([linear.factor(tangent) for tangent in tangents])
        self.end_factor = self.mass_factor.factors[-1]
        self.real_factor = linear.factor(tangents[-1], gamma**2, gamma, 1.0)
        self._scale = np.concatenate((linear.scale[: system.n], gamma**2 * linear.scale[system.n :]))
        self._solve = self._factor(equations.rate, SOFTENING * gamma**2 if linear.softened else 0.0)
        linear.factorizations += 1

    def _factor(self, rate: Array, softening: float) -> Solve:
        system, joints, scale, one = self.system, self.system.joints, self._scale, np.eye(len(rate))

        def spread(weights: Array, rows: Index, cols: Index, values: Array) -> tuple[Index, Index, Array]:
            """A matrix times weights [s, s] between stages; or, for unit weights, one matrix for each stage: values [s, entries]."""
            i, j = (index[:, None] for index in np.nonzero(weights))
            scaled = weights[i, j] * (values * scale[rows] * scale[cols])
            return (i * scale.size + rows).ravel(), (j * scale.size + cols).ravel(), scaled.ravel()

        below, corner = joints.rows + system.n, np.arange(system.n, scale.size)
        parts = [
            spread(rate @ rate, system.mass_rows, system.mass_cols, system.mass_values),
            spread(one, system.stiffness_rows, system.stiffness_cols, self.stiffness),
            spread(one, below, joints.cols, self._gradient),
            spread(one, joints.cols, below, self._gradient),
            spread(one, corner, corner, -softening / scale[corner] ** 2),
        ]
        if self.damping is not None:
            parts.append(spread(rate, system.damping_rows, system.damping_cols, self.damping))
        rows, cols, values = (np.concatenate(part) for part in zip(*parts))
        size = len(rate) * scale.size
        store = cheapest(size, size, rows, cols)
        return store.factor(np.bincount(store.slot(rows, cols), values, minlength=store.slots))

    def solve(self, top: Array, bottom: Array) -> tuple[Array, Array]:
        """The stage system: right sides [s, n] and [s, m]."""
        right = np.concatenate((top, bottom), axis=1) * self._scale
        x = self._solve(right.ravel()).reshape(right.shape) * self._scale
        return x[:, : self.system.n], x[:, self.system.n :]
