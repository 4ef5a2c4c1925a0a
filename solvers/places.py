"""Room for accelerations at several states of a reduced system, prepared so that they take seven calls of NumPy and LAPACK.

Of small systems a right side costs calls, not numbers. So all that is found at a state is written where the next call takes it from, as
views made once, and whether a state is nearly singular is asked for all of a step together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.linalg import lapack

from .formats import Singular
from .start import settle
from .system import Array, System, targets

if TYPE_CHECKING:
    from .reduced import Reduced

NEARLY_SINGULAR = 1e-5
"""Share of an equation's slope, squared, that those before it leave: below it multipliers are not trusted, whatever the tolerance."""

MANY = 100
"""Equations above which that share is the smaller, the more they are."""


class NearlySingular(Singular):
    """Joints in or near a singular position, at one of several places."""

    def __init__(self, place: int, detail: object = ""):
        self.place = place
        super().__init__(str(detail) or "joints in a nearly singular position")


class Place(NamedTuple):
    """Views of one of several places. ``load`` and ``gradient`` are the rows of ``pull``, and these and ``turning`` parts of ``product``, all with
    the sign -; ``weights`` is -1 and the ``multipliers``."""

    w: Array
    u: Array
    product: Array
    load: Array
    gradient: Array
    turning: Array
    pull: Array
    square: Array
    weights: Array
    multipliers: Array
    acceleration: Array


class Places:
    """States w [places, 2, k + 1] of a form, and their accelerations [places, k + 1]; see ``index_one.Places``."""

    def __init__(self, form: Reduced, w: Array, accelerations: Array):
        count, k, m = len(w), form.k, form.m
        self.form = form
        product, square, weights = np.empty((count, 2, (m + 1) * k)), np.empty((count, m, m)), np.full((count, m + 1), -1.0)
        pull = product[:, 0].reshape(count, m + 1, k)
        turning = product[:, 1].reshape(count, m + 1, k)[:, 1:]
        self.multipliers = weights[:, 1:]
        views = (w, w[:, 1, :-1], product, pull[:, 0], pull[:, 1:], turning, pull, square, weights, self.multipliers, accelerations[:, :-1])
        self._places = [Place(*each) for each in zip(*views)]
        self._gradient, self._pivots = pull[:, 1:], np.diagonal(square, axis1=1, axis2=2)

    def rates(self, system: System, place: int, t: float) -> None:
        """The accelerations and multipliers of one state. Raises NearlySingular."""
        form = self.form
        w, u, product, load, gradient, turning, pull, square, weights, multipliers, acceleration = self._places[place]
        np.dot(w, form.tensor, product)
        if not form.affine or system.n_stresses:
            load -= form.force(system, w, system.inputs(t))
        if form.m:
            np.dot(gradient, gradient.T, square)
            np.subtract(gradient.dot(load), turning.dot(u), multipliers)
            if system.driven:
                multipliers -= targets(system.inputs(t)).acceleration[form.kept]
            if lapack.dposv(square.T, multipliers, 1, 1, 1)[2]:  # the factor and the solution take the places of both
                raise NearlySingular(place)
        np.dot(weights, pull, acceleration)

    def land(self, system: System, place: int, t: float) -> None:
        """Moves a state to the joints and goes on as ``rates``. Raises Inconsistent where it finds none near."""
        form, at = self.form, self._places[place]
        if form.m:
            z, (goal, speed) = at.w[0, :-1], form.goals(system, t)
            self._factor(place)
            z[:] = settle(z, lambda z: form.gap(z) - goal, lambda gap: -_solve(at, gap), form.reach, form.floor)
            self._factor(place)
            at.u[:] -= _solve(at, at.gradient.dot(at.u) + speed)
        self.rates(system, place, t)

    def _factor(self, place: int) -> None:
        """The Cholesky factor of G G' in ``square``; raises NearlySingular."""
        at = self._places[place]
        np.dot(at.w, self.form.tensor, at.product)
        np.dot(at.gradient, at.gradient.T, at.square)
        if lapack.dpotrf(at.square.T, 1, 0, 1)[1]:
            raise NearlySingular(place)

    def shares(self, places: slice) -> Array:
        """Of each state the least share of an equation's slope, squared, that others leave."""
        gradient = self._gradient[places]
        return least_share(self._pivots[places], np.einsum("pij,pij->pi", gradient, gradient))


def _solve(at: Place, right: Array) -> Array:
    """The least change of the coordinates for which -G times it is ``right``, where the factor is that of ``_factor``."""
    return lapack.dpotrs(at.square.T, right, 1)[0].dot(at.gradient)


def least_share(pivots: Array, sizes: Array) -> Array:
    """[...]: the least share of an equation's slope, squared, that those before it leave: pivots [..., m] of the Cholesky factors of matrices
    with these diagonals. In a long chain the last equation keeps no more than one part in its number, which counts as all."""
    return (pivots * pivots / sizes).min(axis=-1, initial=1.0) / min(1.0, MANY / max(pivots.shape[-1], 1))
