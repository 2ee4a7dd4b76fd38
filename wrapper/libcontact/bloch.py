"""
Waves in a mesh of equal bricks, step by step: their speeds, and the front of a step as their sum.

Lengths are in the unit of ``size``, speeds over c₁, times in that unit over c₁. Theory: the chapter *dispersion* of the
book.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._core import ffi, lib
from .bridge import Floats, call, chosen, doubles, names, positive, real, row
from .errors import ArgumentError
from .mesh import FACTS, KINDS

__all__ = ["Dispersion", "Front", "dispersion", "dispersion_front"]

MASSES = names("ct_mass_form")
SCHEMES = names("ct_scheme")


@dataclass(frozen=True)
class Dispersion:
    """
    The waves of a mesh: 3 branches with hex8 and 12 with hex20, ascending in ``omega_mesh``.

    Attributes
    ----------
    wave : ndarray, shape (..., 3)
        The wave vectors k.
    omega_mesh : ndarray, shape (..., branches)
        Frequencies of the mesh in continuous time.
    omega : ndarray, shape (..., branches)
        Frequencies with the time steps.
    decay : ndarray, shape (..., branches)
        Rate at which the steps damp the waves, as exp(-decay t).
    group : ndarray, shape (..., branches, 3)
        Group velocity, the gradient of ``omega`` by the wave vector; NaN where ``omega_mesh`` is 0.
    shape : ndarray, shape (..., branches, nodes, 3)
        Amplitudes of the displacement of the corner and, with hex20, of the middles of the edges along x, y, z.
    """

    wave: Floats
    omega_mesh: Floats
    omega: Floats
    decay: Floats
    group: Floats
    shape: Floats

    @property
    def phase(self) -> Floats:
        """Phase velocities ω/\\|k\\|, shape (..., branches); NaN where k = 0."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(self.omega / np.linalg.norm(self.wave, axis=-1)[..., None])


@dataclass(frozen=True)
class Front:
    """
    Stress behind a front, from a sum of waves or from a run.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        Ascending places.
    stress : ndarray, shape (n,)
        Stress over the exact one behind the front, -ρ c₁ v₀.
    time : float
        Time of a sum of waves, after whole steps, and with c₁ = 1 the place of the exact front; NaN for a run.
    """

    distance: Floats
    stress: Floats
    time: float = float("nan")

    @property
    def half_height(self) -> float:
        """The outermost place where the stress passes ½, linear between places; NaN if it does nowhere."""
        passed = np.flatnonzero((self.stress[:-1] >= 0.5) & (self.stress[1:] < 0.5))
        if not passed.size:
            return float("nan")
        pair = slice(passed[-1], passed[-1] + 2)
        return float(np.interp(-0.5, -self.stress[pair], self.distance[pair]))

    @property
    def overshoot(self) -> float:
        """By how much the largest stress passes 1."""
        return float(self.stress.max() - 1.0)


def _definition(
    element: str,
    size: Any,
    poisson: float,
    mass: str,
    integrator: str,
    parameter: float | None,
    courant: float,
) -> Any:
    """The mesh and the steps for C, with c₁ = ρ = 1."""
    nu, edges = float(poisson), real("size", size, (3,))
    if not -1.0 < nu < 0.5:
        raise ArgumentError(f"poisson = {nu:g}, must be above -1 and below 0.5")
    if not 0.0 <= float(courant) < float("inf"):
        raise ArgumentError(f"courant = {courant}, must be 0 or a positive number")
    out = ffi.new("ct_dispersion_def *", lib.ct_dispersion_def_default())
    out.kind, out.mass = chosen("element", element, KINDS), chosen("mass", mass, MASSES)
    out.size = [positive("size", edge) for edge in edges.tolist()]
    out.material.young = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)
    out.material.poisson = nu
    out.integrator = lib.ct_integrator_default(chosen("integrator", integrator, SCHEMES))
    if parameter is not None:
        out.integrator.parameter = parameter
    out.step = float(courant) * min(out.size)
    return out


