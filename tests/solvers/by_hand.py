"""A pendulum written by hand against the ``System`` protocol of the solvers, without the library's elements, joints or assembly."""

from types import SimpleNamespace

import numpy as np
from scipy.special import ellipj, ellipk

from mbd.solvers.linear import Linear
from mbd.solvers.march import Record, march
from mbd.solvers.pace import Pace, Rhythm
from mbd.solvers.protocol import State
from mbd.solvers.start import accelerations, mass_factor

MASS, LENGTH, GRAVITY = 0.3, 1.7, 9.81


class Rod:
    """g = (r . r - L^2) / 2 at positions r [..., 2]."""

    m, linear, slips = 1, False, np.zeros(0, dtype=np.intp)
    rows, cols = np.array([0, 0]), np.array([0, 1])

    def at(self, r):
        return SimpleNamespace(
            gradient=r,
            value=0.5 * (np.sum(r * r, axis=-1, keepdims=True) - LENGTH**2),
            pull=lambda multipliers: r * multipliers,
            push=lambda v: np.sum(r * v, axis=-1, keepdims=True),
            swirl=lambda v: v,
            bias=lambda v: np.sum(v * v, axis=-1, keepdims=True),
        )

    def to_rows(self, entries):
        return np.sum(entries, axis=-1, keepdims=True)


class Pendulum:
    """M = m I, load = weight, K = d(G' lambda)/dq = lambda I; no stresses, no damping."""

    n, m, n_stresses = 2, 1, 0
    length, levers, lengths, arm, vectors = LENGTH, np.ones(2), np.zeros(2, dtype=bool), np.inf, np.zeros(2, dtype=np.intp)
    modulus, viscosity, damped, onsets, joints = np.zeros(0), None, False, False, Rod()
    mass_rows = mass_cols = stiffness_rows = stiffness_cols = np.arange(2)
    damping_rows = damping_cols = np.zeros(0, dtype=np.intp)
    mass_values = np.full(2, MASS)

    def mass(self, x):
        return MASS * x

    def inputs(self, t):
        return None

    def strains(self, q):
        return None

    def load(self, q, v, inputs):
        return np.broadcast_to([0.0, -MASS * GRAVITY], q.shape)

    def stiffness(self, q, v, inputs, stress, multipliers, *, strains=None, joints=None):
        return np.full(2, multipliers[0])

    def label(self, row):
        return "rod"


def exact(t):
    """r, v [k, 2] at times t [k] after release from the horizontal, by Jacobi's elliptic functions (Whittaker 1937, section 44)."""
    omega, m = np.sqrt(GRAVITY / LENGTH), 0.5
    sn, cn, *_ = ellipj(ellipk(m) - omega * np.asarray(t, dtype=float), m)
    angle, rate = 2.0 * np.arcsin(np.sqrt(m) * sn), -2.0 * np.sqrt(m) * omega * cn
    r = LENGTH * np.stack((np.sin(angle), -np.cos(angle)), axis=-1)
    return r, rate[..., None] * np.stack((-r[..., 1], r[..., 0]), axis=-1)


def begin(system=None):
    """The linear algebra and the record of a run that starts at rest and horizontal."""
    system = system or Pendulum()
    q, v = np.array([LENGTH, 0.0]), np.zeros(2)
    linear = Linear(system, q)
    a, multipliers = accelerations(system, mass_factor(system, linear, q), q, v, None)
    return system, linear, Record([State(0.0, q, v, multipliers, np.zeros(0))]), a


def marched(system, linear, method, record, t_end, tolerance, first_step):
    """From the record's last state to t_end."""
    state = record.states[-1]
    pace = Pace(Rhythm(state.t, method.fixed or first_step), [t_end], method.fixed)
    for _ in march(system, linear, method, record, state, pace, tolerance):
        pass


def run(method, t_end, tolerance=1e-9 * LENGTH):
    system, linear, record, a = begin()
    first_step = method.first_step(system, record.states[0], a, t_end, tolerance)
    marched(system, linear, method, record, t_end, tolerance, first_step)
    return system, linear, record


def motion(record):
    return tuple(np.array([getattr(state, name) for state in record.states]) for name in "tqv")
