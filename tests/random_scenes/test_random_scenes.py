"""Random scenes run, or say why not; and however they are described, they move the same.

The quick group takes 50 scenes, the same every time; the slow one 2050, in rounds of their own seeds, since scenes of one round have much in
common. A failure prints the smallest scene that fails; ``tests/test_random_finds.py`` keeps those that were found.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, seed, settings

from .plans import Plan
from .properties import PROPERTIES, judge_result, outcome
from .strategies import plans

ROUNDS, EACH = 52, 25
"""Rounds of the slow group, and scenes in each."""

LIKE = {"deadline": None, "database": None, "suppress_health_check": list(HealthCheck), "print_blob": True}


def runs_or_says_why(plan: Plan) -> None:
    _, result, told = outcome(plan)
    if result is not None:
        judge_result(plan, result, told)


def checked(judge: Callable[[Plan], None], count: int, start: int, compare: bool) -> None:
    """So many scenes of one seed."""

    @seed(start)
    @settings(max_examples=count, **LIKE)
    @given(plans(adaptive=compare, most=3 if compare else 4))
    def scenes(plan: Plan) -> None:
        judge(plan)

    scenes()


def test_scenes_run_or_say_why():
    checked(runs_or_says_why, 20, 1, False)


@pytest.mark.parametrize("judge", PROPERTIES, ids=lambda f: f.__name__)
def test_descriptions_of_one_motion(judge):
    checked(judge, 5, 1, True)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(430, 430 + ROUNDS))
def test_many_scenes_run_or_say_why(start):
    checked(runs_or_says_why, EACH, start, False)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(304, 309))
@pytest.mark.parametrize("judge", PROPERTIES, ids=lambda f: f.__name__)
def test_many_descriptions_of_one_motion(judge, start):
    checked(judge, EACH, start, True)
