"""The two bricks: reference nodes, and strains and stiffness from the shape functions of the library."""

import numpy as np
from libcontact._core import ffi, lib

from .drawing import GREY
from .faces import FACES

CORNERS = np.array([[*corner, z] for z in (-1, 1) for corner in FACES["Q4"]])
EDGES = [(i, (i + 1) % 4) for i in range(4)]
EDGES += [(4 + i, 4 + j) for i, j in EDGES] + [(i, 4 + i) for i in range(4)]
BRICKS = {
    "hex8": CORNERS,
    "hex20": np.concatenate([CORNERS, [(CORNERS[i] + CORNERS[j]) / 2 for i, j in EDGES]]),
}
KIND = {"hex8": lib.CT_HEX8, "hex20": lib.CT_HEX20}


def draw_edges(ax, corners, **style):
    """The twelve edges of a brick with these corners."""
    for i, j in EDGES:
        ax.plot(*corners[[i, j]].T, **({"color": GREY, "lw": 1.1} | style))


def shape(kind, xi):
    """Shape functions (nodes,) at a point."""
    N = np.zeros(20)
    lib.ct_brick_shape(
        KIND[kind], ffi.from_buffer("double[]", np.array(xi, float)), ffi.from_buffer("double[]", N)
    )
    return N[: len(BRICKS[kind])]


def gradient(kind, xi):
    """Their derivatives (nodes, 3) by the reference coordinates."""
    dN = np.zeros((20, 3))
    lib.ct_brick_gradient(
        KIND[kind],
        ffi.from_buffer("double[]", np.array(xi, float)),
        ffi.cast("double(*)[3]", ffi.from_buffer(dN)),
    )
    return dN[: len(BRICKS[kind])]


def rule(count):
    """Points and weights of Gauss's rule with `count` points along each axis."""
    x, w = np.polynomial.legendre.leggauss(count)
    return np.stack(np.meshgrid(x, x, x, indexing="ij"), -1).reshape(-1, 3), np.einsum(
        "i,j,k", w, w, w
    ).ravel()


def strains(kind, nodes, xi):
    """B (6, 3 nodes): engineering strains xx yy zz xy yz zx from the displacements; and det J."""
    dN = gradient(kind, xi)
    J = nodes.T @ dN
    slope = dN @ np.linalg.inv(J)
    B = np.zeros((6, len(nodes), 3))
    for i in range(3):
        j = (i + 1) % 3
        B[i, :, i] = slope[:, i]
        B[3 + i, :, i], B[3 + i, :, j] = slope[:, j], slope[:, i]
    return B.reshape(6, -1), np.linalg.det(J)


def moduli(young=1.0, poisson=0.0):
    """Stiffness (6, 6) of a linear elastic material, by engineering strains."""
    lame, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    return np.diag([2 * mu] * 3 + [mu] * 3) + lame * np.pad(np.ones((3, 3)), (0, 3))


def stiffness(kind, nodes, points, C):
    """Stiffness (3 nodes, 3 nodes) of an element by `points` Gauss points along each axis."""
    K = np.zeros((3 * len(nodes),) * 2)
    for xi, w in zip(*rule(points)):
        B, det = strains(kind, nodes, xi)
        K += w * det * B.T @ C @ B
    return K
