"""Answers of the exercises of the chapter on one-point elements."""

import itertools

import numpy as np


def rank(nodes, gradients):
    """Independent strains that points see."""
    rows = []
    d = nodes.shape[1]
    for g in gradients:
        for i, j in itertools.combinations_with_replacement(range(d), 2):
            row = np.zeros((len(nodes), d))
            row[:, i] += g[:, j]
            row[:, j] += g[:, i]
            rows.append(row.ravel())
    return np.linalg.matrix_rank(np.array(rows), tol=1e-9)


def gradients(functions, points, eps=1e-5):
    d = len(points[0])
    return [
        np.stack(
            [(functions(p + eps * e) - functions(p - eps * e)) / (2 * eps) for e in np.eye(d)], 1
        )
        for p in map(np.array, points)
    ]


def test_reduced_counts(says):
    counts = []
    for d in (2, 3):
        nodes = np.array(list(itertools.product((-1, 1), repeat=d)), float)
        found = gradients(lambda x: np.prod(1 + nodes * x, axis=1) / 2**d, [np.zeros(d)])
        counts.append(d * len(nodes) - rank(nodes, found) - (3 if d == 2 else 6))
    nodes = np.array([n for n in itertools.product((-1, 0, 1), repeat=3) if n.count(0) <= 1], float)

    def hex20(x):
        corner = np.prod(1 + nodes * x, axis=1) * ((nodes * x).sum(axis=1) - 2) / 8
        middle = np.prod(np.where(nodes == 0, 1 - x**2, 1 + nodes * x), axis=1) / 4
        return np.where((nodes == 0).any(axis=1), middle, corner)

    eight = list(itertools.product((-(3**-0.5), 3**-0.5), repeat=3))
    for points in ([(0.0, 0.0, 0.0)], eight):
        counts.append(60 - rank(nodes, gradients(hex20, points)) - 6)
    says(*map(str, counts))


def test_reduced_beam(says):
    """Squares of the heights of cubes over that of the section, and a tenth of the rest."""
    for n in (1, 2, 4):
        y = (np.arange(n) + 0.5) / n - 0.5
        kept = 12 * (y**2).mean()
        says(f"{1 / (kept + 0.1 * (1 - kept)):.3g}")
