"""Picture of the chapter on masses."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import BRICKS, CORNERS, draw_edges, rule, shape
from shared.drawing import BLUE, RED, axes_in_space


def masses():
    """Shares of a cube's mass at its nodes: hex8, and hex20 by row sum and by scaling; areas are shares."""
    figure = Figure(figsize=(7.5, 3.4))
    points, weights = rule(3)
    for place, kind, name in (
        (131, "hex8", "row sum"),
        (132, "hex20", "row sum"),
        (133, "hex20", "scaled diagonal"),
    ):
        N = np.array([shape(kind, xi) for xi in points])
        m = weights @ (N if name == "row sum" else N**2)
        m /= m.sum()
        ax = axes_in_space(figure, place)
        draw_edges(ax, CORNERS)
        for node, share in zip(BRICKS[kind], m):
            ax.plot(
                *node, "o", ms=34 * abs(share) ** 0.5, color=RED if share < 0 else BLUE, alpha=0.85
            )
        label = f"corner {m[0]:+.3f}" + ("" if kind == "hex8" else f"\nmiddle {m[8]:+.3f}")
        ax.set_title(f"{kind}, {name}", pad=14)
        ax.text2D(
            0.5, -0.02, label.replace("-", "−"), transform=ax.transAxes, ha="center", va="top"
        )
        ax.set_box_aspect((1, 1, 1), zoom=0.9)
    return figure
