"""The page: a template, a style sheet and scripts of this folder, filled with the data of one run. It loads nothing."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np

from .. import __version__
from ..marker import Marker
from ..result import Result
from . import words
from .frames import LOST, SIZE, Frames, frames, packed
from .picture import AZIMUTH, ELEVATION, run_picture, upward
from .series import Plot, checked, plots
from .words import text

SCRIPTS = ("data.js", "stage.js", "symbols.js", "plots.js", "player.js")


def page(result: Result, title: str, outputs: Any = None, verification: Any = None, size: int = SIZE) -> str:
    """The HTML of a report; ``size``: about the most bytes that the animation takes."""
    if result.scene.build() is not result.system:
        raise ValueError("report: expected the scene as it was in this run, found items added since; write a report before adding to its scene")
    chosen = checked(result, outputs)
    film = frames(result, {name: item for name, item in chosen.items() if isinstance(item, Marker)}, size)
    data = _data(film, plots(result, film.run, chosen, verification), result)
    fill = {
        "title": text(title),
        "style": _file("page.css"),
        "summary": text(_summary(result)),
        "doubts": "".join(f'<li class="doubt">{text(line)}</li>' for line in words.doubts(result)),
        "picture": run_picture(film.drawing, film.points, film.run.t),
        "sections": "".join(_section(*each) for each in _sections(result, verification)),
        "data": embedded(data),
        "script": "\n".join(_file(name) for name in SCRIPTS),
        "version": text(__version__),
    }
    return re.sub(r"<!--(\w+)-->", lambda found: fill[found[1]], _file("page.html"))


def _file(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def embedded(data: Any) -> str:
    """JSON that cannot end the element it stands in, whatever names are in it."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _summary(result: Result) -> str:
    start, end = float(result.trajectory.t[0]), float(result.trajectory.t[-1])
    stats = result.stats
    steps = f"{stats['steps']} steps of {stats['solver']}, computed in {stats['wall time']:.3g} s"
    return f"{len(result.scene.items)} items, {start:.6g} to {end:.6g} s in {steps}"


def _data(film: Frames, shown: list[Plot], result: Result) -> dict[str, Any]:
    points, drawing = film.points, film.drawing
    every = points.reshape(-1, points.shape[-1])
    low, high = every.min(axis=0), every.max(axis=0)
    origin = 0.5 * (low + high)  # float32 keeps what is near to zero
    strongest = max((float(np.abs(values).max()) for values in film.forces.values()), default=0.0)
    kinds = {item.name: item.description.kind for item in result.scene.items}
    return {
        "dimension": points.shape[-1],
        "up": upward(result.scene.gravity),
        "view": [AZIMUTH, ELEVATION],
        "origin": origin.tolist(),
        "low": low.tolist(),
        "high": high.tolist(),
        "times": packed(film.run.t, "<f8"),
        "points": packed(points - origin),
        "count": points.shape[1],
        "shapes": [[shape.item, kinds.get(shape.item, "output"), shape.form, list(shape.points)] for shape in drawing.shapes],
        "forces": {name: packed(values / (strongest or 1.0)) for name, values in film.forces.items()},
        "strongest": strongest,
        "between": film.between,
        "plots": [_plot(each) for each in shown],
        "events": {name: times.t.tolist()[:200] for name, times in result.events.items()},
    }


def _plot(plot: Plot) -> dict[str, Any]:
    curves = [[label, packed(values)] for label, values in plot.curves.items()]
    times = None if plot.times is None else packed(plot.times, "<f8")
    return {"group": plot.group, "title": plot.title, "unit": plot.unit, "log": plot.log, "note": plot.note, "times": times, "curves": curves}


def _sections(result: Result, verification: Any) -> list[tuple[str, str, bool]]:
    """Headings, contents, and whether they are open at first."""
    from ..structure import check

    found = [("Audit", _safely(lambda: words.audit(result.audit)), True)]
    if verification is not None:
        found.append(("Error estimates", words.verification(verification), True))
    found.append(("Structure", _safely(lambda: words.structure(check(result.scene, result.assembly.state))), True))
    found.append(("Solver statistics", words.statistics(result.stats), True))
    if result.events:
        found.append(("Events", words.events(result), True))
    found.append((f"Scene: {len(result.scene.items)} items", words.items(result.scene), False))
    found.append(("Scene file", words.scene_file(result.scene), False))
    found.append(("Reproduction", words.reproduction(result), False))
    return found


def _safely(make: Callable[[], str]) -> str:
    """A section, or why there is none."""
    try:
        return make()
    except LOST as error:
        return f"<p>not to be had: {text(error)}</p>"


def _section(heading: str, content: str, opened: bool) -> str:
    return f"<details{' open' if opened else ''}><summary><h2>{text(heading)}</h2></summary>{content}</details>"
