"""Symbols for the coordinates of a scene, named after its items."""

from __future__ import annotations

import re

import sympy as sp

from mbd.scene import Scene


class Naming:
    """q and v [n] as symbols: ``rod_mass_centre_x``, in LaTeX x with the rest of the name below it."""

    def __init__(self, scene: Scene):
        owners = scene.layout.owners()
        words = ["_".join(re.findall(r"\w+", f"{item} {label}")) for item, label in owners]
        self.q = [sp.Symbol(word, real=True) for word in words]
        self.v = [sp.Symbol(f"{word}_rate", real=True) for word in words]
        written = [_written(item, label) for item, label in owners]
        self.written = dict(zip(self.q, written)) | dict(zip(self.v, (rf"\dot {text}" for text in written)))


def _written(item: str, label: str) -> str:
    *what, last = label.split()
    letter, below = (last, [item, *what]) if last in ("x", "y", "z") else (r"\varphi" if last == "turn" else "s", [item, *what, last])
    text = " ".join(below).replace("_", r"\_")
    return rf"{letter}_{{\text{{{text}}}}}"
