"""``sweep``: one function of parameters, many cases, on any executor."""

from __future__ import annotations

import inspect
import itertools
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from contextlib import ExitStack
from typing import Any

from ..errors import SceneError
from ..extras import need
from . import case as worker
from .case import Case, Outcome
from .checkpoint import Checkpoint
from .table import Sweep

Parameters = Mapping[str, Iterable[Any]] | Sequence[Case]
Outputs = Mapping[str, Callable[[Any], Any]]


def sweep(
    build: Callable[..., Any],
    parameters: Parameters,
    outputs: Outputs,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    checkpoint: str | os.PathLike[str] | None = None,
    **settings: Any,
) -> Sweep:
    """Runs a scene for many parameters; a labelled table of outputs.

    build       a function of the parameters, by keyword, that returns a scene, which is simulated with the ``settings`` (``t_end=``, ``rtol=``, ...),
                or what it has computed itself: ``mbd.modes(scene)``, ``mbd.equilibrium(scene)``, ...
    parameters  names and values, of which all combinations are run, or a list of cases, a dict each
    outputs     names and functions of the result, or of what ``build`` returned, that give a number or an array
    executor    any ``concurrent.futures.Executor``, also ``dask.distributed.Client(...).get_executor()``; each case has one thread of linear
                algebra there (needs threadpoolctl). Processes need functions of a module, not lambdas. None: here, one case after the other
    progress    a bar on the terminal, where it is one and tqdm is installed
    checkpoint  a file in which finished cases are kept: the same call goes on where it was stopped. Cases that failed run again

    A case that fails, or whose worker dies, is a failure of that case, with its message, in the table. Raises SceneError for arguments that
    make no sense, ValueError for the checkpoint of another sweep.
    """
    cases, grid = _cases(parameters)
    _check(build, cases, outputs, settings)
    if executor is not None:
        need("threadpoolctl", "sweep")
    done: dict[int, Outcome] = {}
    with ExitStack() as stack:
        kept = None
        if checkpoint is not None:
            kept = stack.enter_context(Checkpoint(checkpoint, build, list(cases[0]), list(outputs), settings))
            done = {k: found for k, found in ((k, kept.get(case)) for k, case in enumerate(cases)) if found}
        bar = stack.enter_context(_bar(len(cases), len(done))) if progress else None
        missing = [k for k in range(len(cases)) if k not in done]
        for k, outcome in _outcomes(executor, build, cases, missing, outputs, settings):
            done[k] = outcome
            if kept:
                kept.keep(cases[k], outcome)
            if bar is not None:
                bar.update()
    return Sweep(cases, [done[k] for k in range(len(cases))], list(outputs), grid)


def _cases(parameters: Parameters) -> tuple[list[Case], dict[str, list[Any]] | None]:
    """The cases and, where they are all combinations, the names and values."""
    if isinstance(parameters, Mapping):
        wrong = [name for name, values in parameters.items() if isinstance(values, str) or not isinstance(values, Iterable)]
        if wrong or not parameters:
            raise SceneError([f"parameters: expected names, each with several values, found {dict(parameters)!r}; give lists of values"])
        grid = {name: list(values) for name, values in parameters.items()}
        return [dict(zip(grid, values)) for values in itertools.product(*grid.values())], grid
    return [dict(case) for case in parameters], None


def _check(build: Any, cases: list[Case], outputs: Any, settings: dict[str, Any]) -> None:
    found = []
    if not callable(build):
        found.append(f"build: expected a function of the parameters that returns a scene, found {build!r}")
    if not cases:
        found.append("parameters: expected at least one case, found none; give every parameter a value or more")
    if not outputs or not isinstance(outputs, Mapping) or not all(map(callable, outputs.values())):
        found.append(f"outputs: expected names, each with a function of the result, found {outputs!r}")
    if len({tuple(case) for case in cases}) > 1:
        found.append("parameters: expected the same names in all cases, in one order, found others; complete them")
    if callable(build) and not found:
        found += _misnamed(build, cases[0])
    unknown = sorted(set(settings) - {"t_end", "rtol", "solver", "t_eval", "events"})
    if unknown:
        found.append(f"settings: expected arguments of mbd.simulate (t_end, rtol, solver, t_eval, events), found {', '.join(unknown)}")
    if found:
        raise SceneError(found)


def _misnamed(build: Callable[..., Any], case: Case) -> list[str]:
    try:
        inspect.signature(build).bind(**case)
    except TypeError as error:
        return [f"parameters: expected the arguments of {getattr(build, '__name__', build)}, found {', '.join(case)} ({error})"]
    except ValueError:  # a callable that tells no signature
        return []
    return []


def _outcomes(
    executor: Executor | None, build: Callable[..., Any], cases: list[Case], missing: list[int], outputs: Outputs, settings: dict[str, Any]
) -> Iterator[tuple[int, Outcome]]:
    """Numbers of cases with what came of them, as they finish."""
    if executor is None:
        for k in missing:
            yield k, worker.run(build, cases[k], dict(outputs), settings, None)
        return
    futures = {executor.submit(worker.run, build, cases[k], dict(outputs), settings, 1): k for k in missing}
    try:
        for future in as_completed(futures):
            error = future.exception()
            yield futures[future], Outcome({}, f"{type(error).__name__}: {error}") if error else future.result()
    finally:
        for future in futures:
            future.cancel()


def _bar(total: int, done: int) -> Any:
    try:
        from tqdm import tqdm
    except ImportError:
        from contextlib import nullcontext

        return nullcontext()
    return tqdm(total=total, initial=done, unit="case", disable=not sys.stderr.isatty())
