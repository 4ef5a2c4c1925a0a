"""Magnitudes that hint at a slip of units: millimetres for metres, gigapascals for pascals, degrees for radians.

Any consistent set of units is right, so most rules compare numbers of a scene with each other: a section's moment with its area, a beam's
thickness with its length, the stretch under its own weight. Where gravity is that of the Earth it tells the unit of length, and rules may
know what matter is like; where numbers are those of steel or aluminium, whether their powers of ten go together. Hints are no errors: each
rule leaves room for what is merely unusual.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .scene import Scene

SECTIONS = (1e-6, 100.0)
"""I / A^2: 0.08 of a solid square or disc; from flat strips to thin tubes."""

SLENDER = 1e5
"""Length over thickness: of a fibre of 10 um and 1 m."""

SOUND = (1.0, 3e4)
"""Speeds of sound [m/s]: slower than in jelly, faster than in diamond."""

DENSITIES = (1e-3, 1e7)
"""Mass over the cube of the radius of gyration [kg/m^3]: 1e5 of a solid cube of steel, far less of frames and rods."""

FAR, THREAD = 200.0, 0.05
"""A scene longer than this [m] that weighs less than this a metre [kg/m] is likely described in millimetres."""

TIP_SPEED = 700.0
"""[m/s]; rotors burst near it."""

MASSES, GYRATION, STRETCH, SAG, FULL_SAG = 1e9, 1e3, 1.0, 100.0, 3.0
"""Ratios: of masses; of a radius of gyration to the scene; of the stretch by its own weight to a beam; of a spring's static extension to the
scene, where joints may carry the weight and where nothing else does."""

STEPS = 4.0
"""The fewest steps to a period."""

EARTH = (9.7, 9.9)


class System(NamedTuple):
    """A consistent set of units: by what SI's numbers of elastic moduli, densities and accelerations are multiplied."""

    modulus: float
    density: float
    gravity: float


SYSTEMS = {
    "m, kg, s": System(1.0, 1.0, 1.0),
    "mm, t, s": System(1e-6, 1e-12, 1e3),
    "mm, kg, s": System(1e-3, 1e-9, 1e3),
    "mm, kg, ms": System(1e-9, 1e-9, 1e-3),
    "cm, g, s": System(10.0, 1e-3, 1e2),
}
MATERIALS = {"steel": ((1.9e11, 2.15e11), (7.7e3, 8.05e3)), "aluminium": ((6.8e10, 7.4e10), (2.65e3, 2.85e3))}


@dataclass(frozen=True)
class Hint:
    """A magnitude worth a second look: the item, what was found, what is usual, and how to mend it if it is a slip."""

    item: str
    found: str
    usual: str
    mend: str

    def __str__(self) -> str:
        return f"{self.item!r}: {self.found}, where {self.usual}; {self.mend}"


class Look:
    """What rules look at: the items of a scene, its size, and the unit of length where gravity tells it."""

    def __init__(self, scene: Scene, step: float | None):
        self.scene, self.step = scene, step
        self.q, self.v = scene.layout.start()
        self.descriptions = [(item.name, item.description) for item in scene.items]
        self.gravity = float(np.linalg.norm(scene.gravity))
        self.metre = next((unit for unit in (1.0, 1e3, 1e2) if EARTH[0] * unit < self.gravity < EARTH[1] * unit or self.gravity == 10.0 * unit), None)
        self.beams = [(name, d) for name, d in self.descriptions if all(hasattr(d, word) for word in ("E", "A", "I", "rho"))]
        self.bodies = [(name, d) for name, d in self.descriptions if hasattr(d, "mass") and hasattr(d, "inertia") and d.mass > 0.0]
        self.masses = {name: float(d.mass) for name, d in self.descriptions if hasattr(d, "mass") and d.mass > 0.0}
        self.masses |= {name: float(d.rho * d.A) * self.length(name) for name, d in self.beams}
        self.extent = self._extent()

    def length(self, name: str) -> float:
        """Of a beam."""
        return float(np.sum(self.scene[name].lengths))

    def _extent(self) -> float:
        """The diagonal of the box around everything that is somewhere."""
        places = [marker.point.value(self.q) for _, d in self.descriptions for marker in getattr(d, "markers", ())]
        places += [d.position for _, d in self.descriptions if isinstance(getattr(d, "position", None), np.ndarray) and hasattr(d, "mass")]
        places += [end.point.value(self.q) for name, _ in self.beams for end in (self.scene[name].start, self.scene[name].end)]
        return float(np.linalg.norm(np.ptp(np.array(places), axis=0))) if places else 0.0

    def arm(self, name: str) -> float:
        """How far a body reaches from its mass centre: its markers, or its radius of gyration."""
        centre = self.scene[name].at().point.value(self.q)
        ends = [m.point.value(self.q) for _, d in self.descriptions for m in getattr(d, "markers", ()) if m.item == name]
        return max([float(np.linalg.norm(end - centre)) for end in ends], default=gyration(self.scene[name].description))


