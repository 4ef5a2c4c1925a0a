"""Packages that only some features need: imported when they are asked for, with a sentence where they are missing."""

from __future__ import annotations

import importlib
from typing import Any


def need(package: str, extra: str) -> Any:
    """The package. Raises ImportError that names the extra of mbd which installs it."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f'{package} is needed for this and not installed: pip install "mbd[{extra}]"') from error
