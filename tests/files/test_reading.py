"""Scene files as people write them: formulas of parameters, markers as texts, functions, overrides; and what is said where they are wrong."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import mbd
from mbd.descriptions import described
from mbd.files import read

SCENES = Path(__file__).resolve().parents[2] / "examples" / "scenes"

MACHINE = """
gravity = [0, "-g"]

[parameters]
n = "round(2.6)"
half = "L / 2"  # used before it is given
L = 0.3
g = 9.81
k = 2

[[items]]
kind = "RigidBody.rod"
name = "crank"
start = [0, 0]
end = ["2 * half", 0]
mass = "k"
angular_velocity = "-k"

[[items]]
kind = "RigidBody.box"
name = "block"
size = [0.1, 0.2]
mass = 1
position = ["L", "L"]
angle = "pi / 6"

[[items]]
kind = "Particle"
name = "bob"
mass = 1
position = [3, 0]

[[items]]
kind = "GeometricallyExactBeam"
name = "beam"
start = [1, 0]
end = [2, 0]
n_elements = "n"
E = 1e6
A = 1e-3
I = 1e-8
rho = 1000
GA = "2e2 + k"

[[items]]
kind = "Pin"
name = "pivot"
a = "crank.at(-half, min(0, k))"
b = "ground"

[[items]]
kind = "Spring"
a = "beam.at(1 / 4)"
b = "bob"
stiffness = "k"

[[items]]
kind = "Force"
marker = "beam.end"
vector = [1, "k * t if t < 0.3 else 0"]

[[items]]
kind = "Torque"
marker = "block"
value = "k * g"

[[items]]
kind = "Torque"
marker = "crank"
value = { kind = "Sine", amplitude = "k", frequency = 3 }

[[items]]
kind = "Angle"
name = "turn"
a = "crank"
b = "ground"

[[items]]
kind = "Length"
name = "rope"
a = "bob"
b = "ground.at(0, 1)"

[[items]]
kind = "Coupling"
terms = [[1, "turn"], ["-k", "rope"]]
value = { kind = "Motion", value = "t**2", rate = "2 * t" }

[[items]]
kind = "ForceLaw"
measures = ["turn", "rope"]
rates = true
function = ["-k * s1 * s2", "-ds2 * t"]

[[items]]
kind = "UserMeasure"
measures = "turn"
function = "s**2"

