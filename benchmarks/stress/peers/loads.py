"""The families of ``families/loads.py`` in Exudyn."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...exudyn_scenes import Machine, cable, empty, items, node_position
from ..families import loads as of
from .running import Attempts, attempts


def truss(factor: float) -> Attempts:
    def make() -> Machine:
        mbs = empty()
        node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[0.0, of.RISE]))
        mbs.AddObject(items.ObjectMassPoint2D(physicsMass=1.0, nodeNumber=node))
        crown, ground = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node)), mbs.AddObject(items.ObjectGround())
        for x in (-1.0, 1.0):
            foot = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=ground, localPosition=[x, 0.0, 0.0]))
            mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=[foot, crown], stiffness=of.STIFFNESS, referenceLength=of.REST))
        mbs.AddLoad(items.LoadForceVector(markerNumber=crown, loadVector=[0.0, -factor * of.CRITICAL, 0.0]))
        mbs.Assemble()
        end = node_position(mbs, node)
        return Machine(mbs, lambda: end()[:2])

    return attempts(make, of.SNAP_END, 500, lambda x: abs(x[1] - of.truss_height(factor)) / of.truss_scale(factor))


def strut(factor: float) -> Attempts:
    wanted = of.strut_middle(factor)

    def make() -> Machine:
        mbs = empty()
        nodes = cable(mbs, of.STRUT, 0.0)
        q, v = of.strut_start(factor)
        reference = np.linspace(0.0, 1.0, len(nodes))
        for k, node in enumerate(nodes):
            mbs.SetNodeParameter(node, "initialCoordinates", [q[k, 0] - reference[k], 0.0, q[k, 2] - 1.0, 0.0])
            mbs.SetNodeParameter(node, "initialVelocities", list(v[k]))
        ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
        for node, k in ((nodes[0], 0), (nodes[0], 1), (nodes[-1], 1)):
            held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=k))
            mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, held]))
        end = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
        mbs.AddLoad(items.LoadForceVector(markerNumber=end, loadVector=[-factor * of.EULER, 0.0, 0.0]))
        mbs.Assemble()
        middle = node_position(mbs, nodes[len(nodes) // 2])
        return Machine(mbs, lambda: middle()[:2])

    return attempts(make, of.GROWTH / of.strut_rate(factor), 500, lambda x: abs(x[1] - wanted) / abs(wanted), sparse=True)


def _struck(force: Callable[[float], float], wanted: float, scale: float) -> Attempts:
    def make() -> Machine:
        mbs, markers, ends = empty(), [], []
        for y in (0.0, 1.0):
            node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[0.0, y]))
            mbs.AddObject(items.ObjectMassPoint2D(physicsMass=1.0, nodeNumber=node))
            markers.append(mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node)))
            ends.append(node_position(mbs, node))
        mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, stiffness=100.0, referenceLength=1.0))
        mbs.AddLoad(items.LoadForceVector(markerNumber=markers[0], loadVectorUserFunction=lambda mbs, t, load: [force(t), 0.0, 0.0]))
        mbs.Assemble()
        return Machine(mbs, lambda: 0.5 * (ends[0]() + ends[1]())[:2])

    return attempts(make, 1.0, 1000, lambda x: abs(x[0] - wanted) / scale)


def pulse(width: float) -> Attempts:
    """It has no declaration of jumps: the load is a function of time."""
    return _struck(lambda t: 1.0 / width if 0.5 <= t < 0.5 + width else 0.0, of.pair_centre(width), 0.25)


def undeclared_pulse(width: float) -> Attempts:
    return pulse(width)


def undeclared_jump(force: float) -> Attempts:
    wanted = 0.5 * force * 0.5 * 0.25
    return _struck(lambda t: force if t >= 0.5 else 0.0, wanted, max(abs(wanted), 1.0))
