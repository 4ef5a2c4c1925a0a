"""What is swept, and how a level of it is judged: right, refused with a reason, announced as doubtful, or wrong without a word."""

from __future__ import annotations

import importlib
import signal
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple

import mbd

Level = float | str

RIGHT, REFUSED, ANNOUNCED, SILENT, SLOW = "right", "refused", "announced", "SILENT", "too slow"
"""Verdicts. ANNOUNCED: the result is wrong and a warning says so. SLOW: stopped at the patience of the sweep."""

PATIENCE = 60.0
"""Seconds of processor time that one level may take."""


class PeerFailure(Exception):
    """What the peer said when it gave up."""


class Verdict(NamedTuple):
    """Of one level: what came out, its error (None where nothing did), what was said, and the processor time it took [s]."""

    kind: str
    error: float | None = None
    said: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Family:
    """A quantity and its levels.

    name, what   of the quantity;  reference  what results are compared with, in words
    levels       from one extreme to the other;  nominal  the one that sweeps go out from;  wanted  those that have to be right
    bar          the largest error of a right result, as a share of the scene's scale
    run          the error of a level
    quick        levels that take no time;  note  what a reader of the table should know;  patience [s]
    """

    name: str
    what: str
    reference: str
    levels: Sequence[Level]
    nominal: Level
    bar: float
    run: Callable[[Any], float]
    quick: Sequence[Level] = ()
    wanted: Sequence[Level] = ()
    note: str = ""
    patience: float = PATIENCE

    @property
    def peer(self) -> Callable[[Any], Iterator[Callable[[], float]]] | None:
        """Exudyn's runs of a level, one for each of its settings: errors, or PeerFailure raised. None where it has no such thing."""
        module = importlib.import_module(self.run.__module__.replace(".families.", ".peers."))
        return getattr(module, self.run.__name__, None)


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Interrupts what takes more processor time, as Ctrl-C would."""

    def interrupt(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGVTALRM, interrupt)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def judged(family: Family, level: Level) -> Verdict:
    """mbd's run of a level. Errors that are not the library's own are not caught: they would be defects."""
    clock = time.process_time()

    def verdict(kind: str, error: float | None = None, said: str = "") -> Verdict:
        return Verdict(kind, error, said, time.process_time() - clock)

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with at_most(family.patience):
                error = family.run(level)
        except mbd.SimulationError as failure:
            return verdict(SLOW if failure.what == "interrupted" else REFUSED, None, str(failure))
        except mbd.SceneError as failure:
            return verdict(REFUSED, None, str(failure))
        except KeyboardInterrupt:
            return verdict(SLOW)
    said = "; ".join(dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, mbd.SceneWarning)))
    if error <= family.bar:
        return verdict(RIGHT, error, said)
    return verdict(ANNOUNCED if "do not trust" in said else SILENT, error, said)


def peer_judged(family: Family, level: Level) -> Verdict:
    """Exudyn's run: right if any of its settings is; silent if none is and one of them reported success."""
    clock, errors, said = time.process_time(), [], ""
    runs = family.peer
    assert runs is not None
    for run in runs(level):
        try:
            errors.append(run())
        except PeerFailure as failure:
            said = str(failure)
            continue
        if errors[-1] <= family.bar:
            break
    best = min((e for e in errors if e == e), default=None)
    kind = REFUSED if not errors else RIGHT if best is not None and best <= family.bar else SILENT
    return Verdict(kind, best, said, time.process_time() - clock)


def reach(family: Family, verdicts: dict[Level, Verdict]) -> list[Level]:
    """The levels that are right without a gap from the nominal one."""
    levels = [level for level in family.levels if level in verdicts]
    middle = levels.index(family.nominal)
    found: list[Level] = []
    for outward in (levels[middle::-1], levels[middle + 1 :]):
        for level in outward:
            if verdicts[level].kind != RIGHT:
                break
            found.append(level)
    return sorted(found, key=levels.index)
