"""Inertia of lumped masses (chapter "Mass")."""

from __future__ import annotations

import numpy as np

from .._core import ffi, lib
from ..bridge import Floats, doubles
from ..mesh import KINDS, Mesh

# Largest number of elements for which it is computed; finer bodies have the inertia of the continuum.
MOST = 20_000


def inertia_ratios(mesh: Mesh, mass: Floats) -> list[float] | None:
    """
    Moments of inertia of lumped masses (n,) over those of the body with uniform density, about the principal
    axes of the body, ascending; None for large meshes.
    """
    if len(mesh.elements) > MOST:
        return None
    x, dV = _points(mesh)
    middle = dV @ x / dV.sum()
    _, axes = np.linalg.eigh(-_second(x - middle, dV))
    lumped, exact = (
        [_about(_second(r - middle, m / m.sum()), axis) for axis in axes.T]
        for r, m in ((mesh.nodes, mass), (x, dV))
    )
    return [float(a / b) for a, b in zip(lumped, exact)]


def _second(r: Floats, m: Floats) -> Floats:
    """Σ m r rᵀ."""
    out: Floats = np.einsum("n,ni,nj->ij", m, r, r)
    return out


def _about(second: Floats, axis: Floats) -> float:
    """The moment of inertia about an axis."""
    return float(np.trace(second) - axis @ second @ axis)


def _points(mesh: Mesh) -> tuple[Floats, Floats]:
    """Positions and volumes of 3³ Gauss points in each element."""
    xi, w = np.polynomial.legendre.leggauss(3)
    corners, places, volumes = mesh.nodes[mesh.elements], [], []
    width = corners.shape[1]
    for k in np.ndindex(3, 3, 3):
        at, N, dN = np.ascontiguousarray(xi[list(k)]), np.zeros(20), np.zeros((20, 3))
        lib.ct_brick_shape(KINDS[mesh.element], doubles(at), doubles(N))
        slopes = ffi.from_buffer("double[][3]", dN)
        lib.ct_brick_gradient(KINDS[mesh.element], doubles(at), slopes)
        places.append(np.einsum("a,eai->ei", N[:width], corners))
        J = np.einsum("aj,eai->eij", dN[:width], corners)
        volumes.append(w[list(k)].prod() * np.linalg.det(J))
    return np.concatenate(places), np.concatenate(volumes)
