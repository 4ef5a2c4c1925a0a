r"""
From the shape function to the swinging pendulum in twenty steps
================================================================

A soft beam, pinned at one end, falls from rest: the flexible pendulum of Escalona, Hussien and Shabana (1998), *Application of the absolute
nodal co-ordinate formulation to multibody system dynamics*, J. Sound Vib. 214, 833-851. Here its equations are derived with SymPy, put into a
hundred lines of NumPy and integrated by hand, and every step is compared with what ``mbd`` computes. Each step asserts what it
claims, and prints one line.

.. code-block:: sh

    python examples/tutorial/twenty_steps.py

Symbols: :math:`x` runs along the undeformed element of length :math:`l`, primes are derivatives by :math:`x`, :math:`r(x)` is the place of the
point :math:`x` in the plane, :math:`e` holds the eight nodal coordinates of an element, and all units are SI.
"""

from functools import cache
from itertools import pairwise

import numpy as np
import scipy.optimize
import sympy as sp

import mbd

LENGTH, GRAVITY = 1.2, 9.81  # the paper's pendulum; it does not print g
SECTION = {"E": 0.7e6, "A": 1.8e-3, "I": 1.215e-8, "rho": 5540.0}
EA, EI, LINE_MASS = SECTION["E"] * SECTION["A"], SECTION["E"] * SECTION["I"], SECTION["rho"] * SECTION["A"]
rng = np.random.default_rng(1998)

# %%
# Kinematics: one element
# -----------------------
#
# **1. Shape functions.** A cubic in :math:`x` has four coefficients. Two positions and two slopes, at :math:`x = 0` and :math:`x = l`,
# determine them; the factors of these four are the shape functions :math:`N_1 \dots N_4` (eq. 1 of the paper).

x, ell = sp.symbols("x l", positive=True)
ends = sp.symbols("r_0 s_0 r_1 s_1")
coefficients = sp.symbols("c:4")
cubic = sum(c * x**k for k, c in enumerate(coefficients))
at_ends = [cubic.subs(x, 0), cubic.diff(x).subs(x, 0), cubic.subs(x, ell), cubic.diff(x).subs(x, ell)]
found = sp.solve([a - b for a, b in zip(at_ends, ends)], coefficients)
N = sp.Matrix([[sp.expand(cubic.subs(found)).coeff(end) for end in ends]])

xi = x / ell
assert N.equals(sp.Matrix([[1 - 3 * xi**2 + 2 * xi**3, ell * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, ell * (xi**3 - xi**2)]]))
print("1. N =", [sp.factor(n) for n in N])

# %%
# **2. Rigid motion is among them.** With :math:`S = (N_1 1, N_2 1, N_3 1, N_4 1)`, where 1 is the unit matrix of the plane, the curve is
# :math:`r = S e`, :math:`e = (r_0, r'_0, r_1, r'_1)`. Put the element anywhere, straight and turned by :math:`\theta`: it must stay a
# straight line of the same length, whatever :math:`\theta`. It does, exactly (eqs 3 and 4). Coordinates that are angles or displacements
# can only promise this for small turns.

S = sp.kronecker_product(N, sp.eye(2))
R1, R2, theta = pose = sp.symbols("R_1 R_2 theta", real=True)
c, s = sp.cos(theta), sp.sin(theta)
rigid = sp.Matrix([R1, R2, c, s, R1 + ell * c, R2 + ell * s, c, s])

assert (S * rigid - sp.Matrix([R1 + x * c, R2 + x * s])).expand() == sp.zeros(2, 1)
print("2. S e of a rigid motion =", list((S * rigid).applyfunc(sp.simplify)))

# %%
# **3. Position and slope.** In numbers: a bent element, the point at 30 % of it, and its slope :math:`r' = S' e`. The slope's length is 1
# plus the stretch; nothing is normalised. In ``mbd`` the same two vectors are the point and the axis of a marker.

one = mbd.Scene(gravity=(0.0, -GRAVITY))
rod = one.add(mbd.AncfCable((0, 0), (LENGTH, 0), n_elements=1, **SECTION, name="rod"))
bent = np.array([0.0, 0.0, 1.0, 0.1, 1.0, 0.5, 0.5, 0.9])
shape, slope = (sp.lambdify((x, ell), matrix, "numpy") for matrix in (S, S.diff(x)))

