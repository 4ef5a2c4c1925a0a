"""Sweeps: tables, failures of single cases, executors, and files from which they go on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.sweeps.checkpoint import Checkpoint

OUTPUTS: dict[str, Any] = {}


def pendulum(length: float, mass: float = 1.0) -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (length, 0), mass=mass, name="rod"))
    scene.add(mbd.Pin(rod.at(-length / 2, 0), scene.ground.at(0, 0), name="pivot"))
    return scene


def tip(result: mbd.Result) -> Any:
    rod = result.scene["rod"]
    return result.position(rod.at(rod.length / 2, 0))[-1]


def work(result: mbd.Result) -> float:
    return float(result.energy.kinetic[-1])


def dies(length: float) -> mbd.Scene:
    if length > 2.5:
        os._exit(3)
    return pendulum(length)


OUTPUTS = {"tip": tip, "kinetic": work}


def test_all_combinations_in_order():
    table = mbd.sweep(pendulum, {"length": [1.0, 2.0], "mass": [1.0, 3.0]}, OUTPUTS, t_end=0.2)
    assert [tuple(case.values()) for case in table.cases] == [(1.0, 1.0), (1.0, 3.0), (2.0, 1.0), (2.0, 3.0)]
    assert table["tip"].shape == (4, 2) and not np.ma.is_masked(table["tip"])
    np.testing.assert_allclose(table["kinetic"][1::2], 3.0 * table["kinetic"][::2], rtol=1e-9)  # a mass scales all
    alone = mbd.simulate(pendulum(2.0, 3.0), t_end=0.2)
    assert np.array_equal(table["tip"][3], tip(alone))


def test_a_list_of_cases():
    table = mbd.sweep(pendulum, [{"length": 1.0}, {"length": 1.5}], {"tip": tip}, t_end=0.1)
    assert len(table) == 2 and table.parameters is None and not table.failures


def test_analyses_of_its_own():
    def frequency(modes: mbd.Modes) -> float:
        return float(modes.frequencies[0])

    def hanging(length: float) -> Any:
        scene = mbd.Scene(gravity=(0.0, -9.81))
        rod = scene.add(mbd.RigidBody.rod((0, 0), (0, -length), mass=1.0))
        scene.add(mbd.Pin(rod.at(-length / 2, 0), scene.ground.at(0, 0)))
        return mbd.modes(scene)

    table = mbd.sweep(hanging, {"length": [0.5, 1.0, 2.0]}, {"frequency": frequency})
    np.testing.assert_allclose(table["frequency"], np.sqrt(1.5 * 9.81 / np.array([0.5, 1.0, 2.0])), rtol=1e-8)  # a rod about its end


def test_a_failure_is_of_its_case_alone():
    table = mbd.sweep(pendulum, {"length": [1.0, 0.0, 2.0]}, {"tip": tip, "kinetic": work}, t_end=0.1)
    assert [case["length"] for case, _ in table.failures] == [0.0]
    assert table.failures[0][1]
    assert np.array_equal(table["kinetic"].mask, [False, True, False])
    assert table.columns()["tip[0]"][1] is None
    assert "failure" in str(table)


def test_outputs_are_checked():
    table = mbd.sweep(pendulum, {"length": [1.0]}, {"bad": lambda result: np.nan}, t_end=0.1)
    assert "expected finite numbers" in table.failures[0][1]
    table = mbd.sweep(pendulum, {"length": [1.0]}, {"bad": lambda result: 1 / 0}, t_end=0.1)
    assert "ZeroDivisionError" in table.failures[0][1] and "'bad'" in table.failures[0][1]


@pytest.mark.parametrize(
    ("arguments", "settings", "told"),
    [
        ((None, {"length": [1.0]}, OUTPUTS), {}, "build: expected a function"),
        ((pendulum, {}, OUTPUTS), {}, "parameters: expected names"),
        ((pendulum, {"length": 1.0}, OUTPUTS), {}, "parameters: expected names"),
        ((pendulum, {"length": []}, OUTPUTS), {}, "at least one case"),
        ((pendulum, [], OUTPUTS), {}, "at least one case"),
        ((pendulum, {"lenght": [1.0]}, OUTPUTS), {}, "expected the arguments of pendulum, found lenght"),
        ((pendulum, [{"length": 1.0}, {"mass": 1.0}], OUTPUTS), {}, "the same names in all cases"),
        ((pendulum, {"length": [1.0]}, {}), {}, "outputs: expected names"),
        ((pendulum, {"length": [1.0]}, {"tip": 3}), {}, "outputs: expected names"),
        ((pendulum, {"length": [1.0]}, OUTPUTS), {"t_ned": 1.0}, "found t_ned"),
    ],
)
def test_wrong_arguments(arguments: Any, settings: Any, told: str):
    with pytest.raises(mbd.SceneError, match=told):
        mbd.sweep(*arguments, **settings)


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_executors_give_the_same(executor: Any):
    pytest.importorskip("threadpoolctl")
    lengths = np.linspace(1.0, 2.0, 6)
    here = mbd.sweep(pendulum, {"length": lengths}, OUTPUTS, t_end=0.1)
    context = {"mp_context": get_context("fork")} if executor is ProcessPoolExecutor and sys.platform == "linux" else {}
    with executor(2, **context) as pool:
        there = mbd.sweep(pendulum, {"length": lengths}, OUTPUTS, pool, t_end=0.1)
    assert not there.failures
    assert np.array_equal(here["tip"], there["tip"])


def test_a_worker_that_dies_costs_no_finished_case(tmp_path: Path):
    pytest.importorskip("threadpoolctl")
    file = tmp_path / "sweep.jsonl"
    with ProcessPoolExecutor(1, mp_context=get_context("fork")) as pool:
        table = mbd.sweep(dies, {"length": [1.0, 2.0, 3.0]}, {"tip": tip}, pool, checkpoint=file, t_end=0.1)
    assert [case["length"] for case, _ in table.failures] == [3.0]
    assert "BrokenProcessPool" in table.failures[0][1]
    assert len(file.read_text().splitlines()) == 3  # a head and two cases


def counted(length: float) -> mbd.Scene:
    calls.append(length)
    return pendulum(length)


calls: list[float] = []


def test_it_goes_on_from_its_file(tmp_path: Path):
    file = tmp_path / "sweep.jsonl"
    calls.clear()
    first = mbd.sweep(counted, {"length": [1.0, 0.0, 2.0]}, OUTPUTS, checkpoint=file, t_end=0.1)
    assert calls == [1.0, 0.0, 2.0]
    whole = file.read_bytes()
    file.write_bytes(whole[:-9])  # the last line was cut when the machine failed
    again = mbd.sweep(counted, {"length": [1.0, 0.0, 2.0]}, OUTPUTS, checkpoint=file, t_end=0.1)
    assert calls[3:] == [0.0, 2.0]  # what failed, and what was cut
    assert np.ma.allequal(first["tip"], again["tip"])
    more = mbd.sweep(counted, {"length": [1.0, 2.0, 4.0]}, OUTPUTS, checkpoint=file, t_end=0.1)
    assert calls[5:] == [4.0]
    assert np.array_equal(more["tip"][0], again["tip"][0])


def test_a_file_of_another_sweep_is_refused(tmp_path: Path):
    file = tmp_path / "sweep.jsonl"
    mbd.sweep(pendulum, {"length": [1.0]}, {"tip": tip}, checkpoint=file, t_end=0.1)
    with pytest.raises(ValueError, match="settings: expected"):
        mbd.sweep(pendulum, {"length": [1.0]}, {"tip": tip}, checkpoint=file, t_end=0.2)
    with pytest.raises(ValueError, match="outputs: expected"):
        mbd.sweep(pendulum, {"length": [1.0]}, OUTPUTS, checkpoint=file, t_end=0.1)
    with pytest.raises(ValueError, match="build: expected"):
        mbd.sweep(dies, {"length": [1.0]}, {"tip": tip}, checkpoint=file, t_end=0.1)


@pytest.mark.parametrize("content", [b"\x00\xff\n", b"[1]\n", b"{}\n", b"[" * 100_000 + b"\n", b'{"format": "mbd sweep"}\n'])
def test_damaged_files_are_refused(tmp_path: Path, content: bytes):
    file = tmp_path / "sweep.jsonl"
    file.write_bytes(content)
    with pytest.raises(ValueError, match=r"sweep\.jsonl"):
        mbd.sweep(pendulum, {"length": [1.0]}, {"tip": tip}, checkpoint=file, t_end=0.1)
    assert file.read_bytes() == content


def test_lines_of_damaged_cases_are_named(tmp_path: Path):
    file = tmp_path / "sweep.jsonl"
    with Checkpoint(file, pendulum, ["length"], ["tip"], {}):
        pass
    with open(file, "a") as more:
        more.write(json.dumps({"case": {"length": 1.0}, "values": {"top": 1.0}}) + "\n")
    with pytest.raises(ValueError, match="line 2: expected a case and its tip"):
        Checkpoint(file, pendulum, ["length"], ["tip"], {})


def test_labelled_tables():
    pytest.importorskip("xarray")
    table = mbd.sweep(pendulum, {"length": [1.0, 0.0], "mass": [1.0, 2.0, 3.0]}, OUTPUTS, t_end=0.1)
    data = table.to_xarray()
    assert data["tip"].dims == ("length", "mass", "tip_0") and data.sizes["mass"] == 3
    assert float(data["kinetic"].sel(length=1.0, mass=2.0)) == table["kinetic"][1]
    assert np.isnan(data["kinetic"].sel(length=0.0)).all() and str(data["failure"].sel(length=0.0, mass=1.0).item())
    frame = table.to_dataframe()
    assert list(frame.columns) == ["length", "mass", "tip[0]", "tip[1]", "kinetic", "failure", "seconds"] and len(frame) == 6


def test_threads_of_workers_are_limited():
    pytest.importorskip("threadpoolctl")
    from threadpoolctl import threadpool_info

    def threads(result: Any) -> int:
        return max((pool["num_threads"] for pool in threadpool_info()), default=1)

    with ThreadPoolExecutor(1) as pool:
        table = mbd.sweep(pendulum, {"length": [1.0]}, {"threads": threads}, pool, t_end=0.01)
    assert table["threads"][0] == 1


DASK = """
import os, signal, sys, threading, time
import mbd
from dask.distributed import Client, LocalCluster
sys.path.insert(0, sys.argv[1])
from sweep_case import slow, tip

