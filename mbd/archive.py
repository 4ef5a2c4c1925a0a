"""Results in files: ``result.save("run.npz")`` and ``mbd.load("run.npz")``.

An uncompressed .npz without pickle: ``head``, a JSON text in bytes, holds the descriptions of the scene's items, gravity, solver and
statistics; every other member is a float64 array of the trajectory; where parts of the scene were integrated separately, the arrays of all
parts in one row. Loading builds the scene anew of the same descriptions. Nothing in a file is executed, and nothing much larger than the file
is allocated for it.

Functions of t are stored where they are of ``mbd.functions`` (``mbd.Expression``, ``mbd.Sine``, ...). Others cannot be: what needs them
(accelerations, reactions, values between the steps) raises after loading, by name; everything else is answered.
"""

from __future__ import annotations

import io
import json
import math
import os
import secrets
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import __version__, solvers
from .affine import Array
from .assembly import Assembly, Correction, prepare
from .descriptions import described, functions, rebuilt
from .errors import SceneWarning, SimulationError
from .event import Events, Times
from .parts import Part
from .result import Result
from .solvers.protocol import State as SolverState
from .starts import together
from .state import State
from .stored import ARRAYS, CHOSEN, EVENTS, STATE, check_shapes, divided, gathered
from .trajectory import Trajectory, joined

FORMAT, VERSION = "mbd result", 1


def save(result: Result, path: str | os.PathLike[str]) -> None:
    """Writes a result. The file appears whole or not at all; until then an old one stays.

    Warns, by name, of items whose functions cannot be stored. Raises ValueError for a scene that has grown since the run.
    """
    if result.scene.build() is not result.system:
        raise ValueError("save: expected the scene as it was in this run, found items added since; save a result before adding to its scene")
    head = _head(result)
    if head["functions"]:
        names = ", ".join(map(repr, head["functions"]))
        warnings.warn(f"functions of t are not stored: a loaded result refuses what needs those of {names}", SceneWarning, stacklevel=3)
    arrays = gathered(result.trajectory.pieces(), bool(head["parts"]))
    if result.chosen:
        arrays |= dict(zip(CHOSEN, result.chosen))
    if result.events:
        arrays |= {name: np.concatenate(parts) for name, parts in zip(EVENTS, zip(*result.events.values()))}
    text = json.dumps(head, default=_plain)
    rows = {name: np.ascontiguousarray(array, dtype="<f8") for name, array in arrays.items()}
    with _replacing(Path(path).resolve()) as file:
        np.savez(file, allow_pickle=False, head=np.frombuffer(text.encode(), dtype=np.uint8), **rows)


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)


def _solver(piece: Trajectory) -> dict[str, Any]:
    return {"class": type(piece.solver).__name__, "fields": asdict(piece.solver)}


def _head(result: Result) -> dict[str, Any]:
    items, pieces = described(result.scene), result.trajectory.pieces()
    return {
        "format": FORMAT,
        "version": VERSION,
        "mbd": __version__,
        "gravity": result.scene.gravity,
        "items": items,
        "functions": functions(items),
        "coordinates": result.scene.coordinates(),
        "solver": _solver(pieces[0]),
        "parts": [{"steps": len(each.t), "solver": _solver(each)} for each in pieces] if pieces[0].part.system is not result.system else [],
        "rtol": result.stats["rtol"],
        "stats": result.stats,
        "events": {name: len(times.t) for name, times in result.events.items()},
        "corrections": [asdict(correction) for correction in result.assembly.corrections],
        "redundant": result.assembly.redundant,
    }