def dispersion(
    wave: Any,
    element: str = "hex8",
    size: Any = (1.0, 1.0, 1.0),
    poisson: float = 0.3,
    mass: str = "lumped",
    integrator: str = "central_difference",
    parameter: float | None = None,
    courant: float = 0.0,
) -> Dispersion:
    """
    Compute the waves of an infinite mesh of equal bricks with edges along x, y, z.

    Parameters
    ----------
    wave : array_like, shape (..., 3)
        Wave vectors k [1 / unit of size].
    element : {"hex8", "hex20"}
        Kind of the bricks.
    size : array_like, shape (3,)
        Their edges; all lengths are in this unit.
    poisson : float
        Poisson's ratio, -1 < ν < ½.
    mass : {"lumped", "consistent"}
        The mass matrix; runs use the lumped one.
    integrator : {"central_difference", "chung_lee", "noh_bathe", "tchamwa_wielgosz"}
        The method of the time steps.
    parameter : float, optional
        Its parameter β, p or ρ∞; by default the usual one.
    courant : float
        c₁ Δt over the shortest edge; 0: time is not discretized.

    Returns
    -------
    Dispersion
        Frequencies, damping, group velocities and shapes, with c₁ = 1.

    Raises
    ------
    ValueError
        A value is impossible.

    Examples
    --------
    P waves of six elements a wave length, along an axis and at 45°, run too slowly by:

    >>> import libcontact as ct, numpy as np
    >>> k = 2 * np.pi / 6
    >>> waves = ct.dispersion([[k, 0, 0], [k / 2**0.5, k / 2**0.5, 0]])
    >>> (1 - waves.phase[:, 2]).round(4).tolist()
    [0.0451, 0.0743]
    """
    vectors = real("wave", wave)
    if vectors.ndim < 1 or vectors.shape[-1] != 3:
        raise ValueError(f"wave must have shape (..., 3), not {vectors.shape}")
    definition = _definition(element, size, poisson, mass, integrator, parameter, courant)
    nodes, before = FACTS[element].cell_nodes, vectors.shape[:-1]
    count = vectors.size // 3
    rows = np.zeros((count, 3 * nodes), row("ct_branch"))
    call(
        lib.ct_dispersion,
        definition,
        count,
        doubles(vectors.reshape(-1)),
        ffi.from_buffer("ct_branch[]", rows),
    )
    rows = rows.reshape(*before, 3 * nodes)
    scalars = {name: rows[name].copy() for name in ("omega_mesh", "omega", "decay", "group")}
    shape = rows["shape"][..., : 3 * nodes].reshape(*rows.shape, nodes, 3)
    return Dispersion(wave=vectors, shape=shape, **scalars)


def dispersion_front(
    time: float,
    normal: Any = (1, 0, 0),
    distance: Any = None,
    element: str = "hex8",
    size: Any = (1.0, 1.0, 1.0),
    poisson: float = 0.3,
    mass: str = "lumped",
    integrator: str = "central_difference",
    parameter: float | None = None,
    courant: float = 0.0,
) -> Front:
    """
    Add up the waves behind the front of a step: a half-space of bricks meets a rigid wall.

    The half-space flies with -v₀ along the normal of the wall and meets it at t = 0. The wall is a second half-space,
    the image of the first point by point, which flies against it.

    Parameters
    ----------
    time : float
        Time [unit of size / c₁]; with time steps the nearest whole number of them is taken.
    normal : sequence of 3 int
        Whole numbers (p, q, r) of the plane of nodes that is the wall, at most 16: (1, 0, 0) along x, (1, 1, 0) at 45°
        for cubes.
    distance : array_like, shape (n,), optional
        Distances of element centres from the wall, ascending; by default all up to 12 planes of nodes beyond the exact
        front.
    element, size, poisson, mass, integrator, parameter, courant
        The mesh and the steps, as for :func:`dispersion`.

    Returns
    -------
    Front
        Stress across the wall over its exact value -ρ c₁ v₀, with half height and overshoot.

    Raises
    ------
    ValueError
        A value is impossible, or the step is above the stability limit.

    Examples
    --------
    The paper's mesh and step at c₁t = 56 elements (Fig. 4): the front is three quarters of an element late, and 26 %
    too high:

    >>> import libcontact as ct
    >>> front = ct.dispersion_front(56.0, courant=0.125)
    >>> round(front.time - front.half_height, 2), round(front.overshoot, 2)
    (0.74, 0.26)
    """
    definition = _definition(element, size, poisson, mass, integrator, parameter, courant)
    index = [int(i) for i in np.asarray(normal).reshape(-1)]
    if len(index) != 3 or not np.array_equal(index, np.asarray(normal).reshape(-1)):
        raise ValueError(f"normal must be three whole numbers, not {normal!r}")
    t, dt = float(time), float(definition.step)
    t = round(t / dt) * dt if dt > 0.0 and abs(t) < float("inf") else t
    divided = np.array(index) / (np.gcd.reduce(index) or 1)
    if distance is None:
        spacing = 1.0 / (np.linalg.norm(divided / list(definition.size)) or 1.0)
        planes = np.arange(max(t, 0.0) / spacing + 12.0 if t < 1e9 else 1.0)
        distance = spacing * (planes + 0.5 * (divided.sum() % 2))
    places = real("distance", distance, ("n",))
    if (np.diff(places) <= 0.0).any():
        raise ValueError("distance must ascend")
    stress = np.empty(len(places))
    call(
        lib.ct_dispersion_front, definition, index, t, len(places), doubles(places), doubles(stress)
    )
    shortest = np.pi * divided / list(definition.size)  # the wave of two planes of nodes
    mesh = (element, size, poisson, mass, integrator, parameter, courant)
    decay = dispersion(np.linspace(0.0, 1.0, 33)[:, None] * shortest, *mesh).decay
    # A second root of a damping integrator may grow beside the wave, so the sum is looked at, too.
    if decay.min() < -1e-6 or not np.abs(stress).max(initial=0.0) < 10.0:
        words = f"is above the stability limit of {integrator}, so short waves grow"
        raise ArgumentError(f"courant = {courant:g} {words}")
    return Front(places, stress, t)
