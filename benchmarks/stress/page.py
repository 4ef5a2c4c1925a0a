"""The table of limits, and every level below it, as Markdown; with a record that partial runs are merged into."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..tables import table
from .families import FAMILIES
from .family import ANNOUNCED, REFUSED, RIGHT, SILENT, SLOW, Family, Level, Verdict, reach

OUT = Path(__file__).parents[2] / "docs"
COMMAND = 'python -m pip install ".[bench]" && python -m benchmarks.stress'
INTRODUCTION = f"""# Where it breaks

Written by `{COMMAND}`.

Each row is a family of scenes, swept from an ordinary level to both sides until something breaks or the numbers end. A level is *right*
where its error against the reference is below the bar: a closed form, an independent integration, an invariance, and for mbd always also
the audit; that a run ended says nothing. *Refused*: an error says why. *Announced*: the result is off, and a warning or its audit says so.
*SILENT*: the result is off and nothing says so. *Too slow*: stopped after some 20 s of processor time. mbd runs as it comes, with the default
solver, at rtol 1e-6 unless said otherwise. Exudyn has several tries (its defaults, eight times the steps, looser Newton tolerances, more
numerical damping, the trapezoidal rule; adaptive steps down to 1 % of the given one) and the best of them counts; it is silent where none
is right and one of them reported success."""


def text(level: Level) -> str:
    return level if isinstance(level, str) else f"{level:g}"


def span(levels: Sequence[Level]) -> str:
    """The first and last of levels, in words."""
    if not levels:
        return "none"
    return text(levels[0]) if len(levels) == 1 else f"{text(levels[0])} to {text(levels[-1])}"


def worst(found: Sequence[Verdict]) -> str:
    errors = [v.error for v in found if v.kind == RIGHT and v.error is not None]
    return f"{max(errors):.0e}" if errors else ""


def limits(family: Family, verdicts: dict[Level, Verdict]) -> list[tuple[Level, Verdict]]:
    """The first levels on both sides of what is right without a gap."""
    levels = [level for level in family.levels if level in verdicts]
    inside = reach(family, verdicts)
    if not inside:
        return [(family.nominal, verdicts[family.nominal])]
    first, last = levels.index(inside[0]), levels.index(inside[-1])
    return [(levels[k], verdicts[levels[k]]) for k in (first - 1, last + 1) if 0 <= k < len(levels)]


def _limit(family: Family, verdicts: dict[Level, Verdict]) -> str:
    return "; ".join(f"{text(level)}: {verdict.kind}" for level, verdict in limits(family, verdicts)) or "none found"


def row(family: Family, own: dict[Level, Verdict], peer: dict[Level, Verdict]) -> list[str]:
    checked = f"{family.reference}; {family.bar:g}"
    cells = [family.name, family.what, checked, span(reach(family, own)), worst(list(own.values())), _limit(family, own)]
    if not peer:
        return [*cells, "cannot", "", ""]
    silent = [level for level in family.levels if level in peer and peer[level].kind == SILENT]
    return [*cells, span(reach(family, peer)), _limit(family, peer), ", ".join(map(text, silent)) or "no"]


HEAD = ["family", "swept", "compared with; bar", "mbd right", "worst error", "mbd's limit", "Exudyn right", "Exudyn's limit", "Exudyn silent at"]


def overview(found: dict[str, tuple[dict[Level, Verdict], dict[Level, Verdict]]]) -> str:
    return table(HEAD, [row(family, *found[family.name]) for family in FAMILIES if family.name in found])


def _detail(family: Family, own: dict[Level, Verdict], peer: dict[Level, Verdict]) -> str:
    lines = []
    for level in family.levels:
        if level in own:
            other = [_cell(peer[level])] if level in peer else [""]
            lines.append([text(level), _cell(own[level]), f"{own[level].seconds:.2f}", *other])
    said = [f"- {text(level)}: {v.kind}. {_said(v)}" for level, v in own.items() if v.kind in (REFUSED, ANNOUNCED, SILENT, SLOW)]
    parts = [f"## {family.name}", *([family.note[0].upper() + family.note[1:] + "."] if family.note else [])]
    parts.append(table([family.what, "mbd", "cpu [s]", "Exudyn"], lines))
    return "\n\n".join(parts + (["\n".join(said)] if said else []))


def _cell(verdict: Verdict) -> str:
    return verdict.kind if verdict.error is None else f"{verdict.kind}, {verdict.error:.1e}"


def _said(verdict: Verdict) -> str:
    found = " ".join(verdict.said.split()).replace("|", "/")
    return found if len(found) <= 400 else found[:397] + "..."


def page(found: dict[str, tuple[dict[Level, Verdict], dict[Level, Verdict]]], where: dict[str, str]) -> str:
    places = dict.fromkeys(where[name] for name in found)
    machines = "\n".join(f"- {place}: {', '.join(n for n in found if where[n] == place)}" for place in places)
    details = [_detail(family, *found[family.name]) for family in FAMILIES if family.name in found]
    return "\n\n".join([INTRODUCTION, overview(found), "## Machine", machines, *details]) + "\n"


def packed(verdicts: dict[Level, Verdict]) -> list[Any]:
    """For JSON, which has no infinity."""
    return [[level, v.kind, None if v.error is None or not math.isfinite(v.error) else v.error, v.said, v.seconds] for level, v in verdicts.items()]


def unpacked(entries: list[Any]) -> dict[Level, Verdict]:
    return {level: Verdict(kind, error, said, seconds) for level, kind, error, said, seconds in entries}


def write(folder: Path, found: dict[str, tuple[dict[Level, Verdict], dict[Level, Verdict]]], where: str) -> None:
    """stress.md of everything on record, these families replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "stress.json"
    entries = json.loads(path.read_text()) if path.exists() else {}
    for name, (own, peer) in found.items():
        entries[name] = {"where": where, "mbd": packed(own), "exudyn": packed(peer)}
    known = {family.name: entries[family.name] for family in FAMILIES if family.name in entries}
    path.write_text(json.dumps(known, indent=0) + "\n")
    everything = {name: (unpacked(entry["mbd"]), unpacked(entry["exudyn"])) for name, entry in known.items()}
    (folder / "stress.md").write_text(page(everything, {name: entry["where"] for name, entry in known.items()}))
