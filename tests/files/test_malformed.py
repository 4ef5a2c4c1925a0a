"""Files that are no scenes: each is refused within a second, by a message that names the place, and nothing else ever happens."""

from __future__ import annotations

import copy
import json
import random
import re
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mbd
from mbd.files.text import DEPTH, LARGEST, VALUES

SCENES = Path(__file__).resolve().parents[2] / "examples" / "scenes"
HEAD = "gravity = [0, -9.81]\n"
BALL = '[[items]]\nkind = "Particle"\nname = "ball"\nmass = 1\nposition = [0, 0]\n'
ROD = '[[items]]\nkind = "AncfCable"\nname = "rod"\nstart = [0, 0]\nend = [1, 0]\nn_elements = 2\nE = 1\nA = 1\nI = 1\nrho = 1\n'
LENGTH = '[[items]]\nkind = "Length"\nname = "l"\na = "ball"\nb = "ground.at(1, 1)"\n'


def item(kind: str, *lines: str) -> str:
    return "\n".join(["[[items]]", f'kind = "{kind}"', *lines, ""])


def force(marker: str, vector: str = "[0, 1]") -> str:
    return item("Force", f"marker = {marker}", f"vector = {vector}")


@pytest.fixture(scope="module", autouse=True)
def imported() -> None:
    """What is imported at the first file is not counted."""
    mbd.read_scene(SCENES / "pendulum.toml")


def refused(path: Path, *told: str) -> str:
    """Refused in words, in time, with the name of the file and what else is told."""
    clock = time.process_time()
    with pytest.raises(mbd.SceneError) as trouble:
        mbd.read_scene(path)
    assert time.process_time() - clock < 1.0
    lines = trouble.value.complaints
    assert lines and all(re.match(rf"{re.escape(path.name)}(, line \d+)?(, [^:]+)?: .|and more: correct these first$", line) for line in lines), lines
    assert len(lines) <= 101 and all(len(line) < 1000 for line in lines)
    text = "\n".join(lines)
    assert all(part in text for part in told), (told, text)
    return text


