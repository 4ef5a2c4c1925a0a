"""Scenes as files, TOML or JSON: ``mbd.read_scene(path)``, ``mbd.write_scene(scene, path)``, and ``mbd.files.read(path)``, a ``Job``.

Files are data: reading one never runs code. Their model is made of the fields of descriptions (``kinds.py``), checked by pydantic
(``model.py``), and formulas are parsed (``mbd.functions.language``). docs/guide/scene_files.md tells how to write them. Writing needs no
pydantic, so each of them is imported when it is asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOME = {"Job": "mbd.job", "read": "mbd.files.reading"}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'mbd.files' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
