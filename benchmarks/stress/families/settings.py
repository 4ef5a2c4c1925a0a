"""Tolerances and fixed steps, from far too loose to far too tight."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import mbd

from ... import machines
from .. import exact
from ..common import audited, powers, share
from ..family import Checked, Family

SPAN = 10.0
ALLOWED = 30.0
"""What an error may be, in units of rtol, above what rounding leaves."""


def rod(solver: Any = None, rtol: float = 1e-6, t_end: float = SPAN) -> tuple[mbd.Result, np.ndarray]:
    """A rigid rod of 1.2 m, released horizontally, with its end."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    body = scene.add(mbd.RigidBody.rod((0, 0), (1.2, 0), mass=1.0, name="rod"))
    scene.add(mbd.Pin(body.at(-0.6, 0), scene.ground.at(0, 0), name="pivot"))
    result = mbd.simulate(scene, t_end, rtol=rtol, solver=solver)
    return result, result.position(body.at(0.6, 0))[-1]


def tolerance(rtol: float) -> float:
    _, end = rod(rtol=rtol)
    return share(end, exact.flat(SPAN), 1.2) / max(ALLOWED * rtol, 1e-12)


@cache
def _beam(rtol: float) -> np.ndarray:
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    body = scene.add(mbd.AncfCable(**machines.pendulum_cable(machines.SOFT, 10)._asdict(), name="rod"))
    scene.add(mbd.Pin(body.start, scene.ground.at(0, 0), name="pivot"))
    return np.array(mbd.simulate(scene, 0.6, rtol=rtol, solver=mbd.Radau(stages=7) if rtol == 1e-12 else None).position(body.end)[-1])


def beam_tolerance(rtol: float) -> float:
    return share(_beam(rtol), _beam(1e-12), 1.2) / max(ALLOWED * rtol, 1e-10)


def _fixed(solver: Any) -> Checked:
    result, end = rod(solver)
    return audited(result, share(end, exact.flat(SPAN), 1.2))


def radau_step(step: float) -> Checked:
    return _fixed(mbd.Radau(stages=3, step=step))


def alpha_step(step: float) -> Checked:
    return _fixed(mbd.GeneralizedAlpha(step=step))


def gauss_step(step: float) -> Checked:
    return _fixed(mbd.Gauss(step=step, stages=3))


STEPS = (1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
WHY = "steps that the user fixed are not controlled; what comes out is checked by its energy balance alone"
FAMILIES = (
    Family("tolerance, body", "rtol; errors in units of 30 rtol", "elliptic functions", (*powers(-14, -1), 0.5), 1e-6, 1.0, tolerance,
           quick=(1e-14, 1e-6, 0.5), wanted=(*powers(-14, -1), 0.5)),
    Family("tolerance, beam", "rtol; errors in units of 30 rtol", "rtol 1e-12, 7 stages", (*powers(-14, -1), 0.5), 1e-6, 1.0, beam_tolerance,
           quick=(1e-6,), wanted=powers(-11, -1)),
    Family("fixed step, Radau", "step [s], period 1.9 s", "elliptic functions", STEPS, 0.01, 5e-2, radau_step, quick=(0.1,),
           wanted=STEPS[:4], note=WHY),
    Family("fixed step, gen. alpha", "step [s], period 1.9 s", "elliptic functions", STEPS, 0.01, 5e-2, alpha_step, wanted=STEPS[:2], note=WHY),
    Family("fixed step, Gauss", "step [s], period 1.9 s", "elliptic functions", STEPS, 0.01, 5e-2, gauss_step, wanted=STEPS[:4], note=WHY),
)  # fmt: skip
