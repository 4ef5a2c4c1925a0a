"""Ctrl-C and kill -9: what is left of a run, and of a file that was being written."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import mbd

ROOT = Path(mbd.__file__ or "").parents[1]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}

LONG = """
import sys, mbd
scene = mbd.Scene()
rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
told = []
def push(t):
    if t > 1.0 and not told:
        told.append(t)
        print("on its way", flush=True)
    return (0.0, 0.0)
push.discontinuities = ()  # or the search for jumps before the run would tell that it is on its way
scene.add(mbd.Force(rod.at(), push, name="push"))
"""


def interrupted(ending: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A long run in a process of its own that gets SIGINT on its way."""
    code = LONG + ending
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", code], env=ENVIRONMENT, cwd=folder, text=True, **pipes) as run:  # type: ignore[call-overload]
        assert run.stdout and run.stdout.readline() == "on its way\n"
        time.sleep(0.05)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=60)
    return subprocess.CompletedProcess(code, run.returncode, out, err)


def test_a_script_ends_with_one_line(tmp_path: Path) -> None:
    done = interrupted("mbd.simulate(scene, 1e6, checkpoint='run.npz')\nprint('never')", tmp_path)
    assert done.returncode == 130 and done.stdout == ""
    assert done.stderr.startswith("mbd: interrupted at t = ") and done.stderr.count("\n") == 1
    kept = mbd.load(tmp_path / "run.npz")
    assert kept.t[-1] > 1.0 and np.isfinite(kept.energy.total).all()


def test_what_catches_an_interrupt_has_the_result(tmp_path: Path) -> None:
    catch = """
try:
    mbd.simulate(scene, 1e6)
except Exception:
    print("not this way")
except KeyboardInterrupt as stop:
    print(type(stop).__name__, len(stop.result.t) == len(stop.result.q), stop.result.t[-1] == stop.time, stop.result.audit.balanced)
"""
    done = interrupted(catch, tmp_path)
    assert (done.stdout, done.stderr, done.returncode) == ("Interrupted True True True\n", "", 0)


def test_other_errors_of_a_script_are_shown_as_ever(tmp_path: Path) -> None:
    done = interrupted("try:\n    mbd.simulate(scene, 1e6)\nexcept KeyboardInterrupt:\n    raise ValueError('mine') from None", tmp_path)
    assert done.returncode == 1 and "Traceback" in done.stderr and "ValueError: mine" in done.stderr


def test_a_notebook_shows_one_line() -> None:
    scene = mbd.Scene()
    scene.add(mbd.Particle(1.0, (0.0, 0.0)))
    shown = mbd.Interrupted(mbd.simulate(scene, 0.1))._render_traceback_()
    assert len(shown) == 1 and "t = 0.1" in shown[0] and "sys.last_value.result" in shown[0]


SAVING = """
import sys, mbd
results = [mbd.load(name) for name in ("one.npz", "two.npz")]
print("ready", flush=True)
while True:
    for result in results:
        result.save("run.npz")
"""


def test_killed_while_it_saves(tmp_path: Path) -> None:
    """At random moments: the old file or the new one, never half; what is left of the write goes with a later one."""
    scene = mbd.Scene()
    scene.add(mbd.Particle(1.0, (0.0, 0.0)))
    for name, t_end in (("one.npz", 0.1), ("two.npz", 0.2)):
        times = np.linspace(0.0, t_end, 20_000)
        mbd.simulate(scene, t_end, t_eval=times).save(tmp_path / name)
    mbd.load(tmp_path / "one.npz").save(tmp_path / "run.npz")
    draw = random.Random(1)
    for _ in range(6):
        with subprocess.Popen([sys.executable, "-c", SAVING], env=ENVIRONMENT, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as run:
            assert run.stdout and run.stdout.readline() == "ready\n"
            time.sleep(draw.uniform(0.0, 0.05))
            run.kill()
        assert mbd.load(tmp_path / "run.npz").t[-1] in (0.1, 0.2)
    left = list(tmp_path.glob(".run.npz.*.part"))
    (stale := tmp_path / ".run.npz.0123abcd.part").write_bytes(b"half")
    os.utime(stale, (0, 0))
    mbd.load(tmp_path / "one.npz").save(tmp_path / "run.npz")
    assert not stale.exists() and all(part.exists() for part in left), "only what is old: another process may be at it"


@pytest.mark.parametrize("phase", ["mbd.run.announce", "mbd.solvers.linear.Linear.factor", "mbd.solvers.start.accelerations"])
def test_interrupts_elsewhere_pass(phase: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """During assembly and within linear algebra too: nothing takes them for a failed step."""

    def stop(*arguments: object, **options: object) -> None:
        raise KeyboardInterrupt

    scene = mbd.Scene()
    rod = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=2000))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    monkeypatch.setattr(phase, stop)
    with pytest.raises(KeyboardInterrupt):
        mbd.simulate(scene, 1.0)
