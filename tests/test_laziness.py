"""Nothing is imported, built or evaluated before it is needed: modules in fresh processes, layers by their source, work by counters."""

from __future__ import annotations

import ast
import json
import os
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbd
import mbd.elements
import mbd.joints
import mbd.solvers
from mbd.constraint import Quadratic
from mbd.solvers.linear import Linear
from mbd.system import System

FACE = ("matplotlib", "meshio", "pandas", "pydantic", "threadpoolctl", "tqdm", "typer", "xarray")
HEAVY = ("sympy", "networkx", *FACE, "scipy.sparse", "scipy.integrate", "scipy.optimize")
FOLDERS = {name: Path(module.__file__ or "").parent for name, module in vars(mbd).items() if name in ("elements", "joints", "solvers")}
FOLDERS["mbd"] = Path(mbd.__file__ or "").parent

PENDULUM = """
import mbd
scene = mbd.Scene(gravity=(0.0, -9.81))
rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=4, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
pivot = scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
result = mbd.simulate(scene, t_end=0.05, rtol=1e-4)
result.position(rod.end), result.reaction(pivot), result.energy.total, str(result.audit)
"""
DOUBLE_PENDULUM = """
import mbd
scene = mbd.Scene(gravity=(0.0, -9.81))
upper = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
lower = scene.add(mbd.RigidBody.rod((1, 0), (2, 0), mass=1.0))
scene.add(mbd.Pin(upper.at(-0.5, 0), scene.ground.at(0, 0)))
elbow = scene.add(mbd.Pin(upper.at(0.5, 0), lower.at(-0.5, 0)))
result = mbd.simulate(scene, t_end=0.2)
result.position(lower.at()), result.reaction(elbow), result.angle(lower), result.energy.total, str(result.audit)
"""


def fresh(code: str, folder: Path) -> str:
    """What a new process prints that finds this very mbd first."""
    environment = os.environ | {"PYTHONPATH": str(Path(mbd.__file__ or "").parents[1])}
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def loaded(code: str, folder: Path) -> set[str]:
    return set(json.loads(fresh(f"{code}\nimport json, sys; print(json.dumps(list(sys.modules)))", folder).splitlines()[-1]))


def test_importing_mbd_imports_only_numpy(tmp_path):
    modules = loaded("import mbd", tmp_path)
    assert not modules & {*HEAVY, "scipy"}
    assert {name for name in modules if name.split(".")[0] == "mbd"} == {"mbd"}


@pytest.mark.parametrize("code", [PENDULUM, DOUBLE_PENDULUM], ids=["flexible pendulum", "double pendulum"])
def test_small_scenes_run_without_the_heavy_modules(code, tmp_path):
    """SciPy's LAPACK wrappers are all they need; scipy.integrate and scipy.optimize would bring scipy.sparse along."""
    modules = loaded(code, tmp_path)
    assert "scipy.linalg" in modules
    assert not modules & set(HEAVY)
    unasked = ("mbd.report", "mbd.draw", "mbd.export", "mbd.files", "mbd.sweeps", "mbd.verification", "mbd.commands", "mbd.derivations")
    assert not [name for name in modules if name.startswith(unasked)]


def test_reports_and_notebooks_need_nothing_beside_mbd(tmp_path):
    """As where none of the extras is installed."""
    shown = f"""
import sys
sys.modules |= dict.fromkeys({FACE!r})
{DOUBLE_PENDULUM}
result.report("run.html")
print(scene._repr_html_()[:4], result._repr_html_()[:7], result.audit._repr_html_()[:4])
"""
    assert fresh(shown, tmp_path).split() == ["<div", "<iframe", "<div"]
    assert "RigidBody" in (tmp_path / "run.html").read_text(encoding="utf-8")


def test_importing_mbd_takes_no_time(tmp_path):
    """Below 0.15 s beyond NumPy's own. It is about 1 ms; the limit leaves a busy machine a hundredfold, and the median forgets outliers."""
    code = "import time, numpy; clock = time.perf_counter(); import mbd; print(time.perf_counter() - clock)"
    assert statistics.median(float(fresh(code, tmp_path)) for _ in range(5)) < 0.15