marker = rod.at(0.3)
point, tangent = shape(0.3 * LENGTH, LENGTH) @ bent, slope(0.3 * LENGTH, LENGTH) @ bent
np.testing.assert_allclose(point, marker.point.value(bent), rtol=1e-14)
np.testing.assert_allclose(tangent, marker.axes[0].value(bent), rtol=1e-14)
print(f"3. the bent element at 30 %: r = {point.round(4)}, |r'| = {np.linalg.norm(tangent):.4f}")

# %%
# Inertia and weight
# ------------------
#
# **4. The mass matrix.** The kinetic energy is :math:`\frac{1}{2} \int \rho A\, \dot r \cdot \dot r\, dx = \frac{1}{2} \dot e^T M \dot e`
# with :math:`M = \int \rho A\, S^T S\, dx` (eq. 8). No coordinate is in it: :math:`M` is constant, so no centrifugal or Coriolis terms will
# appear.

m, g = sp.symbols("m g", positive=True)
M = (m / ell * S.T * S).applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, ell)))

printed = m / 420 * sp.Matrix([[156, 22 * ell, 54, -13 * ell], [22 * ell, 4 * ell**2, 13 * ell, -3 * ell**2],
                               [54, 13 * ell, 156, -22 * ell], [-13 * ell, -3 * ell**2, -22 * ell, 4 * ell**2]])  # fmt: skip
assert M.equals(sp.kronecker_product(printed, sp.eye(2)))
print("4. M, without the unit matrices of the plane, is m/420 times", (M[::2, ::2] * 420 / m).tolist())

# %%
# **5. The library's mass matrix.** ``mbd.equations`` writes the equations of a small scene with SymPy, and ``scene.build()`` is the system
# of arrays that the solvers see. All three mass matrices agree.

written = mbd.equations(one)
system = one.build()


def in_numbers(matrix, length):
    """For an element of this length of the pendulum."""
    return np.array(matrix.subs({m: LINE_MASS * length, ell: length, g: GRAVITY}), dtype=float)


mass = in_numbers(M, LENGTH)
np.testing.assert_allclose(np.array(written.M.xreplace(written.values), dtype=float), mass, rtol=1e-13)
np.testing.assert_allclose(system.mass(np.eye(8)), mass, rtol=1e-13)
print(f"5. the same from mbd.equations and from the arrays; total mass {mass[::4, ::4].sum():.4f} kg")

# %%
# **6. It is the mass matrix of a rigid rod, too.** Rigid velocities are :math:`\dot e = B(\theta)\, (\dot R_1, \dot R_2, \dot\theta)`. Then
# :math:`B^T M B` is what any textbook gives for a rod about its end, moment of inertia :math:`m l^2 / 3` (eqs 9 to 11).

B = rigid.jacobian(pose)
reduced = (B.T * M * B).applyfunc(sp.simplify)
assert reduced.equals(m * sp.Matrix([[1, 0, -ell * s / 2], [0, 1, ell * c / 2], [-ell * s / 2, ell * c / 2, ell**2 / 3]]))
print("6. B' M B =", reduced.tolist())

# %%
# **7. Weight.** The virtual work of the weight is :math:`\int \rho A\, g \cdot S\, \delta e\, dx`: a constant vector (eq. 27). Its slope
# entries, moments so to speak, are needed: :math:`M^{-1} Q` is free fall of every point without any bending.

weight = (m / ell * S.T * sp.Matrix([0, -g])).applyfunc(lambda f: sp.integrate(sp.expand(f), (x, 0, ell)))
assert weight.equals(-m * g * sp.Matrix([0, sp.Rational(1, 2), 0, ell / 12, 0, sp.Rational(1, 2), 0, -ell / 12]))
assert (M.LUsolve(weight)).applyfunc(sp.simplify) == sp.Matrix([0, -g, 0, 0, 0, -g, 0, 0])
np.testing.assert_allclose(in_numbers(weight, LENGTH)[:, 0], system.weight, atol=1e-12)
print("7. Q =", list(weight), "and M^-1 Q = (0, -g, 0, 0, 0, -g, 0, 0)")

