"""The lowest point of a quadratic model within a square: find the error."""

import numpy as np


def value(g, H, s):
    return g @ s + s @ H @ s / 2


def lowest(g, H):
    """The allowed step, each component at most 1, with the lowest value of the model."""
    newton = -np.linalg.solve(H, g)
    return np.clip(newton, -1, 1)


if __name__ == "__main__":
    rng = np.random.default_rng(1)
    s = np.linspace(-1, 1, 41)
    grid = np.stack(np.meshgrid(s, s), -1).reshape(-1, 2)
    missed, models = 0, 3000
    for _ in range(models):
        A, g = rng.normal(size=(2, 2)), 2 * rng.normal(size=2)
        H = A @ A.T + 0.1 * np.eye(2)
        best = (grid @ g + ((grid @ H) * grid).sum(axis=1) / 2).min()
        missed += value(g, H, lowest(g, H)) > best + 1e-9
    print(f"not the lowest point: {missed / models:.2f} of all models")
