"""Results in files: ``result.save("run.npz")`` and ``mbd.load("run.npz")``.

An uncompressed .npz without pickle: ``head``, a JSON text in bytes, holds the descriptions of the scene's items, gravity, solvers and
statistics; every other member is a float64 array: of the trajectory (where parts of the scene were integrated separately, those of all parts
in one row), of the start as it was given, and of what going on needs (``forks.py``). Loading builds the scene anew of the same descriptions.
Nothing in a file is executed, and nothing much larger than the file is allocated for it.

Functions of t are stored where they are of ``mbd.functions`` (``mbd.Expression``, ``mbd.Sine``, ...). Others cannot be: what needs them
(accelerations, reactions, values between the steps) raises after loading, by name; everything else is answered.
"""

from __future__ import annotations

import glob
import io
import json
import math
import os
import secrets
import time
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import __version__, solvers
from .affine import Array
from .assembly import Assembly, Correction, prepared
from .descriptions import described, functions, rebuilt
from .errors import SceneWarning, SimulationError
from .event import Events, Times
from .forks import Row, read, written
from .parts import Part
from .progress import Plan, Progress, Stage
from .result import Result
from .solvers.protocol import State as SolverState
from .starts import together
from .state import State
from .stored import ARRAYS, CHOSEN, EVENTS, FORK, START, STATE, WANTED, check_shapes, divided, gathered
from .trajectory import Trajectory, joined

FORMAT, VERSION = "mbd result", 2
STALE = 3600.0
"""Age [s] after which what an interrupted write left is removed by the next one to the same place."""


def save(result: Result, path: str | os.PathLike[str]) -> None:
    """Writes a result. The file appears whole or not at all; until then an old one stays.

    Warns, by name, of items whose functions cannot be stored. Raises ValueError for a scene that has grown since the run.
    """
    missing = write(result, path)
    if missing:
        names = ", ".join(map(repr, missing))
        warnings.warn(f"functions of t are not stored: a loaded result refuses what needs those of {names}", SceneWarning, stacklevel=3)


def write(result: Result, path: str | os.PathLike[str]) -> list[str]:
    """As ``save``; returns the names of the items whose functions are not stored."""
    if result.scene.build() is not result.system:
        raise ValueError("save: expected the scene as it was in this run, found items added since; save a result before adding to its scene")
    progress = result.progress
    assert progress is not None
    forks = [written(stage) for stage in progress.stages]
    head = _head(result, progress, [fork for fork, _ in forks])
    arrays = gathered([stage.trajectory for stage in progress.stages], head["divided"])
    arrays |= dict(zip(START, (progress.plan.start.q, progress.plan.start.v)))
    arrays[FORK] = np.concatenate([np.zeros(0), *(array.ravel() for _, own in forks for array in own)])
    if progress.plan.t_eval is not None:
        arrays[WANTED] = progress.plan.t_eval
    if result.chosen:
        arrays |= dict(zip(CHOSEN, result.chosen))
    if result.events:
        arrays |= {name: np.concatenate(parts) for name, parts in zip(EVENTS, zip(*result.events.values()))}
    text = json.dumps(head, default=_plain)
    rows = {name: np.ascontiguousarray(array, dtype="<f8") for name, array in arrays.items()}
    with replacing(Path(path).resolve()) as file:
        np.savez(file, allow_pickle=False, head=np.frombuffer(text.encode(), dtype=np.uint8), **rows)
    return list(head["functions"])


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)


def _solver(piece: Trajectory) -> dict[str, Any]:
    return {"class": type(piece.solver).__name__, "fields": asdict(piece.solver)}


def _head(result: Result, progress: Progress, forks: list[Any]) -> dict[str, Any]:
    items, plan, stages = described(result.scene), progress.plan, progress.stages
    return {
        "format": FORMAT,
        "version": VERSION,
        "mbd": __version__,
        "gravity": result.scene.gravity,
        "items": items,
        "functions": functions(items),
        "coordinates": result.scene.coordinates(),
        "divided": stages[0].trajectory.part.system is not result.system,
        "parts": [
            {"steps": len(stage.trajectory.t), "solver": _solver(stage.trajectory), "fork": fork}
            | {name: getattr(stage, name) for name in ("reason", "softened", "spent")}
            for stage, fork in zip(stages, forks)
        ],
        "plan": {"t": plan.start.t, "t_end": plan.t_end, "rtol": plan.rtol, "events": list(plan.events)},
        "stats": result.stats,
        "events": {name: len(times.t) for name, times in result.events.items()},
        "corrections": [asdict(correction) for correction in result.assembly.corrections],
        "redundant": result.assembly.redundant,
    }


