"""The published JSON Schema: current, and of one mind with the reader."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import mbd
from mbd.files.kinds import FUNCTIONS, ITEMS, SOLVERS
from mbd.files.model import schema

from .test_malformed import MUTATIONS
from .test_round_trip import SCENES

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def validator() -> Any:
    published = json.loads((ROOT / "docs" / "scene.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(published)
    return jsonschema.Draft202012Validator(published)


def test_the_published_schema_is_current(validator: Any) -> None:
    assert validator.schema == schema(), "write it anew: mbd schema > docs/scene.schema.json"


def test_every_kind_is_described(validator: Any) -> None:
    kinds = [each for each in validator.schema["$defs"].values() if "kind" in each["properties"]]
    told = {each["properties"]["kind"]["const"]: each for each in kinds}
    for name, kind in {**ITEMS, **FUNCTIONS, **SOLVERS}.items():
        assert set(told[name]["properties"]) == {"kind", *kind.fields} and told[name]["description"]
        assert set(told[name].get("required", ())) == {"kind", *(key for key, field in kind.fields.items() if field.required)}


@pytest.mark.parametrize("path", sorted((ROOT / "examples" / "scenes").glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenes_are_valid(path: Path, validator: Any) -> None:
    validator.validate(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("name", SCENES)
def test_written_scenes_are_valid(name: str, validator: Any, tmp_path: Path) -> None:
    mbd.write_scene(SCENES[name](), tmp_path / "scene.json", t_end=1.0, solver=mbd.Radau())
    validator.validate(json.loads((tmp_path / "scene.json").read_text(encoding="utf-8")))


def test_misspelt_keys_are_invalid(validator: Any) -> None:
    wrong = [(name, data) for name, data, _ in MUTATIONS if name.endswith("misspelt")]
    assert len(wrong) > 50
    for name, data in wrong:
        assert not validator.is_valid(data), name
