"""Nothing, one, and ten thousand: elements, links of a chain, bodies apart; and long chains dropped."""

from __future__ import annotations

from functools import cache

import numpy as np

import mbd

from ... import machines
from .. import exact
from ..common import audited, share
from ..family import Checked, Family

LINK, EARLY = 0.1, 0.1


def elements(count: float) -> Checked:
    """The steel pendulum of 1.2 m against a rigid rod, for 0.1 s."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    rod = scene.add(mbd.AncfCable(**machines.pendulum_cable(machines.STEEL, int(count))._asdict(), name="rod"))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))
    result = mbd.simulate(scene, EARLY)
    return audited(result, share(result.position(rod.end)[-1], exact.flat(EARLY), 1.2))


def chain(links: int, t_end: float, rtol: float = 1e-6) -> tuple[mbd.Result, np.ndarray]:
    """Rods of 0.1 m and 1 kg in a row, pinned at the origin, horizontal at rest; with its end."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    before = scene.ground.at(0, 0)
    for k in range(links):
        link = scene.add(mbd.RigidBody.rod((k * LINK, 0), ((k + 1) * LINK, 0), mass=1.0, name=f"link {k}"))
        scene.add(mbd.Pin(link.at(-0.5 * LINK, 0), before, name=f"pin {k}"))
        before = link.at(0.5 * LINK, 0)
    result = mbd.simulate(scene, t_end, rtol=rtol)
    return result, np.array(result.position(before)[-1])


@cache
def chain_depth(links: int) -> float:
    """Of the end. One link: a rod. Long chains: the part that is still straight falls freely, while tension may pull it sideways. Else the
    run at rtol 1e-11."""
    if links == 1:
        return float(exact.flat(EARLY, LINK)[1])
    if links >= 30:
        return -0.5 * exact.GRAVITY * EARLY**2
    return float(chain(links, EARLY, 1e-11)[1][1])


def links(count: float) -> Checked:
    result, end = chain(int(count), EARLY)
    return audited(result, abs(end[1] - chain_depth(int(count))) / LINK)


def apart(count: float) -> float:
    """So many pendulums side by side, of different lengths."""
    scene = mbd.Scene(gravity=(0.0, -exact.GRAVITY))
    lengths = np.linspace(0.8, 1.2, int(count))
    rods = [scene.add(mbd.RigidBody.rod((0, 0), (a, 0), mass=1.0)) for a in lengths]
    for rod in rods:
        scene.add(mbd.Pin(rod.at(-0.5 * rod.length, 0), scene.ground.at(0, 0)))
    result = mbd.simulate(scene, EARLY, t_eval=[0.0, EARLY])
    some = np.unique(np.linspace(0, len(rods) - 1, 5).astype(int))
    return max(share(result.position(rods[k].at(0.5 * lengths[k], 0))[-1], exact.flat(EARLY, lengths[k]), 1.0) for k in some)


def dropped(count: float) -> Checked:
    """A chain held at one end falls for 1 s; motions are chaotic, the energy is not."""
    return audited(chain(int(count), 1.0)[0])


FAMILIES = (
    Family("elements", "of a steel pendulum", "rigid rod, 0.1 s", (0.0, 1.0, 2.0, 10.0, 100.0, 1000.0, 10000.0), 10.0, 1e-2, elements,
           quick=(1.0, 100.0),
           wanted=(1.0, 2.0, 10.0, 100.0, 1000.0, 10000.0), note="0 elements are refused"),
    Family("links", "of a chain of rods", "rod, free fall of a long chain's end", (1.0, 10.0, 100.0, 1000.0, 10000.0), 10.0, 1e-3, links,
           quick=(1.0, 100.0), wanted=(1.0, 10.0, 100.0, 1000.0, 10000.0)),
    Family("bodies apart", "pendulums in one scene", "elliptic functions", (1.0, 10.0, 100.0, 1000.0, 10000.0), 10.0, 1e-3, apart, quick=(100.0,),
           wanted=(1.0, 10.0, 100.0, 1000.0, 10000.0), patience=120.0),
    Family("chain dropped", "links of 0.1 m, held at one end, 1 s", "energy and joints", (1.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 10000.0), 10.0, 1e-3,
           dropped, quick=(10.0,), wanted=(1.0, 10.0, 30.0, 100.0, 300.0, 1000.0), patience=120.0),
)  # fmt: skip