# %%
# Elasticity
# ----------
#
# **8. Strains.** Of a thin beam there are two: the stretch :math:`\varepsilon = |r'| - 1` and the curvature :math:`\kappa = (r'_1 r''_2 -
# r'_2 r''_1) / |r'|^2`, the turn of the tangent per undeformed length. Both are nothing for rigid motions. (The paper measures them from
# the element's chord; on short elements that is nearly the same, ``elasticity="local_frame"``.)

a1, a2, b1, b2 = z = sp.symbols("r'_1 r'_2 r''_1 r''_2", real=True)
strains = sp.Matrix([sp.sqrt(a1**2 + a2**2) - 1, (a1 * b2 - a2 * b1) / (a1**2 + a2**2)])

derivatives = sp.Matrix.vstack(S.diff(x), S.diff(x, 2))  # (r', r'') = P e
turned = dict(zip(z, (derivatives * rigid).applyfunc(sp.simplify)))
assert strains.subs(turned).applyfunc(sp.simplify) == sp.zeros(2, 1)
r = sp.Symbol("R", positive=True)
on_circle = dict(zip(z, [sp.cos(x / r), sp.sin(x / r), -sp.sin(x / r) / r, sp.cos(x / r) / r]))
assert strains.subs(on_circle).applyfunc(sp.simplify) == sp.Matrix([0, 1 / r])
print("8. stretch and curvature: 0, 0 for a rigid motion; 0, 1/R on a circle of radius R")

# %%
# **9. Energy.** :math:`U = \frac{1}{2} \int EA\, \varepsilon^2 + EI\, \kappa^2\, dx`. The roots and quotients have no integral in closed
# form, so Gauss's quadrature takes it; seven points are ``mbd``'s default. ``P`` holds :math:`S'` and :math:`S''` at these points, and
# arrays have the elements for their first axis, so that one call serves a mesh.

density = (EA * strains[0] ** 2 + EI * strains[1] ** 2) / 2
density_at = sp.lambdify([z], density, "numpy", cse=True)


derivatives_at = sp.lambdify((x, ell), derivatives, "numpy")


