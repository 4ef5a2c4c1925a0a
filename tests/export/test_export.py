"""Data out: values equal to those of the result, labels and units right, files that read back as they were."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import mbd


@pytest.fixture(scope="module")
def planar() -> tuple[mbd.Result, dict[str, Any]]:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0, name="crank"))
    rod = scene.add(mbd.AncfCable((1, 0), (2, 0), n_elements=2, E=1e6, A=1e-3, I=1e-8, rho=1000, name="rod"))
    pivot = scene.add(mbd.Pin(crank.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))
    scene.add(mbd.Pin(crank.at(0.5, 0), rod.start))
    turn = scene.add(mbd.Angle(crank.at(), scene.ground.at(), name="turn"))
    result = mbd.simulate(scene, t_end=0.1, rtol=1e-5)
    return result, {"tip": rod.end, "pivot": pivot, "turn": turn, "crank": crank, "speed": lambda r: r.velocity(rod.end)}


@pytest.fixture(scope="module")
def spatial() -> tuple[mbd.Result, dict[str, Any]]:
    scene = mbd.Scene(gravity=(0.0, 0.0, -9.81))
    top = scene.add(mbd.RigidBody(mass=1.0, inertia=(1, 1, 0.5), position=(0, 0, 1), velocity=(1, 0, 0), angular_velocity=(0, 1, 10)))
    tip = scene.add(mbd.Ball(top.at(0, 0, -1), scene.ground.at(0, 0, 0), name="tip"))
    return mbd.simulate(scene, t_end=0.1), {"top": top, "tip": tip}


def test_labelled_arrays(planar: Any):
    pytest.importorskip("xarray")
    result, outputs = planar
    data = result.to_xarray(outputs)
    np.testing.assert_array_equal(data["tip position"].sel(axis="y"), result.position(outputs["tip"])[:, 1])
    np.testing.assert_array_equal(data["pivot force"], result.reaction(outputs["pivot"])[:, :2])
    np.testing.assert_array_equal(data["pivot moment"], result.reaction(outputs["pivot"])[:, 2])
    np.testing.assert_array_equal(data["crank angle"], result.angle(outputs["crank"]))
    np.testing.assert_array_equal(data["q"].sel(coordinate=result.scene.coordinates()[3]), result.q[:, 3])
    np.testing.assert_array_equal(data["total_energy"], result.energy.total)
    assert data["time"].attrs["units"] == "s" and data["tip position"].attrs["units"] == "m" and data["pivot moment"].attrs["units"] == "N m"
    assert data["turn angle"].attrs["units"] == "rad" and data.attrs["solver"] == result.stats["solver"]
    times = [0.0, 0.033, 0.1]
    np.testing.assert_array_equal(result.to_xarray(outputs, times)["tip position"], result.position(outputs["tip"], times))
    assert set(result.to_xarray().data_vars) >= {"q", "v", "kinetic_energy"}


def test_labelled_arrays_in_space(spatial: Any):
    pytest.importorskip("xarray")
    result, outputs = spatial
    data = result.to_xarray(outputs)
    np.testing.assert_array_equal(data["tip moment"], result.reaction(outputs["tip"])[:, 3:])
    np.testing.assert_array_equal(data["top angular velocity"].sel(axis="z"), result.angular_velocity(outputs["top"])[:, 2])


def test_a_data_frame(planar: Any):
    pytest.importorskip("pandas")
    result, outputs = planar
    frame = result.to_dataframe(outputs)
    assert frame.index.name == "t [s]" and frame.index[-1] == 0.1
    headings = ["tip position x [m]", "tip position y [m]", "pivot force x [N]", "pivot force y [N]", "pivot moment z [N m]", "turn angle [rad]"]
    assert list(frame.columns) == [*headings, "crank angle [rad]", "speed 0", "speed 1"]
    np.testing.assert_array_equal(frame["speed 1"], result.velocity(outputs["tip"])[:, 1])


def test_text_files_read_back_exactly(planar: Any, tmp_path: Path):
    result, outputs = planar
    path = tmp_path / "run.csv"
    result.to_csv(path, {"tip": outputs["tip"], "a, b": outputs["crank"]}, t=np.linspace(0.0, 0.1, 7))
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["t [s]", "tip position x [m]", "tip position y [m]", "a, b angle [rad]"]
    values = np.array(rows, dtype=float)
    np.testing.assert_array_equal(values[:, 1:3], result.position(outputs["tip"], np.linspace(0.0, 0.1, 7)))


def test_outputs_are_checked_all_at_once(planar: Any, spatial: Any, tmp_path: Path):
    result, outputs = planar
    with pytest.raises(mbd.SceneError) as caught:
        result.to_csv(tmp_path / "run.csv", {"other": spatial[1]["top"], "": outputs["tip"], "wrong": 3})
    assert len(caught.value.complaints) == 3 and "another" in str(caught.value) and "found 3" in str(caught.value)
    with pytest.raises(mbd.SceneError, match="expected names"):
        result.to_dataframe([outputs["tip"]])
    with pytest.raises(mbd.SceneError, match="one for each time"):
        result.to_dataframe({"bad": lambda r: 1.0})


@pytest.mark.parametrize("which", ["planar", "spatial"])
def test_paraview_files_hold_the_motion(which: str, request: Any, tmp_path: Path):
    meshio = pytest.importorskip("meshio")
    result, outputs = request.getfixturevalue(which)
    times = [0.0, 0.04, 0.1]
    result.to_paraview(tmp_path / "run.pvd", times)
    entries = ElementTree.parse(tmp_path / "run.pvd").getroot().findall("./Collection/DataSet")
    assert [float(entry.get("timestep") or "nan") for entry in entries] == times
    marker = outputs["tip"] if which == "planar" else outputs["top"].at()
    mesh = meshio.read(tmp_path / (entries[1].get("file") or ""))
    position, velocity = (np.zeros(3), np.zeros(3))
    position[: result.system.dimension] = result.position(marker, 0.04)
    velocity[: result.system.dimension] = result.velocity(marker, 0.04)
    nearest = int(np.argmin(np.linalg.norm(mesh.points - position, axis=1)))
    np.testing.assert_allclose(mesh.points[nearest], position, atol=1e-12)
    np.testing.assert_allclose(mesh.point_data["velocity"][nearest], velocity, atol=1e-12)
    numbers = {int(number) for block in mesh.cell_data["item"] for number in block}
    assert 0 in numbers and numbers <= set(range(len(result.scene.items)))