if __name__ == "__main__":
    with LocalCluster(n_workers=3, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.run(lambda folder: sys.path.insert(0, folder), sys.argv[1])
        victim = next(iter(client.run(os.getpid).values()))
        threading.Timer(1.0, os.kill, (victim, signal.SIGKILL)).start()
        lengths = [1.0 + 0.1 * k for k in range(30)] + [0.0]
        table = mbd.sweep(slow, {"length": lengths}, {"tip": tip}, client.get_executor(), progress=False, t_end=0.1)
        pids = set(client.run(os.getpid).values())
    print(len(table), len(table.failures), table.failures[0][0]["length"], victim in pids)
    here = mbd.sweep(slow, {"length": [1.0, 1.1]}, {"tip": tip}, progress=False, t_end=0.1)
    print(bool((here["tip"] == table["tip"][:2]).all()))
"""
CASE = """
import time
import mbd

def slow(length):
    time.sleep(0.15)
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (length, 0), mass=1.0, name="rod"))
    scene.add(mbd.Pin(rod.at(-length / 2, 0), scene.ground.at(0, 0)))
    return scene

def tip(result):
    return result.position(result.scene["rod"].at())[-1]
"""


def test_a_dask_cluster_that_loses_a_worker(tmp_path: Path):
    """Three worker processes, one of which is killed: its cases run again elsewhere, and the one bad case is told."""
    pytest.importorskip("distributed")
    pytest.importorskip("threadpoolctl")
    (tmp_path / "sweep_case.py").write_text(CASE)
    (tmp_path / "run.py").write_text(DASK)
    paths = os.pathsep.join((str(Path(mbd.__file__ or "").parents[1]), str(tmp_path)))
    environment = os.environ | {"PYTHONPATH": paths}
    done = subprocess.run([sys.executable, tmp_path / "run.py", str(tmp_path)], env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["31 1 0.0 False", "True"]


@pytest.mark.slow
def test_two_processes_take_little_more_than_half_the_time():
    """200 pendulums: here, and on two processes that are up already; the best of three pairs in turn."""
    pytest.importorskip("threadpoolctl")
    if (os.cpu_count() or 1) < 2:
        pytest.skip("needs two processors")
    cases = {"length": np.linspace(1.0, 2.0, 200)}

    def seconds(executor: Any) -> float:
        clock = time.perf_counter()
        assert not mbd.sweep(pendulum, cases, {"tip": tip}, executor, progress=False, t_end=2.0, rtol=1e-9).failures
        return time.perf_counter() - clock

    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
        list(pool.map(abs, range(8)))
        gains = [seconds(None) / seconds(pool) for _ in range(3)]
    assert max(gains) >= 1.7, gains
