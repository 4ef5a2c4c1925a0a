"""The file in which a sweep keeps what is done: a JSON text in each line, the first for the sweep, the others for a case each.

Lines are appended and pushed to the disk one by one. Whoever is killed leaves whole lines and at most a piece of one, which is left out when
the file is read again. Cases that failed are not kept: they run again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .case import Case, Outcome

FORMAT, VERSION = "mbd sweep", 1


class Checkpoint:
    """The finished cases in a file, which is made where there is none.

    Raises ValueError for a file of another sweep: of other parameters, outputs, settings or another function.
    """

    def __init__(
        self, path: str | os.PathLike[str], build: Callable[..., Any], parameters: list[str], outputs: list[str], settings: Mapping[str, Any]
    ):
        self._path = Path(path)
        name = f"{getattr(build, '__module__', '')}.{getattr(build, '__qualname__', repr(build))}"
        about = {"format": FORMAT, "version": VERSION, "build": name, "parameters": parameters, "outputs": outputs, "settings": dict(settings)}
        self._head = json.loads(text(about))
        lines, whole = self._lines()
        self._check(lines)
        self._done = {key(line["case"]): _outcome(line) for line in lines[1:]}
        self._file = open(self._path, "r+b" if self._path.exists() else "xb")  # noqa: SIM115 (closed by __exit__)
        self._file.seek(whole)
        self._file.truncate()
        if not lines:
            self._append(self._head)

    def __enter__(self) -> Checkpoint:
        return self

    def __exit__(self, *_: Any) -> None:
        self._file.close()

    def get(self, case: Case) -> Outcome | None:
        """What came of a case before, or None."""
        return self._done.get(key(case))

    def keep(self, case: Case, outcome: Outcome) -> None:
        if not outcome.failure:
            values = {name: array.tolist() for name, array in outcome.values.items()}
            self._append({"case": case, "values": values, "warnings": outcome.warnings, "seconds": outcome.seconds})

    def _append(self, line: Any) -> None:
        self._file.write(text(line).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def _lines(self) -> tuple[list[dict[str, Any]], int]:
        """The whole lines, and the length in bytes up to the end of the last one."""
        data = self._path.read_bytes() if self._path.exists() else b""
        whole = data.rfind(b"\n") + 1
        try:
            return [json.loads(line) for line in data[:whole].splitlines()], whole
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{self._path}: expected the checkpoint of a sweep, found a damaged file ({error}); choose another name") from error

    def _check(self, lines: list[dict[str, Any]]) -> None:
        if not lines:
            return
        head = lines[0] if isinstance(lines[0], dict) else {}
        for name, expected in self._head.items():
            if head.get(name) != expected:
                found = f"found {head.get(name)!r}; choose another name or remove the file"
                raise ValueError(f"{self._path}: {name}: expected {expected!r} of this sweep, {found}")
        for number, line in enumerate(lines[1:], start=2):
            good = isinstance(line, dict) and isinstance(line.get("case"), dict) and isinstance(line.get("values"), dict)
            if not good or list(line["values"]) != self._head["outputs"]:
                raise ValueError(f"{self._path}, line {number}: expected a case and its {', '.join(self._head['outputs'])}, found {line!r:.80}")


def _outcome(line: dict[str, Any]) -> Outcome:
    values = {name: np.array(value, dtype=float) for name, value in line["values"].items()}
    return Outcome(values, "", tuple(line.get("warnings", ())), float(line.get("seconds", 0.0)))


def key(case: Case) -> str:
    return text(case)


def text(value: Any) -> str:
    return json.dumps(value, default=_plain, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    told = repr(value)
    if " at 0x" in told or "<" in told:
        raise ValueError(f"checkpoint: expected parameters and settings that can be written down, found {told}; give numbers or texts")
    return told
