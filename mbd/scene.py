"""The door of the library: a scene collects descriptions, names them, checks them and builds the system."""

from __future__ import annotations

import pickle
import threading
from collections import defaultdict
from copy import deepcopy
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import validate
from .affine import Affine
from .displayed import Displayed
from .errors import SceneError
from .layout import Layout
from .marker import Marker
from .model import Model
from .system import System

if TYPE_CHECKING:
    from .parts import Part


_BUILDING = threading.RLock()
"""One thread at a time: those that share a scene share its system."""


class Scene(Displayed):
    """A mechanism under construction.

    gravity  [d] [m/s^2]; two components make a planar scene, three a spatial one. Any consistent set of units works.

    ``add`` takes a description (a cable, body, joint, spring, load) and returns the item in the scene, with its markers. Mistakes are
    collected and raised together, as a SceneError, when the scene is first used.
    """

    def __init__(self, gravity: ArrayLike = (0.0, -9.81)):
        self._complaints: list[str] = []
        self.gravity = validate.floats(gravity)
        good = isinstance(self.gravity, np.ndarray) and self.gravity.shape in ((2,), (3,)) and np.isfinite(self.gravity).all()
        if not good:
            found = validate.show(self.gravity)
            self._complaints.append(f"scene: gravity: expected two (planar) or three (spatial) finite numbers, found {found}; correct it")
            self.gravity = np.zeros(3 if np.shape(self.gravity) == (3,) else 2)
        self.dimension = int(self.gravity.size)
        self.layout = Layout(self.dimension)
        self.ground = Ground(self)
        self.items: list[Any] = []
        self._names: dict[str, Any] = {"ground": self.ground}
        self._numbers: dict[str, int] = defaultdict(_one)  # the least that a made name may still have, by stem
        self._bad: set[str] = set()
        self._built: tuple[int, System] | None = None
        self._parts: tuple[System, list[Part]] | None = None

    def __repr__(self) -> str:
        return f"<{'planar' if self.dimension == 2 else 'spatial'} scene of {len(self.items)} items>"

    def __getitem__(self, name: str) -> Any:
        """The item of that name."""
        if name not in self._names:
            raise KeyError(f"no item named {name!r}; there are {', '.join(map(repr, self._names))}")
        return self._names[name]

    def add(self, description: Any) -> Any:
        """The item that the description becomes in this scene. Names are given, or made from the kind and a number."""
        name = self._name(description)
        faults = self._faults(name, description)
        self._complaints.extend(f"{description.kind} {name!r}: {line}" for line in faults)
        item = Misfit(description, name, self) if faults or self._leans_on_misfit(description) else description.place(Site(self, name))
        if isinstance(item, Misfit):
            self._bad.add(name)
        else:
            self.items.append(item)
        self._names[name] = item
        self._built = None
        return item

    def _name(self, description: Any) -> str:
        if not hasattr(description, "place"):
            raise TypeError(f"scene.add takes descriptions such as mbd.AncfCable(...) or mbd.Pin(...), found {description!r}")
        wanted = description.name
        if wanted is not None and not (isinstance(wanted, str) and wanted):
            self._complaints.append(f"{description.kind}: name: expected a text, found {wanted!r}; correct it")
            wanted = None
        if wanted is not None and wanted not in self._names:
            return wanted
        stem = wanted or description.kind
        if wanted is not None:
            self._complaints.append(f"{description.kind} {wanted!r}: name: expected one not used yet, found {wanted!r} a second time; rename one")
        while (name := f"{stem} {self._numbers[stem]}") in self._names:
            self._numbers[stem] += 1
        return name

    def _faults(self, name: str, description: Any) -> list[str]:
        markers = getattr(description, "markers", None)
        if markers is not None:
            wrong = self._faulty_markers(markers)
            if wrong or any(marker.item in self._bad for marker in markers):
                return wrong
        return list(description.faults(self.dimension))

    def _faulty_markers(self, markers: tuple[Any, ...]) -> list[str]:
        for marker in markers:
            if not isinstance(marker, Marker):
                found = f"the item {marker.name!r}" if hasattr(marker, "name") else validate.show(marker)
                return [f"marker: expected a marker such as rod.end or body.at(x, y), found {found}; attach both ends"]
            if marker.dimension != self.dimension:
                found = f"{marker.dimension} at {marker.item!r}"
                return [f"marker: expected {self.dimension} components, found {found}; do not mix planar and spatial scenes"]
            if marker.scene is not self:
                return [f"marker: expected one of this scene, found one of {marker.item!r} in another scene; add that item here"]
            if not all(np.isfinite(x).all() for x in (marker.point.weights, marker.point.constant)):
                return [f"marker: expected finite numbers, found NaN or infinity in a point of {marker.item!r}; correct its at(...)"]
        if any(marker.item in self._bad for marker in markers):
            return []
        found = ", ".join(repr(marker.item) for marker in markers)
        if all(marker.fixed for marker in markers):
            return [f"marker: expected at least one on a moving item, found {found}; attach it to a body or a cable"]
        if len(markers) == 2 and markers[0].item == markers[1].item and markers[0].rigid:
            return [f"marker: expected two items, found both ends on {markers[0].item!r}; attach one of them elsewhere"]
        return []

    def _leans_on_misfit(self, description: Any) -> bool:
        return any(marker.item in self._bad for marker in getattr(description, "markers", ()))

    @property
    def complaints(self) -> list[str]:
        """What is wrong so far, a line each; ``build`` raises them."""
        return list(self._complaints)

    def coordinates(self) -> list[str]:
        """A name for each entry of q: the item and its coordinate, in order of ``add``."""
        return [" ".join(owner) for owner in self.layout.owners()]

    def build(self) -> System:
        """The system of equations; the same object until something is added. Raises SceneError with every complaint."""
        with _BUILDING:
            if self._built is None or self._built[0] != len(self.items):
                self._built = (len(self.items), self._assemble())
            return self._built[1]

    def parts(self) -> list[Part]:
        """The independent parts of the scene, which are integrated separately; the same objects until something is added."""
        from .parts import split

        with _BUILDING:
            system = self.build()
            if self._parts is None or self._parts[0] is not system:
                self._parts = (system, split(self))
            return self._parts[1]

    def __getstate__(self) -> dict[str, Any]:
        """For other processes. Raises TypeError where a function cannot go there, by the name of its item."""
        stuck = [f"{type(item.description).__name__} {item.name!r}: {field}" for item in self.items for field in _stuck(item.description)]
        if stuck:
            found = "; ".join(stuck)
            raise TypeError(f"scene: expected functions that can be pickled, of the top of a module, found others ({found}); define them there")
        return self._described()

    def _described(self) -> dict[str, Any]:
        """All but what is built of it."""
        return vars(self) | {"_built": None, "_parts": None}

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        """A scene of its own; functions, whatever they are, stay the same."""
        other = memo[id(self)] = Scene.__new__(Scene)
        vars(other).update({name: deepcopy(value, memo) for name, value in self._described().items()})
        return other

    def _assemble(self) -> System:
        if self._complaints:
            raise SceneError(self._complaints)
        if self.layout.n == 0:
            raise SceneError(["scene: expected at least one item with mass, found none; add a cable, a body or a particle"])
        model = Model(self.layout, np.asarray(self.gravity), _extent(self.layout, self.items))
        for item in self.items:
            item.assemble(model)
        if model.complaints:
            raise SceneError(model.complaints)
        system = System(model)
        system.scene = self
        return system


