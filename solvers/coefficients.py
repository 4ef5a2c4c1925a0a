"""Radau IIA collocation with s stages: order 2 s - 1, stiffly accurate.

Nodes are the zeros of P_s(x) - P_(s-1)(x) on [0, 1]. Everything follows from the Lagrange polynomials through the nodes, in extended
precision (a Vandermonde system would leave 1e-13 for 7 stages); their algebra is asserted. Hairer and Wanner (1996), Solving
Ordinary Differential Equations II, IV.5 and IV.8.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Wide = NDArray[np.longdouble]
Array = NDArray[np.float64]


def radau_nodes(stages: int) -> Wide:
    """c [s] in (0, 1], the last is 1."""
    series = np.zeros(stages + 1, dtype=np.longdouble)
    series[stages], series[stages - 1] = 1, -1
    x = np.sort(legendre.legroots(series.astype(float)).real).astype(np.longdouble)
    slope = legendre.legder(series)
    for _ in range(4):
        x = x - legendre.legval(x, series) / legendre.legval(x, slope)
    x[-1] = 1
    return (x + 1) / 2


def lagrange(nodes: NDArray, points: NDArray) -> NDArray:
    """[points, nodes]: values of the Lagrange polynomials."""
    out = np.ones((len(points), len(nodes)), dtype=nodes.dtype)
    for j, node in enumerate(nodes):
        for k, other in enumerate(nodes):
            if k != j:
                out[:, j] *= (points - other) / (node - other)
    return out


def differentiation(nodes: NDArray) -> NDArray:
    """D [nodes, nodes]: derivatives of the Lagrange polynomials at the nodes (barycentric; Berrut and Trefethen 2004, eq. 9.4)."""
    weights = np.array([1 / np.prod([node - other for other in nodes if other != node]) for node in nodes], dtype=nodes.dtype)
    d = np.zeros((len(nodes), len(nodes)), dtype=nodes.dtype)
    for i, node in enumerate(nodes):
        for j, other in enumerate(nodes):
            if i != j:
                d[i, j] = weights[j] / weights[i] / (node - other)
        d[i, i] = -d[i].sum()
    return d


def _gauss(points: int) -> tuple[Wide, Wide]:
    """Gauss points and weights on [0, 1]."""
    series = np.zeros(points + 1, dtype=np.longdouble)
    series[-1] = 1
    x, slope = legendre.leggauss(points)[0].astype(np.longdouble), legendre.legder(series)
    for _ in range(3):
        x = x - legendre.legval(x, series) / legendre.legval(x, slope)
    weights = 1 / ((1 - x**2) * legendre.legval(x, slope) ** 2)
    return (x + 1) / 2, weights.astype(np.longdouble)


def _quadrature(nodes: Wide, ends: Wide) -> Wide:
    """[ends, s] = int_0^end l_j; with the nodes as ends it is A."""
    x, w = _gauss(len(nodes))
    return np.array([(w * end) @ lagrange(nodes, x * end) for end in ends])


def decouple(inverse: Array) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.complex128], Array, Array]:
    """eigenvalues, into, back, into_parts and back_parts of a^-1, as ``Tableau`` describes them."""
    values, vectors = np.linalg.eig(inverse)
    into = np.linalg.inv(vectors)
    keep = np.flatnonzero(values.imag > -1e-9 * np.abs(values))
    keep = keep[np.argsort(values[keep].imag, kind="stable")]
    double = np.where(np.abs(values[keep].imag) > 1e-9, 2.0, 1.0)
    into, back, real = into[keep], vectors[:, keep] * double, int(double[0] == 1.0)
    one = np.eye(len(inverse))
    assert real == len(inverse) % 2 and np.abs((back @ into).real - one).max() < 1e-8, "eigenvectors"
    # The eigenvector of the real eigenvalue may come with a complex factor: make it real.
    if real:
        phase = back[np.argmax(np.abs(back[:, 0])), 0]
        into[0], back[:, 0] = (into[0] * phase).real, (back[:, 0] / phase).real
    mixed = [part for row in into[real:] for part in (row.real, row.imag)]
    spread = [part for column in back[:, real:].T for part in (column.real, -column.imag)]
    into_parts, back_parts = np.array([*into[:real].real, *mixed]), np.array([*back[:, :real].real.T, *spread]).T.copy()
    assert np.abs(back_parts @ into_parts - one).max() < 1e-8, "real and imaginary parts"
    return values[keep], into, back, into_parts, back_parts


class Tableau:
    """Coefficients of the s-stage method, in double precision.

    c [s] nodes, a [s, s], inverse = a^-1, start [s]: derivative at 0 of the polynomial through 0 and the stages, gamma: the real
    eigenvalue of a^-1, and ``eigenvalues`` [p] (gamma, if s is odd, then one of each complex pair) with rows ``into`` [p, s] and columns
    ``back`` [s, p] such that x = real(back @ (into @ x)) and real(back @ diag(eigenvalues) @ into) = a^-1. ``into_parts`` [s, s] and
    ``back_parts`` [s, s] are the same in real arithmetic: the real row, then real and imaginary part of each pair. ``middle`` [s + 1],
    ``middle_stages`` and ``back_to_start`` [s] evaluate stage polynomials at half the step (with, without the start) and at its start.
    ``noise`` is the most that an error in the stage positions of a free particle shows in the error estimate of h v.
    """

    def __init__(self, stages: int):
        self.stages, self.order = stages, 2 * stages - 1
        nodes = radau_nodes(stages)
        a = _quadrature(nodes, nodes)
        derivative = differentiation(np.concatenate((np.zeros(1, dtype=np.longdouble), nodes)))
        self._assert_algebra(nodes, a, derivative[1:, 1:])
        self.c, self.a, self.b = nodes.astype(float), a.astype(float), a[-1].astype(float)
        self.inverse, self.start = derivative[1:, 1:].astype(float), derivative[0, 1:].astype(float)
        self._nodes = nodes
        self._split()

    def _assert_algebra(self, c: Wide, a: Wide, inverse: Wide) -> None:
        s = self.stages
        powers = np.arange(1, s + 1)
        assert np.abs(a @ c[:, None] ** (powers - 1) - c[:, None] ** powers / powers).max() < 1e-15, "collocation C(s)"
        assert np.abs([a[-1] @ c ** (k - 1) - np.longdouble(1) / k for k in range(1, 2 * s)]).max() < 1e-15, "quadrature B(2s-1)"
        assert np.abs(inverse @ a - np.eye(s)).max() < 1e-14, "inverse"

    def _split(self) -> None:
        self.eigenvalues, self.into, self.back, self.into_parts, self.back_parts = decouple(self.inverse)
        self.real = self.stages % 2
        self.gamma = float(self.eigenvalues[0].real) if self.real else float("nan")
        in_q = (self.start @ self.inverse / self.gamma + self.start) / self.gamma
        self.noise = float(np.abs(self.start - self.gamma * in_q).sum())
        half, start = np.array([0.5]), np.zeros(1)
        self.middle, self.middle_stages = self.extend(half, with_start=True)[0], self.extend(half, with_start=False)[0]
        self.back_to_start = self.extend(start, with_start=False)[0]

    def extend(self, at: Array, *, with_start: bool) -> Array:
        """[points, s (+ 1)]: the stage polynomial (with its value at 0 first) evaluated at fractions of the step, also beyond 1."""
        nodes = np.concatenate((np.zeros(1), self.c)) if with_start else self.c
        return lagrange(nodes, np.asarray(at, dtype=float))


class GaussLobatto:
    """Coefficients of the s-stage Gauss method, order 2 s, with constraints at the s + 1 points of Lobatto's quadrature.

    c, b [s], inverse [s, s] and its eigenvalues as in ``Tableau``; d, weights [s + 1]: Lobatto's points on [0, 1]. For stage values
    X = x0 + dX, velocities V and forces of the constraints Y [s + 1], the last of which acts beyond the stages:
    ends [s, s]: polynomial minus x0 at d_1..d_s = ends @ dX;  pull [s, s + 1]: Y as forces at the stages;  kick [s + 1]: the part of Y in
    the final velocity that extrapolation of V by (b a^-1) lacks. ``ends_inverse``, ``pull_inverse`` [s, s] (of the first s columns),
    ``last`` = b a^-1 [s]. The symplectic pair is b_i A_ij + weights_j E_ji = b_i weights_j (Jay 1996, eq. 3.2; 2007).

    Forces are taken at ``samples`` [k], Gauss's points too, with weights ``sample_weights``: spread [k, s]: polynomial minus x0 there = spread @ dX;
    slope [k, s]: velocities there = slope @ V;  gather [s, k]: forces there as their projection to degree s - 1, at the stages.
    """

    def __init__(self, stages: int, samples: int):
        self.stages, self.order, self.real = stages, 2 * stages, stages % 2
        c, b = _gauss(stages)
        c, b = c[np.argsort(c)], b[np.argsort(c)]
        d = _lobatto(stages)
        weights = _quadrature(d, d[-1:])[0]
        reach = _quadrature(c, d[1:])
        inverse = differentiation(np.concatenate((np.zeros(1, dtype=np.longdouble), c)))[1:, 1:]
        into_stages = weights * (1 - np.concatenate((np.zeros((1, stages), dtype=np.longdouble), reach)).T / b[:, None])
        powers = np.arange(1, 2 * stages + 1)[:, None]
        assert np.abs(c ** (powers - 1) @ b - 1 / powers[:, 0].astype(np.longdouble)).max() < 1e-15, "quadrature B(2s)"
        assert np.abs(d ** (powers - 1) @ weights - 1 / powers[:, 0].astype(np.longdouble)).max() < 1e-15, "Lobatto's quadrature B(2s)"
        assert np.abs(inverse @ _quadrature(c, c) - np.eye(stages)).max() < 1e-14, "inverse"
        self.c, self.b, self.d, self.weights = (x.astype(float) for x in (c, b, d, weights))
        self.inverse, self.ends, self.pull = (x.astype(float) for x in (inverse, reach @ inverse, inverse @ into_stages))
        self.last, self.kick = (b @ inverse).astype(float), (b @ inverse @ into_stages - weights).astype(float)
        self.ends_inverse, self.pull_inverse = np.linalg.inv(self.ends), np.linalg.inv(self.pull[:, :-1])
        self.eigenvalues, self.into, self.back, self.into_parts, self.back_parts = decouple(self.inverse)
        self.samples, self.sample_weights = self.c, self.b
        self.spread = self.slope = self.gather = np.eye(stages)
        if samples > stages:
            self._sample(c, inverse, samples)

    def _sample(self, c: Wide, inverse: Wide, samples: int) -> None:
        points, weights = _gauss(samples)
        points, weights = points[np.argsort(points)], weights[np.argsort(points)]
        legendre_at = [legendre.legvander(2.0 * x - 1.0, self.stages - 1) for x in (c, points)]
        gather = (legendre_at[0] * (2 * np.arange(self.stages) + 1)) @ legendre_at[1].T * weights
        spread, slope = _quadrature(c, points) @ inverse, lagrange(c, points)
        assert np.abs(gather @ slope - np.eye(self.stages)).max() < 1e-14, "what has degree s - 1 is its own projection"
        assert np.abs(gather @ spread - np.eye(self.stages)).max() < 1e-14, "Newton's matrix is that of the stages"
        self.samples, self.sample_weights, self.spread, self.slope, self.gather = (x.astype(float) for x in (points, weights, spread, slope, gather))


def _lobatto(stages: int) -> Wide:
    """The s + 1 points on [0, 1]: its ends and the zeros of P_s'."""
    series = np.zeros(stages + 1, dtype=np.longdouble)
    series[-1] = 1
    slope = legendre.legder(series)
    x = np.sort(legendre.legroots(slope.astype(float)).real).astype(np.longdouble)
    for _ in range(4):
        x = x - legendre.legval(x, slope) / legendre.legval(x, legendre.legder(slope))
    return (np.concatenate((-np.ones(1, dtype=np.longdouble), x, np.ones(1, dtype=np.longdouble))) + 1) / 2


@cache
def tableau(stages: int) -> Tableau:
    """The s-stage Radau IIA method, made once."""
    return Tableau(stages)


@cache
def gauss_lobatto(stages: int, samples: int) -> GaussLobatto:
    """The s-stage Gauss method with Lobatto's points for constraints and forces at so many samples, made once."""
    return GaussLobatto(stages, samples)
