"""Faults that random scenes found, shrunk: each in the smallest scene that showed it."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.solvers.index_one import index_one
from mbd.solvers.reduced import Reduced

DIAGONAL = np.array((1.0, -1.0, 1.0)) / np.sqrt(3.0)


def plate(mass: float = 1.0, third: float = 0.3) -> tuple[mbd.Scene, Any]:
    """A flat body that slides along a diagonal, pulled by a spring: its third director has no inertia."""
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    body = scene.add(mbd.RigidBody(mass=mass, inertia=mass * np.array((0.1, 0.2, third)), position=(0, 0, 0)))
    scene.add(mbd.Slider(body.at(0.2, -0.75, 0.1), scene.ground.at(0.2, -0.75, 0.1), axis=DIAGONAL))
    scene.add(mbd.Spring(body.at(1, 2, 0), scene.ground.at(0, 1, -1), stiffness=10.0 * mass, length=0.0))
    return scene, body


@pytest.mark.parametrize("solver", [None, mbd.Radau(), mbd.GeneralizedAlpha(0.01)], ids=str)
def test_rounding_of_a_flat_bodys_moments_is_no_inertia(solver):
    """0.1 + 0.2 - 0.3 is 5.6e-17. The motion along the line is x'' = p - k x, by the projections of weight and spring."""
    scene, body = plate()
    p = np.array((0, 0, -9.81)) @ DIAGONAL - 10.0 * np.array((1, 1, 1)) @ DIAGONAL
    result = mbd.simulate(scene, t_end=0.2, solver=solver, rtol=1e-8)
    along = p / 10.0 * (1.0 - np.cos(np.sqrt(10.0) * result.t[-1]))
    np.testing.assert_allclose(result.position(body.at(0, 0, 0))[-1], along * DIAGONAL, atol=1e-4 if solver else 1e-7)
    assert result.audit.position_drift < 1e-13


@pytest.mark.parametrize("mass", [1.0, 1e-2, 1e-3, 1e-4])
def test_a_free_direction_without_inertia_has_no_reduced_form(mass):
    """Whether rounding lets the Cholesky factor of a singular matrix exist depends on the unit of mass."""
    turned = np.array(((1.0, 2.0, -2.0), (2.0, 1.0, 2.0), (2.0, -2.0, -1.0))) / 3.0
    centre = np.array((0.469565, 0.114938, 1.114938))
    scene = mbd.Scene(gravity=(-10, 0, -10))
    body = scene.add(mbd.RigidBody(mass=3.0 * mass, inertia=mass * np.array((6.0, 12.0, 18.0)), position=centre, rotation=turned))
    hold, pulled = (0.0370965, 0.0, 1.75), (-0.324037, -1.75, -1.757064)
    scene.add(mbd.Slider(body.at(*turned.T @ (hold - centre)), scene.ground.at(*hold), axis=(-1, 1, 1)))
    ends = body.at(*turned.T @ (pulled - centre)), scene.ground.at(-0.75, 1.25, -0.146704)
    scene.add(mbd.Spring(*ends, stiffness=10.0 * mass, damping=0.1 * mass, length=0.0))
    assert not isinstance(index_one(scene.build(), mbd.assemble(scene).linear), Reduced)
    assert mbd.simulate(scene, t_end=0.5, rtol=1e-4).stats["steps"] < 10


def test_two_equal_equations_are_noticed_though_the_estimated_condition_is_above_rounding():
    scene = mbd.Scene()
    lever = scene.add(mbd.RigidBody(mass=0.1, inertia=0.025, position=(-1.13075, 2.0625), angle=-2.6895))
    block = scene.add(mbd.RigidBody(mass=20.0, inertia=20.0, position=(0, 0)))
    scene.add(mbd.Ball(lever.at(*_inside(lever, (0, 1.5))), scene.ground.at(0, 1.5)))
    scene.add(mbd.Slider(block.at(0, 0), scene.ground.at(0, 0), axis=(1, -1)))
    beam = scene.add(mbd.AncfCable((1.25, -2), (1.25, -1), n_elements=1, A=9e-4, E=3e8, I=6.75e-8, rho=2222))
    scene.add(mbd.Pin(beam.end, block.at(1.25, -1)))
    beads = [scene.add(mbd.BeamSlider(lever.at(*_inside(lever, (1.25, -1.5))), beam)) for _ in range(2)]
    with pytest.warns(mbd.SceneWarning, match="redundant"):
        result = mbd.simulate(scene, t_end=0.01)
    assert result.indeterminate == tuple(bead.name for bead in beads)


def _inside(body: Any, point: tuple[float, float]) -> np.ndarray:
    """A point of the plane in body axes."""
    d = body.description
    c, s = np.cos(d.angle), np.sin(d.angle)
    return np.array([[c, s], [-s, c]]) @ (np.array(point) - d.position)


def test_what_rests_in_rounding_is_not_called_out_of_balance():
    """Without gravity nothing moves but by rounding, whose energy need not balance."""
    scene = mbd.Scene(gravity=(0, 0))
    beam = scene.add(mbd.AncfCable((1.5, 1.75), (0.7929, 2.4571), n_elements=1, A=9e-4, E=7.4e6, I=6.75e-8, rho=555.6))
    body = scene.add(mbd.RigidBody(mass=1.0, inertia=4.0, position=(2.4365, 0)))
    scene.add(mbd.Ball(body.at(-0.937, 0), scene.ground.at(1.4995, 0)))
    scene.add(mbd.Pin(beam.start, scene.ground.at(1.5, 1.75)))
    scene.add(mbd.Clamp(beam.at(0.5), body.at(-1.29005, 2.10355)))
    still = scene.add(mbd.RigidBody(mass=20.0, inertia=5.0, position=(5, 5), velocity=(1, 0), angular_velocity=1.5))
    scene.add(mbd.Clamp(still.at(0, 0.3), scene.ground.at(5, 5.3)))
    scene.add(mbd.Torque(still.at(0, 0), lambda t: 3.0 * t))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        result = mbd.simulate(scene, t_end=0.25, rtol=1e-4)
    assert not any("energy" in str(warning.message) for warning in told)
    assert result.audit.balanced and result.audit.still


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("drive", [False, True])
def test_a_measured_length_is_scaled_as_a_length(unit, drive):
    """In small units of length its unknown was scaled as an angle's: the matrix looked singular, and steps were not landed on the joints."""
    scene = mbd.Scene(gravity=(-10.0 * unit, 0, 0))
    bead = scene.add(mbd.Particle(20.0, unit * np.array((0, 1.0, 0))))
    scene.add(mbd.PointOnLine(bead.at(), scene.ground.at(0, unit, 0), axis=(2, -1, -1)))
    length = scene.add(mbd.Length(bead.at(), scene.ground.at(0, 1.004 * unit, -1.068 * unit)))
    start = 1.068 * unit
    if drive:
        scene.add(mbd.Actuator(length, value=lambda t: start * np.hypot(1.0, 0.004 / 1.068) * (1.0 + 0.2 * t)))
    result = mbd.simulate(scene, t_end=0.3, solver=mbd.Radau(stages=7), rtol=1e-4)
    assert result.audit.position_drift < 1e-11 and result.audit.velocity_drift < 1e-11
    apart = np.linalg.norm(result.position(bead.at()) - unit * np.array((0, 1.004, -1.068)), axis=-1)
    np.testing.assert_allclose(result.q[:, length.coordinate], apart, rtol=1e-10)


def test_the_work_of_a_damper_in_one_element():
    """Many steps of one element at once: arrays with an axis of length one may have any layout."""
    scene = mbd.Scene(gravity=(0, 0))
    beam = scene.add(mbd.AncfCable((0, 0), (0, 1), n_elements=1, A=9e-4, E=1.48e7, I=6.75e-8, rho=1111.0, damping=1e-3))
    scene.add(mbd.Pin(beam.start, scene.ground.at(0, 0)))
    assert mbd.simulate(scene, 0.25).audit.energy_error < 1e-12
    scene.add(mbd.Force(beam.end, (1.0, 0.0)))
    audit = mbd.simulate(scene, 0.25).audit
    assert audit.energy_error < 1e-6 * audit.energy_scale
