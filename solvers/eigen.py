"""Modes of the linearised equations: (s^2 M + s D + K) x + G' y = 0, G x = 0.

Small systems in minimal coordinates by LAPACK. Large ones by Lanczos or Arnoldi iterations on the inverse, shifted a little off zero so
that rigid modes do no harm, through the sparse KKT matrix (Ericsson and Ruhe 1980, Math. Comput. 35):
    undamped   (K - sigma M)^-1 M              with the inner product of M
    otherwise  (A - z B)^-1 B,  A = [0 I; -K -D],  B = diag(I, M):     (K + z D + z^2 M) x = -b - D a - z M a,  x' = a + z x
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eig, eigh, solve_triangular

from .kkt import Kkt
from .linear import Linear, Tangent
from .minimal import Minimal
from .system import Array, System

UNDAMPED_DENSE, GENERAL_DENSE = 600, 150
"""Coordinates up to which dense matrices are faster: 0.2 s for 400 undamped, but 10 s damped, where the sparse inverse takes 0.2 s."""

OFF = 1e-9
"""The shift, as a share of the largest entry of the scaled K."""

RESTARTS = 30

Complex = NDArray[np.complex128]


def undamped_dense(matrices: Minimal, count: int) -> tuple[Array, Array]:
    """omega^2 [k] ascending, shapes [k, n]; K symmetric."""
    last = min(count, len(matrices.mass)) - 1
    if last < 0:
        return np.zeros(0), np.zeros((0, len(matrices.basis)))
    symmetric = 0.5 * (matrices.stiffness + matrices.stiffness.T)
    squares, shapes = eigh(symmetric, matrices.mass, subset_by_index=[0, last])
    return squares, (matrices.basis @ shapes).T


def general_dense(matrices: Minimal) -> tuple[Complex, Complex]:
    """All s [2 r] and shapes [2 r, n]."""
    factor = cholesky(matrices.mass, lower=True)

    def divided(a: Array) -> Array:
        return solve_triangular(factor, solve_triangular(factor, a, lower=True).T, lower=True).T

    r = len(factor)
    pencil = np.zeros((2 * r, 2 * r))
    pencil[:r, r:] = np.eye(r)
    pencil[r:, :r], pencil[r:, r:] = -divided(matrices.stiffness), -divided(matrices.damping)
    s, vectors = eig(pencil)
    return s, (matrices.basis @ solve_triangular(factor, vectors[:r], lower=True, trans="T")).T


def undamped_sparse(system: System, linear: Linear, tangent: Tangent, count: int) -> tuple[Array, Array]:
    """omega^2 [k] ascending, shapes [k, n]: those nearest to zero."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    kkt = Kkt(system, linear)
    shift = OFF * kkt.buffer(tangent, 0.0)[1]
    factor, still = kkt.factor(tangent, shift), np.zeros(system.m)

    def inverse(b: Array) -> Array:
        return factor.solve(b, still)[0]

    def operator(function: Callable[[Array], Array]) -> Any:
        return LinearOperator((system.n, system.n), matvec=function, dtype=float)

    mass, start = operator(system.mass), inverse(system.mass(_start(system, linear)))
    squares, shapes = eigsh(mass, k=count, M=mass, sigma=-shift, OPinv=operator(inverse), v0=start)
    order = np.argsort(squares)
    return squares[order], shapes[:, order].T


def general_sparse(system: System, linear: Linear, tangent: Tangent, damping: Callable[[Array], Array], count: int) -> tuple[Complex, Complex]:
    """s and shapes [..., n]: about as many as asked for, those nearest to zero; fewer where they crowd (creep of damped beams does)."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

    size = Kkt(system, linear).buffer(tangent, 0.0)[1]
    z, n, still = float(np.sqrt(OFF * size)), system.n, np.zeros(system.m)
    factor = linear.factor(tangent, z * z, z, 1.0)

    def inverse(state: Array) -> Array:
        a, b = state[:n], system.mass(state[n:])
        x, _ = factor.solve(-b - damping(a) - z * system.mass(a), still)
        return np.concatenate((x, a + z * x))

    start = inverse(np.concatenate((_start(system, linear), _start(system, linear))))
    operator = LinearOperator((2 * n, 2 * n), matvec=inverse, dtype=float)
    try:
        theta, vectors = eigs(operator, k=count, v0=inverse(start), ncv=min(4 * count + 20, 2 * n), maxiter=RESTARTS)
    except ArpackNoConvergence as partly:
        theta, vectors = partly.eigenvalues, partly.eigenvectors
    return z + 1.0 / theta, vectors[:n].T


def _start(system: System, linear: Linear) -> Array:
    return np.random.default_rng(1).standard_normal(system.n) * linear.scale[: system.n]
