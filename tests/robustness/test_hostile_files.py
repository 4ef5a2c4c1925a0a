"""Files that mean harm: bytes flipped and cut, heads and arrays changed to anything; a refusal in bounded time and memory, or a result."""

from __future__ import annotations

import copy
import io
import json
import os
import random
import subprocess
import sys
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import mbd

ROOT = Path(mbd.__file__ or "").parents[1]
SECONDS = 1.0
Change = Callable[[dict[str, Any], dict[str, Any], random.Random], None]


def scene() -> mbd.Scene:
    out = mbd.Scene()
    rod = out.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=2000, name="rod"))
    body = out.add(mbd.RigidBody.rod((1, 0), (2, 0), mass=1.0, name="body"))
    out.add(mbd.Pin(rod.start, out.ground.at(0, 0), name="foot"))
    out.add(mbd.Pin(rod.end, body.at(-0.5, 0), name="knee"))
    out.add(mbd.Force(body.at(), (0.0, 1.0), name="push"))
    out.add(mbd.Spring(out.add(mbd.Particle(1.0, (5, 0), name="ball")).at(), out.ground.at(5, 2), stiffness=200.0))
    return out


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("hostile") / "run.npz"
    mbd.simulate(scene(), 0.03, t_eval=[0.0, 0.01]).save(path)
    return path.read_bytes()


