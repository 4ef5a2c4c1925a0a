"""What is swept, and how a level of it is judged: right, refused with a reason, announced as doubtful, or wrong without a word."""

from __future__ import annotations

import _thread
import importlib
import resource
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import Pipe, get_context
from typing import Any, NamedTuple

import mbd

Level = float | str

RIGHT, REFUSED, ANNOUNCED, SILENT, SLOW = "right", "refused", "announced", "SILENT", "too slow"
"""Verdicts. ANNOUNCED: the result is wrong, and a warning or its audit says so. SLOW: stopped at the patience of the sweep."""

PATIENCE = 20.0
"""Seconds of processor time that one level may take."""


class PeerFailure(Exception):
    """What the peer said when it gave up."""


class Checked(NamedTuple):
    """An error against a reference, and what the result's own audit shows to be wrong, both as shares."""

    error: float
    shown: float = 0.0


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
    run: Callable[[Any], float | Checked]
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
    """Interrupts what takes more processor time, as Ctrl-C would. A thread watches, and the interpreter is told: not every machine delivers
    the system's timers of processor time."""
    end, done = time.process_time() + seconds, threading.Event()

    def interrupt(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    def watch() -> None:
        while (left := end - time.process_time()) > 0.0:
            if done.wait(left):
                return
        _thread.interrupt_main(signal.SIGVTALRM)

    before = signal.signal(signal.SIGVTALRM, interrupt)
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()
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
                found = family.run(level)
        except mbd.SimulationError as failure:
            return verdict(SLOW if failure.what == "interrupted" else REFUSED, None, str(failure))
        except mbd.SceneError as failure:
            return verdict(REFUSED, None, str(failure))
        except KeyboardInterrupt:
            return verdict(SLOW)
    checked = found if isinstance(found, Checked) else Checked(found)
    said = "; ".join(dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, mbd.SceneWarning)))
    error = max(checked)
    if error <= family.bar:
        return verdict(RIGHT, error, said)
    announced = "do not trust" in said or checked.shown > family.bar
    return verdict(ANNOUNCED if announced else SILENT, error, said or f"the audit shows an error of {checked.shown:.1e}")


def peer_judged(family: Family, level: Level) -> Verdict:
    """Exudyn's run: right if any of its settings is; silent if none is and one of them reported success. In a process of its own, which
    ends at the patience: it cannot be interrupted."""
    here, there = Pipe(duplex=False)
    child = get_context("fork").Process(target=_tries, args=(family, level, there))
    clock = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    child.start()
    there.close()
    errors, said, ended = [], "", False
    with suppress(EOFError):
        while True:
            found = here.recv()
            ended = found is None
            if isinstance(found, str):
                said = found
            elif found is not None:
                errors.append(found)
    child.join()
    best = min((e for e in errors if e == e), default=None)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - clock
    if best is not None and best <= family.bar:
        return Verdict(RIGHT, best, said, seconds)
    return Verdict(SILENT if errors else REFUSED if ended else SLOW, best, said, seconds)


def _tries(family: Family, level: Level, send: Any) -> None:
    """Sends the error of every setting until one is right, or what was said instead; None at the end."""
    resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time()) + int(PATIENCE), resource.RLIM_INFINITY))
    runs = family.peer
    assert runs is not None
    for run in runs(level):
        try:
            error = run()
        except PeerFailure as failure:
            send.send(str(failure))
            continue
        send.send(error)
        if error <= family.bar:
            break
    send.send(None)


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
