"""The families of ``families/sizes.py`` in Exudyn."""

from __future__ import annotations

import numpy as np

from ... import machines
from ...exudyn_scenes import Machine, Out, Planar
from .. import exact
from ..common import share
from ..families import sizes as of
from .running import Attempts, attempts, dynamic, hinged_cable


def elements(count: float) -> Attempts:
    make = hinged_cable(machines.pendulum_cable(machines.STEEL, int(count)), exact.GRAVITY)
    for steps, loose in ((100, False), (100, True), (400, True))[: 3 if count < 5000 else 2]:
        yield lambda n=steps, x=loose: share(dynamic(make, of.EARLY, n, loose=x, sparse=True), exact.flat(of.EARLY), 1.2)  # type: ignore[misc]


def _chain(links: int, output: str = "end") -> Machine:
    plane, a, bodies = Planar(exact.GRAVITY), of.LINK, []
    before = plane.point(plane.ground_body, (0.0, 0.0))
    for k in range(links):
        bodies.append(plane.body(1.0, a * a / 12.0, ((k + 0.5) * a, 0.0)))
        plane.pin(before, plane.point(bodies[-1], (-0.5 * a, 0.0)))
        before = plane.point(bodies[-1], (0.5 * a, 0.0))
    machine = plane.machine(bodies[-1], (0.5 * a, 0.0))
    return machine if output == "end" else Machine(machine.system, lambda: _imbalance(machine.system, bodies))


def _imbalance(mbs: object, bodies: list[int]) -> np.ndarray:
    """[1]: kinetic and potential energy, which were 0 at the start, over the kinetic energy."""
    kinetic = potential = 0.0
    for body in bodies:
        velocity = np.array(mbs.GetObjectOutputBody(body, Out.Velocity, localPosition=[0.0, 0.0, 0.0]))  # type: ignore[attr-defined]
        turn = np.array(mbs.GetObjectOutputBody(body, Out.AngularVelocity, localPosition=[0.0, 0.0, 0.0]))  # type: ignore[attr-defined]
        place = np.array(mbs.GetObjectOutputBody(body, Out.Position, localPosition=[0.0, 0.0, 0.0]))  # type: ignore[attr-defined]
        kinetic += 0.5 * float(velocity @ velocity) + 0.5 * of.LINK**2 / 12.0 * float(turn @ turn)
        potential += exact.GRAVITY * float(place[1])
    return np.array([(kinetic + potential) / max(kinetic, 1e-300)])


def links(count: float) -> Attempts:
    for steps in (100, 400)[: 2 if count < 5000 else 1]:
        yield lambda n=steps: abs(  # type: ignore[misc]
            dynamic(lambda: _chain(int(count)), of.EARLY, n, sparse=count > 30)[1] - of.chain_depth(int(count))) / of.LINK  # fmt: skip


def apart(count: float) -> Attempts:
    lengths = np.linspace(0.8, 1.2, int(count))

    def make() -> Machine:
        plane = Planar(exact.GRAVITY)
        for a in lengths:
            body = plane.body(1.0, a * a / 12.0, (0.5 * a, 0.0))
            plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(body, (-0.5 * a, 0.0)))
        return plane.machine(body, (0.5 * lengths[-1], 0.0))

    yield lambda: share(dynamic(make, of.EARLY, 100, sparse=count > 30), exact.flat(of.EARLY, lengths[-1]), 1.0)


def dropped(count: float) -> Attempts:
    return attempts(lambda: _chain(int(count), "energy"), 1.0, 1000, lambda x: abs(float(x[0])), sparse=count > 30)
