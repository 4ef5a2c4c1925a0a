"""Still pictures as SVG: a scene at its start, or a run as shapes at several times. For notebooks, print, and where there are no scripts."""

from __future__ import annotations

import numpy as np

from ..affine import Array
from ..drawing import FINE, Drawing
from ..scene import Scene
from .words import text

WIDTH, LEFT, ROOM = 640.0, 62.0, 40.0
"""Pixels: of the picture, beside its axis, and around it."""
SHADES = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (180, 205, 40)])
"""From the first time to the last: the viridis map, without its palest end."""
AZIMUTH, ELEVATION = -0.9, 0.45
"""From where space is seen [rad]; the page starts with the same view."""
SHAPES, POINTS, NAMED = 9, 4000, 40
"""The most that a picture of a run shows."""
STROKE = {"beam": 2.5, "rod": 4.0, "arm": 1.5, "hull": 1.5, "axes": 1.5, "disc": 1.5, "spring": 1.2, "link": 1.5, "guide": 0.8}
DASHED = {"link": "6 3", "guide": "8 3 2 3"}


def scene_picture(scene: Scene) -> str:
    """The scene at its start, as described."""
    q = scene.build().q0[None]
    drawing = Drawing(scene, q, fine=FINE // 4)
    title = f"the scene at its start: {len(scene.items)} items"
    return picture(drawing, drawing.at(q), np.zeros(0), title, names=len(scene.items) <= NAMED)


def run_picture(drawing: Drawing, points: Array, times: Array) -> str:
    """A run as shapes at even times; points [n_t, n_points, d] at times [n_t] [s]. Of a scene of very many points fewer shapes."""
    count = min(max(POINTS // max(points.shape[1], 1), 2), SHAPES, len(times))
    chosen = np.linspace(0, len(times) - 1, count).round().astype(int)
    return picture(drawing, points[chosen], times[chosen], f"shapes at {count} times from {times[0]:g} to {times[-1]:g} s")


def picture(drawing: Drawing, points: Array, times: Array, title: str, names: bool = False) -> str:
    """points [n_t, n_points, d]; times [n_t] [s], from the second on a key to the shades; names of items beside them."""
    flat = projected(points, drawing.scene.gravity)
    low, high = _box(flat, drawing.extent)
    scale = min((WIDTH - LEFT - ROOM) / (high[0] - low[0]), 420.0 / (high[1] - low[1]))
    left = LEFT + 0.5 * (WIDTH - LEFT - ROOM - scale * (high[0] - low[0]))
    height = scale * (high[1] - low[1]) + 2.0 * ROOM + 20.0
    place = np.stack((left + scale * (flat[..., 0] - low[0]), ROOM + scale * (high[1] - flat[..., 1])), axis=-1)
    parts = _axes(low, high, scale, left) if drawing.scene.dimension == 2 else _directions(drawing.scene.gravity, scale, height)
    for k, at in enumerate(place):
        colour = _shade(k / max(len(place) - 1, 1)) if len(place) > 1 else "currentColor"
        parts += [_shape(shape.form, at[list(shape.points)], colour, last=k == len(place) - 1) for shape in drawing.shapes]
    parts += _key(times) if len(times) > 1 else []
    parts += _names(drawing, place[-1]) if names else []
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {height:.0f}" role="img" aria-label="{text(title)}"'
    style = 'style="max-width:100%;height:auto" font-family="sans-serif" font-size="12" fill="currentColor"'
    return f'{head} width="{WIDTH:g}" {style}><title>{text(title)}</title>{"".join(parts)}</svg>'


def projected(points: Array, gravity: Array) -> Array:
    """[..., 2]: in space seen from aside and a little above, the vertical being that of gravity (z without)."""
    if points.shape[-1] == 2:
        return points
    return points @ view(gravity).T


def upward(gravity: Array) -> int:
    """The axis of space that stands upright."""
    return int(np.argmax(np.abs(gravity))) if np.any(gravity) else 2


def view(gravity: Array) -> Array:
    """[2, 3]: to the right and up on the picture."""
    up = upward(gravity)
    order = [(up + 1) % 3, (up + 2) % 3, up]
    ca, sa, ce, se = np.cos(AZIMUTH), np.sin(AZIMUTH), np.cos(ELEVATION), np.sin(ELEVATION)
    out = np.zeros((2, 3))
    out[:, order] = [[-sa, ca, 0.0], [-ca * se, -sa * se, ce]]
    return out


def _box(flat: Array, extent: float) -> tuple[Array, Array]:
    every = flat.reshape(-1, 2)
    low, high = (every.min(axis=0), every.max(axis=0)) if len(every) else (np.zeros(2), np.zeros(2))
    thin = np.maximum(0.15 * max(float(np.max(high - low)), 0.1 * extent) - (high - low), 0.0) / 2.0
    return low - thin, high + thin


def _shade(fraction: float) -> str:
    place = fraction * (len(SHADES) - 1)
    return "rgb(" + ",".join(str(round(float(np.interp(place, range(len(SHADES)), column)))) for column in SHADES.T) + ")"


def _path(points: Array) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)


def _shape(form: str, at: Array, colour: str, last: bool) -> str:
    if form in STROKE:
        line = _zigzag(at) if form == "spring" else at[1:] if form == "disc" else at
        dash = f' stroke-dasharray="{DASHED[form]}"' if form in DASHED else ""
        fill = f'{colour}" fill-opacity="0.12' if form in ("hull", "disc") else "none"
        look = f'stroke="{colour}" stroke-width="{STROKE[form]}" stroke-linejoin="round" stroke-linecap="round"{dash}'
        return f'<path d="{_path(line)}" fill="{fill}" {look}/>'
    x, y = at[0]
    if form in ("centre", "particle"):
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{2 if form == "centre" else 5}" fill="{colour}"/>'
    if not last or form in ("output", "force"):
        return ""
    if form == "ground":
        hatch = "".join(f"M{x + k:.1f} {y + 12:.1f}l-4 5" for k in (-8, -3, 2, 7))
        return f'<path d="M{x:.1f} {y:.1f}l-8 12h16zM{x - 12:.1f} {y + 12:.1f}h24{hatch}" fill="none" stroke="currentColor"/>'
    if form in ("clamp", "slider"):
        turn = np.degrees(np.arctan2(*(at[1] - at[0])[::-1])) if form == "slider" else 0.0
        half = 8 if form == "slider" else 5
        return (
            f'<rect x="{-half}" y="-5" width="{2 * half}" height="10" transform="translate({x:.1f} {y:.1f}) rotate({turn:.1f})" '
            f'fill="{"currentColor" if form == "clamp" else "white"}" stroke="currentColor"/>'
        )
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="white" stroke="currentColor" stroke-width="1.5"/>'


def _zigzag(ends: Array, teeth: int = 8, width: float = 5.0) -> Array:
    a, b = ends
    along = b - a
    size = float(np.hypot(*along)) or 1.0
    across = np.array([-along[1], along[0]]) / size
    places = np.concatenate(([0.0, 0.15], 0.15 + 0.7 * (np.arange(2 * teeth) + 0.5) / (2 * teeth), [0.85, 1.0]))
    sides = np.concatenate(([0.0, 0.0], width * (-1.0) ** np.arange(2 * teeth), [0.0, 0.0]))
    return a + places[:, None] * along + sides[:, None] * across


def nice(low: float, high: float, most: int) -> Array:
    """Round numbers between two, about as many as wanted."""
    step = 10.0 ** np.floor(np.log10((high - low) / most))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= most)
    return np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step + 0.0


def _axes(low: Array, high: Array, scale: float, left: float) -> list[str]:
    bottom, right = ROOM + scale * (high[1] - low[1]) + 12.0, left + scale * (high[0] - low[0])
    out = []
    for x in nice(low[0], high[0], 7):
        at = left + scale * (x - low[0])
        out += [f'<path d="M{at:.1f} {bottom:.1f}v5" stroke="currentColor"/>', _word(at, bottom + 18, f"{x:.6g}", "middle")]
    for y in nice(low[1], high[1], 5):
        at = ROOM + scale * (high[1] - y)
        out += [f'<path d="M{left - 14:.1f} {at:.1f}h-5" stroke="currentColor"/>', _word(left - 22, at + 4, f"{y:.6g}", "end")]
    return [*out, _word(right + 8, bottom + 5, "x [m]"), _word(left - 30, ROOM - 22, "y [m]")]


def _directions(gravity: Array, scale: float, height: float) -> list[str]:
    """The axes of space, and a length to compare with."""
    out, corner = [], np.array([40.0, height - 40.0])
    for name, along in zip("xyz", view(gravity).T):
        end = corner + 26.0 * along * (1.0, -1.0)
        x, y = corner + 1.4 * (end - corner) + (0, 4)
        out += [f'<path d="{_path(np.array([corner, end]))}" stroke="currentColor"/>', _word(x, y, name, "middle")]
    step = nice(0.0, 150.0 / scale, 3)[-1]
    bar = np.array([[WIDTH - 16.0 - step * scale, height - 16.0], [WIDTH - 16.0, height - 16.0]])
    return [*out, f'<path d="{_path(bar)}" stroke="currentColor" stroke-width="2"/>', _word(WIDTH - 16.0, height - 24.0, f"{step:.6g} m", "end")]


def _names(drawing: Drawing, place: Array) -> list[str]:
    """Names of items, of bodies and beams first; one that would cover another is left out."""
    out: list[str] = []
    seen: set[str] = set()
    taken: list[tuple[float, float, float, float]] = []
    first = [shape for shape in drawing.shapes if shape.form in ("beam", "rod", "hull", "arm", "axes", "particle")]
    for shape in (*first, *(shape for shape in drawing.shapes if shape.form not in ("guide", "output"))):
        if shape.item in seen:
            continue
        seen.add(shape.item)
        x, y = place[list(shape.points)].mean(axis=0) + (7.0, -7.0)
        box = (x, y - 11.0, x + 6.6 * len(shape.item), y + 3.0)
        if all(box[0] > other[2] or other[0] > box[2] or box[1] > other[3] or other[1] > box[3] for other in taken):
            taken.append(box)
            out.append(_word(x, y, shape.item))
    return out


def _key(times: Array) -> list[str]:
    """Which shade is when."""
    wide, count = 150.0, len(times)
    first = WIDTH - wide - 70.0
    size = f'y="8" width="{wide / count:.1f}" height="8"'
    cells = [f'<rect x="{first + k * wide / count:.1f}" {size} fill="{_shade(k / (count - 1))}"/>' for k in range(count)]
    return [*cells, _word(first - 6, 16, f"t = {times[0]:.4g}", "end"), _word(first + wide + 6, 16, f"{times[-1]:.4g} s")]


def _word(x: float, y: float, said: str, anchor: str = "start") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text(said)}</text>'
