"""Every kind and every kernel has a derivation that agrees with its numbers; a wrong sign is found and named."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import mbd
import mbd.elements
import mbd.joints
from mbd.__main__ import main
from mbd.constraint import Quadratic
from mbd.derivations import kernels, subjects
from mbd.derivations.laws import TERMS
from mbd.derivations.load_laws import LOADS
from mbd.derivations.masses import MASSES
from mbd.derivations.record import Record, Underived
from mbd.derivations.specimens import Specimen, kinds, specimens
from mbd.derivations.step import EXACT
from mbd.elements import floating_frame
from mbd.elements.corotational import CorotationalAt
from mbd.elements.floating_frame import DeflectionAt
from mbd.elements.force import FollowerForces
from mbd.elements.force_law import RateLaws
from mbd.elements.friction import Frictions
from mbd.elements.geometrically_exact import GeometricallyExactAt
from mbd.elements.local_frame import LocalFrameAt
from mbd.elements.planar_continuum import PlanarContinuumAt
from mbd.elements.rigid import RigidBody
from mbd.elements.spatial_continuum import SpatialContinuumAt
from mbd.elements.spring_strains import StretchAt
from mbd.elements.torque import DeadTorques, PlanarTorques
from mbd.joints.drives import Couples
from mbd.marker import Marker
from mbd.model import Model
from mbd.rows import coincide, dot
from mbd.slip import Slip
from mbd.turn import Turn


@pytest.mark.parametrize("word", subjects.words())
def test_every_subject_agrees_with_its_kernels(word: str) -> None:
    steps = subjects.steps(word)
    assert steps
    for step in steps:
        worst = step.worst()
        assert worst.difference < EXACT, f"{step.kernel}: {worst}"
        assert step.source and step.kernel.startswith("mbd.") and str(step) and step.latex


def test_sources_number_the_equations_of_the_paper() -> None:
    """1, 3-5, 8-11, 14-18, 24, 25, 27 and 28 of the 1998 paper."""
    sources = " ".join(step.source for word in ("ancf_cable", "local_frame") for step in subjects.steps(word))
    for number in ("eq. 1", "eq. 3", "eq. 4", "eqs. 5, 9, 10", "eq. 8", "eq. 11", "eq. 14-17", "eq. 18", "eq. 24", "eq. 25", "eq. 27", "eq. 28"):
        assert number in sources


# Coverage.


def kernel_classes() -> Iterator[type]:
    """Every class in elements/ and joints/ that a system evaluates: loads have force and inputs, measures an ``at`` whose result pulls."""
    for home in (mbd.elements, mbd.joints):
        for name in {kind.__module__ for kind in vars(home).values() if isinstance(kind, type)}:
            for module in (importlib.import_module(name), *(m for m in vars(importlib.import_module(name)).values() if inspect.ismodule(m))):
                yield from filter(is_kernel, vars(module).values())


def is_kernel(kind: Any) -> bool:
    if not isinstance(kind, type) or not kind.__module__.startswith(("mbd.elements", "mbd.joints")):
        return False
    if hasattr(kind, "force") and hasattr(kind, "inputs"):
        return True
    made = inspect.get_annotations(kind.at).get("return") if inspect.isfunction(getattr(kind, "at", None)) else None
    return hasattr(vars(importlib.import_module(kind.__module__)).get(str(made)), "pull")


def test_every_kernel_has_a_derivation() -> None:
    found = set(kernel_classes())
    assert {"PlanarContinuum", "SpatialContinuum", "LocalFrame", "Stretch", "DeadForces", "Couples"} <= {kind.__name__ for kind in found}
    assert not found - {*TERMS, *LOADS}, "a kernel without a derivation: add one to mbd/derivations/laws.py or load_laws.py"


def test_every_derivation_is_compared_with_its_kernel_and_every_mass_belongs_to_a_kind() -> None:
    compared = {step.kernel for word in subjects.words() for step in subjects.steps(word)}
    for kind in (*TERMS, *LOADS):
        assert f"{kind.__module__}.{kind.__name__}" in compared
    assert set(MASSES) <= set(kinds().values())


def test_every_exported_kind_is_a_subject() -> None:
    assert {subjects.word(name) for name in (*mbd.elements.__all__, *mbd.joints.__all__)} <= set(subjects.words())


class Unknown:
    """A kernel that nobody has derived."""

    def __init__(self, *, points: list[Any], signals: list[Any]):
        self.dofs, self.signals = np.zeros((1, 2), dtype=np.intp), signals
        self.constant_in_q = self.linear_in_q = True

    def inputs(self, times: np.ndarray) -> np.ndarray:
        return np.zeros(1)

    def force(self, q: np.ndarray, inputs: np.ndarray) -> np.ndarray:
        return np.zeros((1, 2))


def test_an_unknown_kernel_is_asked_for_its_derivation(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = mbd.Scene()
    ball = scene.add(mbd.Particle(1.0, (0, 0)))
    scene.add(mbd.Force(ball.at(), lambda t: (t, 1.0)))
    monkeypatch.setattr("mbd.elements.force.DeadForces", Unknown)
    with pytest.raises(Underived, match=r"test_derivations.Unknown has no derivation: add one to mbd/derivations/load_laws.py"):
        list(kernels.acting(scene, Unknown, np.random.default_rng(0)))
    with pytest.raises(Underived, match="Unknown"):
        mbd.equations(scene)


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint that the library does not know, with fields of the usual names."""

    a: Marker
    b: Marker
    axis: Any = field(kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    kind = "hinge"

    @property
    def markers(self) -> tuple[Marker, ...]:
        return (self.a, self.b)

    def faults(self, dimension: int) -> list[str]:
        return [] if dimension == 2 and all(marker.turns() for marker in self.markers) else ["not this one"]

    def place(self, site: Any) -> PlacedHinge:
        return PlacedHinge(self, site)


class PlacedHinge:
    def __init__(self, description: Hinge, site: Any):
        self.description, self.name, self.site = description, site.name, site

    def assemble(self, model: Model) -> None:
        a, b = self.description.markers
        model.equation(self.name, "x", coincide(a.point, b.point)[0])
        model.equation(self.name, "odd", dot(a.axes[0], b.axes[0].scaled(0.2 + 0.4j), 0.1))


def test_a_new_joint_is_covered_by_its_own_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mbd.joints, "Hinge", Hinge, raising=False)
    monkeypatch.setattr(mbd.joints, "__all__", [*mbd.joints.__all__, "Hinge"])
    subjects.steps.cache_clear()
    assert "hinge" in subjects.words()
    steps = [step for step in subjects.steps("hinge") if "still closed" not in step.title]
    assert len(steps) == 5 and all(step.check() < EXACT for step in steps)
    assert [label for step in steps[:1] for label in step.title.split(": ")[1].split(", ")] == ["x", "odd"]


