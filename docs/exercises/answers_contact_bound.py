"""Answers of the exercises of the chapter on the bound of a contact."""

import numpy as np


def exact(springs, beta, n=200):
    """Of a long bar on its spring, by the eigenvalues of its matrix."""
    K = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    K[0, 0] = 1 + springs * beta
    root = np.r_[2**0.5, np.ones(n - 1)]
    return 2 / np.sqrt(np.linalg.eigvalsh(root[:, None] * K * root)[-1])


def test_bound_wall(says):
    bound = 1 / np.sqrt(5)
    wall, bars = exact(1, 4), exact(2, 4)
    says(f"{wall:.3f}", f"{bound:.3f}", f"{100 * (1 - bound / wall):.0f} %")
    says(f"{bars:.3f}", f"{100 * (1 - bound / bars):.1f} %")


def test_bound_host(says):
    alone = 1 / np.sqrt(1 / 0.81 - 1)
    says(f"{1 / np.sqrt(1 + 1 / 0.25):.3f}", f"{alone:.2f}", f"{(alone / 0.5) ** 2:.0f}")
