"""What the fields of descriptions and functions hold, said in their annotations: to readers, and to scene files, whose model is made of them.

For a type checker all of these are ``Any``: descriptions take whatever a user gives, and complain of it by name when they are added.
"""

from __future__ import annotations

from typing import Annotated, Any

Number = Annotated[Any, "number"]
Count = Annotated[Any, "count"]
"""A whole number of pieces, which sizes arrays."""
Text = Annotated[Any, "text"]
Texts = Annotated[Any, "texts"]
Vector = Annotated[Any, "vector"]
"""Numbers [k]."""
Matrix = Annotated[Any, "matrix"]
"""Rows of numbers [k, l]."""
Constants = Annotated[Any, "constants"]
"""Numbers by name."""
Function = Annotated[Any, "function"]
"""A number, or numbers [d]; or a function of t [s] that returns them."""
Law = Annotated[Any, "law"]
"""A function of several numbers: measures, perhaps their rates and t."""
Laws = Annotated[Any, "laws"]
"""A law, or a list of laws."""
Place = Annotated[Any, "marker"]
"""A marker; or a body, a particle or the ground, which stands for its own."""
Measured = Annotated[Any, "measure"]
"""A measure, as ``scene.add`` returned it."""
Measures = Annotated[Any, "measures"]
"""A measure, or a list of measures."""
Terms = Annotated[Any, "terms"]
"""Pairs (coefficient, measure)."""
Beam = Annotated[Any, "beam"]
"""A cable, as ``scene.add`` returned it."""