def opened(whole: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    with np.load(io.BytesIO(whole)) as stored:
        arrays = dict(stored)
    return arrays, json.loads(arrays.pop("head").tobytes())


def closed(arrays: dict[str, Any], head: Any) -> bytes:
    out = io.BytesIO()
    text = head if isinstance(head, bytes) else json.dumps(head).encode()
    np.savez(out, head=np.frombuffer(text, dtype=np.uint8), **arrays)
    return out.getvalue()


VALUES: list[Any] = [
    None, True, -1, 0, 1, 3, 10**9, 10**18, -(10**9), 1e308, -1e-308, float("nan"), float("inf"), "", "x", "x" * 1_000_000, "../../etc", [], {},
    [0.0], [[1.0] * 3] * 3, {"function": None}, {"item": "rod"}, {"item": "none"}, {"marker": "rod", "point": {}, "axes": [], "rigid": True},
    [1] * 100_000,
]  # fmt: skip


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """All places in JSON data."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, part in inner for place in places(part, (*path, key)))]


def changed_head(head: Any, draw: random.Random) -> Any:
    """One to three places given other values, copied elsewhere, left out, or wrapped."""
    head = copy.deepcopy(head)
    for _ in range(draw.randint(1, 3)):
        path = draw.choice(places(head)[1:] or [()])
        if not path:
            return copy.deepcopy(draw.choice(VALUES))
        holder = head
        for key in path[:-1]:
            holder = holder[key]
        act = draw.randrange(5)
        if act == 0 and isinstance(holder, dict):
            del holder[path[-1]]
        elif act == 1 and isinstance(holder, list):
            holder.extend(holder * draw.choice([1, 2, 50]))
        elif act == 2:
            holder[path[-1]] = [holder[path[-1]]]
        else:
            holder[path[-1]] = copy.deepcopy(draw.choice(VALUES))
    return head


def changed_arrays(arrays: dict[str, Any], draw: random.Random) -> dict[str, Any]:
    arrays = dict(arrays)
    name = draw.choice(sorted(arrays))
    array = arrays[name]
    ways: list[Callable[[], Any]] = [
        lambda: array[:-1], lambda: array.ravel(), lambda: array * np.nan, lambda: array * 1e300, lambda: -array, lambda: np.zeros(0),
        lambda: array[None],
        lambda: np.zeros((0, 10**9)), lambda: np.zeros((10**5, 0)), lambda: array.astype(complex), lambda: array.astype("<f4"), lambda: array + 1.0,
        lambda: np.asfortranarray(np.tile(array, (2, 1))), lambda: np.random.default_rng(1).permutation(array),
    ]  # fmt: skip
    arrays[name] = draw.choice(ways)()
    if draw.random() < 0.1:
        arrays.pop(draw.choice(sorted(arrays)))
    return arrays


def changed_bytes(whole: bytes, draw: random.Random) -> bytes:
    if draw.random() < 0.2:
        return whole[: draw.randrange(len(whole))]
    out = bytearray(whole)
    for _ in range(draw.choice([1, 1, 3, 30])):
        out[draw.randrange(len(out))] = draw.randrange(256)
    if draw.random() < 0.1:
        cut = draw.randrange(len(out))
        out[cut:cut] = out[draw.randrange(len(out)) :]
    return bytes(out)


def mutated(whole: bytes, draw: random.Random) -> bytes:
    arrays, head = opened(whole)
    kind = draw.choice([0, 1, 2, 2])
    if kind == 0:
        return changed_bytes(whole, draw)
    if kind == 1:
        return closed(changed_arrays(arrays, draw), head)
    return closed(arrays, changed_head(head, draw))


def judged(files: list[bytes], whole: bytes, folder: Path) -> list[str]:
    """What loading each made of it, after a whole one; none may take more than its time and memory, or fail otherwise than by ValueError."""
    paths = [folder / f"{k}.npz" for k in range(len(files) + 1)]
    for path, data in zip(paths, [whole, *files]):
        path.write_bytes(data)
    command = [sys.executable, str(Path(__file__).parent / "hostile.py"), *map(str, paths)]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    assert len(lines) == len(paths), f"{paths[len(lines)]} ended the process: {done.stderr[-500:]}"
    told = [line.split(" ", 1) for line in lines]
    assert not {path.name: line for path, line in zip(paths, told) if line[1] not in ("loaded", "refused") or float(line[0]) > SECONDS}
    return [verdict for _, verdict in told[1:]]


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")
@pytest.mark.parametrize("count", [100, pytest.param(2400, marks=pytest.mark.slow)])
def test_files_changed_at_random(count: int, whole: bytes, tmp_path: Path) -> None:
    draw = random.Random(count)
    for _ in range(max(count // 200, 1)):
        found = judged([mutated(whole, draw) for _ in range(min(count, 200))], whole, tmp_path)
        assert found.count("refused") > len(found) / 3


def twice(arrays: dict[str, Any], head: Any) -> bytes:
    out = io.BytesIO(closed(arrays, head))
    with warnings.catch_warnings(), zipfile.ZipFile(out, "a") as archive:
        warnings.simplefilter("ignore")
        archive.writestr("q.npy", archive.read("q.npy"))
    return out.getvalue()


def many(arrays: dict[str, Any], head: Any) -> bytes:
    out = io.BytesIO(closed(arrays, head))
    with zipfile.ZipFile(out, "a") as archive:
        for k in range(20_000):
            archive.writestr(f"{k}", b"")
    return out.getvalue()


def bomb(arrays: dict[str, Any], head: Any) -> bytes:
    out = io.BytesIO()
    np.savez_compressed(out, head=np.frombuffer(json.dumps(head).encode(), dtype=np.uint8), **arrays | {"q": np.zeros(20_000_000)})
    return out.getvalue()


def edit(*path: Any, value: Any) -> Callable[[dict[str, Any], Any], bytes]:
    def changed(arrays: dict[str, Any], head: Any) -> bytes:
        holder = head
        for key in path[:-1]:
            holder = holder[key]
        holder[path[-1]] = value
        return closed(arrays, head)

    return changed


HOSTILE: dict[str, Callable[[dict[str, Any], Any], bytes]] = {
    "a member twice": twice,
    "very many members": many,
    "a bomb": bomb,
    "deep nesting": lambda arrays, head: closed(arrays, b'{"format": ' + b"[" * 200_000),
    "deep items": edit("items", 0, "fields", "start", value=json.loads("[" * 400 + "]" * 400)),
    "a huge number": lambda arrays, head: closed(arrays, b'{"format": ' + b"9" * 1_000_000 + b"}"),
    "a huge count": edit("items", 0, "fields", "n_elements", value=10**9),
    "a count that is none": edit("items", 0, "fields", "n_elements", value=float("inf")),
    "a huge name": edit("items", 0, "fields", "name", value="n" * 1_000_000),
    "huge coordinates": edit("coordinates", value=["x" * 1_000_000]),
    "many items": lambda arrays, head: closed(arrays, head | {"items": head["items"] * 2000}),
    "a huge step": edit("parts", 0, "steps", value=10**15),
    "a negative step": edit("parts", 0, "steps", value=-4),
    "a huge memory": edit("parts", 0, "fork", "memory", value={"stages.dq": [10**9, 10**9]}),
    "a memory of no size": edit("parts", 0, "fork", "memory", value={"stages.dq": [0, -3]}),
    "a NaN of a step": edit("parts", 0, "fork", "rhythm", value=[0.0, float("nan"), 1.0, None]),
    "counts of events": edit("events", value={"a": 10**18}),
    "negative events": edit("events", value={"a": 5, "b": -5}),
}


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")
def test_files_made_to_harm(whole: bytes, tmp_path: Path) -> None:
    names = list(HOSTILE)
    found = judged([HOSTILE[name](*opened(whole)) for name in names], whole, tmp_path)
    assert not [name for name, verdict in zip(names, found) if verdict == "loaded"]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_bytes_by_hypothesis(data: Any, whole: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    """The same file, or a refusal; shrunk to the least change where it is neither."""
    path = tmp_path_factory.getbasetemp() / "flipped.npz"
    flips = data.draw(st.lists(st.tuples(st.integers(0, len(whole) - 1), st.integers(0, 255)), min_size=1, max_size=4))
    out = bytearray(whole[: data.draw(st.integers(len(whole) // 2, len(whole)))])
    for place, value in flips:
        out[place % len(out)] = value
    path.write_bytes(bytes(out))
    try:
        assert np.isfinite(mbd.load(path).q).all()
    except ValueError as error:
        assert str(error).startswith(str(path))


def test_a_fork_of_another_shape_is_refused_when_it_is_used(whole: bytes, tmp_path: Path) -> None:
    arrays, head = opened(whole)
    fork = head["parts"][0]["fork"]
    sizes = [int(np.prod(shape)) for shape in fork["memory"].values()]
    fork["memory"] = {name: [size] for name, size in zip(fork["memory"], sizes)}
    (tmp_path / "run.npz").write_bytes(closed(arrays, head))
    with pytest.raises(ValueError, match="memory: expected numbers"):
        mbd.resume(tmp_path / "run.npz")
