"""
Ten minutes with mbd
====================

From an empty scene to a machine with a bending rod, a motor and an event, and to numbers that can be trusted.

.. code-block:: sh

    python -m pip install ".[plot]"
    python examples/tutorial/ten_minutes.py
"""

import matplotlib.pyplot as plt
import numpy as np

import mbd

# %%
# A scene
# -------
#
# A scene has a gravity, whose two components say that it is planar. ``add`` takes a description and returns the item, with the markers at
# which joints, springs and loads attach. A rod, uniform and slender, hangs on a pin and starts horizontally, at rest.

scene = mbd.Scene(gravity=(0.0, -9.81))
rod = scene.add(mbd.RigidBody.rod((0, 0), (1, 0), mass=2.0, name="rod"))
pivot = scene.add(mbd.Pin(rod.at(-0.5, 0), scene.ground.at(0, 0), name="pivot"))

# %%
# ``rod.at(x, y)`` is a point in metres in the axes of the body, from its mass centre. What can this scene do? ``check`` says it in words.

print(mbd.check(scene))

# %%
# A run
# -----
#
# ``simulate`` takes the time of the end. The solver is chosen by what is in the scene, steps by the tolerance.

result = mbd.simulate(scene, t_end=2.0, rtol=1e-8)
print(result)
print(result.audit)

# %%
# The audit says how well the joints closed and the energy adds up, in each run, without being asked. Values are arrays over ``result.t``,
# or at times of one's own. At the lowest point the rod's speed follows from energy, :math:`\omega^2 = 3 g / L`, and the pin carries 5/2 of
# the weight.

lowest = mbd.simulate(scene, 2.0, rtol=1e-8, events=[mbd.Event(lambda state: state.position(rod.at(0, 0))[0], terminal=True, name="lowest")])
omega, force = lowest.angular_velocity(rod)[-1], lowest.reaction(pivot)[-1, 1]
print(f"after {lowest.t[-1]:.6f} s: {omega:.6f} rad/s, {force / (2.0 * 9.81):.6f} of the weight")
assert np.isclose(omega**2, 3.0 * 9.81, rtol=1e-6) and np.isclose(force, 2.5 * 2.0 * 9.81, rtol=1e-6)

# %%
# A beam that bends
# -----------------
#
# An ``AncfCable`` is a thin elastic beam that may turn and bend as far as it likes: absolute positions and slopes at its nodes. The joint
# is the same.

soft = mbd.Scene(gravity=(0.0, -9.81))
beam = soft.add(mbd.AncfCable((0, 0), (1.2, 0), n_elements=20, E=0.7e6, A=1.8e-3, I=1.215e-8, rho=5540, name="beam"))
soft.add(mbd.Pin(beam.start, soft.ground.at(0, 0), name="pivot"))
fall = mbd.simulate(soft, t_end=0.9, rtol=1e-6)
print(fall.stats["solver"], fall.stats["steps"], "steps")
print(fall.audit)

ax = fall.plot(np.linspace(0.0, 0.9, 10))
ax.set_title("a soft beam falls")

# %%
# A machine
# ---------
#
# Now a slider-crank: a motor turns the crank, the connecting rod bends, a block slides. ``Motor`` drives an angle, a speed or a torque;
# here the speed rises smoothly, since a start with a jerk would strike the elastic rod.

machine = mbd.Scene(gravity=(0.0, 0.0))
crank = machine.add(mbd.RigidBody.rod((0, 0), (0.15, 0), mass=0.4, name="crank"))
bending = mbd.AncfCable((0.15, 0), (0.6, 0), n_elements=6, E=3e9, A=2e-4, I=6.7e-9, rho=1200, damping=1e-4, name="connecting rod")
link = machine.add(bending)
block = machine.add(mbd.Particle(0.2, (0.6, 0), name="block"))
machine.add(mbd.Pin(crank.at(-0.075, 0), machine.ground.at(0, 0), name="bearing"))
machine.add(mbd.Pin(link.start, crank.at(0.075, 0), name="crank pin"))
machine.add(mbd.Pin(link.end, block.at(), name="piston pin"))
machine.add(mbd.PointOnLine(block.at(), machine.ground.at(0, 0), axis=(1, 0), name="guide"))
speed = mbd.piecewise(lambda t: 60.0 * np.sin(0.5 * np.pi * min(t / 0.1, 1.0)) ** 2, at=[0.1])
motor = machine.add(mbd.Motor(crank, machine.ground, speed=speed, name="motor"))
print(mbd.check(machine))

# %%
# A function of time that has a kink declares it (``mbd.piecewise``): steps end there, and it costs no accuracy. The motor's torque is its
# reaction.

run = mbd.simulate(machine, t_end=0.4, rtol=1e-5, t_eval=np.linspace(0.0, 0.4, 401))
a, b, middle = (run.position(marker) for marker in (link.start, link.end, link.at(0.5)))
along = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
offset = (middle - 0.5 * (a + b)) @ np.array([[0.0, 1.0], [-1.0, 0.0]])
deflection = np.sum(offset * along, axis=1)
torque = run.reaction(motor)[:, 2]
print(f"the rod bends by up to {1e3 * np.abs(deflection).max():.2f} mm; the motor gives up to {np.abs(torque).max():.1f} N m")
print(run.audit)

figure, (shapes, graph) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
run.plot(np.linspace(0.3, 0.4, 6), ax=shapes)
shapes.set_title("six instants of a turn")
graph.plot(run.t, 1e3 * deflection)
graph.set(xlabel="t [s]", ylabel="deflection of the middle [mm]", title="the rod bends")
graph.grid(alpha=0.3)

# %%
# When something is wrong
# -----------------------
#
# A scene with mistakes is refused before anything runs, with all complaints at once: which item, what was expected, what was found, how to
# mend it.

broken = mbd.Scene(gravity=(0.0, -9.81))
bad = broken.add(mbd.RigidBody(mass=-1.0, inertia=0.1, position=(0, 0), name="wheel"))
broken.add(mbd.AncfCable((0, 0), (0, 0), n_elements=0, E=1e9, A=1e-4, I=1e-9, rho=7800, name="wire"))
try:
    mbd.simulate(broken, 1.0)
except mbd.SceneError as error:
    print(error)
    assert len(error.complaints) == 2

# %%
# From here: the modelling guide, how to choose a solver, and the gallery, where each example is a page of code.
