"""The rigid body by directors: r = R + sum x_k d_k with numbers x_k fixed in the body, so that its mass matrix is constant."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

import mbd

from .numbers import evaluated
from .step import Pairs, Step

SOURCE = "Betsch and Steinmann (2001)"
KERNEL = "mbd.elements.rigid"
MASS, INERTIA, ANGLE, SPIN = sp.symbols(r"m J theta \dot{theta}", real=True)
ARM = sp.symbols("x_1:4", real=True)


def axes(d: int) -> list[sp.Matrix]:
    """R, then the coordinate axes d_1 (planar) or d_1, d_2, d_3."""
    return [sp.Matrix(sp.symbols(f"{name}_x:{'xyz'[d - 1]}", real=True)) for name in ("R", *(f"d{k + 1}" for k in range(1 if d == 2 else 3)))]


def point(d: int, vectors: list[sp.Matrix]) -> sp.Matrix:
    """Of the vectors or of their rates; in the plane d_2 = k x d_1."""
    centre, *directors = vectors
    if d == 2:
        directors = [directors[0], sp.Matrix([-directors[0][1], directors[0][0]])]
    return centre + sum((x * v for x, v in zip(ARM, directors)), sp.zeros(d, 1))


def moments(d: int) -> dict[Any, Any]:
    """Integrals of 1, x_i and x_i x_j over the mass, from m and the moments of inertia J about the mass centre."""
    if d == 2:  # J = int x_1^2 + x_2^2; how it is shared does not matter
        share = sp.Symbol("S", real=True)
        return {(0, 0): MASS, (2, 0): share, (0, 2): INERTIA - share}
    j = inertia()
    second = sp.trace(j) / 2 * sp.eye(3) - j
    powers = np.eye(3, dtype=int)
    return {(0, 0, 0): MASS} | {tuple((powers[a] + powers[b]).tolist()): second[a, b] for a in range(3) for b in range(3)}


def inertia() -> sp.Matrix:
    return sp.Matrix(3, 3, lambda a, b: sp.Symbol(f"J_{'xyz'[min(a, b)]}{'xyz'[max(a, b)]}", real=True))


@cache
def kinetic(d: int) -> sp.Expr:
    """1/2 int |dr/dt|^2 dm in the rates, which stand under the names of the vectors."""
    velocity = point(d, axes(d))
    integrand = sp.Poly(sp.expand(velocity.dot(velocity) / 2), *ARM[:d])
    weights = moments(d)
    return sp.expand(sum(coefficient * weights.get(power, 0) for power, coefficient in integrand.terms()))


def mass(d: int) -> sp.Matrix:
    """On (R_x, d1_x, ...): the same for every component."""
    return sp.hessian(kinetic(d), [v[0] for v in axes(d)])


class Body:
    """A body in numbers."""

    def __init__(self, rng: np.random.Generator, d: int):
        self.m, velocity, position = float(rng.uniform(1.0, 2.0)), rng.standard_normal(d), rng.standard_normal(d)
        if d == 2:
            moment, angle, spin = rng.uniform(0.5, 1.5, 3).tolist()
            motion: dict[str, Any] = {"inertia": moment, "angle": angle, "angular_velocity": spin}
            self.values: dict[Any, Any] = {MASS: self.m, INERTIA: moment, ANGLE: angle, SPIN: spin}
        else:
            a = rng.standard_normal((3, 3))
            matrix = np.trace(a @ a.T) * np.eye(3) - a @ a.T  # of a body with int x x' dm = a a'
            self.rotation, _ = np.linalg.qr(rng.standard_normal((3, 3)))
            self.rotation[:, 0] *= np.linalg.det(self.rotation)
            self.spin = rng.standard_normal(3)
            motion = {"inertia": matrix, "rotation": self.rotation, "angular_velocity": self.spin}
            self.values = {MASS: self.m} | {inertia()[r, c]: matrix[r, c] for r in range(3) for c in range(3)}
        self.scene, self.velocity = mbd.Scene(gravity=np.zeros(d)), velocity
        self.item = self.scene.add(mbd.RigidBody(mass=self.m, position=position, velocity=velocity, **motion))
        self.system = self.scene.build()


def _point(d: int) -> Any:
    def compare(rng: np.random.Generator) -> Pairs:
        body, arm = Body(rng, d), rng.standard_normal(d)
        names = [x for v in axes(d) for x in v]
        values = dict(zip(names, body.system.q0.tolist())) | dict(zip(ARM, arm.tolist()))
        yield "r", evaluated(point(d, axes(d)), values)[:, 0], body.item.at(*arm).point.value(body.system.q0)

    return compare


def _mass(d: int) -> Any:
    def compare(rng: np.random.Generator) -> Pairs:
        body = Body(rng, d)
        exact = np.kron(evaluated(mass(d), body.values), np.eye(d))
        yield "M", exact, body.system.mass(np.eye(body.system.n))

    return compare


def _planar_reduction(rng: np.random.Generator) -> Pairs:
    body = Body(rng, 2)
    exact = evaluated(sp.Matrix([turning()]), body.values)[0, 0] + 0.5 * body.m * body.velocity @ body.velocity
    yield "T", exact, body.system.kinetic(body.system.v0)


@cache
def turning() -> sp.Expr:
    """What is left of the kinetic energy for dR/dt = 0 and d = (cos theta, sin theta)."""
    rate = sp.Matrix([-sp.sin(ANGLE), sp.cos(ANGLE)]) * SPIN
    centre, director = axes(2)
    return sp.simplify(kinetic(2).subs(dict(zip(centre, (0, 0))) | dict(zip(director, rate)), simultaneous=True))


OMEGA = sp.Matrix(sp.symbols("omega_1:4", real=True))


@cache
def spatial_turning() -> sp.Expr:
    """The same in space for d_k = e_k, dd_k/dt = omega x e_k: components of omega in the body."""
    centre, *directors = axes(3)
    rates = dict(zip(centre, (0, 0, 0)))
    for k, director in enumerate(directors):
        rates |= dict(zip(director, OMEGA.cross(sp.eye(3)[:, k])))
    return sp.expand(kinetic(3).subs(rates, simultaneous=True))


def _spatial_reduction(rng: np.random.Generator) -> Pairs:
    body = Body(rng, 3)
    own = body.rotation.T @ body.spin
    exact = evaluated(sp.Matrix([spatial_turning()]), body.values | dict(zip(OMEGA, own.tolist())))[0, 0]
    yield "T", exact + 0.5 * body.m * body.velocity @ body.velocity, body.system.kinetic(body.system.v0)


def internal(d: int) -> sp.Matrix:
    """Directors stay orthonormal: 1/2 (d_i . d_i - 1) and d_i . d_j."""
    _, *directors = axes(d)
    pairs = [(a, b) for a in range(len(directors)) for b in range(a, len(directors))]
    return sp.Matrix([(directors[a].dot(directors[a]) - 1) / 2 if a == b else directors[a].dot(directors[b]) for a, b in pairs])


def _internal(d: int) -> Any:
    def compare(rng: np.random.Generator) -> Pairs:
        body = Body(rng, d)
        q = body.system.q0 + 0.3 * rng.standard_normal(body.system.n)
        names = [x for v in axes(d) for x in v]
        yield "g", evaluated(internal(d), dict(zip(names, q.tolist())))[:, 0], body.system.joints.at(q).value

    return compare


def steps() -> list[Step]:
    here = "here, from the step before"
    return [
        Step("A point of a planar body", "r", point(2, axes(2)), SOURCE, f"{KERNEL}.Body.at", _point(2)),
        Step("Mass matrix in the plane, on the x components of (R, d_1), and the same on y", r"\partial^2 T/\partial \dot{q}^2", mass(2), SOURCE,
             f"{KERNEL}.RigidBody.director_mass", _mass(2)),
        Step("It holds the rotational energy of a rigid body", "T", turning(), here, "mbd.system.System.kinetic", _planar_reduction),
        Step("Its internal equation", "g", internal(2), SOURCE, f"{KERNEL}.Body.assemble", _internal(2)),
        Step("A point of a spatial body", "r", point(3, axes(3)), SOURCE, f"{KERNEL}.Body.at", _point(3)),
        Step("Mass matrix in space, on one component of (R, d_1, d_2, d_3): tr J / 2 - J on directors", r"\partial^2 T/\partial \dot{q}^2",
             mass(3), SOURCE, f"{KERNEL}.RigidBody.director_mass", _mass(3)),
        Step("It holds omega . J omega / 2, components in the body", "T", spatial_turning(), here, "mbd.system.System.kinetic", _spatial_reduction),
        Step("Its internal equations", "g", internal(3), SOURCE, f"{KERNEL}.Body.assemble", _internal(3)),
    ]  # fmt: skip
