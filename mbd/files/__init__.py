"""Scenes as files, TOML or JSON: ``mbd.read_scene(path)`` and ``mbd.write_scene(scene, path)``.

Files are data: reading one never runs code. Their model is made of the fields of descriptions (``kinds.py``), checked by pydantic
(``model.py``), and formulas are parsed (``mbd.functions.language``). docs/guide/scene_files.md tells how to write them.
"""

from ..job import Job
from .reading import read, read_scene
from .writing import write_scene

__all__ = ["Job", "read", "read_scene", "write_scene"]