def test_every_public_name_loads_and_is_listed():
    for name in mbd.__all__:
        assert getattr(mbd, name) is not None
    assert set(mbd.__all__) == set(dir(mbd)) >= {"AncfCable", "Scene", "simulate", "__version__"}


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="'mbd' has no attribute 'AncfCabel'"):
        mbd.AncfCabel  # noqa: B018


# Layers: read from the source, so that an import in a branch no test takes counts too.


def imports(path: Path, package: str) -> Iterator[tuple[str, bool]]:
    """(absolute module, inside a function) of every import that runs; those for type checkers only do not."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    todo: list[tuple[ast.AST, bool]] = [(tree, False)]
    while todo:
        node, inside = todo.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            todo.extend((child, inside) for child in node.orelse)
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, inside) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            yield from ((module if node.module and module != "mbd" else f"{module}.{alias.name}", inside) for alias in node.names)
        deeper = inside or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        todo.extend((child, deeper) for child in ast.iter_child_nodes(node))


def sources() -> list[tuple[str, str, str, bool]]:
    """(folder, file, module, inside a function) of all imports beyond the standard library."""
    found = []
    for folder, home in FOLDERS.items():
        for path in sorted(home.glob("*.py")):
            for module, inside in imports(path, "mbd" if folder == "mbd" else f"mbd.{folder}"):
                if module.split(".")[0] not in sys.stdlib_module_names:
                    found.append((folder, path.name, module, inside))
    return found


SOURCES = sources()
SYSTEM = {"mbd.system", "mbd.scene", "mbd.run", "mbd.result", "mbd.assembly"}
EDGE = {"archive.py", "descriptions.py", "drawing.py", "drawn.py", "plot.py", "report.py"}
"""The edge of the house: files, pictures, and reports (a folder). They may use everything; nothing inside loads them before they are asked for."""


def layer(module: str) -> str:
    """elements, joints, solvers, mbd, or the name of a foreign package."""
    parts = module.split(".")
    return parts[1] if parts[0] == "mbd" and len(parts) > 1 and parts[1] in FOLDERS else parts[0]


def offences(rule: Callable[[str, str, str, bool], bool]) -> list[str]:
    """The imports that break a rule, as 'folder/file imports module'."""
    return [f"{folder}/{file} imports {module}" for folder, file, module, inside in SOURCES if not rule(folder, file, module, inside)]


def test_the_reader_of_imports_sees_them_all():
    assert ("solvers", "formats.py", "scipy.sparse.linalg", True) in SOURCES
    assert ("joints", "pairs.py", "mbd.rows", False) in SOURCES
    assert ("solvers", "radau.py", "mbd.solvers.start", False) in SOURCES
    assert ("mbd", "run.py", "mbd.solvers.automatic", True) in SOURCES
    assert {folder for folder, *_ in SOURCES} == set(FOLDERS)


def test_elements_and_joints_know_numpy_and_the_vocabulary_of_mbd():
    """They describe: they see neither the system that is made of them, nor each other, nor any solver."""

    def rule(folder: str, file: str, module: str, inside: bool) -> bool:
        if folder not in ("elements", "joints"):
            return True
        outside = SYSTEM | {f"mbd.{name.removesuffix('.py')}" for name in EDGE}
        return layer(module) in ("numpy", "mbd", folder) and not any(module == name or module.startswith(name + ".") for name in outside)

    assert not offences(rule)


def test_solvers_know_no_mechanics():
    assert not offences(lambda folder, file, module, inside: folder != "solvers" or layer(module) in ("numpy", "scipy", "solvers"))


def test_mbd_imports_its_parts_only_when_asked():
    def rule(folder: str, file: str, module: str, inside: bool) -> bool:
        lazy = layer(module) not in ("numpy", "mbd") or f"{module.removeprefix('mbd.').split('.')[0]}.py" in EDGE
        return folder != "mbd" or inside or file in EDGE or not lazy

    assert not offences(rule)


@pytest.mark.parametrize(
    ("package", "files"),
    [("networkx", {"topology.py"}), ("sympy", set()), ("matplotlib", {"plot.py"}), ("tqdm", {"run.py"}), ("scipy", None)],
)
def test_heavy_packages_have_one_door_each(package, files):
    def rule(folder: str, file: str, module: str, inside: bool) -> bool:
        return module.split(".")[0] != package or (folder == "solvers" if files is None else file in files)

    assert not offences(rule)


def test_derivations_are_imported_by_commands_that_run_and_by_name_only():
    """Sympy's only door is the folder of derivations, and no module of the library leads there."""
    inner = [(path, "mbd.commands") for path in FOLDERS["mbd"].glob("commands/*.py")]
    inner += [(path, "mbd" if folder == "mbd" else f"mbd.{folder}") for folder, home in FOLDERS.items() for path in home.glob("*.py")]
    found = [(path.name, inside) for path, package in inner for module, inside in imports(path, package) if module.startswith("mbd.derivations")]
    assert found and all(found_inside for _, found_inside in found) and {name for name, _ in found} == {"derive.py"}
    outside = {"mpmath", "numpy", "sympy", "mbd"}
    assert all(module.split(".")[0] in outside | sys.stdlib_module_names for path in FOLDERS["mbd"].glob("derivations/*.py")
               for module, _ in imports(path, "mbd.derivations"))  # fmt: skip


