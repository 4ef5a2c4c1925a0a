"""What implicit steps of a large scene allocate; ``benchmarks/scaling.py`` measures the whole process, whose allocator keeps a third more."""

import tracemalloc

import pytest

import mbd


def pendulum(n: int) -> mbd.Scene:
    scene = mbd.Scene(gravity=(0.0, -9.81))
    rod = scene.add(mbd.AncfCable((0.0, 0.0), (1.2, 0.0), n_elements=n, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540.0))
    scene.add(mbd.Pin(rod.start, scene.ground.at(0.0, 0.0)))
    return scene


@pytest.mark.parametrize(("stages", "kilobytes"), [(3, 4.8), (7, 7.5)])
def test_a_process_that_takes_a_third_more_stays_below_ten_kilobytes_a_coordinate(stages: int, kilobytes: float) -> None:
    solver = mbd.Radau(stages)
    mbd.simulate(pendulum(2), 1e-3, solver=solver)  # loads what is imported late
    tracemalloc.start()
    try:
        scene = pendulum(120)
        mbd.simulate(scene, 0.006, rtol=1e-6, solver=solver)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < kilobytes * 1024 * scene.build().n