def test_a_joint_of_unusual_fields_is_asked_for_them() -> None:
    @dataclass(frozen=True)
    class Strange:
        whatever: Any

    with pytest.raises(LookupError, match="Strange has no specimen: add its fields to WORDS or VARIANTS"):
        specimens(Strange)


def test_specimens_are_small_scenes_that_hold_their_kind() -> None:
    for kind in kinds().values():
        for specimen in specimens(kind):
            assert isinstance(specimen, Specimen) and any(type(item.description) is kind for item in specimen.scene.items)
            assert specimen.scene.build().n <= 40 and Record(specimen.scene).n == specimen.scene.build().n


# Wrong signs.


def negated(method: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *args, **kwargs: -method(*args, **kwargs)


def nonzero(method: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *args, **kwargs: method(*args, **kwargs) + 1e-9


def without_frame(self: LocalFrameAt, stress: np.ndarray) -> np.ndarray:
    """Eq. 25 without the derivatives of the frame."""
    on_u, on_w = self._nodal(stress)
    return self._along(on_u) + self._across(on_w)


def mirrored(curve: Any) -> Any:
    """Second derivatives as of the conjugate."""

    def wrong(self: Any, stress: np.ndarray) -> Any:
        values = curve(self, stress)
        values[..., 1 : 6 * self.kernel.points : 2] *= -1.0  # before the even part, real and imaginary ones in turn
        return values

    return wrong


WRONG: list[tuple[Any, str, Callable[[Any], Any], str, str, str]] = [
    (LocalFrameAt, "pull", lambda _: without_frame, "local_frame", "mbd.elements.local_frame.LocalFrameAt.pull", "eq. 25"),
    (LocalFrameAt, "_curve", negated, "local_frame", "mbd.elements.local_frame.LocalFrameAt.stiffness", "dQ/de"),
    (SpatialContinuumAt, "_curve", negated, "continuum", "mbd.elements.spatial_continuum.SpatialContinuum", "swirl_times"),
    (SpatialContinuumAt, "swirl_times", negated, "continuum", "mbd.elements.spatial_continuum.SpatialContinuum", "swirl_times"),
    (PlanarContinuumAt, "_curve", mirrored, "continuum", "mbd.elements.planar_continuum.PlanarContinuum", "stiffness"),
    (PlanarContinuumAt, "swirl_times", negated, "continuum", "mbd.elements.planar_continuum.PlanarContinuum", "swirl_times"),
    (CorotationalAt, "curve", negated, "corotational_beam", "mbd.elements.corotational.Corotational", "swirl_times"),
    (GeometricallyExactAt, "curve", negated, "geometrically_exact_beam", "mbd.elements.geometrically_exact.GeometricallyExact", "swirl_times"),
    (DeflectionAt, "curve", negated, "floating_frame_beam", "mbd.elements.floating_frame.Deflection", "swirl_times"),
    (StretchAt, "_across", negated, "spring", "mbd.elements.spring_strains.Stretch", "stiffness"),
    (RigidBody, "director_mass", negated, "rigid_body", "mbd.elements.rigid.RigidBody.director_mass", "M"),
    (FollowerForces, "gradient", negated, "force", "mbd.elements.force.FollowerForces", "gradient"),
    (DeadTorques, "gradient", negated, "torque", "mbd.elements.torque.DeadTorques", "gradient"),
    (PlanarTorques, "force", negated, "torque", "mbd.elements.torque.PlanarTorques", "force"),
    (Couples, "force", negated, "motor", "mbd.joints.drives.Couples", "force"),
    (Frictions, "force", negated, "friction", "mbd.elements.friction.Frictions", "force"),
    (Frictions, "rate_gradient", negated, "friction", "mbd.elements.friction.Frictions", "rate gradient"),
    (RateLaws, "gradient", negated, "force_law", "mbd.elements.force_law.RateLaws", "gradient"),
    (RateLaws, "rate_gradient", negated, "force_law", "mbd.elements.force_law.RateLaws", "rate gradient"),
    (Slip, "value", nonzero, "knife_edge", "mbd.joints.knife_edge.KnifeEdge.slips", "Slip.value"),
    (Slip, "gradient", negated, "knife_edge", "mbd.joints.knife_edge.KnifeEdge.slips", "Slip.gradient"),
    (Slip, "swirl", negated, "knife_edge", "mbd.joints.knife_edge.KnifeEdge.slips", "Slip.swirl"),
    (Slip, "bias", negated, "wheel", "mbd.joints.knife_edge.Wheel.slips", "Slip.bias"),
    (Slip, "curvature", negated, "wheel", "mbd.joints.knife_edge.Wheel.slips", "Slip.curvature"),
    (Turn, "bias", negated, "rows", "mbd.turn.Turn", "bias"),
    (Quadratic, "bias", negated, "pin", "mbd.joints.pairs.Pin.rows", "Quadratic.bias"),
    (Quadratic, "curvature", negated, "rows", "mbd.rows.dot", "curvature"),
]


def failures(word: str, kernel: str) -> list[str]:
    """The quantities in which the steps about a kernel find a difference."""
    steps = [step for step in subjects.steps(word) if step.kernel == kernel]
    assert steps
    return [worst.quantity for step in steps if not (worst := step.worst(states=1)).exact]


@pytest.mark.parametrize(("owner", "name", "wrong", "word", "kernel", "quantity"), WRONG, ids=lambda x: x if isinstance(x, str) else "")
def test_a_wrong_sign_is_found_by_the_step_about_it(owner, name, wrong, word, kernel, quantity, monkeypatch) -> None:
    assert not failures(word, kernel)
    monkeypatch.setattr(owner, name, wrong(getattr(owner, name)))
    assert quantity in failures(word, kernel)


def test_a_wrong_shortening_is_found_in_the_mass_of_a_floating_frame(monkeypatch) -> None:
    subjects.steps.cache_clear()
    monkeypatch.setattr("mbd.elements.floating_frame._shortening", negated(floating_frame._shortening))
    assert len(failures("floating_frame_beam", "mbd.system.System.mass")) == 2  # not without stiffening
    subjects.steps.cache_clear()


@pytest.mark.parametrize(("table", "gravity"), [("WEIGHT", "consistent"), ("WEIGHT_LUMPED", "lumped")])
def test_a_wrong_gravity_vector_is_found(table: str, gravity: str, monkeypatch) -> None:
    monkeypatch.setattr(f"mbd.elements.ancf_cable.{table}", np.array([0.5, -0.1, 0.5, 0.1]))
    assert failures("ancf_cable", f"mbd.elements.shapes.{table}") == [f"{gravity} weight"]


def test_the_command_names_what_is_wrong(monkeypatch, capsys) -> None:
    monkeypatch.setattr(StretchAt, "_across", negated(StretchAt._across))
    assert main(["derive", "particle", "spring", "--check"]) == 1
    told = capsys.readouterr()
    assert told.err.startswith("wrong: mbd.elements.spring_strains.Stretch: stiffness (spring: ")
    assert "<-- WRONG" in told.out and "2 wrong" in told.out.splitlines()[-1]


def test_a_joint_whose_rows_are_wrong_does_not_stay_closed(monkeypatch, capsys) -> None:
    """A point minus the mirrored one: closed at one place, and only there."""
    subjects.steps.cache_clear()
    monkeypatch.setattr("mbd.joints.pairs.points", lambda a, b: [(axis, row) for axis, row in zip("xyz", coincide(a.point, b.point.scaled(-1.0)))])
    assert main(["derive", "ball", "--check"]) == 1
    assert "wrong: mbd.joints.pairs.Ball.rows: closure" in capsys.readouterr().err
    subjects.steps.cache_clear()


def test_the_curvature_of_a_nonholonomic_row_is_not_symmetric_and_a_transposed_one_is_found(monkeypatch) -> None:
    compiled = Slip._compile_curvature

    def transposed(self: Slip) -> None:
        compiled(self)
        self.curvature_rows, self.curvature_cols = self.curvature_cols, self.curvature_rows

    subjects.steps.cache_clear()
    monkeypatch.setattr(Slip, "_compile_curvature", transposed)
    assert failures("wheel", "mbd.joints.knife_edge.Wheel.slips") == ["Slip.curvature"]
    subjects.steps.cache_clear()
