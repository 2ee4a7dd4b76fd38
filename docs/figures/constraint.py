"""Picture of the chapter on many constraints at once."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE, RED


def iteration():
    """A quadratic function of two forces under λ ≥ 0, and the way to its minimum."""
    W = np.array([[1.0, 0.7], [0.7, 1.2]])
    free = np.array([-1.0, -0.3])
    value = lambda f: 0.5 * np.einsum("...i,ij,...j", f, W, f) + f @ free
    D = np.abs(W).sum(axis=1)
    path = [np.array([0.1, 0.9])]
    for _ in range(12):
        rest = W @ path[-1] + free
        path.append(path[-1] - np.minimum(rest / D, path[-1]))
    figure = Figure(figsize=(5.6, 3.8))
    ax = figure.subplots()
    grid = np.linspace(-0.8, 1.7, 161)
    height = value(np.stack(np.meshgrid(grid, grid), -1))
    levels = value(np.array([1.0, 0.0])) + np.array([0.003, 0.02, 0.06, 0.15, 0.3, 0.5, 0.8, 1.2])
    ax.contour(grid, grid, height, levels, colors=GREY, linewidths=0.7)
    ax.fill([0, 1.6, 1.6, 0], [0, 0, 1.2, 1.2], color=BLUE, alpha=0.08, lw=0)
    ax.plot(*np.array(path).T, "o-", color=ORANGE, ms=4.5)
    ax.plot(*np.linalg.solve(W, -free), "x", color=RED, ms=9, mew=2)
    ax.plot(1, 0, "*", color="black", ms=11)
    ax.set(xlabel="λ₁", ylabel="λ₂", xlim=(-0.3, 1.6), ylim=(-0.75, 1.15), aspect="equal")
    ax.axhline(0, color="black", lw=1)
    ax.axvline(0, color="black", lw=1)
    ax.grid(False)
    return figure
