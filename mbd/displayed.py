"""What notebooks show instead of a text."""

from __future__ import annotations


class Displayed:
    """Shown in notebooks as HTML, made when asked for by the report package."""

    def _repr_html_(self) -> str:
        from .report.notebook import html

        return html(self)
