"""The families of ``families/singular.py`` in Exudyn."""

from __future__ import annotations

import numpy as np

from ...exudyn_scenes import Machine, Out, Planar, empty, items, node_position
from .. import exact
from ..common import share
from ..families import singular as of
from . import ratios
from .running import Attempts, attempts


def aligned(angle: float) -> Attempts:
    def make() -> Machine:
        plane, tip = Planar(0.0), np.array([np.cos(angle), np.sin(angle)])
        swing = of.SPEED * np.array([-tip[1], tip[0]])
        links = [plane.body(1.0, 1.0 / 12.0, 0.5 * tip + (2.0 * k, 0.0), angle, 0.5 * swing, of.SPEED) for k in (0, 1)]
        coupler = plane.body(1.0, 4.0 / 12.0, tip + (1.0, 0.0), 0.0, swing)
        for k, link in enumerate(links):
            plane.pin(plane.point(plane.ground_body, (2.0 * k, 0.0)), plane.point(link, (-0.5, 0.0)))
            plane.pin(plane.point(link, (0.5, 0.0)), plane.point(coupler, (2.0 * k - 1.0, 0.0)))
        return plane.machine(links[1], (0.5, 0.0))

    return attempts(make, 3.0, 1000, lambda x: share(x - (2.0, 0.0), of.aligned_end(angle), 1.0))


def dead_centre(excess: float) -> Attempts:
    angle = of.crank_angle(excess)

    def make() -> Machine:
        plane, length = Planar(0.0), 1.0 + excess
        crank = plane.body(1.0, 0.75, (0.5, 0.0), 0.0, (0.0, 0.5 * of.SPEED), of.SPEED)
        block = plane.piston(1.0, (1.0 + length, 0.0))
        plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(crank, (-0.5, 0.0)))
        plane.mbs.AddObject(items.ObjectConnectorDistance(markerNumbers=[plane.point(crank, (0.5, 0.0)), block], distance=length))
        return plane.machine(crank, (0.5, 0.0))

    return attempts(make, of.CRANK_END, 1000, lambda x: share(x, (np.cos(angle), np.sin(angle)), 1.0))


def folded(angle: float) -> Attempts:
    def make() -> Machine:
        mbs = empty()
        before = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=mbs.AddObject(items.ObjectGround())))
        for place in ((1.0, 0.0), (1.0 - np.cos(angle), -np.sin(angle))):
            node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=list(place)))
            mbs.AddObject(items.ObjectMassPoint2D(physicsMass=1.0, nodeNumber=node))
            marker = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node))
            mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[0.0, -exact.GRAVITY, 0.0]))
            mbs.AddObject(items.ObjectConnectorDistance(markerNumbers=[before, marker], distance=1.0))
            before = marker
        mbs.Assemble()
        end = node_position(mbs, node)
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, 0.8, 500, lambda x: share(x, of.folded_end(angle), 2.0))


def hinges(extra: float) -> Attempts:
    def make() -> Machine:
        mbs = empty()
        node = mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[0.6, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
        body = mbs.AddObject(items.ObjectRigidBody(physicsMass=1.0, physicsInertia=[0.04, 0.16, 0.12, 0, 0, 0], nodeNumber=node))
        middle = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0, 0, 0]))
        mbs.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[0, -exact.GRAVITY, 0]))
        wall = mbs.AddObject(items.ObjectGround())
        for k in range(int(extra) + 1):
            ends = [mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=b, localPosition=[x, 0, 0.1 * k])) for b, x in ((wall, 0.0), (body, -0.6))]
            mbs.AddObject(items.ObjectJointGeneric(markerNumbers=ends, constrainedAxes=[1, 1, 1, 1, 1, 0]))
        mbs.Assemble()
        return Machine(mbs, lambda: np.array(mbs.GetObjectOutputBody(body, Out.Position, localPosition=[0.6, 0.0, 0.0]))[:2])

    return attempts(make, 1.0, 200, lambda x: share(x, exact.flat(1.0), 1.2), sparse=extra > 20.0)


def conflict(gap: float) -> Attempts:
    angle = exact.swing(0.5 * np.pi, np.sqrt(exact.GRAVITY), 1.0)

    def make() -> Machine:
        mbs = empty()
        wall = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=mbs.AddObject(items.ObjectGround())))
        node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[1.0, 0.0]))
        mbs.AddObject(items.ObjectMassPoint2D(physicsMass=1.0, nodeNumber=node))
        bob = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node))
        mbs.AddLoad(items.LoadForceVector(markerNumber=bob, loadVector=[0.0, -exact.GRAVITY, 0.0]))
        for length in (1.0, 1.0 + gap):
            mbs.AddObject(items.ObjectConnectorDistance(markerNumbers=[wall, bob], distance=length))
        mbs.Assemble()
        end = node_position(mbs, node)
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, 1.0, 200, lambda x: share(x, (np.sin(angle), -np.cos(angle)), 1.0))


def massless(mass: float) -> Attempts:
    return ratios.parallelogram(mass)