@contextmanager
def replacing(path: Path) -> Iterator[io.BufferedWriter]:
    """A file that takes the place of the one at the path when it is complete: whoever is killed leaves the old one or the new one."""
    for left in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > STALE:
                left.unlink()
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
        missing = [name for name in (*ARRAYS, *START, FORK) if name not in arrays]
        if missing:
            raise ValueError(f"expected arrays {', '.join((*ARRAYS, *START, FORK))}, found none named {', '.join(missing)}")
        return _restored(head, arrays)
    except (LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        found = _shortened(f"{type(error).__name__}: {error}")
        raise ValueError(f"{path}: expected a result that result.save wrote, found a damaged one ({found})") from error
    except (ValueError, SimulationError) as error:
        raise ValueError(f"{path}: {_shortened('; '.join(str(error).splitlines()))}") from error


def _shortened(text: str, most: int = 1000) -> str:
    """What a file says may be of any length."""
    return text if len(text) <= most else f"{text[:most]}..."


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
                known = {f"{name}.npy": name for name in ("head", *ARRAYS, *START, FORK, WANTED, *CHOSEN, *EVENTS)}
                if len({m.filename for m in members} & known.keys()) < len(members):
                    raise ValueError(f"expected members among {', '.join(known)}, each once, found others or one twice")
                return {known[m.filename]: _array(archive.read(m), m.filename) for m in members}
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
    told, apart = head["parts"], bool(head["divided"])
    n = len(head["coordinates"]) if apart else arrays["q"].shape[-1]
    scene = rebuilt(head["gravity"], head["items"], n, max(n, arrays["stress"].shape[-1]))
    system = scene.build()
    if scene.coordinates() != head["coordinates"]:
        raise ValueError(f"expected the coordinates of the run, found others; mbd {head['mbd']} wrote the file, this is {__version__}")
    parts = scene.parts() if apart else [Part.whole(scene)]
    if len(told) != len(parts):
        raise ValueError(f"parts: expected {len(parts)} of this scene, found {len(told)}")
    pieces = divided(arrays, parts, [part["steps"] for part in told] if apart else [])
    check_shapes({name: array for name, array in arrays.items() if name not in ("head", *ARRAYS, FORK)}, system)
    plan, events = _plan(head["plan"], arrays), _events(head["events"], arrays)
    stages = _stages(told, parts, pieces, plan, arrays[FORK])
    assembly = _assembly(head, parts, [stage.trajectory for stage in stages], system.n)
    chosen = (arrays["chosen_t"], arrays["chosen_q"], arrays["chosen_v"]) if CHOSEN[0] in arrays else None
    trajectory = joined([stage.trajectory for stage in stages], system.n)
    return Result(scene, system, trajectory, dict(head["stats"]), assembly, chosen, events, Progress(plan, tuple(stages)))


def _plan(data: dict[str, Any], arrays: dict[str, Array]) -> Plan:
    t, t_end, rtol = (float(data[name]) for name in ("t", "t_end", "rtol"))
    if not (math.isfinite(t + t_end) and 0.0 < rtol < 1.0):
        raise ValueError(f"plan: expected finite times and a tolerance, found {t}, {t_end} and {rtol}")
    start = State(arrays[START[0]], arrays[START[1]], t)
    return Plan(start, t_end, rtol, arrays.get(WANTED), dict.fromkeys(map(str, data["events"])))


def _stages(told: list[Any], parts: list[Part], pieces: list[dict[str, Array]], plan: Plan, forks: Array) -> list[Stage]:
    row, stages = Row(forks), []
    for data, part, own in zip(told, parts, pieces):
        mark = read(data["fork"], row, part)
        if mark and not (mark.steps < len(own["t"]) and mark.state.t == own["t"][mark.steps]):
            raise ValueError("fork: expected one of the steps, found another time")
        linear = prepared(part.system, plan.start.q[part.columns], bool(data["softened"]), own["q"][0])
        steps = _trajectory(part, own, _rebuilt_solver(data["solver"]), linear, plan.rtol)
        stages.append(Stage(steps, mark, bool(data["softened"]), int(data["spent"]), str(data["reason"])))
    row.end()
    return stages


def _rebuilt_solver(data: dict[str, Any]) -> Any:
    if data["class"] not in solvers.__all__:
        raise ValueError(f"solver: expected one of {', '.join(solvers.__all__)}, found {data['class']!r}")
    return getattr(solvers, data["class"])(**data["fields"])


def _trajectory(part: Part, own: dict[str, Array], solver: Any, linear: Any, rtol: float) -> Trajectory:
    states = [SolverState(**dict(zip(STATE, state))) for state in zip(own["t"].tolist(), *(own[name] for name in STATE[1:]))]
    return Trajectory(part, own["t"], own["q"], own["v"], own["work"], states, solver, solver.integrator(rtol), linear)


def _assembly(head: dict[str, Any], parts: list[Part], pieces: list[Trajectory], n: int) -> Assembly:
    """The start as it was found, with linear algebra prepared anew."""
    begin = [Assembly(State(own.q[0], own.v[0], float(own.t[0])), (), (), own.linear) for own in pieces]
    whole = together(begin, parts, n)
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