def hints(scene: Scene, step: float | None = None) -> tuple[Hint, ...]:
    """All hints about a scene that can be built, and about a fixed step [s] to run it with."""
    look = Look(scene, step)
    return tuple(hint for rule in RULES for hint in rule(look))


def gyration(body: Any) -> float:
    """The radius of gyration [m]."""
    inertia = np.asarray(body.inertia)
    moment = float(inertia if inertia.ndim == 0 else np.max(inertia) if inertia.ndim == 1 else np.linalg.eigvalsh(inertia)[-1])
    return float(np.sqrt(moment / float(body.mass))) if body.mass > 0.0 else 0.0


def sections(look: Look) -> Iterator[Hint]:
    for name, d in look.beams:
        ratio = float(d.I / d.A**2)
        if not SECTIONS[0] < ratio < SECTIONS[1]:
            usual = f"solid sections have about 0.1 and strips and tubes {SECTIONS[0]:g} to {SECTIONS[1]:g}"
            yield Hint(name, f"I / A^2 = {ratio:.2g}", usual, f"give A = {float(d.A):g} and I = {float(d.I):g} in one unit of length")


def thicknesses(look: Look) -> Iterator[Hint]:
    for name, d in look.beams:
        thickness, length = float(np.sqrt(12.0 * d.I / d.A)), look.length(name)
        if thickness > length:
            found = f"a thickness of about {thickness:.3g} (from I / A) and a length of {length:.3g}"
            yield Hint(name, found, "beams are longer than thick", "give lengths, A and I in one unit of length, or use a rigid body")
        elif length > SLENDER * thickness:
            found = f"a length of {length / thickness:.2g} thicknesses (from I / A)"
            yield Hint(name, found, f"even fibres have less than {SLENDER:g}", "give lengths, A and I in one unit of length")


def stiffnesses(look: Look) -> Iterator[Hint]:
    """Of each beam one hint at most."""
    for name, d in look.beams:
        found = _material(look, name, d) or _stretch(look, name, d) or _sound(look, name, d)
        if found:
            yield found


def _material(look: Look, name: str, d: Any) -> Hint | None:
    """Digits of a known material whose powers of ten belong to different units."""
    for material, (moduli, densities) in MATERIALS.items():
        if not (_digits(float(d.E), moduli) and _digits(float(d.rho), densities)):
            continue
        fits = [unit for unit in SYSTEMS.values() if _within(d.E / unit.modulus, moduli) and _within(d.rho / unit.density, densities)]
        earthly = _digits(look.gravity, EARTH)
        if fits and (not earthly or any(_within(look.gravity / unit.gravity, EARTH) for unit in fits)):
            continue
        usual = f"{material} has E = {moduli[0]:.2g}, rho = {densities[0]:.2g} in m, kg, s with gravity 9.81, and "
        usual += f"E = {moduli[0] * 1e-6:.2g}, rho = {densities[0] * 1e-12:.2g} in mm, t, s with gravity 9810"
        gravity = f", gravity = {look.gravity:g}" if earthly else ""
        return Hint(name, f"E = {float(d.E):g}, rho = {float(d.rho):g}{gravity}", usual, "give all numbers in one set of units")
    return None


def _stretch(look: Look, name: str, d: Any) -> Hint | None:
    stretch = look.gravity * float(d.rho / d.E) * look.length(name)
    if stretch < STRETCH:
        return None
    found = f"hung up, it would stretch by {0.5 * stretch:.2g} of its length under its own weight"
    return Hint(name, found, "a metre of rubber stretches by 0.01", f"check E = {float(d.E):g} (pascals?) and rho = {float(d.rho):g}")


def _sound(look: Look, name: str, d: Any) -> Hint | None:
    speed = float(np.sqrt(d.E / d.rho)) / (look.metre or np.nan)
    if not (speed < SOUND[0] or speed > SOUND[1]):
        return None
    usual = f"matter has {SOUND[0]:g} to {SOUND[1]:g} m/s (gravity = {look.gravity:g} tells the unit of length)"
    return Hint(name, f"sound travels at sqrt(E / rho) = {speed:.2g} m/s", usual, f"check E = {float(d.E):g} and rho = {float(d.rho):g}")


def inertias(look: Look) -> Iterator[Hint]:
    for name, d in look.bodies:
        if not (radius := gyration(d)):
            continue
        density = float(d.mass) / radius**3
        if look.extent and radius > GYRATION * look.extent:
            found = f"a radius of gyration sqrt(inertia / mass) = {radius:.3g} in a scene of size {look.extent:.3g}"
            yield Hint(name, found, "bodies are not much larger than their scene", "give inertia in mass times length squared of the scene's units")
        elif look.metre == 1.0 and not DENSITIES[0] < density < DENSITIES[1]:
            usual = f"bodies have {DENSITIES[0]:g} to {DENSITIES[1]:g}"
            yield Hint(name, f"mass / radius of gyration^3 = {density:.2g} kg/m^3", usual, "give lengths in metres, mass in kg, inertia in kg m^2")


