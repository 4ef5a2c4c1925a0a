"""What ``check`` found, as data and in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .displayed import Displayed
from .edits import Edit
from .magnitudes import Hint


@dataclass(frozen=True)
class Redundancy:
    """The smallest set of joints (and drives) some of whose equations follow from the others.

    equations   of each joint those that take part: the labels of the reactions that are indeterminate
    count       how many equations are too many in this pose
    elsewhere   and in poses nearby; None where the mechanism has no other pose
    rigid       a free motion seems to exist, but it leads to no other pose: it is infinitesimal
    drives      the members that are drives
    edit        equations to release so that the set holds everything once
    """

    equations: dict[str, tuple[str, ...]]
    count: int
    elsewhere: int | None
    rigid: bool
    drives: tuple[str, ...]
    edit: tuple[Edit, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        return tuple(self.equations)

    @property
    def generic(self) -> bool:
        """Whether it holds in other poses too, as far as there are any."""
        return self.elsewhere is None or self.elsewhere > 0

    @property
    def singular(self) -> bool:
        """Whether this pose is worse than those nearby."""
        return self.rigid or (self.elsewhere is not None and self.elsewhere < self.count)

    def __str__(self) -> str:
        where = "in the only pose there is" if self.elsewhere is None else "in every pose" if self.generic else "in this pose only"
        where = f"here ({self.elsewhere} in every pose)" if self.generic and self.singular and not self.rigid else where
        alike: dict[tuple[str, ...], list[str]] = {}
        for name, labels in self.equations.items():
            alike.setdefault(labels, []).append(name)
        members = "; ".join(f"{', '.join(map(repr, names))} ({', '.join(labels)})" for labels, names in alike.items())
        lines = [f"{self.count} equation{'s' * (self.count > 1)} too many {where} among {members}"]
        if self.singular:
            lines.append("  " + self._singular())
        if self.generic:
            lines.append("  their reactions are indeterminate in these equations" + (f"; {' and '.join(map(str, self.edit))}" if self.edit else ""))
        return "\n".join(lines)

    def _singular(self) -> str:
        if self.rigid:
            return "singular: bars or axes are in line, and what seems a free motion is infinitesimal: it leads to no other pose"
        if self.drives:
            return f"singular: a dead centre of {', '.join(map(repr, self.drives))}, which cannot drive the mechanism through this pose"
        return "singular: bars or axes come into line here, and the mechanism may go on in more than one way"


@dataclass(frozen=True)
class Structure(Displayed):
    """What ``check`` found.

    bodies, joints  names; parts, names of the items of each independent part; loops, names of bodies and joints in turn
    count           coordinates less equations, drives left aside (Gruebler, Kutzbach)
    freedoms        the degrees of freedom, by the rank of G in this pose, drives left aside
    driven          how many equations are driven
    free            the degrees of freedom that drives leave
    redundant       sets of joints that hold something twice; indeterminate: the joints whose reactions are not unique because of it
    unheld          coordinates with neither inertia nor a joint to determine them
    motions         a line for each free motion, where there are not too many
    complaints      why the scene cannot be assembled; the rest is then said of it as described
    hints           magnitudes that hint at a slip of units: each with item, found, usual, mend
    """

    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    parts: tuple[tuple[str, ...], ...]
    loops: tuple[tuple[str, ...], ...]
    count: int
    freedoms: int
    driven: int
    free: int
    redundant: tuple[Redundancy, ...]
    unheld: tuple[str, ...]
    motions: tuple[str, ...]
    complaints: tuple[str, ...]
    hints: tuple[Hint, ...] = ()

    @property
    def indeterminate(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(name for each in self.redundant if each.generic for name in each.joints))

    @property
    def singular(self) -> bool:
        """Whether this pose is singular: a dead centre, bars in line."""
        return any(each.singular for each in self.redundant)

    def __str__(self) -> str:
        lines = [*(f"cannot be assembled: {line}" for line in self.complaints)]
        lines.append(f"{_many(self.bodies, 'body', 'bodies')}, {_many(self.joints, 'joint')}, {_many(self.parts, 'independent part')}")
        lines += [f"loop: {', '.join(map(repr, way))}" for way in self.loops]
        driven = f", {self.driven} driven, {self.free} free" if self.driven else ""
        lines.append(f"degrees of freedom: {self.freedoms} by rank, {self.count} by count (coordinates less equations){driven}")
        lines += [f"free motion: {line}" for line in self.motions]
        if self.free > len(self.motions):
            lines.append(f"free motions: {self.free - len(self.motions)} more, too many to describe")
        lines += [str(each) for each in self.redundant]
        lines += [f"neither inertia nor a joint determines {name}; give it mass or hold it" for name in self.unheld]
        lines += [f"unusual magnitude: {hint}" for hint in self.hints]
        return "\n".join(lines)


def _many(things: tuple[Any, ...], one: str, several: str = "") -> str:
    return f"{len(things)} {one if len(things) == 1 else several or one + 's'}"
