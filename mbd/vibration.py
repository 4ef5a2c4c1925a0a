"""``modes``: how a scene vibrates about a state of rest, or about a steady rotation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .about import About
from .affine import Array
from .balance import Equilibrium
from .displayed import Displayed
from .errors import SceneError
from .marker import Marker
from .rotating import Rotating
from .scatter import Scatter
from .spin import spin_of
from .state import State
from .system import System

if TYPE_CHECKING:
    from .scene import Scene

GENERAL = 1e3
"""How much more than an energy's rounding counts as zero where |s|^2 comes from a general eigenvalue problem."""


@dataclass(frozen=True, eq=False)
class Modes(Displayed):
    """Modes of vibration, q(t) = q0 + Re(shape exp(s t)), slowest first.

    eigenvalues  [k] s [1/s]; undamped i omega, of an unstable motion its growth. Of a conjugate pair that with positive imaginary part
    shapes       [k, n], with shape^H M shape = 1; complex where something damps or follows
    rigid        how many have frequency zero: they come first, after what is unstable
    unstable     how many grow
    q            [n], the state of rest; about a steady rotation, q and shapes are those seen in the rotating frame, with q at the start
    """

    scene: Scene
    system: System
    q: Array
    eigenvalues: NDArray[np.complex128]
    shapes: NDArray[Any]
    rigid: int
    unstable: int

    def __repr__(self) -> str:
        return f"<{len(self.eigenvalues)} modes, {self.rigid} rigid, {self.unstable} unstable: {self.hertz.round(6).tolist()} Hz>"

    @cached_property
    def frequencies(self) -> Array:
        """[k] [rad/s]: of the (damped) oscillation; zero where a motion is rigid, creeps or grows without oscillating."""
        return np.abs(self.eigenvalues.imag)

    @cached_property
    def hertz(self) -> Array:
        """[k] [Hz]."""
        return self.frequencies / (2.0 * np.pi)

    @cached_property
    def damping_ratios(self) -> Array:
        """[k] -Re s / |s|: share of critical damping; zero of rigid modes, -1 of what grows without oscillating."""
        size = np.abs(self.eigenvalues)
        return -self.eigenvalues.real / np.where(size > 0.0, size, 1.0)

    def displacement(self, marker: Marker) -> NDArray[Any]:
        """[k, d]: how a marker's point moves in each mode."""
        if not isinstance(marker, Marker):
            raise TypeError(f"expected a marker such as rod.end or body.at(x, y), found {marker!r}")
        return self.shapes[:, marker.point.columns()] @ marker.point.matrix().T


def modes(scene: Scene, n: int = 6, about: State | Equilibrium | None = None, *, spin: Any = None) -> Modes:
    """The n slowest modes of a scene, constrained by its joints, about a state of rest or a steady rotation.

    about  ``mbd.equilibrium(scene)``, a state at rest, or None: positions as described. Stresses and forces of joints there are part of
           the stiffness; drives stand still
    spin   [rad/s], a number in the plane, [3] in space: the whole scene turns steadily about the axis through the origin. Positions of
           balance under the centrifugal load are solved for, from those of ``about``; frequencies and shapes are those seen in the
           rotating frame, Coriolis' forces included. Drives run (a hub with ``Motor(speed=spin)``), or the scene turns freely

    Rigid modes are included. Raises SceneError for a state in motion, warns where the state is no equilibrium. Small scenes (up to 600
    coordinates, damped 150) by dense matrices, larger ones by iterations on the sparse inverse, which find the modes nearest to zero; of
    a damped scene they may be fewer than n, where slow motions crowd. With spin, up to 600 coordinates; raises SceneError, by name, for
    joints, loads and drives that do not turn with the scene: gravity across the axis, a support beside it, a motor of another speed.
    """
    if isinstance(n, bool) or not isinstance(n, (int, np.integer)) or n < 1:
        raise SceneError([f"n: expected a whole number of modes from 1, found {n!r}; correct it"])
    if spin is not None and (turning := spin_of(spin, scene.dimension)).any():
        return _rotating(Rotating(scene, about, turning), int(n))
    at = About(scene, about)
    undamped = at.damping is None and at.conservative
    return (_undamped if undamped else _general)(at, int(n))


def _undamped(at: About, n: int) -> Modes:
    from .solvers.eigen import UNDAMPED_DENSE, undamped_dense, undamped_sparse
    from .solvers.minimal import minimal_form

    system = at.system
    if system.n <= max(UNDAMPED_DENSE, 4 * n):
        _, shapes = undamped_dense(minimal_form(system, at.linear, at.q, at.stiffness, None), n)
    else:
        _, shapes = undamped_sparse(system, at.linear, at.tangent, n)
    shapes = shapes / np.sqrt(np.sum(shapes * system.mass(shapes), axis=-1, keepdims=True))
    squares = at.quotients(shapes)
    squares[np.abs(squares) <= at.rounding] = 0.0
    order = np.argsort(squares, kind="stable")
    squares, shapes = squares[order], shapes[order]
    s = np.where(squares < 0.0, np.sqrt(np.abs(squares)), 1j * np.sqrt(np.abs(squares)))
    return Modes(at.scene, system, at.q, s, shapes, int(np.sum(squares == 0.0)), int(np.sum(squares < 0.0)))


def _general(at: About, n: int) -> Modes:
    from .solvers.eigen import GENERAL_DENSE, general_dense, general_sparse
    from .solvers.minimal import minimal_form

    system = at.system
    if system.n <= max(GENERAL_DENSE, 8 * n):
        s, shapes = general_dense(minimal_form(system, at.linear, at.q, at.stiffness, at.damping))
    else:
        s, shapes = general_sparse(system, at.linear, at.tangent, _damping(at), 2 * n + 2)
    return _chosen(at, s, shapes, n)


def _rotating(at: Rotating, n: int) -> Modes:
    from .solvers.eigen import rotating_dense

    return _chosen(at, *rotating_dense(at.minimal(), at.quotients, at.rounding), n)


def _chosen(at: About | Rotating, s: NDArray[np.complex128], shapes: NDArray[Any], n: int) -> Modes:
    """The n slowest of all s, one of each pair, with shapes of unit mass."""
    system = at.system
    zero = np.abs(s) ** 2 <= GENERAL * at.rounding
    s = np.where(zero, 0.0, s)
    rigid = np.flatnonzero(zero)[::2]  # each twice: a position and a velocity
    moving = np.flatnonzero(~zero & (s.imag >= 0.0))
    grows = s[moving].real > 1e-9 * np.abs(s[moving])
    groups = (moving[grows], rigid, moving[~grows])
    chosen = np.concatenate([group[np.argsort(np.abs(s[group]), kind="stable")] for group in groups])[:n]
    s, shapes = s[chosen], shapes[chosen]
    weight = np.sum(shapes.conj() * (system.mass(shapes.real) + 1j * system.mass(shapes.imag)), axis=-1, keepdims=True).real
    count = int(np.sum(s.real > 1e-9 * np.abs(s)))
    return Modes(at.scene, system, at.q, s, shapes / np.sqrt(weight), int(np.sum(s == 0.0)), count)


def _damping(at: About) -> Any:
    """D x."""
    system = at.system
    if at.damping is None:
        return np.zeros_like
    scatter = Scatter(system.damping_rows, system.n)
    return lambda x: scatter(at.damping * x[..., system.damping_cols])