def test_usage_is_told_without_sympy(tmp_path):
    """Nor with any other package that one command wants."""
    code = "import mbd.__main__\ntry: mbd.__main__.main(['--help'])\nexcept SystemExit: pass"
    assert not loaded(code, tmp_path) & set(HEAVY)


def test_only_scene_files_want_pydantic():
    """In one module; the functions that may stand in files are the library's own, without it."""
    homes = [(path, f"mbd.{path.parent.name}") for folder in ("commands", "files", "functions") for path in FOLDERS["mbd"].glob(f"{folder}/*.py")]
    found = {path.name for path, package in homes for module, _ in imports(path, package) if module.split(".")[0].startswith("pydantic")}
    assert found == {"model.py"}
    assert not offences(lambda folder, file, module, inside: not module.startswith("pydantic"))


def test_nothing_inside_the_library_imports_its_face():
    """Scene files and commands: by name only, from ``mbd/__init__.py``'s table."""
    assert not offences(lambda folder, file, module, inside: not module.startswith(("mbd.files", "mbd.commands")) or file == "__main__.py")


def test_sparse_matrices_are_imported_where_the_format_was_chosen():
    heavy = ("scipy.sparse", "scipy.integrate", "scipy.optimize")
    homes = ("formats.py", "kkt.py", "eigen.py", "equilibration.py")  # of large systems: factors, inertia, modes; of very unequal masses: scales
    allowed = {(file, module) for file in homes for module in ("scipy.sparse", "scipy.sparse.linalg", "scipy.sparse.csgraph")}
    assert not offences(lambda folder, file, module, inside: not module.startswith(heavy) or (inside and (file, module) in allowed))


# Work: what is zero or constant is not computed. Counted on the running code.


