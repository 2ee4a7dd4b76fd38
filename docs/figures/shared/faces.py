"""The reference faces, the curved faces of the pictures, and the squared distance of a point from them."""

import numpy as np

import libcontact as ct

from .drawing import GREY

SQUARE = np.array(
    [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], dtype=float
)
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
FACES = {"Q4": SQUARE[:4], "Q8": SQUARE, "T3": TRIANGLE[:3], "T6": TRIANGLE}
POINT = np.array([0.1, 0.1, -0.1])  # of the tutorial on the closest point
ARCH = np.column_stack([1.5 * SQUARE, 0.35 - 0.5 * SQUARE[:, 0] ** 2 + 0.15 * SQUARE[:, 1]])


def bent_face():
    """The distorted Q8 face of the tutorial on the closest point, and its point (0.1, 0.1, -0.1)."""
    s = 1.1 * SQUARE[:, 0] + 0.35 * SQUARE[:, 1]
    t = SQUARE[:, 1] + 0.11 * SQUARE.prod(axis=1)
    return np.column_stack([np.sin(s), t, np.cos(s) + 0.165 * SQUARE.prod(axis=1)])


def outline(kind, edges=33):
    """Reference coordinates around a reference face."""
    corners = FACES[kind][: 4 if kind[0] == "Q" else 3]
    part = np.linspace(0, 1, edges)[:, None]
    sides = [a + part * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(sides)


def draw_face(ax, kind, nodes, lines=9):
    """A face in space: its parameter lines and its nodes."""
    low = 0.0 if kind[0] == "T" else -1.0
    along, levels = np.linspace(low, 1, 41), np.linspace(low, 1, lines)
    for level in levels:
        for flip in (False, True):
            xi = np.column_stack([along, np.full_like(along, level)])
            points = ct.face_points(kind, nodes, xi[:, ::-1] if flip else xi)
            ax.plot(*points.T, color=GREY, lw=1.4 if abs(level) == 1 else 0.5)
    ax.plot(*np.asarray(nodes).T, "o", color="black", ms=4)


def squares(nodes, point, xi):
    """The squared distance of the point from the points xi of a Q8 face."""
    return ((ct.face_points("Q8", nodes, xi) - point) ** 2).sum(-1)


def coefficients(nodes, point):
    """The vectors c_0 to c_7 of a Q8 face as seen from the point, by solving for them."""
    powers = lambda xi: np.stack(
        [
            np.ones(len(xi)),
            xi[:, 0],
            xi[:, 1],
            xi[:, 0] * xi[:, 1],
            xi[:, 0] ** 2,
            xi[:, 1] ** 2,
            xi[:, 0] ** 2 * xi[:, 1],
            xi[:, 0] * xi[:, 1] ** 2,
        ],
        axis=1,
    )
    return np.linalg.solve(powers(SQUARE), nodes - point)


def derivatives(c, xi):
    """d, the tangents, and the second derivatives 11, 22, 12 at one point."""
    x, y = xi
    d = c[0] + c[1] * x + c[2] * y + c[3] * x * y + c[4] * x**2 + c[5] * y**2
    d = d + c[6] * x**2 * y + c[7] * x * y**2
    t1 = c[1] + c[3] * y + 2 * c[4] * x + y * (2 * c[6] * x + c[7] * y)
    t2 = c[2] + c[3] * x + 2 * c[5] * y + x * (c[6] * x + 2 * c[7] * y)
    return d, t1, t2, 2 * (c[4] + c[6] * y), 2 * (c[5] + c[7] * x), c[3] + 2 * (c[6] * x + c[7] * y)


def patch(z, up, cells=2, size=1.0):
    """A flat patch of Q4 faces that points up or down: nodes and faces."""
    x = np.linspace(0, size, cells + 1)
    nodes = np.array([[a, b, z] for b in x for a in x])
    i = np.arange(cells)
    first = (i[:, None] * (cells + 1) + i[None, :]).ravel()
    faces = np.stack([first, first + 1, first + cells + 2, first + cells + 1], -1)
    return nodes, faces if up else faces[:, ::-1].copy()


def patch_contact(upper, lower, **options):
    """The contact of two patches (nodes, faces) with an explicit penalty of 1."""
    surfaces = (ct.Surface("Q4", *patch) for patch in (upper, lower))
    law = {"epsilon": 1.0, "enforcement": "penalty", "initial_penetration": "force"}
    return ct.Contact(*surfaces, **law, **options)
