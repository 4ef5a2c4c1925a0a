"""The kinds that the parametrised tests go through, each built in small scenes, beside its formula. A new kind joins with one line in ELASTIC."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

import mbd
from mbd.derivations import beam_laws, laws

from . import symbolic
from .symbolic import Term, gauss, hermite

ZERO = {2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}
POINTS = 3  # Gauss points of continuum cables: the fewest allowed keep the symbolic sums short


def rotation(rng: np.random.Generator, d: int) -> np.ndarray:
    """A random rotation matrix [d, d]."""
    matrix, _ = np.linalg.qr(rng.standard_normal((d, d)))
    matrix[:, 0] *= np.linalg.det(matrix)
    return matrix


def dense(rows: np.ndarray, cols: np.ndarray, values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    out = np.zeros(shape)
    np.add.at(out, (rows, cols), values)
    return out


def derivative(f: Callable[[np.ndarray], np.ndarray], x: np.ndarray, dx: np.ndarray, h: float = 5e-4) -> np.ndarray:
    """d f(x + h dx)/dh at h = 0 by central differences of order 6: error 1e-22 of the seventh derivative, rounding eps / h = 4e-13."""
    weights = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))
    return sum(w * (f(x + k * h * dx) - f(x - k * h * dx)) for k, w in weights) / h


def moved(system: Any, scene: Any, q: np.ndarray, turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """The whole scene rotated about the origin, then shifted: positions move, slopes and directors only turn."""
    d, rows = scene.dimension, scene.layout.n_rows
    out, table = q.copy(), q[: d * rows].reshape(rows, d) @ turn.T
    table[[label.endswith(("position", "mass centre")) for label in scene.layout.row_labels()]] += shift
    out[: d * rows] = table.ravel()
    return out


# What can be attached to: one marker of an item placed so that the marker lies at ``point``, the item's frame being ``frame`` [d, d].

ARM = {2: (0.3, -0.2), 3: (0.3, -0.2, 0.5)}
FRACTION = 0.3  # of a cable of two elements: inside the first, at 0.6 of it
# Too soft to disturb what is attached to it.
CABLE = {"n_elements": 2, "E": 1e-300, "A": 0.4, "I": 0.01, "rho": 2.0}


def body(scene: Any, point: np.ndarray, frame: np.ndarray, name: str) -> Any:
    d = len(point)
    arm = np.array(ARM[d])
    pose = {"angle": np.arctan2(frame[1, 0], frame[0, 0]), "inertia": 0.3} if d == 2 else {"rotation": frame, "inertia": (0.3, 0.4, 0.5)}
    return scene.add(mbd.RigidBody(mass=1.5, position=point - frame @ arm, name=name, **pose)).at(*arm)


def node(scene: Any, point: np.ndarray, frame: np.ndarray, name: str) -> Any:
    return scene.add(mbd.AncfCable(point - frame[:, 0], point, name=name, **CABLE)).end


def span(scene: Any, point: np.ndarray, frame: np.ndarray, name: str) -> Any:
    return scene.add(mbd.AncfCable(point - FRACTION * frame[:, 0], point + (1 - FRACTION) * frame[:, 0], name=name, **CABLE)).at(FRACTION)


def particle(scene: Any, point: np.ndarray, frame: np.ndarray, name: str) -> Any:
    return scene.add(mbd.Particle(0.7, point, name=name)).at()


def ground(scene: Any, point: np.ndarray, frame: np.ndarray, name: str) -> Any:
    return scene.ground.at(*point)


MARKERS = {f.__name__: f for f in (body, node, span, particle, ground)}


def point_map(kind: str, marker: Any, q0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[d, n] and [d]: the marker's point as an affine map of q, from the definitions of bodies and cables."""
    scene, d = marker.scene, marker.dimension
    matrix, eye = np.zeros((d, len(q0))), np.eye(d)
    if kind == "ground":
        return matrix, marker.point.constant
    item = scene[marker.item]
    rows = np.atleast_1d(item.row if kind == "particle" else item.rows).ravel()
    blocks = [eye]
    if kind == "body":
        arm = ARM[d]
        blocks += [np.array([[arm[0], -arm[1]], [arm[1], arm[0]]])] if d == 2 else [a * eye for a in arm]
    elif kind in ("node", "span"):
        x = 0.6 * item.lengths[0] if kind == "span" else item.lengths[1]
        rows = rows[:4] if kind == "span" else rows[2:6]
        blocks = [float(n) * eye for n in hermite(0, x, item.lengths[0])]
    for row, block in zip(rows, blocks):
        matrix[:, d * row : d * row + d] = block
    return matrix, np.zeros(d)


