"""The families of ``families/frames.py`` in Exudyn."""

from __future__ import annotations

from functools import cache

import numpy as np
from exudyn.rigidBodyUtilities import AngularVelocity2EulerParameters_t, RotationMatrix2EulerParameters

from ... import machines
from ...exudyn_scenes import Machine, Out, Planar, cable, empty, items
from .. import exact
from ..common import share
from ..families import frames as of
from .running import Attempts, attempts, dynamic, hinged, hinged_cable


def _crank(a: float, b: float, c: float) -> Machine:
    plane, area = Planar(exact.GRAVITY * a / c**2), 4e-6
    crank = plane.body(0.36 * b, 0.36 * 0.15**2 / 12.0 * b * a**2, (0.0, 0.075 * a), 0.5 * np.pi, (1.5 * a / c, 0.0), -20.0 / c)
    end = (np.sqrt(0.09 - 0.0225) * a, 0.0)
    given = machines.Cable((0.0, 0.15 * a), end, 4, 2e9 * b / (a * c**2), area * a**2, area**2 / 12.0 * a**4, 7870.0 * b / a**3)
    nodes = cable(plane.mbs, given, exact.GRAVITY * a / c**2, damping=1e-3 * c)
    start, tip = (plane.mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[k])) for k in (0, -1))
    block = plane.piston(0.075 * b, end)
    plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(crank, (-0.075 * a, 0.0)))
    plane.pin(plane.point(crank, (0.075 * a, 0.0)), start)
    plane.pin(tip, block)
    plane.mbs.AddObject(items.ObjectConnectorSpringDamper(
        markerNumbers=[plane.point(plane.ground_body, (0.6 * a, 0.0)), block], stiffness=50.0 * b / c**2, damping=b / c,
        referenceLength=0.6 * a - end[0]))  # fmt: skip
    return plane.machine(crank, (0.075 * a, 0.0))


@cache
def _in_si(steps: int, loose: bool) -> np.ndarray:
    return dynamic(lambda: _crank(1.0, 1.0, 1.0), of.UNITS_END, steps, loose=loose, sparse=True)


def _in_units(a: float, b: float, c: float) -> Attempts:
    """Each setting against the same one in SI."""
    for steps, loose in ((500, False), (4000, False), (4000, True)):
        yield lambda n=steps, x=loose: share(  # type: ignore[misc]
            dynamic(lambda: _crank(a, b, c), of.UNITS_END * c, n, loose=x, sparse=True) / a, _in_si(n, x), 0.15)  # fmt: skip


def length_unit(factor: float) -> Attempts:
    return _in_units(factor, 1.0, 1.0)


def mass_unit(factor: float) -> Attempts:
    return _in_units(1.0, factor, 1.0)


def time_unit(factor: float) -> Attempts:
    return _in_units(1.0, 1.0, factor)


def beam_offset(offset: float) -> Attempts:
    """The pin holds the start where it is, so that only coordinates grow."""

    def at(place: float) -> np.ndarray:
        given = machines.pendulum_cable(machines.SOFT, 10)._replace(start=(place, -place), end=(place + 1.2, -place))
        return dynamic(hinged_cable(given, exact.GRAVITY), 0.5, 500, sparse=True) - (place, -place)

    allowed = 30.0 * of.OFFSET_RTOL + 100.0 * np.finfo(float).eps * offset
    yield lambda: share(at(offset), at(0.0), 1.0) / allowed


def _rod(length: float, lean: float) -> Machine:
    plane, end = Planar(exact.GRAVITY), length * np.array([np.sin(lean), -np.cos(lean)])
    rod = plane.body(1.0, length**2 / 12.0, 0.5 * end, lean - 0.5 * np.pi)
    plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(rod, (-0.5 * length, 0.0)))
    return plane.machine(rod, (0.5 * length, 0.0))


def clock(start: float) -> Attempts:
    for steps in (200, 1600):
        yield lambda n=steps: share(dynamic(lambda: _rod(1.2, 0.5 * np.pi), 1.0, n, start=start), exact.flat(1.0), 1.2)  # type: ignore[misc]


def periods(count: float) -> Attempts:
    t, end = of.long_end(count)
    for each, radius in ((200, 0.9), (1000, None)):
        yield lambda n=each, r=radius: share(  # type: ignore[misc]
            dynamic(lambda: _rod(1.0, np.pi / 3.0), t, int(n * count) + n, radius=r), end, 1.0)  # fmt: skip


def top(spin: float) -> Attempts:
    omega, start, end = of.precession(spin)

    def make() -> Machine:
        mbs, centre, ep = empty(), of.ARM * start[:, 2], RotationMatrix2EulerParameters(start)
        ep_t = AngularVelocity2EulerParameters_t(omega, ep)
        node = mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*centre, *ep], initialVelocities=[*np.cross(omega, centre), *ep_t]))
        body = mbs.AddObject(items.ObjectRigidBody(physicsMass=1.0, physicsInertia=[of.ACROSS, of.ACROSS, of.ALONG, 0, 0, 0], nodeNumber=node))
        middle, tip = (mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0, 0, z])) for z in (0.0, -of.ARM))
        origin = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround()), localPosition=[0, 0, 0]))
        mbs.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[0, 0, -exact.GRAVITY]))
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[origin, tip]))
        mbs.Assemble()
        return Machine(mbs, lambda: np.array(mbs.GetNodeOutput(node, Out.RotationMatrix)).reshape(3, 3))

    turns = spin * of.SPIN_END / (2.0 * np.pi)
    return attempts(make, of.SPIN_END, int(100 * turns) + 100, lambda x: share(x, end, 1.0))


def blade(speed: float) -> Attempts:
    radius, slope = of.stretched(speed)

    def make() -> Machine:
        mbs = empty()
        nodes = cable(mbs, of.BLADE, 0.0)
        reference = np.linspace(0.0, 0.1, len(nodes))
        for k, node in enumerate(nodes):
            mbs.SetNodeParameter(node, "initialCoordinates", [radius[k] - reference[k], 0.0, slope[k] - 1.0, 0.0])
            mbs.SetNodeParameter(node, "initialVelocities", [0.0, speed * radius[k], 0.0, speed * slope[k]])
        return hinged(mbs, nodes)

    return attempts(make, of.TURNS * 2.0 * np.pi / speed, 500, lambda x: share(x, of.blade_end(speed), radius[-1]), sparse=True)
