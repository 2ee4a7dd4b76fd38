"""Picture of the chapter on the robust method."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY


def trust():
    """The lowest point of a quadratic model inside a box of allowed steps, in three cases."""
    figure = Figure(figsize=(7.5, 2.7))
    cases = (
        ("allowed", [[2.0, 0.4], [0.4, 1.2]], [-0.8, 0.4]),
        ("cut by a side", [[2.0, 0.9], [0.9, 1.2]], [-2.8, -0.4]),
        ("at a saddle", [[2.0, 0.5], [0.5, -1.0]], [0.0, 0.0]),
    )
    grid = np.linspace(-1.6, 1.6, 321)
    steps = np.stack(np.meshgrid(grid, grid), -1)
    box = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    for ax, (title, hessian, gradient) in zip(figure.subplots(1, 3), cases):
        model = steps @ gradient + 0.5 * np.einsum("xyi,ij,xyj->xy", steps, hessian, steps)
        ax.contour(grid, grid, model, 22, colors=GREY, linewidths=0.6)
        inside = np.where(np.abs(steps).max(-1) <= 1 + 1e-9, model, np.inf)
        lowest_ = np.argwhere(inside <= inside.min() + 1e-9)
        ax.plot(*box.T, color="black", lw=1.2)
        ax.plot(0, 0, "o", mfc="none", color=BLUE, ms=9)
        for i, j in lowest_:
            ax.plot(grid[j], grid[i], "*", color=GREEN, ms=12)
        ax.set(title=title, aspect="equal", xlabel="s₁", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
        ax.grid(False)
    figure.axes[0].set_ylabel("s₂")
    return figure
