"""One case of a sweep: what a worker does. It returns numbers or a message, never raises, so that one case cannot end the others."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from typing import Any, NamedTuple

import numpy as np

from ..affine import Array

Case = dict[str, Any]


class Outcome(NamedTuple):
    """What came of a case: an array for each output or, where it failed, a message; what it warned of; and the seconds that it took."""

    values: dict[str, Array]
    failure: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0


def run(
    build: Callable[..., Any], case: Case, outputs: Mapping[str, Callable[[Any], Any]], settings: dict[str, Any], threads: int | None
) -> Outcome:
    """Builds, simulates and reads one case, with at most ``threads`` threads of linear algebra (None: as many as it takes)."""
    clock = time.perf_counter()
    with _limited(threads), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = _result(build, case, settings)
            values, failure = {name: _value(name, output, result) for name, output in outputs.items()}, ""
        except Exception as error:
            values, failure = {}, f"{type(error).__name__}: {error}"
    told = tuple(dict.fromkeys(str(warning.message) for warning in caught))
    return Outcome(values, failure, told, time.perf_counter() - clock)


def _limited(threads: int | None) -> Any:
    if threads is None:
        return nullcontext()
    from threadpoolctl import threadpool_limits

    return threadpool_limits(limits=threads)


def _result(build: Callable[..., Any], case: Case, settings: dict[str, Any]) -> Any:
    from ..run import simulate
    from ..scene import Scene

    built = build(**case)
    if isinstance(built, Scene):
        return simulate(built, **settings)
    return built


def _value(name: str, output: Callable[[Any], Any], result: Any) -> Array:
    try:
        found = output(result)
    except Exception as error:
        raise ValueError(f"output {name!r} raised {type(error).__name__}: {error}") from error
    try:
        array = np.array(found, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"output {name!r}: expected a number or an array of numbers, found {found!r}") from None
    if not np.isfinite(array).all():
        raise ValueError(f"output {name!r}: expected finite numbers, found {array!r}")
    return array
