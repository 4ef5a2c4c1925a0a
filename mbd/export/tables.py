"""A result as a flat table: a column for time and one for each component of each output, headed by name and unit."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from ..affine import Array
from ..extras import need
from ..outputs import Output, Series, series
from ..result import Result


def columns(result: Result, outputs: Mapping[str, Output], t: ArrayLike | None = None) -> dict[str, Array]:
    """Values [n_t] by headings such as ``tip position x [m]``; the first column is ``t [s]``."""
    run = result if t is None else result.resampled(t)
    found = {"t [s]": run.t}
    for each in series(run, outputs):
        found |= {heading(each, k): each.values[:, k] for k in range(len(each.components))}
    return found


def heading(each: Series, k: int) -> str:
    words = " ".join(word for word in (each.name, each.what, each.components[k]) if word)
    return f"{words} [{each.unit}]" if each.unit else words


def to_dataframe(result: Result, outputs: Mapping[str, Output], t: ArrayLike | None = None) -> Any:
    """A pandas DataFrame over time."""
    pandas = need("pandas", "data")
    return pandas.DataFrame(columns(result, outputs, t)).set_index("t [s]")


def to_csv(result: Result, path: str | os.PathLike[str], outputs: Mapping[str, Output], t: ArrayLike | None = None) -> None:
    """A text file with a line of headings; numbers in full, so that they read back as they were."""
    table = columns(result, outputs, t)
    with open(Path(path), "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(zip(*(values.tolist() for values in table.values())))
