"""Items with two ends: markers anywhere along them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from mbd.affine import Affine, Array
from mbd.errors import SceneError
from mbd.marker import Marker

if TYPE_CHECKING:
    from mbd.scene import Site


class Lengthwise:
    """A beam in a scene.

    lengths  [pieces] of its elements at rest, or of the pieces that a picture draws [m]
    """

    word: ClassVar[str] = "beam"

    def __init__(self, description: Any, site: Site, lengths: Array):
        self.description, self.name, self.site, self.lengths = description, site.name, site, lengths
        self.length = float(lengths.sum())

    @cached_property
    def start(self) -> Marker:
        return self.at(0.0)

    @cached_property
    def end(self) -> Marker:
        return self.at(1.0)

    def at(self, s: float) -> Marker:
        """The marker at the fraction s in [0, 1] of the arc length at rest."""
        if not 0.0 <= s <= 1.0:
            raise SceneError([f"{self.word} {self.name!r}: at: expected a fraction of the arc length between 0 and 1, found {s!r}; correct it"])
        point, axes = self.locate(s)
        return Marker(self.name, self.site.scene, point, axes, False, (s,))

    def locate(self, s: float) -> tuple[Affine, tuple[Affine, ...]]:
        """The point at s and the axis there, where there is one."""
        raise NotImplementedError
