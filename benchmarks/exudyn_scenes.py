"""The benchmark scenes once more, in Exudyn: the same masses, lengths, loads and starts, in the formulation that a user of it would choose.

Each function returns a ``Machine``: the assembled system and a function that reads the output from its current state. Exudyn's planar
bodies have an angle as coordinate, its cables are ANCFCable2D (5 Gauss points for the stretch, 3 for the bending).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn import OutputVariableType as Out
from exudyn.rigidBodyUtilities import AngularVelocity2EulerParameters_t, RotationMatrix2EulerParameters

from . import machines

Array = np.ndarray
exu.SetWriteToConsole(False)


@dataclass(frozen=True)
class Machine:
    """A system ready to run; ``output()`` reads its output [d] [m]."""

    system: Any
    output: Callable[[], Array]


def empty() -> Any:
    return exu.SystemContainer().AddSystem()


def node_position(mbs: Any, node: int) -> Callable[[], Array]:
    return lambda: np.array(mbs.GetNodeOutput(node, Out.Position))


def body_point(mbs: Any, body: int, local: tuple[float, ...]) -> Callable[[], Array]:
    return lambda: np.array(mbs.GetObjectOutputBody(body, Out.Position, localPosition=[*local, 0.0, 0.0][:3]))


def cable(mbs: Any, given: machines.Cable, gravity: float, fractions: Array | None = None, damping: float = 0.0) -> list[int]:
    """The nodes of a straight cable: of equal elements, or at fractions of its length from 0 to 1; damping is a relaxation time [s]."""
    start, end = np.array(given.start), np.array(given.end)
    length = float(np.linalg.norm(end - start))
    if fractions is None:
        fractions = np.arange(given.n_elements + 1) / given.n_elements
    along, EA, EI = (end - start) / length, given.E * given.A, given.E * given.I
    nodes = [mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[*(start + (end - start) * x), *along])) for x in fractions]
    for k, size in enumerate(np.diff(fractions) * length):
        body = mbs.AddObject(items.ObjectANCFCable2D(
            nodeNumbers=[nodes[k], nodes[k + 1]], physicsLength=size, physicsMassPerLength=given.rho * given.A,
            physicsBendingStiffness=EI, physicsAxialStiffness=EA,
            physicsBendingDamping=EI * damping, physicsAxialDamping=EA * damping))  # fmt: skip
        if gravity:
            mass = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
            mbs.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[0.0, -gravity, 0.0]))
    return nodes


def pendulum(E: float) -> Machine:
    mbs = empty()
    nodes = cable(mbs, machines.pendulum_cable(E), machines.GRAVITY)
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for k in (0, 1):
        held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, held]))
    mbs.Assemble()
    return Machine(mbs, lambda: np.array(mbs.GetNodeOutput(nodes[-1], Out.Position))[:2])


def spaghetti() -> Machine:
    mbs = empty()
    nodes = cable(mbs, machines.SPAGHETTI, 0.0)
    point = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[0]))
    turn = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
    mbs.AddLoad(items.LoadForceVector(markerNumber=point, loadVectorUserFunction=lambda mbs, t, load: [machines.spaghetti_force(t), 0.0, 0.0]))
    mbs.AddLoad(items.LoadTorqueVector(markerNumber=turn, loadVectorUserFunction=lambda mbs, t, load: [0.0, 0.0, machines.spaghetti_moment(t)]))
    mbs.Assemble()
    return Machine(mbs, lambda: np.array(mbs.GetNodeOutput(nodes[-1], Out.Position))[:2])


def spinup() -> Machine:
    """The clamp is a joint whose angle follows the hub; its tangent may stretch, as in mbd."""
    mbs = empty()
    nodes = cable(mbs, machines.SPINUP, 0.0)
    root = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
    origin = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround()), localPosition=[0.0, 0.0, 0.0]))
    mbs.AddObject(items.ObjectJointGeneric(
        markerNumbers=[origin, root], constrainedAxes=[1, 1, 0, 0, 0, 1], offsetUserFunctionParameters=[0.0] * 6,
        offsetUserFunction=lambda mbs, t, item, parameters: [0.0, 0.0, 0.0, 0.0, 0.0, machines.hub_angle(t)],
        offsetUserFunction_t=lambda mbs, t, item, parameters: [0.0, 0.0, 0.0, 0.0, 0.0, machines.hub_speed(t)]))  # fmt: skip
    mbs.Assemble()
    return Machine(mbs, lambda: np.array(mbs.GetNodeOutput(nodes[-1], Out.Position))[:2])


class Planar:
    """Rigid bodies and pins in the plane."""

    def __init__(self, gravity: float):
        self.mbs, self.gravity = empty(), gravity
        self.ground_body = self.mbs.AddObject(items.ObjectGround())

    def body(self, mass: float, inertia: float, position: Any, angle: float = 0.0, velocity: Any = (0.0, 0.0), spin: float = 0.0) -> int:
        node = self.mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*position, angle], initialVelocities=[*velocity, spin]))
        body = self.mbs.AddObject(items.ObjectRigidBody2D(physicsMass=mass, physicsInertia=inertia, nodeNumber=node))
        if self.gravity:
            centre = self.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body))
            self.mbs.AddLoad(items.LoadForceVector(markerNumber=centre, loadVector=[0.0, -mass * self.gravity, 0.0]))
        return int(body)

    def point(self, body: int, local: Any) -> int:
        return int(self.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=[*local, 0.0])))

    def pin(self, a: int, b: int) -> None:
        self.mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=[a, b]))

    def torque(self, body: int, moment: float) -> None:
        motor = self.mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0.0, 0.0, 0.0]))
        self.mbs.AddLoad(items.LoadTorqueVector(markerNumber=motor, loadVector=[0.0, 0.0, moment]))

    def piston(self, mass: float, position: Any) -> int:
        """A particle that slides along x; the marker on it. Its weight is left out, since the slide holds it."""
        node = self.mbs.AddNode(items.NodePoint2D(referenceCoordinates=list(position)))
        self.mbs.AddObject(items.ObjectMassPoint2D(physicsMass=mass, nodeNumber=node))
        ground = self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=self.mbs.AddNode(items.NodePointGround()), coordinate=0))
        height = self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=1))
        self.mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, height]))
        return int(self.mbs.AddMarker(items.MarkerNodePosition(nodeNumber=node)))

    def machine(self, body: int, local: tuple[float, float]) -> Machine:
        self.mbs.Assemble()
        read = body_point(self.mbs, body, local)
        return Machine(self.mbs, lambda: read()[:2])


def four_bar(windows: int) -> Machine:
    plane = Planar(machines.GRAVITY)
    links = [plane.body(1.0, 1 / 12, (k, 0.5), 0.5 * np.pi, (0.5, 0.0), -1.0) for k in range(windows + 1)]
    couplers = [plane.body(1.0, 1 / 12, (k + 0.5, 1.0), 0.0, (1.0, 0.0)) for k in range(windows)]
    for k, link in enumerate(links):
        plane.pin(plane.point(plane.ground_body, (k, 0.0)), plane.point(link, (-0.5, 0.0)))
    for k, coupler in enumerate(couplers):
        plane.pin(plane.point(links[k], (0.5, 0.0)), plane.point(coupler, (-0.5, 0.0)))
        plane.pin(plane.point(links[k + 1], (0.5, 0.0)), plane.point(coupler, (0.5, 0.0)))
    return plane.machine(links[0], (0.5, 0.0))


def slider_crank() -> Machine:
    plane, (pin, end) = Planar(machines.GRAVITY), machines.slider_crank_points()
    crank = plane.body(machines.CRANK_MASS, machines.CRANK_MASS * machines.CRANK**2 / 12, (0.5 * pin[0], 0.5 * pin[1]), machines.CRANK_ANGLE)
    middle, slope = (0.5 * (pin[0] + end[0]), 0.5 * (pin[1] + end[1])), np.arctan2(end[1] - pin[1], end[0] - pin[0])
    rod = plane.body(machines.ROD_MASS, machines.ROD_MASS * machines.ROD**2 / 12, middle, slope)
    piston = plane.piston(machines.PISTON, end)
    plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(crank, (-0.5 * machines.CRANK, 0.0)))
    plane.pin(plane.point(crank, (0.5 * machines.CRANK, 0.0)), plane.point(rod, (-0.5 * machines.ROD, 0.0)))
    plane.pin(plane.point(rod, (0.5 * machines.ROD, 0.0)), piston)
    plane.torque(crank, machines.CRANK_TORQUE)
    return plane.machine(crank, (0.5 * machines.CRANK, 0.0))


def flexible_crank() -> Machine:
    plane, length = Planar(0.0), machines.FLEXIBLE_CRANK
    crank = plane.body(machines.FLEXIBLE_CRANK_MASS, machines.FLEXIBLE_CRANK_INERTIA, (0.5 * length, 0.0))
    nodes = cable(plane.mbs, machines.FLEXIBLE_ROD, 0.0)
    start, end = (plane.mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[k])) for k in (0, -1))
    plane.pin(plane.point(plane.ground_body, (0.0, 0.0)), plane.point(crank, (-0.5 * length, 0.0)))
    plane.pin(plane.point(crank, (0.5 * length, 0.0)), start)
    plane.pin(end, plane.piston(machines.FLEXIBLE_PISTON, machines.FLEXIBLE_ROD.end))
    plane.torque(crank, machines.FLEXIBLE_TORQUE)
    plane.mbs.Assemble()
    read = node_position(plane.mbs, nodes[len(nodes) // 2])
    return Machine(plane.mbs, lambda: read()[:2])


def squeezer() -> Machine:
    plane, numbers = Planar(0.0), machines.squeezer_numbers()
    poses, local = machines.squeezer_poses(numbers), machines.squeezer_points(numbers)
    bodies = [plane.body(m, i, position, angle) for m, i, (position, angle) in zip(numbers["m"], numbers["I"], poses)]
    bodies.append(plane.ground_body)
    for (a, p), (b, r) in machines.SQUEEZER_PINS:
        plane.pin(plane.point(bodies[a], local[a][p]), plane.point(bodies[b], local[b][r]))
    ends = [plane.point(bodies[a], local[a][p]) for a, p in machines.SQUEEZER_SPRING]
    mbs = plane.mbs
    mbs.AddObject(items.ObjectConnectorSpringDamper(
        markerNumbers=ends, stiffness=numbers["spring_c0"], referenceLength=numbers["spring_l0"]))  # fmt: skip
    plane.torque(bodies[0], numbers["motor_torque"])
    return plane.machine(bodies[0], local[0]["F"])


def chain(links: int) -> Machine:
    plane, a = Planar(machines.GRAVITY), machines.LINK
    before = plane.point(plane.ground_body, (0.0, 0.0))
    for k in range(links):
        body = plane.body(1.0, a * a / 12.0, ((k + 0.5) * a, 0.0))
        plane.pin(before, plane.point(body, (-0.5 * a, 0.0)))
        before = plane.point(body, (0.5 * a, 0.0))
    return plane.machine(body, (0.5 * a, 0.0))


def chain_tree(links: int) -> Machine:
    """The chain in relative coordinates: a kinematic tree, for the explicit solvers."""
    mbs, a = empty(), machines.LINK
    zero = [0.0] * links
    node = mbs.AddNode(items.NodeGenericODE2(
        numberOfODE2Coordinates=links, referenceCoordinates=zero, initialCoordinates=zero, initialCoordinates_t=zero))  # fmt: skip
    inertia = a * a / 12.0
    tree = mbs.AddObject(items.ObjectKinematicTree(
        nodeNumber=node, gravity=[0.0, -machines.GRAVITY, 0.0], jointTypes=[exu.JointType.RevoluteZ] * links,
        linkParents=list(range(-1, links - 1)), jointTransformations=exu.Matrix3DList([np.eye(3)] * links),
        jointOffsets=exu.Vector3DList([[0.0, 0.0, 0.0]] + [[a, 0.0, 0.0]] * (links - 1)), linkMasses=[1.0] * links,
        linkInertiasCOM=exu.Matrix3DList([np.diag([0.0, inertia, inertia])] * links),
        linkCOMs=exu.Vector3DList([[0.5 * a, 0.0, 0.0]] * links)))  # fmt: skip
    mbs.Assemble()
    tip = mbs.AddSensor(items.SensorKinematicTree(
        objectNumber=tree, linkNumber=links - 1, localPosition=[a, 0.0, 0.0], writeToFile=False, storeInternal=False,
        outputVariableType=Out.Position))  # fmt: skip
    mbs.Assemble()
    return Machine(mbs, lambda: np.array(mbs.GetSensorValues(tip))[:2])


def heavy_top() -> Machine:
    """Euler parameters and a spherical joint."""
    mbs = empty()
    ep = RotationMatrix2EulerParameters(np.eye(3))
    spin, centre = np.array(machines.TOP_SPIN), np.array(machines.TOP_CENTRE)
    ep_t = AngularVelocity2EulerParameters_t(spin, ep)
    node = mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*centre, *ep], initialVelocities=[*np.cross(spin, centre), *ep_t]))
    body = mbs.AddObject(items.ObjectRigidBody(physicsMass=machines.TOP_MASS, physicsInertia=[*machines.TOP_INERTIA, 0, 0, 0], nodeNumber=node))
    middle = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0, 0, 0]))
    tip = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[*(-centre)]))
    origin = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=mbs.AddObject(items.ObjectGround()), localPosition=[0, 0, 0]))
    mbs.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[0, 0, -machines.TOP_MASS * machines.GRAVITY]))
    mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[origin, tip]))
    mbs.Assemble()
    return Machine(mbs, node_position(mbs, node))