def _one() -> int:
    return 1


def _stuck(description: Any) -> list[str]:
    """Fields with functions that cannot be pickled."""
    found = []
    for name, value in vars(description).items():
        if callable(value):
            try:
                pickle.dumps(value)
            except (pickle.PicklingError, TypeError, AttributeError):
                found.append(name)
    return found


class Site:
    """Where an item goes: its scene, its name, and the layout that gives it rows."""

    def __init__(self, scene: Scene, name: str):
        self.scene, self.name = scene, name

    def rows(self, q: ArrayLike, v: ArrayLike, levers: ArrayLike, labels: list[str]) -> NDArray[np.intp]:
        return self.scene.layout.rows(self.name, q, v, levers, labels)

    def scalar(self, value: float, rate: float, label: str, length: bool = False) -> int:
        return self.scene.layout.scalar(self.name, value, rate, label, length)


class Ground:
    """The fixed frame."""

    def __init__(self, scene: Scene):
        self.scene, self.name = scene, "ground"

    def at(self, *point: float) -> Marker:
        """The marker at (x, y[, z]) [m], by default the origin; its axes are the inertial ones."""
        d = self.scene.dimension
        axes = tuple(Affine.fixed(axis) for axis in np.eye(d)[: 1 if d == 2 else 3])
        return Marker(self.name, self.scene, Affine.fixed(point or np.zeros(d)), axes, True, point)


class Misfit:
    """Stands for an item that was refused, so that the rest of the scene can still be checked: its markers lead nowhere."""

    def __init__(self, description: Any, name: str, scene: Scene):
        self.description, self.name, self.scene = description, name, scene
        self.length = 1.0

    def at(self, *point: float) -> Marker:
        d = self.scene.dimension
        axes = tuple(Affine.fixed(axis) for axis in np.eye(d)[: 1 if d == 2 else 3])
        return Marker(self.name, self.scene, Affine.fixed(np.zeros(d)), axes, rigid=True)

    @property
    def start(self) -> Marker:
        return self.at()

    @property
    def end(self) -> Marker:
        return self.at()


def _extent(layout: Layout, items: list[Any]) -> float:
    """The scene's length [m]: the diagonal of the box around all positions and attachment points, at least the largest lever."""
    q, _ = layout.start()
    table = q[: layout.dimension * layout.n_rows].reshape(-1, layout.dimension)
    levers = layout.levers(0.0)[: table.size].reshape(-1, layout.dimension)[:, 0]
    placed = layout.positions()
    positions = list(table[placed])
    for item in items:
        positions.extend(marker.point.value(q) for marker in getattr(item.description, "markers", ()))
    box = np.ptp(np.array(positions), axis=0)
    return float(max(np.linalg.norm(box), levers[~placed].max(initial=0.0))) or 1.0
