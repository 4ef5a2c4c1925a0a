"""Items that hold other items (measures that are coupled, a cable that is slid along) in scenes of independent parts."""

from __future__ import annotations

from typing import Any

import numpy as np

import mbd


def coupled(scene: mbd.Scene, x: float) -> Any:
    masses = [scene.add(mbd.Particle(m, (x + k, -1.0))) for k, m in enumerate((1.0, 3.0))]
    ropes = [scene.add(mbd.Length(body.at(), scene.ground.at(x + k, 0.0))) for k, body in enumerate(masses)]
    square = scene.add(mbd.UserMeasure(ropes[0], lambda s: s**2))
    scene.add(mbd.Coupling([(1.0, ropes[0]), (1.0, ropes[1])]))
    scene.add(mbd.PD(square, 1.0, proportional=2.0))
    return masses[0].at()


def slid(scene: mbd.Scene, x: float) -> Any:
    cable = scene.add(mbd.AncfCable((x, 0), (x + 1, 0), n_elements=2, E=1e6, A=1e-4, I=1e-8, rho=1000.0))
    for marker, at in ((cable.start, x), (cable.end, x + 1.0)):
        scene.add(mbd.Pin(marker, scene.ground.at(at, 0)))
    bead = scene.add(mbd.Particle(0.1, (x + 0.3, 0)))
    scene.add(mbd.BeamSlider(bead, cable))
    return bead.at()


def test_parts_keep_what_they_refer_to() -> None:
    together = mbd.Scene()
    markers = [coupled(together, 0.0), slid(together, 5.0), coupled(together, 10.0), slid(together, 15.0)]
    result = mbd.simulate(together, 0.2, rtol=1e-8, solver=mbd.Radau(5))
    assert len(together.parts()) >= 2
    for k, make in enumerate((coupled, slid, coupled, slid)):
        alone = mbd.Scene()
        marker = make(alone, 5.0 * k)
        expected = mbd.simulate(alone, 0.2, rtol=1e-8, solver=mbd.Radau(5)).position(marker)[-1]
        assert np.abs(result.position(markers[k])[-1] - expected).max() < 1e-6
