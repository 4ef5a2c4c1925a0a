"""Pictures: what is drawn lies where the items are, labelled, to equal scales."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

import mbd
from mbd.plot import animate, plot_path

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
plt = pytest.importorskip("matplotlib.pyplot")

CABLE: dict[str, Any] = {"E": 1e6, "A": 1e-3, "I": 1e-8, "rho": 2000}


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def planar() -> mbd.Result:
    scene = mbd.Scene()
    rod = scene.add(mbd.AncfCable((0, 0), (1, 0), n_elements=3, name="rod", **CABLE))
    body = scene.add(mbd.RigidBody.rod((1, 0), (1, -1), mass=1.0, name="body"))
    ball = scene.add(mbd.Particle(0.5, (0.0, -1.0), velocity=(0.1, 0.0), name="ball"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    scene.add(mbd.Pin(rod.end, body.at(-0.5, 0)))
    scene.add(mbd.Spring(body.at(0.5, 0), ball.at(), stiffness=10.0, name="spring"))
    return mbd.simulate(scene, t_end=0.1, rtol=1e-4)


@pytest.fixture(scope="module")
def spatial() -> mbd.Result:
    scene = mbd.Scene(gravity=(0, 0, -9.81))
    rope = scene.add(mbd.AncfCable((0, 0, 0), (1, 0, 0), n_elements=3, name="rope", **CABLE))
    scene.add(mbd.Ball(rope.start, scene.ground.at(0, 0, 0)))
    scene.add(mbd.RigidBody(mass=1.0, inertia=(1.0, 1.0, 1.0), position=(0, 1, 0), angular_velocity=(1, 2, 3), name="body"))
    return mbd.simulate(scene, t_end=0.1, rtol=1e-4)


def lines(ax: Any, **properties: Any) -> list[Any]:
    return [line for line in ax.lines if all(getattr(line, f"get_{name}")() == value for name, value in properties.items())]


def points(line: Any) -> np.ndarray:
    return np.array(line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()).T


def near(line: Any, point: np.ndarray) -> float:
    """Distance of a point to the nearest one of a line."""
    return float(np.nanmin(np.linalg.norm(points(line) - point, axis=1)))


def test_ten_shapes_with_labels_to_equal_scales(planar):
    ax = planar.plot()
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("x [m]", "y [m]", 1.0)
    assert [other.get_ylabel() for other in ax.figure.axes if other is not ax] == ["t [s]"]
    shapes, springs, dots = lines(ax, linestyle="-"), lines(ax, linestyle="--"), lines(ax, marker="o")
    assert len(shapes) == len(springs) == len(dots) == 10
    assert len({line.get_color() if isinstance(line.get_color(), str) else tuple(line.get_color()) for line in shapes}) == 10
    assert len(ax.lines) == 31 and len(lines(ax, marker="^")) == 1


def test_shapes_lie_where_the_items_are(planar):
    times = [0.0, 0.03, 0.1]
    ax, scene = planar.plot(times), planar.scene
    for k, (shape, spring, dots) in enumerate(zip(lines(ax, linestyle="-"), lines(ax, linestyle="--"), lines(ax, marker="o"))):
        for marker in (scene["rod"].start, scene["rod"].end, scene["rod"].at(0.5), scene["body"].at(0.5, 0)):
            assert near(shape, planar.position(marker, t=times)[k]) < 1e-12
        for marker in (scene["body"].at(0.5, 0), scene["ball"].at()):
            assert near(spring, planar.position(marker, t=times)[k]) < 1e-12
        for marker in (scene["ball"].at(), scene["body"].at()):
            assert near(dots, planar.position(marker, t=times)[k]) < 1e-12
    np.testing.assert_array_equal(points(lines(ax, marker="^")[0]), [[0.0, 0.0]])


def test_cables_are_smooth(planar):
    """Between neighbouring points of the bent cable the direction turns by little."""
    ax = planar.plot([0.1], items=[planar.scene["rod"]])
    steps = np.diff(points(ax.lines[0]), axis=0)
    angles = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    assert len(steps) > 60 and np.ptp(angles) > 0.2 and np.max(np.abs(np.diff(angles))) < 0.1


def test_some_items_and_one_time(planar):
    ax = planar.plot(0.05, items=[planar.scene["rod"], planar.scene["pivot"]])
    assert len(ax.lines) == 2 and ax.figure.axes == [ax]


def test_given_axes(planar, spatial):
    _, ax = plt.subplots()
    assert planar.plot(ax=ax) is ax
    with pytest.raises(ValueError, match=r"ax: expected 3-D axes .* found 'rectilinear'"):
        spatial.plot(ax=ax)
    with pytest.raises(ValueError, match=r"ax: expected planar axes .* found '3d'"):
        planar.plot(ax=plt.figure().add_subplot(projection="3d"))


def test_space(spatial):
    ax = spatial.plot()
    assert ax.name == "3d" and (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("x [m]", "y [m]", "z [m]")
    assert len(lines(ax, linestyle="-")) == 10
    for marker in (spatial.scene["rope"].end, spatial.scene["body"].at()):
        assert near(lines(ax, linestyle="-")[-1], spatial.position(marker)[-1]) < 1e-12
    ax.figure.canvas.draw()
    scales = np.ptp([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()], axis=1) / ax._box_aspect
    np.testing.assert_allclose(scales, scales[0])


def test_the_path_of_a_marker(planar, spatial):
    ax = plot_path(planar, planar.scene["rod"].end, color="red", label="tip")
    (line,) = ax.lines
    assert (line.get_color(), line.get_label(), ax.get_aspect(), ax.get_xlabel()) == ("red", "tip", 1.0, "x [m]")
    np.testing.assert_allclose(points(line)[[0, -1]], planar.position(planar.scene["rod"].end)[[0, -1]])
    assert plot_path(planar, planar.scene["ball"].at(), ax) is ax and len(ax.lines) == 2
    assert plot_path(spatial, spatial.scene["rope"].end).name == "3d"


def test_nothing_but_joints(planar):
    assert len(planar.plot(items=[planar.scene["pivot"]]).lines) == 1


@pytest.mark.parametrize("name", ["planar", "spatial"])
def test_animations_move(name, request):
    result = request.getfixturevalue(name)
    film = animate(result, fps=100, speed=0.5)
    frames = list(film.new_frame_seq())
    assert len(frames) == 21
    film._draw_frame(0)
    (shape,) = lines(film._fig.axes[0], linestyle="-")[-1:]
    item = result.scene["rod" if name == "planar" else "rope"]
    for k, row in ((0, 0), (20, -1)):
        film._draw_frame(k)
        assert near(shape, result.position(item.end)[row]) < 1e-12
    assert film._fig.axes[0].get_title() == "t = 0.100 s"
    film._draw_was_started = True  # it was drawn, by hand: no warning that it was not


def test_a_film_in_a_file(planar, tmp_path):
    pillow = pytest.importorskip("PIL.Image")
    planar.animate(tmp_path / "film.gif", fps=50)
    with pillow.open(tmp_path / "film.gif") as film:
        assert film.n_frames == 6


def test_a_film_as_mp4_needs_ffmpeg(planar, tmp_path, monkeypatch):
    from matplotlib.animation import writers

    if writers.is_available("ffmpeg"):
        planar.animate(tmp_path / "film.mp4", fps=50)
        assert (tmp_path / "film.mp4").read_bytes()[4:8] == b"ftyp"
    monkeypatch.setattr(type(writers), "is_available", lambda self, name: name != "ffmpeg")
    with pytest.raises(RuntimeError, match=r"film.mp4.*expected the program ffmpeg.*apt-get install ffmpeg.*or write a .gif"):
        planar.animate(tmp_path / "film.mp4")


@pytest.mark.parametrize("bad", [{"fps": 0}, {"speed": -1.0}])
def test_bad_speeds(planar, bad):
    with pytest.raises(ValueError, match="expected positive fps and speed"):
        planar.animate(**bad)


def test_without_matplotlib(planar, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    monkeypatch.delitem(sys.modules, "matplotlib")
    for picture in (planar.plot, planar.animate, lambda: plot_path(planar, planar.scene["rod"].end)):
        with pytest.raises(ImportError, match=r'pip install "mbd\[plot\]"'):
            picture()
