"""The faces of the projection bench, and the definition of a correct result on them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent / "tests" / "data"))

import corpus  # noqa: E402, F401 (for those who import it from here)

RIGHT = 1e-6  # of the distance or the face size, whichever is larger
MARGIN = 1e-6  # a closest point this far from the edges, in xi, counts as inside


def ordinary(count: int, seed: int = 7):
    """Curved Q8 faces, points above or below them, and their closest points by construction: nodes
    (m, 8, 3), points (m, 3), xi (m, 2), gaps (m,)."""
    rng = np.random.default_rng(seed)
    nodes = np.empty((count, 8, 3))
    points, xi, gaps = (
        np.empty((count, 3)),
        rng.uniform(-0.9, 0.9, (count, 2)),
        rng.uniform(-0.3, 0.3, count),
    )
    for i in range(count):
        nodes[i] = corpus.curved(rng, "Q8", 0.4, 0.05)
        y, n = point_and_normal(nodes[i], xi[i])
        points[i] = y + gaps[i] * n
    return nodes, points, xi, np.abs(gaps)


def point_and_normal(nodes, xi):
    """Point and unit normal of a Q8 face, from polynomials of its own."""
    powers = np.array(corpus.POWERS["Q8"])
    A = np.array([[x**i * y**j for i, j in powers] for x, y in corpus.QUADRILATERAL])
    c = np.linalg.solve(A, nodes)
    (x, y), (i, j) = xi, powers.T
    dx, dy = i * x ** np.maximum(i - 1, 0) * y**j, j * x**i * y ** np.maximum(j - 1, 0)
    n = np.cross(dx @ c, dy @ c)
    return (x**i * y**j) @ c, n / np.linalg.norm(n)


def right(cases, distance, outside):
    """Which results for the cases of the corpus are correct? An unconstrained search may return
    "outside" if the minimum is not inside."""
    truth, size = (
        np.array([c["distance"] for c in cases]),
        np.array([corpus.face_size(c["nodes"]) for c in cases]),
    )
    inside = np.array([c["margin"] for c in cases]) > MARGIN
    return (np.abs(distance - truth) <= RIGHT * np.maximum(truth, size)) | (~inside & outside)


def side_by_side(ct, method):
    """Median evaluations of one method of ``ct`` (libcontact) on ordinary faces to 1e-10, and the fraction
    of the corpus with a correct result."""
    nodes, points, _, _ = ordinary(400)
    calls = [
        ct.project("Q8", own, [point], method).evaluations[0] for own, point in zip(nodes, points)
    ]
    cases = corpus.load()
    answers = [ct.project(c["kind"], c["nodes"], [c["point"]], method) for c in cases]
    good = right(
        cases,
        np.array([a.distance[0] for a in answers]),
        np.array([a.where[0] == "outside" for a in answers]),
    )
    return float(np.median(calls)), float(np.mean(good)), len(cases)
