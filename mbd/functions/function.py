"""What functions as data share: fields of numbers that compare, and pickles that carry nothing else."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from .. import validate

Numbers = float | tuple[Any, ...]


class AsData:
    """A frozen dataclass: made of its fields, so that what it computes of them is left out of pickles."""

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), tuple(getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _wrong(self, field: str, expected: str, found: Any) -> ValueError:
        return ValueError(f"{type(self).__name__}: {field}: expected {expected}, found {validate.show(found)}")

    def _number(self, field: str) -> None:
        """The field as a float."""
        value = validate.floats(getattr(self, field))
        if validate.number(field, value):
            raise self._wrong(field, "a number", value)
        self._set(**{field: float(value)})

    def _numbers(self, field: str, most: int = 1) -> None:
        """The field as a float, or numbers [k] (or of more axes, up to ``most``) as tuples."""
        value = validate.floats(getattr(self, field))
        if not isinstance(value, np.ndarray) or value.ndim > most or not np.isfinite(value).all():
            raise self._wrong(field, "finite numbers", value)
        self._set(**{field: _tuples(value.tolist())})


def _tuples(value: Any) -> Any:
    return tuple(_tuples(part) for part in value) if isinstance(value, list) else value


def scaled(factor: float, a: Numbers, offset: Numbers = 0.0) -> Any:
    """offset + factor a, a float or an array [d]."""
    plain = isinstance(a, float) and isinstance(offset, float)
    return offset + factor * a if plain else np.asarray(offset) + factor * np.asarray(a)  # type: ignore[operator]
