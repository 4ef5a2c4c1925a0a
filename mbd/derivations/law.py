"""Elastic kernels as energies, loads as virtual works: everything else follows by differentiation.

A law has strains eps(w) of local variables w, which are affine in the coordinates, w = A q + c, moduli C and viscosities H:

    W = 1/2 eps' C eps,   R = 1/2 eps_t' H eps_t,   eps_t = B w_t,  B = d eps/dw      energy and half the dissipated power
    F = dW/dw + dR/dw_t = B' sigma,   sigma = C eps + H eps_t                         force, on q as A' F
    K = dF/dw = B' C B + sigma . d2 eps/dw2 + B' H d(B w_t)/dw,   D = B' H B          tangents, on q as A' K A, A' D A

The law of a load is its force F(w, w_t), with dF/dw and dF/dw_t. Laws are compiled once, for 30 digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from mbd.affine import Affine, Array

from .numbers import DIGITS, floats, matrix, number, precise


def rates_of(w: Sequence[sp.Symbol]) -> list[sp.Symbol]:
    """w_t."""
    return [sp.Symbol(rf"\dot{{{x.name}}}") for x in w]


class Law:
    """Strains of local variables and what they cost; C and H may contain the parameters."""

    def __init__(self, w: Sequence[sp.Symbol], strains: Sequence[Any], moduli: Any, viscosities: Any, parameters: Sequence[sp.Symbol]):
        self.w, self.strains, self.parameters = list(w), sp.Matrix(strains), list(parameters)
        self.moduli, self.viscosities = sp.Matrix(moduli), sp.Matrix(viscosities)
        self.rates = rates_of(self.w)

    @cached_property
    def gradient(self) -> sp.Matrix:
        """B = d eps/dw."""
        return self.strains.jacobian(self.w)

    @cached_property
    def energy(self) -> sp.Expr:
        return (self.strains.T * self.moduli * self.strains)[0] / 2

    @cached_property
    def force(self) -> sp.Matrix:
        """B' (C eps + H B w_t)."""
        return self.gradient.T * (self.moduli * self.strains + self.viscosities * self.gradient * sp.Matrix(self.rates))

    @cached_property
    def compiled(self) -> Any:
        """-> eps, B, d2 eps/dw2 for each strain, C, H."""
        hessians = [sp.hessian(strain, self.w) for strain in self.strains]
        everything = [self.strains, self.gradient, hessians, self.moduli, self.viscosities]
        return sp.lambdify([*self.w, *self.parameters], everything, modules="mpmath", cse=True)

    def at(self, w: Any, rates: Any, numbers: Sequence[Any]) -> tuple[Any, dict[str, Any], dict[str, Any]]:
        """W, vectors and matrices on w, as mpmath numbers."""
        strains, b, hessians, moduli, viscosities = self.compiled(*w, *numbers)
        stress = moduli * strains + viscosities * b * rates
        turning = mpmath.matrix(b.rows, b.cols)  # d(B w_t)/dw
        bent = mpmath.matrix(b.cols, b.cols)  # sigma . d2 eps/dw2
        for k, hessian in enumerate(hessians):
            bent += stress[k] * hessian
            turning[k, :] = (hessian * rates).T
        swirl = b.T * viscosities * turning
        matrices = {"stiffness": b.T * moduli * b + bent + swirl, "damping": b.T * viscosities * b, "swirl": swirl}
        return (strains.T * moduli * strains)[0] / 2, {"force": b.T * stress}, matrices


class LoadLaw:
    """The force on local variables, for given inputs; it may contain their rates."""

    def __init__(self, w: Sequence[sp.Symbol], inputs: Sequence[sp.Symbol], force: Any):
        self.w, self.inputs, self.force = list(w), list(inputs), sp.Matrix(force)
        self.rates = rates_of(self.w)

    @cached_property
    def compiled(self) -> Any:
        """-> F, dF/dw, dF/dw_t."""
        everything = [self.force, self.force.jacobian(self.w), self.force.jacobian(self.rates)]
        return sp.lambdify([*self.w, *self.rates, *self.inputs], everything, modules="mpmath", cse=True)


class Term(NamedTuple):
    """A law at w = matrix q[columns] + constant, with expressions or numbers for its parameters or inputs."""

    law: Any
    columns: NDArray[np.intp]
    matrix: sp.Matrix
    constant: sp.Matrix
    numbers: tuple[Any, ...]

    def of(self, q: Sequence[sp.Symbol]) -> sp.Matrix:
        """w as expressions of the coordinates."""
        return self.matrix * sp.Matrix([q[k] for k in self.columns]) + self.constant

    def rate(self, v: Sequence[sp.Symbol]) -> sp.Matrix:
        return self.matrix * sp.Matrix([v[k] for k in self.columns])


def stacked(maps: Sequence[Affine]) -> tuple[NDArray[np.intp], sp.Matrix, sp.Matrix]:
    """Columns, matrix and constant of several affine maps one below the other; a coordinate may occur twice among the columns."""
    blocks = [sp.Matrix(m.dimension, m.rows.size * m.dimension, [number(x) for x in m.matrix().ravel()]) for m in maps]
    constant = sp.Matrix([number(x) for m in maps for x in m.constant])
    return np.concatenate([m.columns() for m in maps]), sp.diag(*blocks), constant


class Totals:
    """Sums of the values of terms over the coordinates [n] of a scene, each rounded from 30 digits."""

    def __init__(self, n: int):
        self.n, self.energy = n, 0.0
        self.vectors: dict[str, Array] = {}
        self.matrices: dict[str, Array] = {}

    def add(self, term: Term, q: Array, v: Array) -> None:
        with mpmath.workdps(DIGITS):
            a, columns = matrix(term.matrix), term.columns % self.n
            w = a * matrix(q[columns].tolist()) + matrix(term.constant)
            rates, numbers = a * matrix(v[columns].tolist()), [precise(x) for x in term.numbers]
            if isinstance(term.law, LoadLaw):
                force, gradient, rate_gradient = term.law.compiled(*w, *rates, *numbers)
                self._place(a, columns, {"force": force}, {"gradient": gradient, "rate gradient": rate_gradient})
                return
            energy, *local = term.law.at(w, rates, numbers)
            self.energy += float(energy)
            self._place(a, columns, *local)

    def _place(self, a: Any, columns: NDArray[np.intp], vectors: dict[str, Any], matrices: dict[str, Any]) -> None:
        for name, value in vectors.items():
            np.add.at(self.vectors.setdefault(name, np.zeros(self.n)), columns, floats(a.T * value)[:, 0])
        for name, value in matrices.items():
            square = self.matrices.setdefault(name, np.zeros((self.n, self.n)))
            np.add.at(square, (columns[:, None], columns[None, :]), floats(a.T * value * a))
