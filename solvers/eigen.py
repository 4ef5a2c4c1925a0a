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

ROUNDED, DEFECTIVE = 1e-12, 1e-6
"""Share of D and of the largest omega^2 that is rounding; share of |s| by which equal s of a gyroscopic system may move off the imaginary axis."""

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


def rotating_dense(matrices: Minimal, quotients: Callable[[Array], Array], rounding: float) -> tuple[Complex, Complex]:
    """All s [2 r] and shapes [2 r, n] of equations with gyroscopic terms in D.

    In the modes without D, whose omega^2 are the quotients [r] of shapes [r, n], everything is of the size of the frequencies, not of their
    squares. Where nothing damps or follows and all omega^2 are positive the matrix is skew, (omega x, x')' = [0 omega; -omega -D] (omega x, x'),
    and every s purely imaginary; otherwise real parts within a defective pair's rounding of zero count as none.
    """
    stiffness, mass = matrices.stiffness, matrices.mass
    _, vectors = eigh(0.5 * (stiffness + stiffness.T), mass)
    shapes = (matrices.basis @ vectors).T
    squares = quotients(shapes)
    squares[np.abs(squares) <= rounding] = 0.0
    damping = vectors.T @ matrices.damping @ vectors
    following = vectors.T @ (0.5 * (stiffness - stiffness.T)) @ vectors
    damping, lost = _skew(damping)
    following = np.where(np.abs(following) <= ROUNDED * np.max(np.abs(squares), initial=0.0), 0.0, following)
    conservative = not lost and not following.any()
    omega = np.sqrt(np.abs(squares))
    omega = np.where(omega > 0.0, omega, np.min(omega[omega > 0.0], initial=1.0))
    r = len(omega)
    pencil = np.zeros((2 * r, 2 * r))
    pencil[:r, r:] = np.diag(omega)
    pencil[r:, :r], pencil[r:, r:] = -(np.diag(squares) + following) / omega, -damping
    if conservative and (squares > 0.0).all():
        values, states = eigh(-1j * pencil)
        s = 1j * values
    else:
        s, states = eig(pencil)
        if conservative:
            s = np.where(np.abs(s.real) <= DEFECTIVE * np.abs(s), 1j * s.imag, s)
    return s, (states[:r] / omega[:, None]).T @ shapes


def _skew(damping: Array) -> tuple[Array, bool]:
    """The skew part of D where that is all but rounding, else D; and whether there is more."""
    lost = 0.5 * (damping + damping.T)
    more = bool(np.max(np.abs(lost), initial=0.0) > ROUNDED * np.max(np.abs(damping), initial=0.0))
    return (damping, True) if more else (damping - lost, False)


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