def distances(look: Look) -> Iterator[Hint]:
    weight = sum(look.masses.values())
    if look.metre == 1.0 and look.extent > FAR and weight < THREAD * look.extent:
        found = f"the scene is {look.extent:.4g} m long and weighs {weight:.3g} kg"
        usual = f"gravity = {look.gravity:g} goes with metres"
        yield Hint(next(iter(look.masses)), found, usual, "give positions in metres, or gravity in the unit of length of the positions (mm: 9810)")


def masses(look: Look) -> Iterator[Hint]:
    if look.masses and max(look.masses.values()) > MASSES * min(look.masses.values()):
        light, heavy = min(look.masses, key=look.masses.__getitem__), max(look.masses, key=look.masses.__getitem__)
        found = f"a mass of {look.masses[light]:.3g} beside {look.masses[heavy]:.3g} of {heavy!r}"
        yield Hint(light, found, f"masses of one scene differ by less than {MASSES:g}", "check units of mass, density and area")


def springs(look: Look) -> Iterator[Hint]:
    held = {marker.item for name, d in look.descriptions for marker in getattr(d, "markers", ()) if hasattr(look.scene[name], "pose")}
    for name, d in look.descriptions:
        loads = [marker.item for marker in getattr(d, "markers", ()) if marker.item in look.masses] if d.kind == "spring" else []
        if not loads or not float(d.stiffness) or not look.extent:
            continue
        sag = look.gravity * min(look.masses[item] for item in loads) / float(d.stiffness)
        alone = not any(item in held for item in loads)
        if sag > (FULL_SAG if alone else SAG) * look.extent:
            found = f"the weight of {loads[0]!r} would stretch it by {sag:.3g} in a scene of size {look.extent:.3g}"
            yield Hint(name, found, "springs carry their load within the scene", f"check stiffness = {float(d.stiffness):g} (N/m, not N/mm)")


def turns(look: Look) -> Iterator[Hint]:
    for name, d in look.bodies:
        angle = 0.0 if getattr(d, "angle", None) is None else float(d.angle)
        if abs(angle) > 2.0 * np.pi and angle % 5.0 == 0.0:
            yield Hint(name, f"angle = {angle:g} rad", "a full turn is 6.28 rad", "give radians: numpy.deg2rad(...)")
        spin = 0.0 if d.angular_velocity is None else float(np.linalg.norm(d.angular_velocity))
        yield from _spinning(look, name, spin)
    for name, d in look.descriptions:
        speed = getattr(d, "speed", None)
        bodies = [m.item for m in getattr(d, "markers", ()) if m.item in dict(look.bodies)]
        if d.kind == "motor" and bodies and speed is not None and not callable(speed):
            yield from _spinning(look, bodies[0], abs(float(speed)), f" by {name!r}")


def _spinning(look: Look, name: str, spin: float, why: str = "") -> Iterator[Hint]:
    if look.metre and spin * look.arm(name) / look.metre > TIP_SPEED:
        found = f"spun{why} at {spin:g} rad/s it moves at {spin * look.arm(name) / look.metre:.3g} m/s"
        yield Hint(name, found, f"rotors burst near {TIP_SPEED:g} m/s", "give rad/s: revolutions a minute times 2 pi / 60, degrees times pi / 180")


def steps(look: Look) -> Iterator[Hint]:
    periods = dict(_periods(look)) if look.step is not None else {}
    if periods and look.step is not None and look.step * STEPS > min(periods.values()):
        name = min(periods, key=periods.__getitem__)
        found = f"a step of {look.step:g} for a period of {periods[name]:.3g}"
        yield Hint(name, found, f"{STEPS:g} steps and more to a period resolve it", "take a smaller step, or an adaptive solver (step=None)")


def _periods(look: Look) -> Iterator[tuple[str, float]]:
    """Of turning, of springs with the masses at their ends, of a pendulum as long as the scene: not of beams, whose fastest need not matter."""
    for name, d in look.bodies:
        if d.angular_velocity is not None and np.any(d.angular_velocity):
            yield name, 2.0 * np.pi / float(np.linalg.norm(d.angular_velocity))
    for name, d in look.descriptions:
        ends = [look.masses[marker.item] for marker in getattr(d, "markers", ()) if marker.item in look.masses]
        if d.kind == "spring" and ends and float(d.stiffness):
            yield name, 2.0 * np.pi * float(np.sqrt(min(ends) / float(d.stiffness)))
    if look.gravity and look.extent and look.masses:
        yield next(iter(look.masses)), 2.0 * np.pi * float(np.sqrt(look.extent / look.gravity))


def _within(x: Any, limits: tuple[float, float]) -> bool:
    return bool(limits[0] * (1 - 1e-9) <= x <= limits[1] * (1 + 1e-9))


def _digits(x: float, limits: tuple[float, float]) -> bool:
    """Whether x is within limits but for a power of ten."""
    low, high = np.log10(limits) % 1.0
    place = float(np.log10(x)) % 1.0 if x > 0.0 else np.nan
    return bool(low - 1e-9 <= place <= high + 1e-9 if low <= high else place >= low - 1e-9 or place <= high + 1e-9)


RULES = (sections, thicknesses, stiffnesses, inertias, distances, masses, springs, turns, steps)
