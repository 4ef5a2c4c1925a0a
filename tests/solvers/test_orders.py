"""Observed orders with fixed steps: a spring pendulum of two particles, the first on a rod; free, or damped and driven.

The spring's vibration (3.5 periods, of which a step of Radau's takes 3 to 18 %) makes errors that stay far above rounding while Newton's
iteration still converges in one frozen Jacobian; the rod makes the equations an index-2 system with a curved constraint.
"""

import numpy as np
import pytest

import mbd

T_END = 1.0


@pytest.fixture(scope="module", params=[0.0, 1.0], ids=["free", "driven"])
def swing(request):
    scene = mbd.Scene(gravity=(0, -9.81))
    a, b = scene.add(mbd.Particle(1.0, (1, 0))), scene.add(mbd.Particle(0.7, (1.5, 0.6)))
    scene.add(mbd.Distance(a.at(), scene.ground.at(0, 0)))
    scene.add(mbd.Spring(a.at(), b.at(), stiffness=200.0, length=0.7, damping=request.param))
    if request.param:
        scene.add(mbd.Force(b.at(), lambda t: (5.0 * np.sin(9.0 * t), 3.0 * np.cos(7.0 * t))))
    # 13th order at 1e-13: found within 2e-13 in q and 1e-12 in v of runs at 1e-12, a hundredth of the smallest errors below.
    return scene, mbd.simulate(scene, T_END, rtol=1e-13, solver=mbd.Radau(stages=7)).final


def orders(swing, solver, counts, rtol):
    """Slopes of the errors of q and v between numbers of steps."""
    scene, true = swing
    errors = []
    for count in counts:
        result = mbd.simulate(scene, T_END, rtol=rtol, solver=solver(T_END / count))
        assert result.stats["failed"] == 0 and result.stats["steps"] == np.ceil(count), "an order needs equal steps"
        errors.append([np.abs(result.final.q - true.q).max(), np.abs(result.final.v - true.v).max()])
    assert np.min(errors) > 3e-11, "rounding and the reference would show"
    return -np.diff(np.log(errors), axis=0) / np.diff(np.log(counts))[:, None]


@pytest.mark.parametrize("stages, counts", [(3, (60, 80, 120)), (5, (20, 24, 28))])
def test_radau(swing, stages, counts):
    # With fixed steps rtol only says where Newton stops: at 1e-14, far below the errors.
    found = orders(swing, lambda h: mbd.Radau(stages, step=h), counts, rtol=1e-12)
    # Asked in the issue. Orders in velocities are those of positions: the stabilised form has no order reduction there.
    assert np.abs(found - (2 * stages - 1)).max() < 0.3, found


@pytest.mark.parametrize("index, rho_inf", [(2, 0.8), (3, 0.8), (2, 0.0)])
def test_generalized_alpha(swing, index, rho_inf):
    # The last step is half as long as the others: the algorithmic acceleration has to follow it.
    found = orders(swing, lambda h: mbd.GeneralizedAlpha(h, index=index, rho_inf=rho_inf), (200.5, 400.5), rtol=1e-6)
    assert np.abs(found - 2.0).max() < 0.2, found


def test_generalized_alpha_audit(swing):
    scene, _ = swing
    audits = [mbd.simulate(scene, T_END, solver=mbd.GeneralizedAlpha(T_END / n)).audit for n in (200, 400)]
    assert max(audits[1].position_drift, audits[1].velocity_drift) < 1e-12, "projected at each step, to rounding"
    # The trapezoidal rule measures work to second order, as the motion itself is: a quarter, with room for higher terms.
    assert audits[1].energy_error < 0.3 * audits[0].energy_error < 0.3 * 0.02 * audits[0].energy_scale
