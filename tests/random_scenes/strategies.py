"""Random plans: trees and loops of bodies, particles and beams, joints, springs, measures and loads, most of whose numbers are round.

Round numbers make what is special common: bars in line, equal masses, points that coincide, joints that hold the same twice. Each item that
joins a tree touches one before it at a point; what closes loops is attached wherever it needs not be moved.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st

from .plans import GROUND, Entry, Frame, Heading, Item, Line, Number, Numbers, Plan, Point, Spot, Terms, Vector, Vectors, Wave, World

MASS, LENGTH, SPEED, SPIN, TORQUE, FORCE, STIFF, DASH = (
    (0, 1, 0), (1, 0, 0), (1, 0, -1), (0, 0, -1), (2, 1, -2), (1, 1, -2), (0, 1, -2), (0, 1, -1))  # fmt: skip
PURE = (0, 0, 0)
TWIST, TWIST_DASH = TORQUE, (2, 1, -1)

BEAMS = ("AncfCable", "CorotationalBeam", "GeometricallyExactBeam", "FloatingFrameBeam")

round_numbers = st.integers(-8, 8).map(lambda k: k / 4)
coordinates = st.one_of(round_numbers, round_numbers, st.floats(-2, 2, width=32), st.just(1e-9))
positive = st.sampled_from((1.0, 2.0, 0.5, 3.0, 0.1, 20.0))
few = st.integers(0, 2)


class Thing(NamedTuple):
    """What has been placed: where attachments may be. ``rigid``: anywhere; else at ``spots`` only."""

    name: str
    rigid: bool
    centre: np.ndarray
    frame: np.ndarray
    spots: tuple[Spot, ...] = ()

    def at(self, point: np.ndarray) -> Spot:
        if not self.rigid:
            return min(self.spots, key=lambda spot: float(np.sum((np.array(spot.point) - point) ** 2)))
        return Spot(self.name, tuple((self.frame.T @ (point - self.centre)).tolist()), tuple(point.tolist()), 2)


def ground(d: int) -> Thing:
    return Thing(GROUND, True, np.zeros(d), np.eye(d))


def tuples(draw: Any, what: Any, count: int) -> tuple[float, ...]:
    return tuple(float(draw(what)) for _ in range(count))


def points(draw: Any, d: int) -> np.ndarray:
    return np.array(tuples(draw, coordinates, d))


def unit(draw: Any, d: int) -> np.ndarray:
    v = np.array(draw(st.tuples(*[st.integers(-2, 2)] * d).filter(any)), dtype=float)
    return v / np.linalg.norm(v)


def frames(draw: Any, d: int) -> np.ndarray:
    """A rotation matrix, often of quarter turns."""
    if d == 2:
        angle = draw(st.one_of(st.integers(0, 3).map(lambda k: k * np.pi / 2), st.floats(-3, 3, width=16)))
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s], [s, c]])
    w, x, y, z = np.array(draw(st.tuples(*[st.integers(-2, 2)] * 4).filter(any)), dtype=float)
    q = np.array([[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                  [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                  [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]])  # fmt: skip
    return q / (w * w + x * x + y * y + z * z)


# What has mass. Each takes draw, the dimension, a name, and the point at which it touches what is there; it returns thing and entry.


def body(draw: Any, d: int, name: str, point: np.ndarray) -> tuple[Thing, Entry]:
    frame, arm, mass, size = frames(draw, d), points(draw, d), draw(positive), draw(st.sampled_from((1.0, 0.5, 0.1, 2.0)))
    centre = point - frame @ arm
    shape = draw(st.sampled_from(((1.0, 1.0, 1.0), (0.5, 1.0, 1.5), (0.0, 1.0, 1.0), (1.0, 1.0, 2.0))))  # of a rod, of a plate too
    inertia: Any = Number(mass * size**2, (2, 1, 0)) if d == 2 else Numbers(tuple(mass * size**2 * x for x in shape), (2, 1, 0))
    words = {"mass": Number(mass, MASS), "inertia": inertia, "position": Point(tuple(centre))}
    words |= {"angle": Heading(float(np.arctan2(frame[1, 0], frame[0, 0])))} if d == 2 else {"rotation": Frame(tuple(map(tuple, frame)))}
    if draw(st.booleans()):
        words["velocity"] = Vector(tuples(draw, coordinates, d), SPEED)
        spin = tuples(draw, coordinates, 1 if d == 2 else 3)
        words["angular_velocity"] = Number(spin[0], SPIN) if d == 2 else Vector(spin, SPIN)
    return Thing(name, True, centre, frame), Entry(name, "RigidBody", words)


def particle(draw: Any, d: int, name: str, point: np.ndarray) -> tuple[Thing, Entry]:
    words = {"mass": Number(draw(positive), MASS), "position": Point(tuple(point)), "velocity": Vector(tuples(draw, coordinates, d), SPEED)}
    return Thing(name, False, point, np.eye(d), (Spot(name, (), tuple(point.tolist()), 0),)), Entry(name, "Particle", words)


def beam(draw: Any, d: int, name: str, point: np.ndarray) -> tuple[Thing, Entry]:
    kinds = ("AncfCable",) if d == 3 else ("AncfCable", *BEAMS)
    kind, along, length = draw(st.sampled_from(kinds)), unit(draw, d), draw(st.sampled_from((1.0, 0.5, 2.0)))
    count, touching = draw(st.integers(1 if kind != "FloatingFrameBeam" else 2, 3)), draw(st.sampled_from((0.0, 0.0, 1.0, 0.5)))
    start = point - touching * length * along
    mass, slender, bend = draw(positive), draw(st.sampled_from((0.03, 0.1, 0.3))), draw(st.sampled_from((1.0, 0.1, 10.0)))
    area = slender**2 * length**2
    stiffness = bend * mass * length**2  # EI / length [nominal], of the order of what gravity asks for
    second = area**2 / 12.0
    words: dict[str, Any] = {
        "start": Point(tuple(start)), "end": Point(tuple(start + length * along)), "n_elements": count, "A": Number(area, (2, 0, 0)),
        "E": Number(stiffness * length / second, (-1, 1, -2)), "I": Number(second, (4, 0, 0)),
        "rho": Number(mass / (area * length), (-3, 1, 0)),
    }  # fmt: skip
    if draw(st.booleans()):
        words["damping"] = Number(draw(st.sampled_from((1e-3, 0.1))), (0, 0, 1))
    if kind == "AncfCable":
        if d == 2 and draw(st.booleans()):
            words["elasticity"] = "local_frame"
        words["gravity"] = draw(st.sampled_from(("consistent", "lumped")))
    if kind == "FloatingFrameBeam":
        words["modes"] = draw(st.sampled_from(("craig_bampton", "cantilever")))
    places = [(s, tuple((start + s * length * along).tolist())) for s in (0.0, 1.0, 0.5)]
    axes = [1, 1, 0 if kind == "GeometricallyExactBeam" else 1]
    spots = tuple(Spot(name, (s,), place, turns) for (s, place), turns in zip(places, axes))
    return Thing(name, False, start, np.column_stack([along] * d), spots), Entry(name, kind, words)


# What holds two spots at one point together; None where it does not fit them.

Maker = Callable[[Any, int, Spot, Spot], tuple[str, dict[str, Any]] | None]


def two(kind: str) -> Maker:
    return lambda draw, d, a, b: (kind, {"a": a, "b": b})


def clamp(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]] | None:
    return ("Clamp", {"a": a, "b": b}) if a.axes and b.axes and (d == 2 or 2 in (a.axes, b.axes)) else None


def pin(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]] | None:
    if d == 2:
        return "Pin", {"a": a, "b": b}
    return ("Pin", {"a": a, "b": b, "axis": Vector(tuple(unit(draw, 3)))}) if a.axes == b.axes == 2 else None


def guided(kind: str) -> Maker:
    def make(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]] | None:
        if b.axes < 2 or (kind != "PointOnLine" and not a.axes) or (kind in ("Cylindrical", "Planar") and (d == 2 or a.axes < 2)):
            return None
        names = ("point", "marker_on_line") if kind == "PointOnLine" else ("a", "b")
        return kind, {names[0]: a, names[1]: b, "normal" if kind == "Planar" else "axis": Line(tuple(unit(draw, d)), b)}

    return make


def universal(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]] | None:
    if d == 2 or not a.axes == b.axes == 2:
        return None
    first = unit(draw, 3)
    second = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
    return "Universal", {"a": a, "b": b, "axes": Vectors((tuple(first), tuple(second / np.linalg.norm(second))))}


TOUCHING: tuple[Maker, ...] = (
    pin, pin, two("Ball"), clamp, guided("Slider"), guided("PointOnLine"), universal, guided("Cylindrical"), guided("Planar"))  # fmt: skip


# What acts between two spots apart.


def distance(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]]:
    return "Distance", {"a": a, "b": b}


def spring(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any]]:
    words = {"a": a, "b": b, "stiffness": Number(draw(st.sampled_from((10.0, 1.0, 1000.0))), STIFF)}
    if draw(st.booleans()):
        words["damping"] = Number(draw(positive), DASH)
    length = draw(st.sampled_from((None, None, 0.0, 1.0)))
    return "Spring", words | ({} if length is None else {"length": Number(length, LENGTH)})


def apart(a: Spot, b: Spot) -> bool:
    return float(np.linalg.norm(np.array(a.point) - b.point)) > 0.05


def measure(draw: Any, d: int, a: Spot, b: Spot) -> tuple[str, dict[str, Any], tuple[int, int, int]] | None:
    """(kind, words, dimensions of its value)."""
    kind = draw(st.sampled_from(("Angle", "Displacement", "Length")))
    if kind == "Angle":
        return (kind, {"a": a, "b": b}, PURE) if d == 2 and a.axes and b.axes else None
    if kind == "Displacement":
        return (kind, {"a": a, "b": b, "axis": Line(tuple(unit(draw, d)), b)}, LENGTH) if b.axes == 2 else None
    return (kind, {"a": a, "b": b}, LENGTH) if apart(a, b) else None


class Assembly:
    """A plan in the making."""

    def __init__(self, draw: Any, d: int):
        self.draw, self.d = draw, d
        self.things, self.entries = [ground(d)], []
        self.measures: list[tuple[str, tuple[int, int, int]]] = []

    def name(self, kind: str) -> str:
        return f"{kind.lower()} {len(self.entries)}"

    def add(self, kind: str, words: dict[str, Any]) -> str:
        name = self.name(kind)
        self.entries.append(Entry(name, kind, words))
        return name

    def somewhere(self, thing: Thing) -> Spot:
        return thing.at(points(self.draw, self.d)) if thing.rigid else self.draw(st.sampled_from(thing.spots))

    def grow(self) -> None:
        """One more thing, held by something before it or free."""
        draw = self.draw
        parent = self.somewhere(draw(st.sampled_from(self.things)))
        touching = draw(st.integers(0, 5)) > 0
        point = np.array(parent.point) if touching else points(draw, self.d)
        thing, entry = draw(st.sampled_from((body, body, beam, particle)))(draw, self.d, f"thing {len(self.entries)}", point)
        self.things.append(thing)
        self.entries.append(entry)
        self.join(thing.at(point), parent, touching)

    def join(self, a: Spot, b: Spot, touching: bool) -> None:
        if a.item == b.item:
            return
        found = None
        if touching:
            found = self.draw(st.sampled_from(TOUCHING))(self.draw, self.d, a, b) or ("Ball", {"a": a, "b": b})
        elif apart(a, b):
            found = self.draw(st.sampled_from((distance, spring)))(self.draw, self.d, a, b)
        if found:
            self.add(*found)

    def close(self) -> None:
        """A loop: two things held together once more."""
        one, other = self.pair()
        a, b = self.somewhere(one), self.somewhere(other)
        if other.rigid and self.draw(st.booleans()):
            self.join(a, other.at(np.array(a.point)), True)
        else:
            self.join(a, b, bool(np.allclose(a.point, b.point)))

    def pair(self) -> tuple[Thing, Thing]:
        """Two different things, the first not the ground."""
        one = self.draw(st.sampled_from(self.things[1:]))
        return one, self.draw(st.sampled_from([thing for thing in self.things if thing is not one]))

    def turn(self) -> None:
        """Something that turns: a motor, a gear, a torsion spring (in the plane, where turns are defined between any two)."""
        one, other = self.pair()
        a, b = self.somewhere(one), self.somewhere(other)
        kind = self.draw(st.sampled_from(("Motor", "TorsionSpring", "Gear")))
        if self.d == 3 or not (a.axes and b.axes):
            return
        words: dict[str, Any] = {"a": a, "b": b}
        if kind == "TorsionSpring":
            words |= {"stiffness": Number(self.draw(positive), TWIST), "damping": Number(self.draw(st.sampled_from((0.0, 0.1))), TWIST_DASH)}
        elif kind == "Gear":
            words |= {"ratio": self.draw(st.sampled_from((-1.0, 2.0, -0.5)))}
        elif self.draw(st.booleans()):
            words |= {"torque": self.wave(self.draw(positive), TORQUE)}
        else:
            words |= self.draw(st.sampled_from(({"speed": Number(1.0, SPIN)}, {"angle": Wave(0.5, 2.0, PURE)})))
        self.add(kind, words)

    def wave(self, amplitude: Any, dims: tuple[int, int, int], inertial: bool = False) -> Any:
        """A constant, or a function of time that may jump."""
        form = self.draw(st.sampled_from(("constant", "sine", "jump")))
        if form == "constant":
            return Number(amplitude, dims) if np.ndim(amplitude) == 0 else (Vector if inertial else Numbers)(tuple(amplitude), dims)
        return Wave(amplitude, 3.0, dims, inertial, jump=0.0625 if form == "jump" else None)

    def load(self) -> None:
        spot = self.somewhere(self.draw(st.sampled_from(self.things[1:])))
        follower = bool(spot.axes) and self.draw(st.booleans())
        if self.d == 2 and spot.axes and self.draw(st.booleans()):
            self.add("Torque", {"marker": spot, "value": self.wave(self.draw(positive), TORQUE), "follower": follower})
        elif self.d == 3 and spot.axes == 2 and self.draw(st.booleans()):
            value = self.wave(tuples(self.draw, round_numbers, 3), TORQUE, not follower)
            self.add("Torque", {"marker": spot, "value": value, "follower": follower})
        elif self.d == 3 and spot.axes == 1 and follower:
            self.add("Force", {"marker": spot, "vector": Numbers((self.draw(positive), 0.0, 0.0), FORCE), "follower": True})
        else:
            vector = self.wave(tuples(self.draw, round_numbers, self.d), FORCE, not follower)
            self.add("Force", {"marker": spot, "vector": vector, "follower": follower})

    def measure(self) -> None:
        one, other = self.pair()
        found = measure(self.draw, self.d, self.somewhere(one), self.somewhere(other))
        if found:
            kind, words, dims = found
            self.measures.append((self.add(kind, words), dims))

    def act(self) -> None:
        """Something on a measure."""
        if not self.measures:
            return
        name, dims = self.draw(st.sampled_from(self.measures))
        push = FORCE if dims == LENGTH else TORQUE
        stiff, dash = ((STIFF, DASH) if dims == LENGTH else (TWIST, TWIST_DASH))
        kind = self.draw(st.sampled_from(("PD", "Stop", "Friction", "Actuator", "Coupling")))
        words: dict[str, Any] = {"measure": Item(name)}
        if kind == "PD":
            words |= {"target": Wave(0.5, 2.0, dims), "proportional": Number(10.0, stiff), "derivative": Number(self.draw(positive), dash)}
        elif kind == "Stop":
            words |= {"upper": Number(self.draw(positive), dims), "stiffness": Number(100.0, stiff), "width": Number(0.1, dims)}
            words |= {"damping": Number(self.draw(st.sampled_from((0.0, 1.0))), dash)}
        elif kind == "Friction":
            words |= {"force": Number(self.draw(positive), push), "speed": Number(0.1, (dims[0], 0, -1))}
        elif kind == "Actuator":
            words |= {"force": self.wave(self.draw(positive), push)} if self.draw(st.booleans()) else {"rate": Wave(0.3, 2.0, (dims[0], 0, -1))}
        else:
            other, dims_other = self.draw(st.sampled_from(self.measures))
            if other == name:
                return
            terms = ((Number(1.0, (-dims[0], 0, 0)), Item(name)), (Number(-2.0, (-dims_other[0], 0, 0)), Item(other)))
            words = {"terms": Terms(terms)}
        self.add(kind, words)

    def slide(self) -> None:
        """A point of a body on a cable."""
        cables = [entry for entry in self.entries if entry.kind == "AncfCable"]
        bodies = [thing for thing in self.things[1:] if thing.rigid]
        if cables and bodies:
            cable = self.draw(st.sampled_from(cables)).name
            thing = next(thing for thing in self.things if thing.name == cable)
            middle = np.array(thing.spots[2].point)
            self.add("BeamSlider", {"point": self.draw(st.sampled_from(bodies)).at(middle), "beam": Item(cable)})


SOLVERS = (
    None, None, ("Radau", {}), ("Radau", {"stages": 3}), ("Radau", {"stages": 7}),
    ("GeneralizedAlpha", {"step": 5e-3}), ("Gauss", {"step": 1e-2}), ("Gauss", {"step": 1e-2, "stages": 3}))  # fmt: skip
EXPLICIT = (*SOLVERS, ("Automatic", {}), ("DormandPrince", {}))
"""Of scenes without beams, whose vibrations would ask for very small steps."""
UNITS = (1.0, 1.0, 1e-3, 1e3, 2.54, 1e6)


@st.composite
def worlds(draw: Any, d: int) -> World:
    shift = points(draw, d) * draw(st.sampled_from((0.0, 1.0, 1e3)))
    return World((draw(st.sampled_from(UNITS)), draw(st.sampled_from(UNITS)), draw(st.sampled_from(UNITS[:5]))), frames(draw, d), shift)


@st.composite
def plans(draw: Any, adaptive: bool = False, most: int = 4) -> Plan:
    """Of up to ``most`` things. ``adaptive``: with the default solver and a tight tolerance, for comparisons."""
    d = draw(st.sampled_from((2, 3)))
    made = Assembly(draw, d)
    for _ in range(draw(st.integers(1, most))):
        made.grow()
    for _ in range(draw(few)):
        made.close()
    for extra in draw(st.lists(st.sampled_from((made.turn, made.load, made.measure, made.act, made.measure, made.act, made.slide)), max_size=5)):
        extra()
    gravity = tuples(draw, st.sampled_from((0.0, -10.0, 3.0)), d)
    watched = tuple(thing.at(thing.centre) if thing.rigid else thing.spots[0] for thing in made.things[1:])
    watched += tuple(spot for thing in made.things[1:] for spot in thing.spots[1:])
    methods = SOLVERS if any(entry.kind in BEAMS for entry in made.entries) else EXPLICIT
    rtol, solver = (1e-8, None) if adaptive else (draw(st.sampled_from((1e-6, 1e-3, 1e-4, 1e-8))), draw(st.sampled_from(methods)))
    return Plan(gravity, tuple(made.entries), watched, draw(st.sampled_from((0.25, 0.1, 0.5))), rtol, solver, draw(worlds(d)))
