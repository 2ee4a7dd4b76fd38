"""Answers of the exercises of the chapter on sums."""

import numpy as np


def test_sum_pairs(says):
    says(repr((0.1 + 0.2) + 0.3), repr(0.1 + (0.2 + 0.3)))
    v = np.random.default_rng(1).random((10_000, 4))
    w = v[:, [1, 0, 3, 2]]
    loop = ((v[:, 0] + v[:, 1]) + v[:, 2]) + v[:, 3] != ((w[:, 0] + w[:, 1]) + w[:, 2]) + w[:, 3]
    pairs = (v[:, 0] + v[:, 1]) + (v[:, 2] + v[:, 3]) != (w[:, 0] + w[:, 1]) + (w[:, 2] + w[:, 3])
    assert not pairs.any()
    says(f"{loop.mean():.0%}".replace("%", " %"))