# Elastic kinds: ``add(scene, k, damping)`` puts the k-th item, with numbers of its own, into the scene, and ``terms(item, q0)`` is its energy.


class Elastic(NamedTuple):
    name: str
    dimension: int
    add: Callable[[Any, int, float], Any]
    terms: Callable[[Any, np.ndarray], list[Term]]
    stress_free: bool = True
    free: bool = True  # not held to the ground

    def scene(self, items: Sequence[int] = (0, 1), damping: float = 0.0) -> tuple[Any, Any, list[Any]]:
        """A scene of these items without gravity, its system, and the items."""
        scene = mbd.Scene(gravity=ZERO[self.dimension])
        added = [self.add(scene, k, damping) for k in items]
        return scene, scene.build(), added

    def state(self, rng: np.random.Generator, system: Any) -> tuple[np.ndarray, np.ndarray]:
        """Far from rest: strains of the order of 0.3, no element folded."""
        return system.q0 + 0.15 * rng.standard_normal(system.n), rng.standard_normal(system.n)


def _numbers(k: int, damping: float) -> dict[str, float]:
    return {"E": 10.0 + k, "A": 0.2 + 0.1 * k, "I": 0.03 - 0.01 * k, "rho": 2.0 + k, "damping": damping * (1 + k)}


def _straight(d: int, elasticity: str) -> Callable[[Any, int, float], Any]:
    def add(scene: Any, k: int, damping: float) -> Any:
        start = np.array([0.5 * k, 1.0, -0.3 * k])[:d]
        end = start + np.array([1.3, 0.4 - k, 0.7])[:d]
        words = {"n_elements": 2, "gauss_points": POINTS, "elasticity": elasticity, "name": f"item {k}"}
        return scene.add(mbd.AncfCable(start, end, **words, **_numbers(k, damping)))

    return add


def _curved(scene: Any, k: int, damping: float) -> Any:
    angles = np.array([0.0, 0.5, 1.2]) + 0.2 * k
    nodes = np.stack((np.cos(angles), np.sin(angles) + k), axis=1)
    tangents = np.stack((-np.sin(angles), np.cos(angles)), axis=1)
    return scene.add(mbd.AncfCable(nodes=nodes, tangents=tangents, gauss_points=POINTS, name=f"item {k}", **_numbers(k, damping)))


def _spring(d: int, ends: tuple[str, str], length: float | None) -> Callable[[Any, int, float], Any]:
    def add(scene: Any, k: int, damping: float) -> Any:
        rng = np.random.default_rng(k)
        first = rng.standard_normal(d)
        second = first if length == 0.0 else first + rng.standard_normal(d)
        a, b = (MARKERS[e](scene, p, rotation(rng, d), f"{e} {side} {k}") for e, p, side in zip(ends, (first, second), "ab"))
        item = scene.add(mbd.Spring(a, b, stiffness=3.0 + k, damping=damping * (2 + k), length=length, name=f"item {k}"))
        item.ends = ends  # what the formula needs to know
        return item

    return add


def _torsion(angle: float) -> Callable[[Any, int, float], Any]:
    def add(scene: Any, k: int, damping: float) -> Any:
        rng = np.random.default_rng(k)
        a, b = (MARKERS[e](scene, rng.standard_normal(2), rotation(rng, 2), f"{e} {k}") for e in ("body", "span"))
        return scene.add(mbd.TorsionSpring(a, b, stiffness=3.0 + k, damping=damping * (2 + k), angle=angle, name=f"item {k}"))

    return add


