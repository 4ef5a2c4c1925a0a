"""Runs that the tests of reports share, and a reader of pages."""

from __future__ import annotations

import base64
import json
import re
import tempfile
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np

import mbd

from ..machines import flexible_pendulum

VOID = {"meta", "link", "input", "br", "path", "rect", "circle", "img"}


@cache
def slider_crank() -> mbd.Result:
    """A motor, pins, a slider, a spring, a force, a cable: a run of 0.2 s. Made once."""
    scene = mbd.Scene()
    crank = scene.add(mbd.RigidBody.rod((0, 0), (0.3, 0), mass=1.0, name="crank"))
    rod = scene.add(mbd.AncfCable((0.3, 0), (1.3, 0), n_elements=2, E=1e6, A=1e-3, I=1e-7, rho=1000, name="rod"))
    block = scene.add(mbd.RigidBody.box((0.2, 0.1), mass=0.5, position=(1.3, 0), name="block"))
    scene.add(mbd.Pin(crank.at(-0.15, 0), scene.ground.at(0, 0), name="bearing"))
    scene.add(mbd.Pin(rod.start, crank.at(0.15, 0), name="crank pin"))
    scene.add(mbd.Pin(rod.end, block.at(0, 0), name="block pin"))
    scene.add(mbd.Slider(block.at(0, 0), scene.ground.at(0, 0), axis=(1, 0), name="slide"))
    scene.add(mbd.Motor(crank, scene.ground, speed=8.0, name="motor"))
    scene.add(mbd.Spring(block.at(0.1, 0), scene.ground.at(2, 0), stiffness=20.0, name="spring"))
    scene.add(mbd.Force(block.at(0.1, 0.05), lambda t: (-5.0 * np.cos(9.0 * t), 0.0), name="push"))
    return mbd.simulate(scene, 0.2, rtol=1e-5)


@cache
def main_job() -> tuple[mbd.Result, str]:
    """The flexible pendulum, and its report as a file holds it. Made once."""
    scene, rod, pivot = flexible_pendulum()
    run = mbd.simulate(scene, 1.2, rtol=1e-5)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flexible pendulum.html"
        run.report(path, outputs={"rod.end": rod.end, "middle": rod.at(0.5), "pivot": pivot})
        return run, path.read_text(encoding="utf-8")


@cache
def heavy_top() -> mbd.Result:
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    tilt = [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]]
    numbers = {"mass": 15.0, "inertia": (0.469, 0.469, 0.234), "position": (0, 0.6, 0.8), "rotation": tilt, "angular_velocity": (0, 90, 120)}
    top = scene.add(mbd.RigidBody(name="top", **numbers))
    scene.add(mbd.Ball(top.at(0, 0, -1), scene.ground.at(0, 0, 0), name="tip"))
    return mbd.simulate(scene, 0.2)


@cache
def long_named() -> mbd.Result:
    """A body whose name has no place to break."""
    scene = mbd.Scene()
    scene.add(mbd.RigidBody(mass=1.0, inertia=1.0, position=(0, 0), name="b" * 150))
    return mbd.simulate(scene, 0.1)


class Reader(HTMLParser):
    """Elements by tag with their attributes, the text of each kind, and whether tags close in order."""

    def __init__(self, page: str):
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.texts: list[str] = []
        self.scripts: list[str] = []
        self.feed(page)
        self.close()
        assert not self.open, f"left open: {self.open}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        (self.scripts if self.open and self.open[-1] == "script" else self.texts).append(data)

    @property
    def text(self) -> str:
        return " ".join(self.texts)

    @property
    def data(self) -> dict[str, Any]:
        return json.loads(self.scripts[0])


def numbers(text: str, kind: str = "<f4") -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind).astype(float)


def embedded(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="run">(.*?)</script>', page, re.S)
    assert found
    return json.loads(found[1])
