"""A strain that sets in within a step, where the middle of the step has no slope to correct positions with, must not be flown through."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import mbd
from mbd.elements.stop import StopDampers, StopDampersAt

STIFFNESS, LIMIT, WIDTH = 2e4, 0.3, 0.01
END = 0.6


class StrainSprings(StopDampers):
    """A stop's spring as a strain: the penetration, with a stiffness."""

    def __init__(self, *, stiffness: np.ndarray, **numbers: np.ndarray):
        super().__init__(damping=np.zeros_like(stiffness), **numbers)
        self.modulus = stiffness[:, None]

    def at(self, q: np.ndarray) -> StrainSpringsAt:
        found = StrainSpringsAt(self.dofs, *self.penetration(q))
        found.modulus = self.modulus
        return found


class StrainSpringsAt(StopDampersAt):
    """The same at configurations, with an energy."""

    modulus: np.ndarray

    def energy(self) -> np.ndarray:
        return 0.5 * np.sum(self.modulus * self.value**2, axis=(-2, -1))


@dataclass(frozen=True, eq=False)
class StrainStop:
    """As ``mbd.Stop``, above only, written as a strain."""

    measure: Any
    stiffness: float = STIFFNESS
    name: str | None = field(default=None, kw_only=True)

    kind = "strain stop"

    def faults(self, dimension: int) -> list[str]:
        return []

    def place(self, site: Any) -> Any:
        placed = type("Placed", (), {"description": self, "name": site.name, "site": site, "assemble": lambda _, model: self.assemble(model)})
        return placed()

    def assemble(self, model: Any) -> None:
        numbers = {"at": np.array([self.measure.coordinate]), "limits": np.array([[-np.inf, LIMIT]]), "width": np.array([WIDTH])}
        model.strain(StrainSprings, (), ["stop"], stiffness=np.array([self.stiffness]), **numbers)


def bouncing(gravity: float) -> tuple[mbd.Scene, Any]:
    """2 kg reach a stop after 0.3 m, falling or at constant speed, and bounce: scene, how far they are."""
    scene = mbd.Scene(gravity=(0, -gravity))
    body = scene.add(mbd.RigidBody(mass=2.0, inertia=0.1, position=(0, 0), velocity=(0, 0 if gravity else -2)))
    scene.add(mbd.Slider(body.at(), scene.ground.at(), axis=(0, -1)))
    way = scene.add(mbd.Displacement(body, scene.ground, axis=(0, -1)))
    scene.add(StrainStop(way))
    return scene, way


@pytest.fixture(scope="module")
def true() -> dict[float, float]:
    """The end by the explicit method, which has no iteration, by gravity."""
    scenes = {gravity: bouncing(gravity) for gravity in (0.0, 9.81)}
    ends = {gravity: mbd.simulate(scene, END, rtol=1e-12, solver=mbd.DormandPrince()).q[-1] for gravity, (scene, _) in scenes.items()}
    return {gravity: float(end[scenes[gravity][1].coordinate]) for gravity, end in ends.items()}


@pytest.mark.parametrize(
    "solver, rtol, accuracy",
    [
        *((mbd.Radau(stages), rtol, accuracy) for stages in (3, 5, 7) for rtol, accuracy in ((1e-4, 3e-3), (1e-7, 3e-6), (1e-10, 3e-8))),
        (mbd.Gauss(2e-3, stages=4), 1e-6, 5e-5),
        (mbd.GeneralizedAlpha(2e-3), 1e-6, 2e-3),
    ],
    ids=str,
)
@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_a_stop_written_as_a_strain_stops(solver: Any, rtol: float, accuracy: float, gravity: float, true: dict[float, float]) -> None:
    """The median of five tolerances: a dozen steps, of which one or another lands well or badly on the impact, scatter by a factor of ten."""
    errors = []
    for nearly in np.geomspace(0.5, 2.0, 5) * rtol if isinstance(solver, mbd.Radau) else (rtol,):  # others take fixed steps
        scene, way = bouncing(gravity)
        result = mbd.simulate(scene, END, rtol=float(nearly), solver=solver)
        errors.append(abs(result.q[-1, way.coordinate] - true[gravity]))
    assert np.median(errors) < accuracy


def pushed(force: float, stiffness: float) -> tuple[mbd.Scene, Any]:
    """2 kg at rest, under a force that grows with t^2: the guess of a first step is that nothing moves."""
    scene = mbd.Scene(gravity=(0, 0))
    body = scene.add(mbd.RigidBody(mass=2.0, inertia=0.1, position=(0, 0)))
    scene.add(mbd.Slider(body.at(), scene.ground.at(), axis=(1, 0)))
    way = scene.add(mbd.Displacement(body, scene.ground, axis=(1, 0)))
    scene.add(mbd.Force(body.at(), lambda t: (force * t * t, 0.0)))
    scene.add(StrainStop(way, stiffness))
    return scene, way


def test_gauss_sees_a_strain_that_its_guess_did_not() -> None:
    """One step whose end is 0.2 m beyond the onset."""
    scene, way = pushed(1.2e5, 2e4)
    true = mbd.simulate(scene, 0.1, rtol=1e-11, solver=mbd.DormandPrince()).q[-1, way.coordinate]
    free = 1.2e5 / 2.0 * 0.1**4 / 12.0
    assert abs(free - true) > 0.01
    assert mbd.simulate(scene, 0.1, solver=mbd.Gauss(0.1, stages=4)).q[-1, way.coordinate] == pytest.approx(true, abs=0.1 * (free - true))


def test_generalized_alpha_sees_a_strain_that_its_guess_did_not() -> None:
    """One step from rest against the equations of Chung and Hulbert for one coordinate."""
    scene, way = pushed(3e4, 500.0)
    h, rho, mass = 0.1, 0.8, 2.0
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + alpha_f - alpha_m
    beta = 0.25 * (gamma + 0.5) ** 2

    def unbalanced(q: float) -> float:
        u = min(max((q - LIMIT) / WIDTH, 0.0), 1.0)
        depth = WIDTH * (u**3 - 0.5 * u**4) + max(q - LIMIT - WIDTH, 0.0)
        return mass * q / (beta * h * h) * (1 - alpha_m) / (1 - alpha_f) + 500.0 * depth * u**2 * (3 - 2 * u) - 3e4 * h * h

    true = brentq(unbalanced, 0.0, 1.0, xtol=1e-14)
    assert true > LIMIT + WIDTH
    with pytest.warns(mbd.SceneWarning, match="lower rtol or the step"):  # it is one coarse step
        result = mbd.simulate(scene, h, solver=mbd.GeneralizedAlpha(h))
    assert result.q[-1, way.coordinate] == pytest.approx(true, abs=1e-9)