def _elements(item: Any) -> Any:
    """The rows [4] of the table and the length of every element, and the numbers of the cable."""
    c = item.description
    tau, ea, ei = float(c.damping), float(c.E * c.A), float(c.E * c.I)
    for e, length in enumerate(item.lengths):
        yield [*item.rows[e], *item.rows[e + 1]], length, (ea, ei, tau)


def _derivatives(rows: Sequence[int], shapes: Sequence[Any], d: int, n: int) -> list[list[Any]]:
    """[d, n]: a derivative of r at a point."""
    matrix = [[0] * n for _ in range(d)]
    for row, shape in zip(rows, shapes):
        for i in range(d):
            matrix[i][d * row + i] = shape
    return matrix


def cable_terms(item: Any, q0: np.ndarray) -> list[Term]:
    """The start shape is the rest shape; one term for each Gauss point."""
    d, n, terms = item.rest.shape[-1], len(q0), []
    with symbolic.mpmath.workdps(symbolic.DIGITS):
        for rows, length, numbers in _elements(item):
            for xi, weight in gauss(POINTS):
                matrices = [_derivatives(rows, hermite(k, xi * length, length), d, n) for k in (1, 2)]
                if d == 3:
                    terms.append(Term(laws.continuum(3), matrices[0] + matrices[1], [0] * 6, (*numbers, weight * length, 1, 0)))
                    continue
                q = symbolic.mpmath.matrix(q0.tolist())
                x, y = (symbolic.mpmath.matrix(m) * q for m in matrices)
                rest = symbolic.mpmath.sqrt(x[0] ** 2 + x[1] ** 2)
                kappa = (x[0] * y[1] - x[1] * y[0]) / rest**3
                terms.append(Term(laws.continuum(2), matrices[0] + matrices[1], [0] * 4, (*numbers, weight * length * rest, rest, kappa)))
    return terms


def local_frame_terms(item: Any, q0: np.ndarray) -> list[Term]:
    terms = []
    for rows, length, numbers in _elements(item):
        parts = [_derivatives(rows, shapes, 2, len(q0)) for shapes in ((-1, 0, 1, 0), (0, 1, 0, 0), (0, 0, 0, 1))]
        terms.append(Term(laws.chord_frame(), parts[0] + parts[1] + parts[2], [0] * 6, (*numbers, length)))
    return terms


def _beam(name: str, **words: str) -> Callable[[Any, int, float], Any]:
    def add(scene: Any, k: int, damping: float) -> Any:
        start = np.array([0.5 * k, 1.0])
        return scene.add(getattr(mbd, name)(start, start + (1.3, 0.4 - k), n_elements=2, name=f"item {k}", **words, **_numbers(k, damping)))

    return add


def corotational_terms(item: Any, q0: np.ndarray) -> list[Term]:
    terms = []
    for rows, length, numbers in _elements(item):
        parts = [_derivatives(rows, shapes, 2, len(q0)) for shapes in ((-1, 0, 1, 0), (0, 1, 0, 0), (0, 0, 0, 1))]
        terms.append(Term(beam_laws.corotational(), parts[0] + parts[1] + parts[2], [0] * 6, (*numbers, length)))
    return terms


def geometrically_exact_terms(item: Any, q0: np.ndarray) -> list[Term]:
    """Quadratic elements through nodes at 0, 1/2, 1; two Gauss points."""
    b, terms, n = item.description, [], len(q0)
    ea, ei = float(b.E * b.A), float(b.E * b.I)
    with symbolic.mpmath.workdps(symbolic.DIGITS):
        for e, length in enumerate(item.lengths):
            rows = item.rows[2 * e : 2 * e + 3]
            for x, weight in gauss(2):
                values = (1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)
                slopes = [m / length for m in (4 * x - 3, 4 - 8 * x, 4 * x - 1)]
                matrix = _derivatives(rows[:, 0], slopes, 2, n)
                matrix += [line for k in range(3) for line in _derivatives(rows[k, 1:], [1], 2, n)]
                numbers = (ea, 5 * ea / (6 * 2.6), ei, float(b.damping), weight * length, *values, *slopes)
                terms.append(Term(beam_laws.geometrically_exact(), matrix, [0] * 8, numbers))
    return terms