[simulate]
t_end = "k"
solver = { kind = "Radau", stages = 5 }
outputs = { tip = "beam.end" }
"""


def machine() -> mbd.Scene:
    """The same in Python."""
    scene = mbd.Scene(gravity=(0, -9.81))
    crank = scene.add(mbd.RigidBody.rod((0, 0), (0.3, 0), mass=2, angular_velocity=-2, name="crank"))
    block = scene.add(mbd.RigidBody.box((0.1, 0.2), mass=1, position=(0.3, 0.3), angle=np.pi / 6, name="block"))
    bob = scene.add(mbd.Particle(1, (3, 0), name="bob"))
    beam = scene.add(mbd.GeometricallyExactBeam((1, 0), (2, 0), n_elements=3, E=1e6, A=1e-3, I=1e-8, rho=1000, GA=202, name="beam"))
    scene.add(mbd.Pin(crank.at(-0.15, 0), scene.ground.at(), name="pivot"))
    scene.add(mbd.Spring(beam.at(0.25), bob.at(), stiffness=2))
    scene.add(mbd.Force(beam.end, mbd.Expression(["1.0", "k * t if t < 0.3 else 0"], constants={"k": 2})))
    scene.add(mbd.Torque(block.at(), 2 * 9.81))
    scene.add(mbd.Torque(crank.at(), mbd.Sine(2, 3)))
    turn = scene.add(mbd.Angle(crank, scene.ground, name="turn"))
    rope = scene.add(mbd.Length(bob, scene.ground.at(0, 1), name="rope"))
    scene.add(mbd.Coupling([(1, turn), (-2, rope)], mbd.Motion(mbd.Expression("t**2"), mbd.Expression("2 * t"))))
    law = mbd.Expression(["-k * s1 * s2", "-ds2 * t"], ("t", "s1", "s2", "ds1", "ds2"), {"k": 2})
    scene.add(mbd.ForceLaw([turn, rope], law, rates=True))
    scene.add(mbd.UserMeasure(turn, mbd.Expression("s**2", ("s",))))
    return scene


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE, encoding="utf-8")
    return path


def test_a_file_says_what_python_says(file: Path) -> None:
    job = read(file)
    assert described(job.scene) == described(machine())
    assert np.array_equal(job.scene.gravity, (0, -9.81))
    assert (job.t_end, job.solver, job.rtol) == (2.0, mbd.Radau(5), None)
    assert job.parameters == {"n": 3.0, "half": 0.15, "L": 0.3, "g": 9.81, "k": 2.0}
    assert (job.outputs["tip"].item, job.outputs["tip"].arguments) == ("beam", (1.0,))


def test_json_is_the_same_data(file: Path) -> None:
    import tomllib

    other = file.with_suffix(".json")
    other.write_text(json.dumps(tomllib.loads(MACHINE)), encoding="utf-8")
    assert described(mbd.read_scene(other)) == described(machine())


def test_the_pendulum_is_the_main_job() -> None:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=30, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540, name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    assert described(mbd.read_scene(SCENES / "pendulum.toml")) == described(scene)


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_that_are_shipped_run_without_a_warning(path: Path) -> None:
    job = read(path)
    assert job.t_end and job.outputs
    result = mbd.simulate(job.scene, 0.1 * job.t_end, rtol=job.rtol or 1e-6)
    assert result.audit.balanced and all(np.isfinite(result.position(marker)).all() for marker in job.outputs.values())


def test_overrides_replace_parameters_and_fields(file: Path) -> None:
    place = (4.0, np.float64(1.0))
    scene = mbd.read_scene(file, {"k": 5, "L": "2 * n", "beam.E": 3e6, "bob.position": place, "simulate.t_end": 9, "gravity": [0, 0]})
    assert float(scene["crank"].description.mass) == 5.0 and scene["crank"].length == 6.0
    assert float(scene["beam"].description.E) == 3e6
    assert scene["bob"].description.position.tolist() == [4.0, 1.0] and not np.any(scene.gravity)
    with pytest.raises(mbd.SceneError) as trouble:
        mbd.read_scene(file, {"kk": 5, "beem.E": 1, "beam.EE": 3, "bob.mass": "q", "beam.n_elements": np.ones(2)})
    text = str(trouble.value)
    for told in ("found 'beem.E'; did you mean 'beam.E'", "found 'kk'", "found 'EE'", "found 'q'", "n_elements of 'beam': expected a whole"):
        assert told in text, told


def complaints(file: Path, *changes: tuple[str, str]) -> list[str]:
    text = file.read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")
    with pytest.raises(mbd.SceneError) as trouble:
        mbd.read_scene(file)
    return trouble.value.complaints


def line_of(file: Path, text: str) -> int:
    return file.read_text(encoding="utf-8").partition(text)[0].count("\n") + 1


CHANGES = {
    "unknown key": ('GA = "2e2 + k"', "Ga = 200", "items[3].Ga of 'beam': expected one of kind, start, .*found 'Ga'; did you mean 'GA'?"),
    "missing key": ('stiffness = "k"', "", "items[5].stiffness: expected a value, found none"),
    "unknown kind": ('kind = "Coupling"', 'kind = "Copling"', "items[11]: kind: expected one of .*found 'Copling'; did you mean 'Coupling'?"),
    "wrong type": ("rho = 1000", "rho = true", "items[3].rho of 'beam': expected a number, or a formula .*found True"),
    "wrong formula": ("L = 0.3", 'L = "0.3 m"', "parameters.L: expected a formula such as '2 * L', found '0.3 m'"),
    "a value that the scene refuses": ("I = 1e-8", "I = -1e-8", "items[3].I of 'beam': expected a positive number, found -1e-08"),
    "unknown parameter": ('half = "L / 2"', 'half = "LL / 2"', "parameters.half: expected names of parameters .*found 'LL'; did you mean 'L'?"),
    "circle": ('half = "L / 2"', 'half = "-half"', "parameters.half: .*in a circle, found half -> half"),
    "unknown item": ('b = "bob"', 'b = "bop"', "items[5].b: expected the name of an item before this one, found 'bop'; did you mean 'bob'?"),
    "an end of a body": ('marker = "block"', 'marker = "block.end"', "items[7].marker: expected .at(...) of 'block', found 'block.end'"),
    "a point of a beam without s": ('marker = "beam.end"', 'marker = "beam"', "items[6].marker: expected '.start', .*found 'beam'"),
    "outside of a beam": ("beam.at(1 / 4)", "beam.at(4)", "items[5].a: beam 'beam': at: expected a fraction .*found 4.0"),
    "wrong function": ('kind = "Sine"', 'kind = "Sinus"', "items[8].value: kind: expected one of Expression, .*found 'Sinus'; did you mean 'Sine'?"),
    "wrong key of a function": ("frequency = 3", "omega = 3", "items[8].value.omega: expected one of kind, amplitude"),
    "variables of a law": ('function = "s**2"', 'function = "u**2"', "items[13].function: Expression('u**2'): expected one of s, pi, .*found 'u'"),
    "wrong solver": ("stages = 5", "stages = 4", "simulate.solver: Radau(stages=4): expected 3, 5, 7"),
    "gravity": ('gravity = [0, "-g"]', 'gravity = [0, "-g", 0, 0]', "gravity: expected two .* or three"),
    "name twice": ('name = "rope"', 'name = "turn"', "items[10].name of 'turn': expected a name that no item before this one has"),
    "no end of a text": ('name = "rope"', 'name = "rope', "Illegal character|Unterminated|Expected"),
    "key twice": ("rho = 1000", "rho = 1000\nrho = 2000", "Cannot overwrite a value"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_complaints_name_line_and_key(name: str, file: Path) -> None:
    old, new, told = CHANGES[name]
    found = complaints(file, (old, new))
    pattern = "|".join(re.escape(part).replace(r"\.\*", ".*") for part in told.split("|"))
    lines = [line for line in found if re.search(pattern, line)]
    assert lines, found
    where = re.match(r"machine\.toml, line (\d+)", lines[0])
    assert where and len(lines[0]) < 400
    if name not in ("missing key", "unknown kind", "name twice", "key twice"):
        assert int(where[1]) == line_of(file, new), lines


def test_all_complaints_at_once_in_order_of_the_lines(file: Path) -> None:
    found = complaints(file, ("k = 2", 'k = "sqrt(-1)"'), ("rho = 1000", "rho = []"), ('b = "bob"', 'b = "bop"'), ("frequency = 3", "f = 3"))
    lines = [int(re.search(r"line (\d+)", line)[1]) for line in found]  # type: ignore[index]
    assert lines == sorted(lines) and len(found) == 5, found


def test_what_leans_on_a_wrong_item_is_not_complained_of(file: Path) -> None:
    found = complaints(file, ("rho = 1000", "rho = []"), ('n = "round(2.6)"', 'n = "x"'))
    assert len(found) == 2, found


def test_files_are_data(file: Path, tmp_path: Path) -> None:
    """Nothing that looks like code runs."""
    for text in ("__import__('os').mkdir('made')", "().__class__", "open('made', 'w')", "exec('1')"):
        for old in ('value = "k * g"', 'mass = "k"', 'marker = "block"'):
            key = old.partition(" ")[0]
            path = tmp_path / "code.toml"
            path.write_text(MACHINE.replace(old, f"{key} = {json.dumps(text)}"), encoding="utf-8")
            with pytest.raises(mbd.SceneError):
                mbd.read_scene(path)
    assert not Path("made").exists() and not (tmp_path / "made").exists()


def test_without_pydantic_the_message_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch, file: Path) -> None:
    for name in [name for name in sys.modules if name.startswith("mbd.files")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pydantic", None)
    monkeypatch.delitem(vars(mbd), "read_scene", raising=False)
    with pytest.raises(ImportError, match=r"python -m pip install 'mbd\[files\]'"):
        _ = mbd.read_scene


def test_no_file() -> None:
    with pytest.raises(FileNotFoundError):
        mbd.read_scene("nowhere.toml")
