"""
Points inside a body, found without the library by the solid angle of the skin as seen from a point: 4π
times the number of times that the body covers the point (Van Oosterom and Strackee 1983).
"""

from __future__ import annotations

import numpy as np

# The faces of a brick, counter-clockwise from outside: VTK's corners, and the nodes on their edges.
FACES = np.array(
    [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
)
MIDDLES = np.array(
    [
        (16, 15, 19, 11),
        (9, 18, 13, 17),
        (8, 17, 12, 16),
        (19, 14, 18, 10),
        (11, 10, 9, 8),
        (12, 13, 14, 15),
    ]
)


def skin(elements: np.ndarray) -> np.ndarray:
    """Outer faces (m, 4) of hex8 or (m, 8) of hex20: those of one element only."""
    columns = FACES if elements.shape[1] == 8 else np.hstack([FACES, MIDDLES])
    faces = elements[:, columns].reshape(-1, columns.shape[1])
    _, first, count = np.unique(
        np.sort(faces[:, :4], axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[first[count == 1]]


def shape(count: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Shape functions of a face with four or eight nodes at the parameters a, b, shape (..., count)."""
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    N = [
        0.25 * (1 + i * a) * (1 + j * b) * (1 if count == 4 else i * a + j * b - 1)
        for i, j in corners
    ]
    if count == 8:
        N += [
            0.5 * (1 - a * a) * (1 + j * b) if i == 0 else 0.5 * (1 + i * a) * (1 - b * b)
            for i, j in ((0, -1), (1, 0), (0, 1), (-1, 0))
        ]
    return np.stack(N, -1)


def triangles(x: np.ndarray, faces: np.ndarray, parts: int = 2) -> np.ndarray:
    """Triangles (n, 3, 3) of the faces of a skin with the nodes at ``x``, each face cut into ``parts`` by
    ``parts`` pieces."""
    line = np.linspace(-1, 1, parts + 1)
    p = np.einsum(
        "abk,fkc->fabc", shape(faces.shape[1], *np.meshgrid(line, line, indexing="ij")), x[faces]
    )
    one, two, three, four = p[:, :-1, :-1], p[:, 1:, :-1], p[:, 1:, 1:], p[:, :-1, 1:]
    return np.concatenate(
        [
            np.stack([one, two, three], -2).reshape(-1, 3, 3),
            np.stack([one, three, four], -2).reshape(-1, 3, 3),
        ]
    )


def covered(points: np.ndarray, skin_triangles: np.ndarray) -> np.ndarray:
    """Number of times that the body within a closed skin covers each point (n,): 0 outside, 1 inside, 2 if
    it overlaps itself."""
    out = np.empty(len(points))
    for first in range(0, len(points), 256):
        a, b, c = (skin_triangles[None, :, k] - points[first : first + 256, None] for k in range(3))
        la, lb, lc = (np.sqrt((v * v).sum(-1)) for v in (a, b, c))
        triple = (a * np.cross(b, c)).sum(-1)
        other = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
        out[first : first + 256] = np.arctan2(triple, other).sum(1) / (2 * np.pi)
    return out


def twice(x: np.ndarray, elements: np.ndarray, share: float) -> int:
    """
    Count corners of the skin that are inside another part of the body by more than a ``share`` of the line
    to the centres of their elements: for each element of the corner the body covers the point at this
    fraction twice.
    """
    faces = skin(elements)
    on_skin = np.isin(elements[:, :8], faces[:, :4])
    owner, place = np.nonzero(on_skin)
    corner = elements[owner, place]
    way = x[elements[owner, :8]].mean(1) - x[corner]
    free = covered(x[corner] + share * way, triangles(x, faces)) < 1.5
    return int(len(np.unique(corner)) - len(np.unique(corner[free])))


def within(points: np.ndarray, x: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """Find points inside a body. Its faces are warped, so two triangles per face are too coarse for points
    near the skin."""
    return covered(points, triangles(x, skin(elements), 8)) > 0.5
