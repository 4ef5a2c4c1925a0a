"""Files that fail: a write that is interrupted leaves the old file, a file that is no whole result is refused in one sentence."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd
from mbd import archive

CABLE: dict[str, Any] = {"E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 2000}


@pytest.fixture(scope="module")
def result() -> mbd.Result:
    """Of a pendulum of one rod."""
    scene = mbd.Scene()
    body = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="body"))
    scene.add(mbd.Pin(body.at(-0.5, 0), scene.ground.at(0, 0), name="joint"))
    return mbd.simulate(scene, t_end=0.04)


@pytest.fixture
def file(result, tmp_path) -> Path:
    result.save(tmp_path / "run.npz")
    return tmp_path / "run.npz"


def test_a_failing_write_leaves_the_old_file(file, result, monkeypatch):
    before = file.read_bytes()

    def full(stream: Any, **arrays: Any) -> None:
        stream.write(b"half of it")
        raise OSError("No space left on device")

    with monkeypatch.context() as patch, pytest.raises(OSError, match="No space"):
        patch.setattr(archive.np, "savez", full)
        result.save(file)
    assert file.read_bytes() == before and list(file.parent.iterdir()) == [file]


@pytest.mark.parametrize("place", ["none/run.npz", "."])
def test_an_impossible_place(result, tmp_path, place):
    with pytest.raises(OSError):
        result.save(tmp_path / place)
    assert not list(tmp_path.iterdir())


def test_a_killed_write_leaves_the_old_file(file):
    """Killed at the worst moment, everything written but not yet in place."""
    before = file.read_bytes()
    code = "import mbd, os, sys; r = mbd.load(sys.argv[1]); os.replace = lambda *a: os.kill(os.getpid(), 9); r.save(sys.argv[1])"
    environment = os.environ | {"PYTHONPATH": str(Path(mbd.__file__ or "").parents[1])}
    done = subprocess.run([sys.executable, "-c", code, str(file)], env=environment, cwd=file.parent)
    assert done.returncode == -signal.SIGKILL
    assert file.read_bytes() == before
    mbd.load(file)


def test_numpy_reads_it_without_pickle(file, result):
    with np.load(file, allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["q"], result.q)


def refused(path: Path, message: str) -> None:
    with pytest.raises(ValueError, match=message) as trouble:
        mbd.load(path)
    text = str(trouble.value)
    assert text.startswith(str(path)) and "expected" in text and ("found" in text or "=" in text) and "\n" not in text, text


def rewrite(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], None]) -> None:
    """The file with its arrays and head (as data) changed."""
    with np.load(path) as stored:
        arrays: dict[str, Any] = dict(stored)
    head = json.loads(arrays["head"].tobytes())
    change(arrays, head)
    if "head" in arrays:
        arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    np.savez(path, **arrays)


def test_no_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        mbd.load(tmp_path / "none.npz")


def test_other_files(tmp_path):
    path = tmp_path / "other.npz"
    path.write_bytes(b"")
    refused(path, "starts with b''")
    path.write_text("t, x\n0, 1\n")
    refused(path, "starts with b't, x'")
    np.save(buffer := io.BytesIO(), np.zeros(3))
    path.write_bytes(buffer.getvalue())
    refused(path, "starts with")
    np.savez(path, t=np.zeros(3))
    refused(path, "without 'head'")
    np.savez(path, head=np.frombuffer(b"{", dtype=np.uint8))
    refused(path, "JSON")
    np.savez(path, head=np.frombuffer(b'{"format": "jpeg"}', dtype=np.uint8))
    refused(path, "format 'mbd result'")
    np.savez(path, head=np.frombuffer(b"[" * 100000, dtype=np.uint8))
    refused(path, "RecursionError|JSON")


def test_truncated_and_damaged_bytes(file, tmp_path):
    """Never anything but a refusal, or the very same result where the byte does not matter."""
    whole, expected = file.read_bytes(), mbd.load(file)
    path = tmp_path / "bad.npz"
    for length in (10, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        refused(path, "truncated or damaged")
    random = np.random.default_rng(1)
    for where in random.integers(0, len(whole), 150):
        path.write_bytes(whole[:where] + bytes([whole[where] ^ int(random.integers(1, 256))]) + whole[where + 1 :])
        try:
            found = mbd.load(path)
        except ValueError:
            continue
        np.testing.assert_array_equal(found.q, expected.q)
        assert found.stats == expected.stats


def test_pickles_are_not_opened(file):
    class Trap:
        def __reduce__(self) -> tuple[Any, ...]:
            return os.mkdir, (str(file.parent / "executed"),)

    rewrite(file, lambda arrays, head: arrays.update(v=np.array([Trap()], dtype=object)))
    refused(file, "v.npy: expected")
    assert not (file.parent / "executed").exists()


def test_files_that_would_swell(file):
    with np.load(file) as stored:
        arrays = dict(stored)
    np.savez_compressed(file, **arrays | {"q": np.zeros((1000, 1000))})
    refused(file, "uncompressed")
    claim = io.BytesIO()
    np.lib.format.write_array_header_1_0(claim, {"descr": "<f8", "fortran_order": False, "shape": (10**13,)})
    with zipfile.ZipFile(file, "w") as out:
        out.writestr("q.npy", claim.getvalue() + bytes(16))
    refused(file, "q.npy: expected")


Edit = Callable[[dict[str, Any], dict[str, Any]], Any]
EDITS: dict[str, tuple[Edit, str]] = {
    "version": (lambda arrays, head: head.update(version=1), "expected version 2 .* found 1"),
    "no head": (lambda arrays, head: arrays.pop("head"), "without 'head'"),
    "no v": (lambda arrays, head: arrays.pop("v"), "found none named v"),
    "no items": (lambda arrays, head: head.pop("items"), "damaged"),
    "wrong shape": (lambda arrays, head: arrays.update(v=arrays["v"][:, 1:]), "v: expected finite numbers of shape"),
    "flat": (lambda arrays, head: arrays.update(q=np.zeros(())), "damaged"),
    "no steps": (lambda arrays, head: arrays.update({k: a[:0] for k, a in arrays.items() if k != "head"}), "damaged|t: expected"),
    "NaN": (lambda arrays, head: arrays["q"].__setitem__((1, 1), np.nan), "q: expected finite"),
    "integers": (lambda arrays, head: arrays.update(t=np.arange(len(arrays["t"]))), "t.npy: expected"),
    "backwards": (lambda arrays, head: arrays.update(t=arrays["t"][::-1].copy()), "t: expected one time or more, ascending"),
    "half of the chosen": (lambda arrays, head: arrays.update(chosen_q=arrays["q"]), "damaged"),
    "other coordinates": (lambda arrays, head: head.update(coordinates=["x"]), "coordinates"),
    "strange kind": (lambda arrays, head: head["items"][0].update({"class": "System"}), "expected kinds among"),
    "strange field": (lambda arrays, head: head["items"][0]["fields"].update(colour=1), "damaged"),
    "bad number": (lambda arrays, head: head["items"][0]["fields"].update(mass=-1.0), "mass: expected a number not below zero"),
    "more items": (lambda arrays, head: head["items"].append(particle("b")), "found more at 'b'"),
    "huge count": (lambda arrays, head: head["items"].append(cable(10**12)), "counts"),
    "marker elsewhere": (lambda arrays, head: head["items"][1]["fields"]["a"].update(at=[0.5]), "at: expected 2 numbers"),
    "marker of text": (lambda arrays, head: head["items"][1]["fields"]["a"].update(at=["x", 0.0]), "at: expected numbers"),
    "strange solver": (lambda arrays, head: head["parts"][0]["solver"].update({"class": "Solver"}), "solver: expected one of"),
    "bad solver": (lambda arrays, head: head["parts"][0]["solver"].update({"class": "Radau", "fields": {"stages": 4}}), "stages=4"),
    "bad gravity": (lambda arrays, head: head.update(gravity=[1.0]), "gravity|found"),
}


def particle(name: str) -> dict[str, Any]:
    return {"class": "Particle", "fields": {"mass": 1.0, "position": [0.0, 0.0], "velocity": None, "name": name}}


def cable(count: int) -> dict[str, Any]:
    data = {field.name: None for field in fields(mbd.AncfCable)} | CABLE | {"start": [0, 0], "end": [1, 0], "n_elements": count}
    return {"class": "AncfCable", "fields": data | {"damping": 0, "elasticity": "continuum", "gravity": "lumped", "gauss_points": 7, "name": "c"}}


@pytest.mark.parametrize("edit", EDITS)
def test_edited_files(file, edit):
    change, message = EDITS[edit]
    rewrite(file, change)
    refused(file, message)