class Counter:
    """Counts the calls of a method, all or those that ``which`` picks by their arguments."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, owner: type, name: str, which: Callable[..., bool] = lambda *a, **k: True):
        self.calls, original = 0, getattr(owner, name)

        def counted(*args: Any, **kwargs: Any) -> Any:
            self.calls += bool(which(*args, **kwargs))
            return original(*args, **kwargs)

        monkeypatch.setattr(owner, name, counted)


def of_masses(linear: Linear, tangent: Any, c_mass: complex = 1.0, c_damping: complex = 0.0, c_stiffness: float = 0.0, **_: Any) -> bool:
    """Whether a factorisation is that of the mass KKT matrix, M with G."""
    return c_stiffness == 0.0 or tangent.stiffness is None


def cable_scene(*, pinned: bool, damping: float = 0.0) -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=3, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540, damping=damping))
    if pinned:
        scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0)))
    return scene


def rigid_scene() -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=1.0))
    scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0)))
    return scene


@pytest.mark.parametrize(("damping", "evaluated"), [(0.0, False), (1e-3, True)])
def test_damping_is_evaluated_only_where_something_damps(damping, evaluated, monkeypatch):
    counter = Counter(monkeypatch, System, "damping")
    mbd.simulate(cable_scene(pinned=True, damping=damping), t_end=0.02, rtol=1e-4)
    assert bool(counter.calls) == evaluated


def test_free_cables_have_no_multiplier():
    scene = cable_scene(pinned=False)
    system = scene.build()
    assert system.m == 0 and system.joints.kernels == []
    assert Linear(system, system.q0).size == system.n
    assert mbd.simulate(scene, t_end=0.02, rtol=1e-4).trajectory.states[-1].multipliers.size == 0


def mass_factorizations(scene: mbd.Scene, t_end: float, monkeypatch: pytest.MonkeyPatch) -> tuple[int, int]:
    """Factorisations of the mass KKT matrix, and accepted steps."""
    with monkeypatch.context() as patch:
        counter = Counter(patch, Linear, "factor", of_masses)
        steps = mbd.simulate(scene, t_end=t_end, rtol=1e-4, solver=mbd.Radau(3, step=0.01)).stats["steps"]
    return counter.calls, steps


@pytest.mark.parametrize("pinned", [False, True], ids=["free", "pinned at a node"])
def test_velocities_of_linear_scenes_need_no_mass_matrix(pinned, monkeypatch):
    """Where G is constant, V = Q' holds by itself: only the start factorises M with G, however many steps follow."""
    few, steps_few = mass_factorizations(cable_scene(pinned=pinned), 0.02, monkeypatch)
    many, steps_many = mass_factorizations(cable_scene(pinned=pinned), 0.1, monkeypatch)
    assert (steps_few, steps_many) == (2, 10) and many == few


def test_velocities_of_rigid_scenes_do(monkeypatch):
    """The counter of the test above sees what it should."""
    calls, steps = mass_factorizations(rigid_scene(), 0.2, monkeypatch)
    assert calls >= steps


def test_constant_rows_are_never_evaluated_again(monkeypatch):
    scene = cable_scene(pinned=True)
    counter = Counter(monkeypatch, Quadratic, "_varying")
    assert scene.build().joints.linear and all(kernel.linear for kernel in scene.build().joints.kernels)
    mbd.simulate(scene, t_end=0.02, rtol=1e-4)
    assert counter.calls == 0
    mbd.simulate(rigid_scene(), t_end=0.02, rtol=1e-4)
    assert counter.calls > 0


def test_the_mass_matrix_is_assembled_once(monkeypatch):
    """Once for a scene, however often it runs, and once into the solver's format for a run."""
    assembled, placed = Counter(monkeypatch, System, "_compile_mass"), Counter(monkeypatch, Linear, "__init__")
    scene = rigid_scene()
    first = mbd.simulate(scene, t_end=0.1)
    assert (assembled.calls, placed.calls) == (1, 1)
    masses = first.trajectory.linear.mass
    kept = masses.copy()
    second = mbd.simulate(scene, t_end=0.2, start=first.final)
    assert (assembled.calls, placed.calls) == (1, 2)
    assert np.array_equal(masses, kept) and np.array_equal(second.trajectory.linear.mass, kept)


def test_a_steady_scene_samples_its_loads_once_a_call(monkeypatch):
    """Constant loads have no time axis: whatever the stages, they are one number."""
    scene = rigid_scene()
    scene.add(mbd.Torque(scene["body 1"].at(0, 0), 0.5))
    system = scene.build()
    assert system.steady and [values.shape for values in system.inputs(np.linspace(0.0, 1.0, 5))] == [(1,)]
