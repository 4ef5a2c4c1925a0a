"""Linear algebra, consistent starts and integrators for index-reduced DAEs. Import it as ``mbd.solvers``.

These modules see a ``System`` (system.py of this folder: a protocol) and do not know that mechanics exists.
"""

if __name__ != "mbd.solvers":
    raise ImportError(f"import mbd.solvers, not {__name__}: loaded twice, every class would exist twice")

from .automatic import Automatic
from .gauss import Gauss
from .generalized_alpha import GeneralizedAlpha
from .projected import DormandPrince
from .radau import Radau

__all__ = ["Automatic", "DormandPrince", "Gauss", "GeneralizedAlpha", "Radau"]
