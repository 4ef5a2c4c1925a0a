"""Mechanisms that the tests of structure share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import mbd

INERTIA = (0.01, 0.2, 0.2)
"""Of links in space, about their own axes [kg m^2]; in the plane the last."""


def link(scene: mbd.Scene, start: Any, end: Any, name: str) -> Any:
    """A link of 2 kg between two points [2] of the xy plane, or of one parallel to it; its first axis lies along."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    along = b - a
    angle = np.arctan2(along[1], along[0])
    if scene.dimension == 2:
        return scene.add(mbd.RigidBody(mass=2.0, inertia=INERTIA[-1], position=(a + b) / 2, angle=angle, name=name))
    c, s = np.cos(angle), np.sin(angle)
    turned = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    return scene.add(mbd.RigidBody(mass=2.0, inertia=INERTIA, position=(*(a + b) / 2, 0), rotation=turned, name=name))


def at(item: Any, x: float, dimension: int) -> mbd.Marker:
    return item.at(x, *np.zeros(dimension - 1))


def four_bar(
    dimension: int, points: Any = ((0, 0), (0, 1), (2, 1.5), (2, 0)), last: Callable[..., Any] | None = None
) -> tuple[mbd.Scene, list[Any], list[Any]]:
    """Pins at four points, the first and last on the ground: scene, links, pins. ``last``: another joint in the place of the last pin."""
    points = np.array(points, dtype=float)
    scene = mbd.Scene(gravity=(0, -9.81) if dimension == 2 else (0, -9.81, 0))
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    links = [link(scene, points[k], points[k + 1], name) for k, name in enumerate(("crank", "coupler", "rocker"))]
    ends = [(at(each, -0.5 * length, dimension), at(each, 0.5 * length, dimension)) for each, length in zip(links, lengths)]
    zero = np.zeros(dimension - 2)
    ground = [scene.ground.at(*points[k], *zero) for k in (0, 3)]
    options: dict[str, Any] = {} if dimension == 2 else {"axis": (0, 0, 1)}
    pairs = [(ends[0][0], ground[0]), (ends[0][1], ends[1][0]), (ends[1][1], ends[2][0]), (ends[2][1], ground[1])]
    pins = [scene.add(mbd.Pin(*pair, **options, name=f"pin {k + 1}")) for k, pair in enumerate(pairs[:-1])]
    pins.append(scene.add(last(*pairs[-1], name="pin 4") if last else mbd.Pin(*pairs[-1], **options, name="pin 4")))
    return scene, links, pins


def slider_crank(angle: float = 0.0, drive: Callable[..., Any] | None = None) -> tuple[mbd.Scene, Any, Any, Any]:
    """Crank of 1 m, rod of 2 m, a slider on the x axis; the drive is made of crank and slider: scene, crank, slider, drive."""
    scene = mbd.Scene()
    knee = np.array([np.cos(angle), np.sin(angle)])
    end = np.array([slider_place(angle), 0.0])
    crank, rod = link(scene, (0, 0), knee, "crank"), link(scene, knee, end, "rod")
    slider = scene.add(mbd.Particle(1.5, end, name="slider"))
    scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0), name="bearing"))
    scene.add(mbd.Pin(crank.at(0.5, 0), rod.at(-1, 0), name="crank pin"))
    scene.add(mbd.Pin(rod.at(1, 0), slider.at(), name="wrist"))
    scene.add(mbd.PointOnLine(slider.at(), scene.ground.at(0, 0), axis=(1, 0), name="guide"))
    return scene, crank, slider, scene.add(drive(scene, crank, slider)) if drive else None


def slider_place(angle: Any) -> Any:
    return np.cos(angle) + np.sqrt(4.0 - np.sin(angle) ** 2)


def bricard() -> tuple[mbd.Scene, list[Any], list[Any]]:
    """IFToMM A04: five rods and the ground in a closed chain of six revolute joints along the edges of a cube: scene, rods, pins."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], dtype=float)
    axes = np.eye(3)[[1, 2, 0, 1, 2, 0]]
    scene = mbd.Scene((0, -9.81, 0))
    rods = []
    for k, (start, end) in enumerate(zip(points[:-1], points[1:])):
        second = np.roll(np.abs(end - start), 1)
        frame = np.stack((end - start, second, np.cross(end - start, second)), axis=1)
        across = (1.0 + 0.1**2) / 12.0
        body = mbd.RigidBody(mass=1.0, inertia=(0.1**2 / 6.0, across, across), position=(start + end) / 2, rotation=frame, name=f"rod {k + 1}")
        rods.append(scene.add(body))
    ends = [scene.ground.at(*points[0]), *(rod.at(0.5, 0, 0) for rod in rods)]
    starts = [*(rod.at(-0.5, 0, 0) for rod in rods), scene.ground.at(*points[5])]
    return scene, rods, [scene.add(mbd.Pin(a, b, axis=axis, name=f"pin {k}")) for k, (a, b, axis) in enumerate(zip(starts, ends, axes))]
