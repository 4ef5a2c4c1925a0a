"""Wheel, sdist and editable install: what they hold, and that each of them, run from anywhere, is one consistent package.

Everything happens on a copy of the tree, so that the tree itself is not littered. Builds use the setuptools of the running environment
(extra "test") and need no network.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = {"mbd": "mbd", "elements": "mbd/elements", "examples": "mbd/examples", "joints": "mbd/joints", "solvers": "mbd/solvers"}
LEFT_OUT = shutil.ignore_patterns(".git", ".*_cache", "__pycache__", "*.egg-info", "build", "dist", ".venv", "venv")

# Loads everything, runs a scene, and says where each module came from.
PROBE = """
import json, sys
import mbd, mbd.elements, mbd.joints, mbd.solvers
mbd.AncfCable, mbd.Clamp, mbd.GeneralizedAlpha
scene = mbd.Scene(gravity=(0.0, -9.81))
rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
assert mbd.simulate(scene, t_end=0.1).position(rod.at()).shape[1] == 2
print(json.dumps({name: module.__file__ for name, module in sys.modules.items() if name.split(".")[0] == "mbd"}))
"""
ALONE = "import elements"
DATA = {"mbd/py.typed", *(str(path.relative_to(ROOT)) for ending in ("html", "css", "js") for path in ROOT.glob(f"mbd/report/*.{ending}"))}


def run(*command: str | Path, cwd: Path, path: Path | None = None, expect: int = 0) -> subprocess.CompletedProcess[str]:
    """A command in its own process, with nothing of ours on its path but ``path``."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PYTEST"))}
    environment |= {"PYTHONDONTWRITEBYTECODE": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_NO_INDEX": "1"}
    if path:
        environment["PYTHONPATH"] = str(path)
    done = subprocess.run([str(part) for part in command], cwd=cwd, env=environment, capture_output=True, text=True)
    assert (done.returncode == 0) == (expect == 0), f"{command}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done


def where(python: str | Path, cwd: Path, path: Path | None = None) -> dict[str, Path]:
    """The file of every mbd module that a process in ``cwd`` loads."""
    last_line = run(python, "-c", PROBE, cwd=cwd, path=path).stdout.splitlines()[-1]
    return {name: Path(file).resolve() for name, file in json.loads(last_line).items()}


def is_wheel_layout(files: dict[str, Path], home: Path) -> bool:
    return all(file.is_relative_to(home / "mbd") for file in files.values())


def is_source_layout(files: dict[str, Path], home: Path) -> bool:
    folder = {name: home / name.split(".")[1] if name.split(".")[1:2] and name.split(".")[1] in FOLDERS else home / "mbd" for name in files}
    return all(file.is_relative_to(folder[name]) for name, file in files.items())


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository."""
    copy = tmp_path_factory.mktemp("packaging") / "tree"
    shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
    return copy


@pytest.fixture(scope="module")
def dists(tree: Path) -> tuple[Path, Path]:
    """The sdist, and the wheel built from that sdist."""
    out = tree.parent / "dist"
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", out, tree, cwd=tree.parent)
    return next(out.glob("*.tar.gz")), next(out.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(dists: tuple[Path, Path]) -> Path:
    """A folder with the wheel installed, as a plain install leaves it in site-packages."""
    target = dists[1].parent / "site"
    run(sys.executable, "-m", "pip", "install", "--no-deps", "--no-compile", "--target", target, dists[1], cwd=target.parent)
    return target


@pytest.fixture(scope="module")
def editable(tree: Path) -> Path:
    """The Python of a fresh environment with the copy installed editable; NumPy, SciPy and setuptools are those of this one."""
    home = tree.parent / "venv"
    run(sys.executable, "-m", "venv", "--without-pip", home, cwd=tree.parent)
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    site = Path(run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=home).stdout.strip())
    for package in ("numpy", "scipy", "setuptools", "_distutils_hack"):
        spec = find_spec(package)
        assert spec is not None and spec.origin is not None
        source = Path(spec.origin).parent
        for folder in (source, *source.parent.glob(f"{package}.libs"), *source.parent.glob(f"{package}-*.dist-info")):
            (site / folder.name).symlink_to(folder, target_is_directory=True)
    run(sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-build-isolation", "-e", tree, cwd=tree.parent)
    return python


def modules(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*.py")}


def test_the_wheel_holds_the_package_and_nothing_else(dists, tree):
    with zipfile.ZipFile(dists[1]) as wheel:
        names = set(wheel.namelist())
        info = next(name.split("/")[0] for name in names if ".dist-info/" in name)
        metadata = wheel.read(f"{info}/METADATA").decode()
    package = {name for name in names if not name.startswith(f"{info}/")}
    code = {f"{home}/{name}" for folder, home in FOLDERS.items() for name in modules(tree / folder)}
    data = {f"mbd/examples/{path.relative_to(tree / 'examples')}" for kind in ("toml", "json") for path in (tree / "examples").rglob(f"*.{kind}")}
    assert package == code | data | DATA and len(data) > 5
    assert f"{info}/licenses/LICENSE" in names
    assert "License-Expression: BSD-3-Clause\n" in metadata


def test_the_version_is_said_once(dists, installed):
    said = run(sys.executable, "-c", "import mbd; print(mbd.__version__)", cwd=installed.parent, path=installed).stdout.strip()
    assert dists[1].name.startswith(f"mbd-{said}-")
    assert f"## [{said}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_sdist_also_holds_tests_examples_and_documents(dists, tree):
    with tarfile.open(dists[0]) as sdist:
        names = {name.partition("/")[2] for name in sdist.getnames()}
    for folder in ("mbd", "elements", "joints", "solvers", "tests", "examples"):
        assert {f"{folder}/{name}" for name in modules(tree / folder)} <= names, folder
    assert {str(path.relative_to(tree)) for path in (tree / "tests" / "data").rglob("*") if path.is_file()} <= names
    assert {"LICENSE", "README.md", "CHANGELOG.md", "pyproject.toml", "mbd/py.typed", "docs/decisions.md", ".ci/run"} <= names


def test_sdist_and_tree_build_the_same_wheel(tree, dists):
    out = tree.parent / "direct"
    run(sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", out, tree, cwd=tree.parent)
    with zipfile.ZipFile(dists[1]) as one, zipfile.ZipFile(next(out.glob("*.whl"))) as other:
        assert {name: one.read(name) for name in one.namelist()} == {name: other.read(name) for name in other.namelist()}


def test_plain_install_from_elsewhere(installed, tmp_path):
    assert is_wheel_layout(where(sys.executable, tmp_path, installed), installed)


def test_plain_install_from_the_root_runs_the_local_package_whole(installed, tree):
    """``python -c`` and ``python -m`` put the current folder first: the local ./mbd answers, and brings its own parts."""
    assert is_source_layout(where(sys.executable, tree, installed), tree)


def test_editable_install_from_elsewhere(editable, tree, tmp_path):
    assert is_source_layout(where(editable, tmp_path), tree)


def test_editable_install_from_the_root(editable, tree):
    assert is_source_layout(where(editable, tree), tree)


def test_examples_are_found_in_every_install(installed, editable, tree, tmp_path):
    code = "from mbd.commands.examples import examples; print(*sorted(examples()))"
    expected = {path.stem for path in (tree / "examples" / "scenes").glob("*.toml")} | {"escalona_1998", "bricard"}
    for python, cwd, path in ((sys.executable, tmp_path, installed), (editable, tmp_path, None), (sys.executable, tree, None)):
        assert expected <= set(run(python, "-c", code, cwd=cwd, path=path).stdout.split())


@pytest.mark.parametrize("name", ["elements", "joints", "solvers", "mbd.mbd"])
def test_the_folders_refuse_to_load_under_another_name(name, installed, tree):
    """Loaded twice, every class would exist twice; the error says what to write instead."""
    said = run(sys.executable, "-c", f"import {name}", cwd=tree, path=installed, expect=1).stderr
    right = "mbd" if name == "mbd.mbd" else f"mbd.{name}"
    assert f"ImportError: import {right}, not {name}" in said


def test_the_folders_are_no_top_level_packages_once_installed(installed, editable, tmp_path):
    assert "ModuleNotFoundError" in run(sys.executable, "-c", ALONE, cwd=tmp_path, path=installed, expect=1).stderr
    assert "ModuleNotFoundError" in run(editable, "-c", ALONE, cwd=tmp_path, expect=1).stderr


@pytest.mark.parametrize(("command", "source"), [(("-m", "pytest"), True), (("-P", "-m", "pytest"), False)], ids=["python -m pytest", "pytest"])
def test_pytest_from_the_root_never_mixes_source_and_install(command, source, installed, tree):
    """``python -m pytest`` tests the tree, bare ``pytest`` (which leaves the current folder off the path) what is installed."""
    probe = tree / "tests" / "test_probe.py"
    probe.write_text(f"def test_where():\n    exec({PROBE!r}, {{}})\n", encoding="utf-8")
    try:
        said = run(sys.executable, *command, "-q", "-s", "-p", "no:cacheprovider", "tests/test_probe.py", cwd=tree, path=installed).stdout
    finally:
        probe.unlink()
    line = next(line for line in said.splitlines() if '{"mbd"' in line)
    files = {name: Path(file).resolve() for name, file in json.loads(line[line.index("{") : line.rindex("}") + 1]).items()}
    assert is_source_layout(files, tree) if source else is_wheel_layout(files, installed)