@cache
def quadrature(length, points=7):
    """P [points, 4, 8] and weights [points] on an element."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return np.array([derivatives_at(0.5 * (node + 1.0) * length, length) for node in nodes]), 0.5 * length * weights


def energy(e, length):
    """Of elements with nodal coordinates e [n, 8]."""
    P, weights = quadrature(length)
    return float(np.sum(weights * density_at(np.einsum("gzk,nk->zng", P, e))))


assert np.isclose(energy(bent[None], LENGTH), system.elastic(bent), rtol=1e-13)
print(f"9. energy of the bent element: {energy(bent[None], LENGTH):.6f} J, as mbd's")

# %%
# **10. Force.** :math:`Q_e = \partial U / \partial e`, by the chain rule: SymPy differentiates the density by the four numbers :math:`z =
# (r', r'')`, and ``P`` transposed takes the result to :math:`e`. Rigid motions cost no energy, so the force on a free element has no
# resultant and no moment.

pull_at = sp.lambdify([z], [density.diff(w) for w in z], "numpy", cse=True)


def force(e, length):
    """dU/de [n, 8]."""
    P, weights = quadrature(length)
    return np.einsum("g,zng,gzk->nk", weights, pull_at(np.einsum("gzk,nk->zng", P, e)), P)


pull = force(bent[None], LENGTH)[0]
system_pull = -system.force(bent, np.zeros(8), system.inputs(0.0)) + system.weight
np.testing.assert_allclose(pull, system_pull, rtol=1e-11)
r_and_slopes, pulls = bent.reshape(4, 2), pull.reshape(4, 2)
moment = np.sum(r_and_slopes[:, 0] * pulls[:, 1] - r_and_slopes[:, 1] * pulls[:, 0])
assert np.abs(pulls[0] + pulls[2]).max() < 1e-11 * np.abs(pull).max() and abs(moment) < 1e-11 * np.abs(pull).max()
print(f"10. force: largest entry {np.abs(pull).max():.1f}, resultant {np.abs(pulls[0] + pulls[2]).max():.0e} N, moment {abs(moment):.0e} N m")

# %%
# **11. Tangent.** An implicit method needs :math:`K = \partial^2 U / \partial e^2`. Derivatives are never taken on trust: central
# differences of the force, whose error falls with the square of the increment, agree. At rest :math:`K` has three zero eigenvalues, the
# three rigid motions.

curve_at = sp.lambdify([z], [[density.diff(v, w) for w in z] for v in z], "numpy", cse=True)


def tangent_matrix(e, length):
    """d2U/de2 [n, 8, 8]."""
    P, weights = quadrature(length)
    return np.einsum("g,gyj,yzng,gzk->njk", weights, P, curve_at(np.einsum("gzk,nk->zng", P, e)), P)


def differences(e, length, by):
    """The tangent by central differences."""
    ahead, behind = (force(e + sign * by * np.eye(8), length) for sign in (1.0, -1.0))
    return (ahead - behind) / (2.0 * by)


exact = tangent_matrix(bent[None], LENGTH)[0]
errors = [np.abs(differences(bent, LENGTH, by) - exact).max() / np.abs(exact).max() for by in (1e-3, 5e-4)]
at_rest = np.linalg.eigvalsh(tangent_matrix(system.q0[None], LENGTH)[0])
assert errors[1] < 1e-4 and 3.8 < errors[0] / errors[1] < 4.2
assert np.abs(at_rest[:3]).max() < 1e-11 * at_rest[-1] < at_rest[3]
print(f"11. tangent: differences are off by {errors[0]:.1e} and, with half the increment, {errors[1]:.1e}; 3 zero eigenvalues at rest")

# %%
# **12. The equations of one element:** :math:`M \ddot e = Q - \partial U / \partial e`. They are ``mbd``'s at a random state, in numbers
# and as the expressions of ``mbd.equations``; and the derivations behind these check themselves against the kernels.

state = system.q0 + 0.2 * rng.standard_normal(8)
right_side = in_numbers(weight, LENGTH)[:, 0] - force(state[None], LENGTH)[0]
as_written = sp.lambdify([written.q], written.f.xreplace(written.values), "numpy", cse=True)(state)[:, 0]
np.testing.assert_allclose(as_written, right_side, rtol=1e-9, atol=1e-9)
np.testing.assert_allclose(system.force(state, np.zeros(8), system.inputs(0.0)), right_side, rtol=1e-9, atol=1e-9)
apart = written.check()
assert apart < 1e-12
print(f"12. right side at a random state: as mbd's; mbd.equations against the arrays: {apart:.0e}")

# %%
# The beam and its pin
# --------------------
#
# **13. Several elements.** Neighbours share a node: its position and its slope. So coordinate :math:`4k + i` of the beam is number
# :math:`i` of the element :math:`k`, everything is added up where it belongs, and the beam is smooth (:math:`C^1`) without any equation.


class Beam:
    """A straight mesh along the x axis: ``q`` [4 (n + 1)] are position and slope of each node."""

    def __init__(self, n):
        self.n, self.length = n, LENGTH / n
        self.places = 4 * np.arange(n)[:, None] + np.arange(8)
        self.mass = self.matrix(in_numbers(M, self.length))
        self.weight = self.vector(in_numbers(weight, self.length)[:, 0])
        self.start = np.stack([[k * self.length, 0.0, 1.0, 0.0] for k in range(n + 1)]).ravel()

    def vector(self, parts):
        """[4 (n + 1)] from [n, 8], or one [8] for all."""
        total = np.zeros(4 * self.n + 4)
        np.add.at(total, self.places, np.broadcast_to(parts, (self.n, 8)))
        return total

    def matrix(self, parts):
        """[4 (n + 1), 4 (n + 1)] from [n, 8, 8], or one [8, 8] for all."""
        total = np.zeros((4 * self.n + 4, 4 * self.n + 4))
        np.add.at(total, (self.places[:, :, None], self.places[:, None, :]), np.broadcast_to(parts, (self.n, 8, 8)))
        return total

    def force(self, q):
        return self.weight - self.vector(force(q[self.places], self.length))

    def stiffness(self, q):
        return self.matrix(tangent_matrix(q[self.places], self.length))


def pendulum(n):
    """The same beam in mbd, pinned."""
    scene = mbd.Scene(gravity=(0.0, -GRAVITY))
    rod = scene.add(mbd.AncfCable((0, 0), (LENGTH, 0), n_elements=n, **SECTION, name="rod"))
    return scene, rod, scene.add(mbd.Pin(rod.start, scene.ground.at(0, 0), name="pivot"))


beam = Beam(6)
scene, rod, pivot = pendulum(6)
system = scene.build()
state = beam.start + 0.05 * rng.standard_normal(beam.start.size)
np.testing.assert_allclose(system.mass(np.eye(28)), beam.mass, atol=1e-14)
np.testing.assert_allclose(system.force(state, np.zeros(28), system.inputs(0.0)), beam.force(state), rtol=1e-9, atol=1e-7)
print(f"13. six elements: {beam.start.size} coordinates, mass {beam.mass[::4, ::4].sum():.4f} kg, forces as mbd's")

# %%
# **14. The pin is an equation,** :math:`g(q) = r_0 = 0`, and what it does to the beam is a force :math:`-G^T \lambda` with :math:`G =
# \partial g / \partial q`. The Lagrange multiplier :math:`\lambda` is minus the force of the pin on the beam. Beside the equations of
# motion stands :math:`\ddot g = G \ddot q = 0`: one linear system gives accelerations and multipliers,
#
# .. math:: \begin{pmatrix} M & G^T \\ G & 0 \end{pmatrix} \begin{pmatrix} \ddot q \\ \lambda \end{pmatrix} = \begin{pmatrix} f \\ 0 \end{pmatrix}
#
# A rigid rod let go horizontally rests on its pin with a quarter of its weight, and its free end falls with :math:`\frac{3}{2} g`. The beam
# does neither: at the first instant nothing is bent yet, so nothing but the pin's neighbourhood knows of the pin, and the finer the mesh
# the less it carries.

G = np.eye(2, beam.start.size)


def kkt(matrix, gradient):
    return np.block([[matrix, gradient.T], [gradient, np.zeros((len(gradient), len(gradient)))]])


def solved(beam, q):
    both = np.linalg.solve(kkt(beam.mass, G), np.concatenate((beam.force(q), np.zeros(2))))
    return both[: q.size], both[q.size :]


acceleration, multiplier = solved(beam, beam.start)
short = mbd.simulate(scene, 1e-3)
np.testing.assert_allclose(-multiplier, short.reaction(pivot)[0, :2], atol=1e-9)
np.testing.assert_allclose(acceleration[-4:-2], short.acceleration(rod.end)[0], atol=1e-9)
total = LINE_MASS * LENGTH * GRAVITY
print(f"14. at the start the pin carries {-multiplier[1] / total:.3f} of the weight; the end falls with {-acceleration[-3]:.2f} m/s^2")

# %%
# Differential-algebraic equations
# --------------------------------
#
# **15. Index 3.** :math:`\dot q = v,\; M \dot v = f - G^T \lambda,\; 0 = g(q)` has no derivative of :math:`\lambda` and no place to solve
# for it. Differentiating :math:`g` once gives :math:`G v = 0`, twice the system above, which determines :math:`\lambda`; a third time would
# give :math:`\dot\lambda`: index 3. Integrating the twice differentiated system is easy, and forgets :math:`g` itself: only :math:`\ddot g
# = 0` is asked for, and errors of :math:`g` grow. The pin above is linear and would hide it, so here is a point of 1 kg on a circle,
# :math:`g = (q \cdot q - 1)/2`, by the classical Runge-Kutta method.

down = np.array([0.0, -GRAVITY])


def index_one(y):
    q, v = y[:2], y[2:]
    right = np.concatenate((down, [-(v @ v)]))  # d2g/dt2 = q . a + v . v
    return np.concatenate((v, np.linalg.solve(kkt(np.eye(2), q[None]), right)[:2]))


def runge_kutta(y, h, steps):
    gaps = []
    for _ in range(steps):
        k1 = index_one(y)
        k2 = index_one(y + 0.5 * h * k1)
        k3 = index_one(y + 0.5 * h * k2)
        y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + index_one(y + h * k3))
        gaps.append(abs(y[:2] @ y[:2] - 1.0) / 2.0)
    return np.array(gaps)


gaps = runge_kutta(np.array([1.0, 0.0, 0.0, 0.0]), 0.02, 2500)
assert gaps[:500].max() > 1e-5 and gaps[-500:].max() > 5.0 * gaps[:500].max()
print(f"15. the differentiated equations leave the circle by {gaps[:500].max():.1e} m within 10 s, by {gaps[-500:].max():.1e} m within 50 s")

# %%
# **16. Index reduction that forgets nothing.** Gear, Leimkuhler and Gupta (1985) keep :math:`g = 0` *and* :math:`G v = 0`, and make room
# for the second one by a second multiplier: :math:`M \dot q = M v + G^T \mu`. In the exact solution :math:`\mu = 0`; in a discrete one it
# is what keeps the point on the circle. Below the midpoint rule with both; ``mbd`` does the same inside its Radau methods.


def stabilised(q, v, h):
    """One step: q, v and both multipliers, times the step, from six equations."""

    def residual(unknown):
        p, w, (pull, shift) = unknown[:2], unknown[2:4], unknown[4:]
        return np.concatenate((
            p - q - 0.5 * h * (v + w) - p * shift,
            w - v - h * down + 0.5 * (q + p) * pull,
            [0.5 * (p @ p - 1.0), p @ w],
        ))  # fmt: skip

    found = scipy.optimize.root(residual, np.concatenate((q + h * v, v, np.zeros(2))), tol=1e-13)
    return found.x[:2], found.x[2:4], found.x[5]


def swing(h, t_end=0.5):
    q, v, worst, shifts = np.array([1.0, 0.0]), np.zeros(2), 0.0, []
    for _ in range(round(t_end / h)):
        q, v, shift = stabilised(q, v, h)
        worst = max(worst, abs(q @ q - 1.0), abs(q @ v))
        shifts.append(abs(shift))
    return q, worst, max(shifts)


ball = mbd.Scene(gravity=(0.0, -GRAVITY))
bob = ball.add(mbd.Particle(1.0, (1.0, 0.0)))
ball.add(mbd.Distance(bob.at(), ball.ground.at(0, 0)))
there = mbd.simulate(ball, 0.5, rtol=1e-11)
(coarse, gap, shift), (fine, _, smaller) = swing(0.02), swing(0.01)
errors = [np.linalg.norm(q - there.position(bob.at())[-1]) for q in (coarse, fine)]
assert gap < 1e-11 and smaller < 0.3 * shift and 3.5 < errors[0] / errors[1] < 4.5
assert there.audit.position_drift < 1e-12 and there.audit.velocity_drift < 1e-12
print(f"16. stabilised: joint and its velocity within {gap:.0e}, h mu at most {shift:.0e}, errors {errors[0]:.1e} and {errors[1]:.1e}; mbd's gap"
      f" {there.audit.position_drift:.0e}")  # fmt: skip

# %%
# The pendulum
# ------------
#
# **17. An integrator of one's own.** The implicit midpoint rule for the beam: forces at the middle of the step, the pin at its end. Of a
# linear constraint :math:`g = 0` at both ends implies :math:`G (v_0 + v_1) = 0`, so :math:`\mu = 0` and it can be left out. Newton's method
# solves for the step's change of position and the multiplier with the tangent of step 11. Explicit methods would have to follow the fastest
# wave through the shortest element; this one may take the steps that the motion asks for.


def midpoint(beam, h, steps):
    """q [steps + 1, n] and multipliers [steps, 2]."""
    q, v, multiplier = beam.start, np.zeros_like(beam.start), np.zeros(2)
    path, multipliers = [q], []
    for _ in range(steps):
        change = h * v
        for _ in range(20):
            middle = q + 0.5 * change
            balance = beam.mass @ (2.0 / h * (change / h - v)) - beam.force(middle) + G.T @ multiplier
            matrix = kkt(2.0 / h**2 * beam.mass + 0.5 * beam.stiffness(middle), G)
            correction = np.linalg.solve(matrix, -np.concatenate((balance, G @ (q + change))))
            change, multiplier = change + correction[: q.size], multiplier + correction[q.size :]
            if np.abs(correction[: q.size]).max() < 1e-12:
                break
        else:
            raise RuntimeError("Newton's method did not converge: shorten the step")
        q, v = q + change, 2.0 / h * change - v
        path.append(q)
        multipliers.append(multiplier)
    return np.array(path), np.array(multipliers)


T_END = 0.2
runs = {h: midpoint(beam, h, round(T_END / h)) for h in (2e-3, 1e-3, 5e-4)}
path, multipliers = runs[5e-4]
assert np.abs(path[:, :2]).max() < 1e-14
print(f"17. {len(path) - 1} steps of 0.5 ms: the end is at {path[-1, -4:-2].round(5)} m, the pin within {np.abs(path[:, :2]).max():.0e} m")

# %%
# **18. The error against the step.** The same six elements in ``mbd``, far more accurate than needed, are the reference; halving the step
# divides the error by four. So both programs integrate the same equations, and the midpoint rule is of order 2. The multipliers are the
# pin's force, too.

reference = mbd.simulate(scene, T_END, rtol=1e-11)
errors = [np.linalg.norm(q[-1, -4:-2] - reference.position(rod.end)[-1]) for q, _ in runs.values()]
middles = 5e-4 * (np.arange(len(multipliers)) + 0.5)
force_error = np.abs(-multipliers - reference.reaction(pivot, t=middles)[:, :2]).max()
orders = [np.log2(before / after) for before, after in pairwise(errors)]
assert all(1.8 < order < 2.2 for order in orders)
assert force_error < 0.02 * np.abs(multipliers).max()
print(f"18. errors {', '.join(f'{error:.1e}' for error in errors)} m: orders {', '.join(f'{order:.2f}' for order in orders)};"
      f" force of the pin within {force_error:.2g} N of {np.abs(multipliers).max():.0f} N")  # fmt: skip

# %%
# **19. The paper's pendulum:** thirty elements, 1.2 s, by ``mbd``. Radau's method chooses its steps, holds the pin in positions and
# velocities, and the audit at the end tells how well the energy balances. Tip positions of this very mesh, computed apart from this library
# by two other integrators to 8 decimals, are the reference (``tests/data/pendulum.json``, "continuum"; the paper itself prints curves
# only).

TIMES = [0.2, 0.4, 0.6, 0.8, 1.0, 1.2]
TIPS = [(1.17992839, -0.19621662), (0.85285585, -0.78419529), (-0.33493262, -1.25138686),
        (-0.88960175, -0.81849131), (-1.16551568, -0.30930553), (-0.87679008, 0.1478276)]  # fmt: skip

scene, rod, pivot = pendulum(30)
result = mbd.simulate(scene, t_end=1.2, rtol=1e-10)
difference = np.abs(result.position(rod.end, t=TIMES) - TIPS).max()
assert difference < 2e-8
assert result.audit.energy_error < 1e-7 * result.audit.energy_scale and result.audit.position_drift < 1e-13
print(f"19. {result.stats['steps']} steps of {result.stats['solver']}: tip within {difference:.0e} m of the reference, energy within"
      f" {result.audit.energy_error:.0e} J of {result.audit.energy_scale:.0f} J")  # fmt: skip

# %%
# **20. Looking at it.** The beam falls nearly undeformed at first, its end leaves the circle of a rigid pendulum, and at the bottom it is
# stretched by a tenth. Energies tell the same: what gravity gives goes into motion, then into stretching, and back.

energy_of = result.energy
lowest = result.position(rod.end)[:, 1].min()
assert lowest < -1.05 * LENGTH and energy_of.elastic.max() > 0.2 * np.ptp(energy_of.potential)
try:
    import matplotlib.pyplot as plt
except ModuleNotFoundError:
    print(f'20. lowest tip {lowest:.3f} m; the picture needs matplotlib: python -m pip install ".[plot]"')
else:
    from mbd.plot import plot_path

    figure, (shapes, graph) = plt.subplots(1, 2, figsize=(12, 5.2), layout="constrained")
    result.plot(np.linspace(0.0, 1.2, 13), ax=shapes)
    around = np.linspace(-np.pi, 0.0, 181)
    shapes.plot(LENGTH * np.cos(around), LENGTH * np.sin(around), "--", color="gray", label="tip of a rigid pendulum")
    plot_path(result, rod.end, shapes, color="C3", linewidth=1.0, label="path of the tip")
    shapes.set_title("shapes every 0.1 s")
    shapes.legend(loc="upper center")
    for name in ("kinetic", "elastic", "potential", "total"):
        graph.plot(result.t, getattr(energy_of, name), label=name, color="k" if name == "total" else None)
    graph.set(xlabel="t [s]", ylabel="energy [J]", title="what becomes of the energy")
    graph.grid(alpha=0.3)
    graph.legend()
    figure.savefig("twenty_steps.png", dpi=120)
    print(f"20. lowest tip {lowest:.3f} m, {-lowest / LENGTH - 1:.0%} below the circle; picture in twenty_steps.png")