@contextmanager
def _replacing(path: Path) -> Iterator[io.BufferedWriter]:
    """A file that takes the place of the one at the path when it is complete: whoever is killed leaves the old one or the new one."""
    part = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        with open(part, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def load(path: str | os.PathLike[str]) -> Result:
    """The result in a file that ``result.save`` wrote. Raises ValueError for any other or damaged file, OSError where there is none."""
    try:
        arrays = _read(Path(path))
        head = _checked_head(arrays)
        missing = [name for name in ARRAYS if name not in arrays]
        if missing:
            raise ValueError(f"expected arrays {', '.join(ARRAYS)}, found none named {', '.join(missing)}")
        return _restored(head, arrays)
    except (LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ValueError(f"{path}: expected a result that result.save wrote, found a damaged one ({type(error).__name__}: {error})") from error
    except (ValueError, SimulationError) as error:
        raise ValueError(f"{path}: {'; '.join(str(error).splitlines())}") from error


def _read(path: Path) -> dict[str, Array]:
    """The known arrays of an uncompressed .npz."""
    with open(path, "rb") as file:
        size, start = os.fstat(file.fileno()).st_size, file.read(4)
        if start != b"PK\x03\x04":
            raise ValueError(f"expected a result that result.save wrote (.npz), found a file that starts with {start!r}")
        try:
            with zipfile.ZipFile(file) as archive:
                members = archive.infolist()
                if sum(member.file_size for member in members) > size:
                    raise ValueError("expected uncompressed arrays, found ones larger than the file")
                known = {f"{name}.npy": name for name in ("head", *ARRAYS, *CHOSEN, *EVENTS)}
                return {known[m.filename]: _array(archive.read(m), m.filename) for m in members if m.filename in known}
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError) as error:
            raise ValueError(f"expected a whole file, found a truncated or damaged one ({error})") from error


def _array(raw: bytes, name: str) -> Array:
    """The array in the bytes of an .npy file. ``np.load`` would allocate whatever a header claims before it reads."""
    stream = io.BytesIO(raw)
    if np.lib.format.read_magic(stream) != (1, 0):
        raise ValueError(f"{name}: expected version 1.0 of the .npy format, found another")
    shape, by_columns, dtype = np.lib.format.read_array_header_1_0(stream)
    expected, found = math.prod(shape) * dtype.itemsize, len(raw) - stream.tell()
    if by_columns or dtype.str not in ("<f8", "|u1") or expected != found:
        raise ValueError(f"{name}: expected {expected} bytes of float64 by rows, found {found} bytes of {dtype}")
    return np.frombuffer(raw, dtype, offset=stream.tell()).reshape(shape).astype(dtype.newbyteorder("="))


def _checked_head(arrays: dict[str, Array]) -> dict[str, Any]:
    if "head" not in arrays:
        raise ValueError("expected a result that result.save wrote, found an .npz without 'head'")
    try:
        head = json.loads(arrays["head"].tobytes())
    except ValueError as error:
        raise ValueError(f"head: expected a JSON text, found another ({error})") from error
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        raise ValueError(f"head: expected the format {FORMAT!r}, found another")
    if head["version"] != VERSION:
        raise ValueError(f"expected version {VERSION} of the format, found {head['version']!r}; load it with mbd {head['mbd']}, which wrote it")
    return head


def _restored(head: dict[str, Any], arrays: dict[str, Array]) -> Result:
    told = head.get("parts", [])
    n = len(head["coordinates"]) if told else arrays["q"].shape[-1]
    scene = rebuilt(head["gravity"], head["items"], n, max(n, arrays["stress"].shape[-1]))
    system = scene.build()
    if scene.coordinates() != head["coordinates"]:
        raise ValueError(f"expected the coordinates of the run, found others; mbd {head['mbd']} wrote the file, this is {__version__}")
    parts = scene.parts() if told else [Part.whole(scene)]
    if told and len(told) != len(parts):
        raise ValueError(f"parts: expected {len(parts)} of this scene, found {len(told)}")
    pieces = divided(arrays, parts, [part["steps"] for part in told])
    check_shapes({name: array for name, array in arrays.items() if name not in ("head", *ARRAYS)}, system)
    linears = [prepare(part.system, own["q"][0])[0] for part, own in zip(parts, pieces)]
    assembly = _assembly(head, parts, pieces, linears, system.n)
    chosen_solvers = [_rebuilt_solver(part["solver"]) for part in told or [head]]
    steps = [_trajectory(*each, float(head["rtol"])) for each in zip(parts, pieces, chosen_solvers, linears)]
    chosen = (arrays["chosen_t"], arrays["chosen_q"], arrays["chosen_v"]) if CHOSEN[0] in arrays else None
    return Result(scene, system, joined(steps, system.n), head["stats"], assembly, chosen, _events(head.get("events", {}), arrays))


def _rebuilt_solver(data: dict[str, Any]) -> Any:
    if data["class"] not in solvers.__all__:
        raise ValueError(f"solver: expected one of {', '.join(solvers.__all__)}, found {data['class']!r}")
    return getattr(solvers, data["class"])(**data["fields"])


def _trajectory(part: Part, own: dict[str, Array], solver: Any, linear: Any, rtol: float) -> Trajectory:
    states = [SolverState(**dict(zip(STATE, state))) for state in zip(own["t"].tolist(), *(own[name] for name in STATE[1:]))]
    return Trajectory(part, own["t"], own["q"], own["v"], own["work"], states, solver, solver.integrator(rtol), linear)


def _assembly(head: dict[str, Any], parts: list[Part], pieces: list[dict[str, Array]], linears: list[Any], n: int) -> Assembly:
    """The start as it was found, with linear algebra prepared anew."""
    begin = [State(own["q"][0], own["v"][0], float(own["t"][0])) for own in pieces]
    whole = together([Assembly(state, (), (), linear) for state, linear in zip(begin, linears)], parts, n)
    corrections = tuple(Correction(**correction) for correction in head["corrections"])
    return replace(whole, corrections=corrections, redundant=tuple(head["redundant"]))


def _events(counts: dict[str, int], arrays: dict[str, Array]) -> Events:
    if not counts:
        return Events({}, {})
    ends = np.cumsum(list(counts.values()))
    if min(counts.values()) < 0 or ends[-1] != len(arrays[EVENTS[0]]):
        raise ValueError(f"events: expected {ends[-1]} times, found {len(arrays[EVENTS[0]])}")
    parts = zip(*(np.split(arrays[name], ends[:-1]) for name in EVENTS))
    return Events({name: Times(*part) for name, part in zip(counts, parts)}, {})