TEXTS: dict[str, tuple[str | bytes, str]] = {
    "nothing": ("", "gravity: expected a value"),
    "no items": (HEAD, "items: expected a value"),
    "empty items": (HEAD + "items = []", "items: expected"),
    "items of numbers": (HEAD + "items = [1, 2]", "items[1]"),
    "items as a table": (HEAD + '[items]\nkind = "Pin"', "items: expected"),
    "gravity of text": ('gravity = "down"\n' + BALL, "gravity: expected a list"),
    "gravity of one": ("gravity = [1]\n" + BALL, "gravity: expected two"),
    "gravity of nested": ("gravity = [[1, 2], [3, 4]]\n" + BALL, "gravity: expected a list"),
    "gravity infinite": ("gravity = [0, inf]\n" + BALL, "gravity: expected"),
    "gravity nan": ("gravity = [0, nan]\n" + BALL, "gravity: expected"),
    "a date": ("gravity = [0, -9.81]\n" + BALL.replace("mass = 1", "mass = 2024-01-01"), "line 5, items[0].mass of 'ball'"),
    "huge number": (HEAD + BALL.replace("mass = 1", "mass = 1e300"), "mass of 'ball': expected a number up to 1e+50"),
    "huge whole number": (HEAD + BALL.replace("mass = 1", f"mass = {'9' * 400}"), "mass of 'ball': expected a number"),
    "too many digits": (HEAD + BALL.replace("mass = 1", f"mass = {'9' * 5000}"), "bad.toml: "),
    "power tower": (HEAD + BALL.replace("mass = 1", 'mass = "9**9**9**9"'), "mass of 'ball': expected a finite value"),
    "division by zero": (HEAD + BALL.replace("mass = 1", 'mass = "1 / 0"'), "mass of 'ball': expected a finite value"),
    "long formula": (HEAD + BALL.replace("mass = 1", f'mass = "{"1+" * 5000}1"'), "mass of 'ball': expected a number, or a formula"),
    "deep formula": (HEAD + BALL.replace("mass = 1", f'mass = "{"-" * 900}1"'), "operations within each other"),
    "formula with brackets": (HEAD + BALL.replace("mass = 1", f'mass = "{"(" * 400}1{")" * 400}"'), "mass of 'ball': expected a formula"),
    "many elements": (HEAD + ROD.replace("n_elements = 2", "n_elements = 1000000000"), "n_elements of 'rod': expected a whole number up to"),
    "many elements by formula": (HEAD + ROD.replace("n_elements = 2", 'n_elements = "1e9"'), "n_elements of 'rod': expected a whole number up to"),
    "many modes": (HEAD + ROD.replace("AncfCable", "FloatingFrameBeam").replace("= 2\n", "= 20000\n"), "expected a whole number up to 400"),
    "many cables of many elements": (
        HEAD + "".join(ROD.replace("= 2\n", "= 20000\n").replace("rod", f"rod{k}") for k in range(10)),
        "items[5].n_elements of 'rod5': expected at most 100000 elements in a file",
    ),
    "half an element": (HEAD + ROD.replace("n_elements = 2", 'n_elements = "5 / 2"'), "found 2.5"),
    "negative elements": (HEAD + ROD.replace("n_elements = 2", "n_elements = -2"), "n_elements of 'rod': expected a whole number of at least 1"),
    "many Gauss points": (HEAD + ROD + "gauss_points = 99999999", "gauss_points of 'rod': expected"),
    "deep list": (HEAD + "x = " + "[" * 5000 + "]" * 5000, f"at most {DEPTH} levels"),
    "deep keys": (HEAD + "a." * 5000 + "b = 1", "line 2: expected at most"),
    "deep tables": (HEAD + "[" + "a." * 5000 + "b]", "line 2: expected at most"),
    "rather deep": (HEAD + "x = " + "[" * (DEPTH + 1) + "]" * (DEPTH + 1), f"at most {DEPTH} levels"),
    "large": (HEAD + "#" * (LARGEST[".toml"] + 1), "expected at most"),
    "binary": (bytes(range(256)) * 10, "UTF-8, found the byte 0x80"),
    "nulls": (b"\0" * 1000, "bad.toml, line 1: "),
    "utf-16": (HEAD.encode("utf-16"), "UTF-8"),
    "png": (b"\x89PNG\r\n\x1a\n" + b"\0" * 100, "UTF-8, found the byte 0x89"),
    "not TOML": ("gravity: [0, 1]", "line 1: Expected '='"),
    "open text": (HEAD + 'name = "x', "bad.toml"),
    "open list": (HEAD + "x = [1, 2", "bad.toml"),
    "key twice": (HEAD + HEAD, "line 2: Cannot overwrite"),
    "table twice": (HEAD + BALL + "[simulate]\nt_end = 1\n[simulate]\nrtol = 1", "line 9: Cannot declare"),
    "unknown section": (
        HEAD + BALL + "[simulation]\nt_end = 1",
        "simulation: expected one of gravity, parameters, items, simulate; found 'simulation'; did you mean",
    ),
    "simulate of a number": ("simulate = 3\n" + HEAD + BALL, "line 1, simulate: expected"),
    "negative time": (HEAD + BALL + '[simulate]\nt_end = "x"', "simulate.t_end: expected one of"),
    "solver of text": (HEAD + BALL + '[simulate]\nsolver = "Radau"', "simulate.solver: expected"),
    "unknown solver": (HEAD + BALL + '[simulate]\nsolver = { kind = "Euler" }', "simulate.solver: kind: expected one of Automatic"),
    "solver without a step": (HEAD + BALL + '[simulate]\nsolver = { kind = "Gauss" }', "simulate.solver.step: expected a value"),
    "output of nothing": (HEAD + BALL + '[simulate]\noutputs = { tip = "rod.end" }', "simulate.outputs: expected the name of an item"),
    "outputs of a list": (HEAD + BALL + '[simulate]\noutputs = ["ball"]', "simulate.outputs: expected"),
    "parameters of a list": ("parameters = [1]\n" + HEAD + BALL, "parameters: expected"),
    "parameter of a list": (HEAD + "[parameters]\na = [1]\n" + BALL, "line 3, parameters.a: expected a number"),
    "parameter of a flag": (HEAD + "[parameters]\na = true\n" + BALL, "parameters.a: expected a number"),
    "parameter t": (HEAD + "[parameters]\nt = 1\n" + BALL, "parameters.t: expected a name of letters"),
    "parameter sin": (HEAD + "[parameters]\nsin = 1\n" + BALL, "parameters.sin: expected a name of letters"),
    "parameter with a space": (HEAD + '[parameters]\n"a b" = 1\n' + BALL, "expected a name of letters, digits and _"),
    "empty parameter": (HEAD + '[parameters]\n"" = 1\n' + BALL, "parameters"),
    "parameter of itself": (HEAD + '[parameters]\na = "a"\n' + BALL, "found a -> a"),
    "circle of three": (HEAD + '[parameters]\na = "b"\nb = "c"\nc = "a + d"\nd = 1\n' + BALL, "a -> b -> c -> a"),
    "long circle": (HEAD + "[parameters]\n" + "".join(f'a{k} = "a{(k + 1) % 900}"\n' for k in range(900)) + BALL, "in a circle"),
    "long chain to nothing": (HEAD + "[parameters]\n" + "".join(f'a{k} = "a{k + 1}"\n' for k in range(900)) + BALL, "found 'a900'"),
    "too many parameters": (HEAD + "[parameters]\n" + "".join(f"a{k} = 1\n" for k in range(1001)) + BALL, "parameters: expected"),
    "unknown function": (HEAD + BALL.replace("mass = 1", 'mass = "sinn(1)"'), "did you mean 'sin'"),
    "t in a number": (HEAD + BALL.replace("mass = 1", 'mass = "t"'), "mass of 'ball': expected one of pi, e, tau; found 't'"),
    "negative mass": (HEAD + BALL.replace("mass = 1", "mass = -1"), "line 5, items[0].mass of 'ball': expected a number not below zero"),
    "name of a number": (HEAD + BALL.replace('"ball"', "3"), "items[0].name: expected a text"),
    "empty name": (HEAD + BALL.replace('"ball"', '""'), "items[0].name of '': expected a text"),
    "name ground": (HEAD + BALL.replace('"ball"', '"ground"'), "name of 'ground': expected a name that no item before this one has"),
    "name twice": (HEAD + BALL + BALL, "line 9, items[1].name of 'ball': expected a name that no item before this one has"),
    "no kind": (HEAD + BALL.replace('kind = "Particle"', ""), "line 2, items[0] of 'ball': kind: expected one of"),
    "kind of a list": (HEAD + BALL.replace('"Particle"', "[1]"), "items[0] of 'ball': kind: expected one of"),
    "kind in small letters": (HEAD + BALL.replace("Particle", "particle"), "did you mean 'Particle'?"),
    "a method as kind": (HEAD + BALL.replace("Particle", "RigidBody.__init__"), "kind: expected one of"),
    "nothing with mass": (HEAD + force('"ground"'), "items[0].marker: expected at least one on a moving item"),
    "marker of a list": (HEAD + BALL + force("[0, 1]"), "items[1].marker: expected a marker such as"),
    "marker of an open bracket": (HEAD + ROD + force('"rod.at(1"'), "found 'rod.at(1'"),
    "marker with two numbers": (HEAD + ROD + force('"rod.at(1, 2)"'), "found 'rod.at(1, 2)'"),
    "marker with a bad formula": (HEAD + ROD + force('"rod.at(1 +)"'), "items[1].marker: expected a formula"),
    "marker with an attribute": (HEAD + ROD + force('"rod.description"'), "found 'rod.description'"),
    "marker with no end": (HEAD + BALL + force('"ball.start"'), "only cables and beams have"),
    "marker of the ground with one number": (
        HEAD + BALL + item("Pin", 'a = "ball"', 'b = "ground.at(1)"'),
        "items[1]: marker: expected 2 components",
    ),
    "marker that comes later": (HEAD + item("Pin", 'a = "ball"', 'b = "ground"', "") + BALL, "items name earlier ones, move it up"),
    "a joint as marker": (HEAD + BALL + item("Pin", 'name = "p"', 'a = "ball"', 'b = "p"'), "items[1].b of 'p': expected the name of an item before"),
    "a body as measure": (HEAD + BALL + item("PD", 'measure = "ball"', "proportional = 1"), "items[1].measure: expected a measure"),
    "a body as cable": (HEAD + BALL + item("BeamSlider", 'point = "ball"', 'beam = "ball"'), "beam: expected a cable"),
    "terms of one": (HEAD + BALL + item("Coupling", "terms = [[1]]"), "items[1].terms: expected pairs"),
    "no terms": (HEAD + BALL + item("Coupling", "terms = []"), "items[1].terms: expected pairs"),
    "function of a list of lists": (HEAD + BALL + force('"ball"', "[[1], [2]]"), "items[1].vector: expected a number, a list"),
    "function of three": (HEAD + BALL + force('"ball"', "[1, 2, 3]"), "items[1].vector: expected 2 numbers"),
    "function without a kind": (HEAD + BALL + force('"ball"', "{ amplitude = 1 }"), "kind: expected one of Expression, Sine"),
    "table that goes back": (
        HEAD + BALL + force('"ball"', '{ kind = "Table", times = [1, 0], values = [[0, 0], [1, 1]] }'),
        "Table: times: expected two or more ascending",
    ),
    "motion of a motion of nothing": (
        HEAD + BALL + item("Prescribed", 'marker = "ball"', 'position = { kind = "Motion", value = { kind = "Motion" } }'),
        "position.value.value: expected a value",
    ),
    "deep motions": (
        HEAD + BALL + item("Prescribed", 'marker = "ball"', "position = " + '{ kind = "Motion", value = ' * 40 + "1" + " }" * 40),
        f"at most {DEPTH} levels",
    ),
    "law of numbers": (HEAD + BALL + LENGTH + item("ForceLaw", 'measures = "l"', "function = 3"), "function: expected a formula such as"),
    "law of other variables": (
        HEAD + BALL + LENGTH + item("ForceLaw", 'measures = "l"', 'function = { kind = "Expression", text = "x", variables = ["x"] }'),
        "expected 2 variables such as t, s; found x",
    ),
    "inertia of text": (HEAD + item("RigidBody", "mass = 1", "position = [0, 0]", 'inertia = [["a"]]'), "items[0].inertia: expected one of pi"),
    "ragged rotation": (
        "gravity = [0, 0, 1]\n" + item("RigidBody", "mass = 1", "position = [0, 0, 0]", "inertia = [1, 1, 1]", "rotation = [[1, 0], [0]]"),
        "rotation: expected a right-handed",
    ),
    "rod of three dimensions": (HEAD + item("RigidBody.rod", 'name = "r"', "mass = 1", "start = [0, 0, 0]", "end = [1, 0, 0]"), "items[0] of 'r': "),
    "rod without length": (
        HEAD + item("RigidBody.rod", 'name = "r"', "mass = 1", "start = [0, 0]", "end = [0, 0]"),
        "items[0] of 'r': length: expected a rod longer",
    ),
    "box of text": (
        HEAD + item("RigidBody.box", 'name = "r"', "mass = 1", 'size = "big"', "position = [0, 0]"),
        "items[0].size of 'r': expected a list",
    ),
    "flat box": (
        HEAD + item("RigidBody.box", 'name = "r"', "mass = 1", "size = [0, 1]", "position = [0, 0]"),
        "items[0].size of 'r': expected two (planar)",
    ),
    "radius of a rod": (
        "gravity = [0, 0, 1]\n" + item("RigidBody.rod", 'name = "r"', "mass = 1", "radius = -1", "start = [0, 0, 0]", "end = [0, 0, 1]"),
        "items[0].radius of 'r': expected a number not below zero",
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_files_by_hand(name: str, tmp_path: Path) -> None:
    content, told = TEXTS[name]
    path = tmp_path / "bad.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    refused(path, told)


JSON: dict[str, tuple[str, str]] = {
    "nothing": ("", "Expecting value"),
    "a list": ("[1, 2]", "expected a table of gravity"),
    "a number": ("3", "expected a table of gravity"),
    "null": ("null", "expected a table of gravity"),
    "key twice": ('{"gravity": [0, 1], "gravity": [0, 2]}', "expected each key once, found 'gravity'"),
    "nan": ('{"gravity": [0, NaN]}', "expected finite numbers, found NaN"),
    "infinity": ('{"gravity": [0, 1e999]}', "gravity: expected a list"),
    "truncated": ('{"gravity": [0, 1', "line 1: Expecting"),
    "deep": ("[" * 100_000, f"at most {DEPTH} levels"),
    "deep and closed": ("[" * 500 + "]" * 500, "bad.json"),
    "many values": ('{"gravity": [' + "0," * VALUES + "0]}", f"at most {VALUES} values"),
    "nulls": ('{"gravity": [0, null], "items": null}', "items: expected"),
    "null in an item": ('{"gravity": [0, 1], "items": [{"kind": "Particle", "mass": null, "position": [0, 0]}]}', "items[0].mass: expected a number"),
    "many bad items": ('{"gravity": [0, 1], "items": [' + ",".join(["{}"] * 20_000) + "]}", "and more: correct these first"),
}


@pytest.mark.parametrize("name", JSON)
def test_json_by_hand(name: str, tmp_path: Path) -> None:
    content, told = JSON[name]
    path = tmp_path / "bad.json"
    path.write_text(content, encoding="utf-8")
    refused(path, told)


# Every value of a shipped scene, replaced by what it cannot be; every key, misspelt; every file, cut off.

STRANGE: list[Any] = [True, [[[1]]], {"x": 1}, [], 1e300, "nonsense("]


def places(data: Any, key: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(data, dict):
        for name, inner in data.items():
            yield (*key, name)
            yield from places(inner, (*key, name))
    elif isinstance(data, list) and key == ("items",):
        for k, inner in enumerate(data):
            yield from places(inner, (*key, k))


def changed(data: Any, key: tuple[Any, ...], change: Callable[[Any, Any], None]) -> Any:
    out = home = copy.deepcopy(data)
    for part in key[:-1]:
        home = home[part]
    change(home, key[-1])
    return out


def mutations() -> list[Any]:
    """(name, data, what the message must name) of well over a hundred files."""
    found: list[Any] = []
    for path in sorted(SCENES.glob("*.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        for n, key in enumerate(places(data)):
            shown = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in key).lstrip(".")
            strange = STRANGE[n % len(STRANGE)]
            free = (key[-1] == "name" and isinstance(strange, str)) or (key[-2:-1] == ("parameters",) and isinstance(strange, float))
            if not free:
                what = shown.removeprefix("simulate.outputs.") if key[0] == "simulate" else shown
                if key[0] == "items" and len(key) > 2 and (key[-1] == "kind" or strange == []):  # the item is named, perhaps by another field of it
                    what = "items["
                found.append((f"{path.stem} {shown} is {strange}", changed(data, key, lambda home, name, s=strange: home.update({name: s})), what))
            if key[0] != "parameters" and key[:2] != ("simulate", "outputs"):
                found.append(
                    (
                        f"{path.stem} {shown} misspelt",
                        changed(data, key, lambda home, name: home.update({f"{name}_": home.pop(name)})),
                        "kind: expected" if key[-1] == "kind" else f"{key[-1]}_",
                    )
                )
    return found


MUTATIONS = mutations()


def test_files_with_one_thing_wrong(tmp_path: Path) -> None:
    assert len(MUTATIONS) + len(TEXTS) + len(JSON) > 300
    for k, (name, data, told) in enumerate(MUTATIONS):
        path = tmp_path / f"bad{k}.json"
        path.write_text(json.dumps(data), encoding="utf-8")
        try:
            refused(path, told)
        except (AssertionError, pytest.fail.Exception) as error:
            raise AssertionError(f"{name}: {error}") from error


def test_files_that_are_cut_off(tmp_path: Path) -> None:
    """Refused, or, cut between items, a smaller scene: never anything else."""
    rng, path = random.Random(7), tmp_path / "cut.toml"
    for source in sorted(SCENES.glob("*.toml")):
        whole = source.read_bytes()
        for _ in range(30):
            path.write_bytes(whole[: rng.randrange(len(whole))])
            any_outcome(path)


def any_outcome(path: Path) -> None:
    try:
        mbd.read_scene(path)
    except mbd.SceneError as error:
        assert all(line.startswith((path.name, "and ")) for line in error.complaints), error.complaints


LEAVES: Any = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8) | st.sampled_from(["rod", "rod.end", "2 * L"])
)
DATA: Any = st.recursive(LEAVES, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=8)
NAMES = st.sampled_from(
    ["kind", "name", "a", "b", "start", "end", "E", "A", "I", "rho", "mass", "position", "marker", "vector", "n_elements", "measures"]
)
KINDS = st.sampled_from(
    ["AncfCable", "Pin", "Particle", "Force", "Motor", "Gear", "ForceLaw", "RigidBody.rod", "RigidBody", "Coupling", "UserMeasure"]
)
ITEM = st.builds(lambda kind, fields: {"kind": kind} | fields, KINDS, st.dictionaries(NAMES, DATA, max_size=5))


@settings(max_examples=120, deadline=1000)
@given(gravity=st.just([0, -9.81]) | DATA, items=st.lists(ITEM, max_size=4), parameters=st.dictionaries(st.text(max_size=3), DATA, max_size=3))
def test_any_data(tmp_path_factory: pytest.TempPathFactory, gravity: Any, items: Any, parameters: Any) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    path.write_text(json.dumps({"gravity": gravity, "parameters": parameters, "items": items}), encoding="utf-8")
    any_outcome(path)


@settings(max_examples=120, deadline=1000)
@given(raw=st.binary(max_size=80), where=st.integers(0, 900), length=st.integers(0, 20))
def test_any_bytes(tmp_path_factory: pytest.TempPathFactory, raw: bytes, where: int, length: int) -> None:
    """Alone, and in the midst of a good file."""
    path = tmp_path_factory.getbasetemp() / "any.toml"
    whole = (SCENES / "pendulum.toml").read_bytes()
    for content in (raw, whole[:where] + raw + whole[where + length :]):
        path.write_bytes(content)
        any_outcome(path)