def floating_frame_terms(item: Any, q0: np.ndarray) -> list[Term]:
    """Modes of two cubic elements, clamped and free, normalised to int w^2 = 1/4, from the matrices as textbooks print them."""
    b, length = item.description, 0.5
    scale = np.diag([1.0, length, 1.0, length])
    mass = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * length / 420
    bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / length**3
    whole = np.zeros((2, 6, 6))
    for e in range(2):
        whole[:, 2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += scale @ np.stack((mass, bend)) @ scale
    values = np.sort(np.linalg.eigvals(np.linalg.solve(whole[0, 2:, 2:], whole[1, 2:, 2:])).real)
    terms = []
    for row, value in zip(item.modal, values):
        matrix = [line for r in (item.frame[1], row) for line in _derivatives([r], [1], 2, len(q0))]
        terms.append(Term(beam_laws.deflection(), matrix, [0] * 4, (float(b.E * b.I) / item.length**3 * value / 4, float(b.damping))))
    return terms


def _gains(spring: Any) -> tuple[float, float]:
    """(stiffness, damping)."""
    return float(spring.stiffness), float(spring.damping)


def _apart(item: Any, q0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    (a, constant_a), (b, constant_b) = (point_map(e, m, q0) for e, m in zip(item.ends, item.description.markers))
    return a - b, constant_a - constant_b


def spring_terms(item: Any, q0: np.ndarray) -> list[Term]:
    matrix, constant = _apart(item, q0)
    length = item.description.length
    rest = np.linalg.norm(matrix @ q0 + constant) if length is None else float(length)
    return [Term(laws.stretch(len(matrix)), matrix.tolist(), constant.tolist(), (*_gains(item.description), rest))]


def offset_terms(item: Any, q0: np.ndarray) -> list[Term]:
    matrix, constant = _apart(item, q0)
    return [Term(laws.offset(len(matrix)), matrix.tolist(), constant.tolist(), _gains(item.description))]


def torsion_terms(item: Any, q0: np.ndarray) -> list[Term]:
    row = np.zeros((1, len(q0)))
    row[0, item.turn] = 1.0
    return [Term(laws.twist(), row.tolist(), [0], (*_gains(item.description), float(item.description.angle)))]


ELASTIC = [
    Elastic("planar cable", 2, _straight(2, "continuum"), cable_terms),
    Elastic("spatial cable", 3, _straight(3, "continuum"), cable_terms),
    Elastic("curved cable", 2, _curved, cable_terms),
    Elastic("local frame cable", 2, _straight(2, "local_frame"), local_frame_terms),
    Elastic("corotational beam", 2, _beam("CorotationalBeam"), corotational_terms),
    Elastic("geometrically exact beam", 2, _beam("GeometricallyExactBeam"), geometrically_exact_terms),
    Elastic("floating frame beam", 2, _beam("FloatingFrameBeam", modes="cantilever"), floating_frame_terms),
    Elastic("planar spring", 2, _spring(2, ("body", "span"), None), spring_terms),
    Elastic("planar spring, stretched", 2, _spring(2, ("particle", "body"), 0.4), spring_terms, stress_free=False),
    Elastic("planar spring to the ground", 2, _spring(2, ("node", "ground"), None), spring_terms, free=False),
    Elastic("spatial spring", 3, _spring(3, ("body", "span"), None), spring_terms),
    Elastic("planar spring of zero length", 2, _spring(2, ("body", "span"), 0.0), offset_terms),
    Elastic("spatial spring of zero length", 3, _spring(3, ("particle", "body"), 0.0), offset_terms),
    Elastic("torsion spring", 2, _torsion(0.0), torsion_terms),
    Elastic("torsion spring, wound", 2, _torsion(0.3), torsion_terms, stress_free=False),
]
