"""The families of ``families/ratios.py`` in Exudyn."""

from __future__ import annotations

import numpy as np

from ... import machines
from ...exudyn_scenes import Machine, Planar, cable, empty, items, node_position
from .. import exact
from ..common import share
from ..families import ratios as of
from .running import Attempts, attempts, hinged_cable, static


def parallelogram(ratio: float) -> Attempts:
    def make() -> Machine:
        plane, tip = Planar(exact.GRAVITY), np.array([np.sin(of.TILT), -np.cos(of.TILT)])
        links = [plane.body(1.0, 1.0 / 12.0, 0.5 * tip + (k, 0), of.TILT - 0.5 * np.pi) for k in (0, 1)]
        coupler = plane.body(ratio, ratio / 12.0, tip + (0.5, 0))
        for k, link in enumerate(links):
            plane.pin(plane.point(plane.ground_body, (k, 0)), plane.point(link, (-0.5, 0)))
            plane.pin(plane.point(link, (0.5, 0)), plane.point(coupler, (k - 0.5, 0)))
        return plane.machine(links[0], (0.5, 0))

    return attempts(make, 1.5, 300, lambda x: share(x, of.parallelogram_end(ratio, 1.5), 1.0))


def double_pendulum(ratio: float) -> Attempts:
    def make() -> Machine:
        mbs = empty()
        before = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=mbs.AddObject(items.ObjectGround())))
        for k, mass in enumerate((1.0, ratio)):
            node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=list((k + 1.0) * of.ALONG)))
            mbs.AddObject(items.ObjectMassPoint2D(physicsMass=mass, nodeNumber=node))
            marker = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node))
            mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[0.0, -mass * exact.GRAVITY, 0.0]))
            mbs.AddObject(items.ObjectConnectorDistance(markerNumbers=[before, marker], distance=1.0))
            before = marker
        mbs.Assemble()
        end = node_position(mbs, node)
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, 1.0, 500, lambda x: share(x, of.double_end(ratio, of.TILT, 1.0), 2.0))


def stiffness(factor: float) -> Attempts:
    make = hinged_cable(machines.pendulum_cable(machines.SOFT * factor), exact.GRAVITY)
    return attempts(make, of.FALL, 500, lambda x: share(x, of.pendulum_end(factor), 1.2), sparse=True)


def slenderness(value: float) -> Attempts:
    frequency, t, wanted = of.vibration(value)

    def make() -> Machine:
        mbs = empty()
        nodes = cable(mbs, of.square(value, of.VIBRATING), 0.0)
        shape, slope = of.first_mode(np.linspace(0.0, 1.0, of.VIBRATING + 1))
        for node, y, dy in zip(nodes, shape, slope):
            mbs.SetNodeParameter(node, "initialVelocities", [0.0, 1e-3 * frequency * y, 0.0, 1e-3 * frequency * dy])
        ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
        for k in (0, 1, 3):
            held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
            mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, held]))
        mbs.Assemble()
        end = node_position(mbs, nodes[-1])
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, t, 300, lambda x: abs(x[1] - wanted) / 1e-3, sparse=True)


def half_circle(value: float) -> Attempts:
    given = of.square(value, of.BENT)

    def make() -> Machine:
        mbs = empty()
        nodes = cable(mbs, given, 0.0)
        ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
        for k in (0, 1, 3):
            held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
            mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, held]))
        turn = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[-1]))
        mbs.AddLoad(items.LoadTorqueVector(markerNumber=turn, loadVector=[0.0, 0.0, np.pi * given.E * given.I]))
        mbs.Assemble()
        end = node_position(mbs, nodes[-1])
        return Machine(mbs, lambda: end()[:2])

    return static(make, lambda x: share(x, (0.0, 2.0 / np.pi), 1.0), sparse=True)


def damper(ratio: float) -> Attempts:
    def make() -> Machine:
        mbs = empty()
        node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[1.5, 0.0]))
        mbs.AddObject(items.ObjectMassPoint2D(physicsMass=1.0, nodeNumber=node))
        ends = [
            mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=mbs.AddObject(items.ObjectGround()))),
            mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node)),
        ]
        mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=ends, stiffness=100.0, damping=20.0 * ratio, referenceLength=1.0))
        mbs.Assemble()
        end = node_position(mbs, node)
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, 1.0, 200, lambda x: abs(x[0] - 1.0 - 0.5 * exact.damped(ratio, 10.0, 1.0)) / 0.5)


def kelvin_voigt(time: float) -> Attempts:
    make = hinged_cable(machines.pendulum_cable(100.0 * machines.STEEL), exact.GRAVITY, damping=time)
    return attempts(make, of.FALL, 500, lambda x: share(x, exact.flat(of.FALL), 1.2), sparse=True)


def graded(ratio: float) -> Attempts:
    make = hinged_cable(machines.pendulum_cable(100.0 * machines.STEEL), exact.GRAVITY, of.fractions(ratio))
    return attempts(make, of.FALL, 500, lambda x: share(x, exact.flat(of.FALL), 1.2), sparse=True)


