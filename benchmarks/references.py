"""Computes ``data/references.json`` anew: ``python -m benchmarks.references [--scene NAME ...]``. Takes many minutes.

Published or exact values where they exist; otherwise mbd at its tightest by two methods, with the difference between them. Exudyn's cables
have 5 Gauss points for the stretch and 3 for the bending where mbd's have 7 for both: its reference is the solution of that very mesh,
found by mbd with the quadrature exchanged. So neither program is charged with what its mesh leaves out.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from unittest import mock

import numpy as np

import mbd
from mbd.elements import continuum

from . import machines
from .scenes import BY_NAME, CASES, Case

LIBRARY = "IFToMM benchmark library A02; exact elliptic solution of the parallelogram branch"
PUBLISHED: dict[str, tuple[list[str], str]] = {
    "squeezer": (
        ["-6.9630394270468515075e-03", "-7.1838843071910190813e-04"],
        "IVP test set problem, integrated in binary128 to 20 digits (agrees with the published values to their 9 digits)",
    ),
    "heavy top": (
        ["-1.5041682274564175981e-01", "-7.2416559163689565074e-01", "-6.7302226956044409605e-01"],
        "Bruels and Cardona (2010), Euler's equations in binary128, 20 digits",
    ),
}


@contextmanager
def exudyn_quadrature() -> Iterator[None]:
    """mbd's cables with five Gauss points for the stretch and three for the curvature: all eight, with weights zero where not meant."""
    (x5, w5), (x3, w3) = continuum.gauss(5), continuum.gauss(3)
    original = continuum.Continuum.__init__

    def eight(self: Any, points: int, **arrays: Any) -> None:
        original(self, 8, **arrays)
        self.modulus[0, :, 5:], self.modulus[1:, :, :5] = 0.0, 0.0

    points = np.concatenate((x5, x3)), np.concatenate((w5, w3))
    with mock.patch.object(continuum, "gauss", lambda _: points), mock.patch.object(continuum.Continuum, "__init__", eight):
        yield


def four_bar(windows: int, t: float) -> list[str]:
    """psi'^2 = 1 + 4 w sin^2(psi/2), psi from upright: psi/2 = am(t/2 | -4 w), w = W/J; position (sin psi, cos psi) of the first bar's end."""
    import mpmath

    with mpmath.workdps(40):
        w = ((windows + 1) / mpmath.mpf(2) + windows) * mpmath.mpf("9.81") / ((windows + 1) / mpmath.mpf(3) + windows)
        sn, cn = (mpmath.re(mpmath.ellipfun(name, mpmath.mpf(t) / 2, m=-4 * w)) for name in ("sn", "cn"))
        return [mpmath.nstr(2 * sn * cn, 20), mpmath.nstr(1 - 2 * sn * sn, 20)]


def _end(case: Case, solver: Any, rtol: float) -> np.ndarray:
    scene, marker = case.build()
    return np.array(mbd.simulate(scene, case.t_end, rtol=rtol, solver=solver).position(marker)[-1])


def _converged(case: Case) -> tuple[list[float], str, float]:
    """By two methods; the rounding of a stiff beam limits what they can agree to."""
    name, second = ("Radau(5)", mbd.Radau(5)) if case.beam else ("DormandPrince()", mbd.DormandPrince())
    rtol = 1e-11 if case.chain > 100 else TIGHT  # below, the rounding of a long chain's equations shows in the error estimate
    one, other = _end(case, mbd.Radau(7), rtol), _end(case, second, rtol)
    apart = float(np.linalg.norm(one - other))
    print(f"{case.name}: {one} {other} apart by {apart:.2g} m", flush=True)
    return [float(x) for x in one], f"mbd {mbd.__version__}, Radau(7) at rtol {rtol:g}; {name} differs by {apart:.1e} m", apart


TIGHT = 1e-12


def reference(case: Case) -> dict[str, Any]:
    if case.peer == "four_bar":
        return {"value": four_bar(case.arguments[0], case.t_end), "source": LIBRARY}
    if case.name in PUBLISHED:
        value, source = PUBLISHED[case.name]
        return {"value": value, "source": source}
    own, source, apart = _converged(case)
    if not case.beam:
        return {"value": own, "source": source, "uncertainty": apart}
    with exudyn_quadrature():
        peer, peer_source, peer_apart = _converged(case)
    entry = {"mbd": own, "source": source, "uncertainty": apart}
    return entry | {"Exudyn": peer, "source of Exudyn": f"quadrature of 5 and 3 points: {peer_source}", "uncertainty of Exudyn": peer_apart}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="*", choices=list(BY_NAME), help="only these")
    chosen = parser.parse_args().scene
    path = machines.DATA / "references.json"
    entries = json.loads(path.read_text()) if path.exists() else {}
    for case in CASES:
        if not chosen or case.name in chosen:
            entries[case.name] = {"t_end": case.t_end, "unit": "m"} | reference(case)
            path.write_text(json.dumps(entries, indent=1) + "\n")


if __name__ == "__main__":
    main()
