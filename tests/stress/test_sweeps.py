"""Every family of the stress suite over the range that it has to pass: right there, and nowhere wrong without a word."""

from __future__ import annotations

import importlib.util
import re

import pytest

from benchmarks.stress.families import FAMILIES
from benchmarks.stress.family import REFUSED, RIGHT, SILENT, Family, judged, peer_judged, reach

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::DeprecationWarning")]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_right_where_wanted_and_never_silent(family: Family) -> None:
    found = {level: judged(family, level) for level in family.levels}
    wrong = {level: verdict for level, verdict in found.items() if level in family.wanted and verdict.kind != RIGHT}
    assert not wrong
    silent = {level: verdict for level, verdict in found.items() if verdict.kind == SILENT}
    assert not silent
    for verdict in found.values():
        if verdict.kind == REFUSED:
            assert re.search(r"t = |expected .* found ", verdict.said), verdict.said


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_as_far_as_exudyn(family: Family) -> None:
    if importlib.util.find_spec("exudyn") is None or family.peer is None:
        pytest.skip("nothing to compare with")
    own = {level: judged(family, level) for level in family.levels}
    peer = {level: peer_judged(family, level) for level in family.levels}
    assert set(reach(family, peer)) & set(family.wanted) <= set(reach(family, own))
