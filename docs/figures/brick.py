"""Pictures of the chapter on bricks as shapes."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import BRICKS, CORNERS, EDGES, draw_edges
from shared.drawing import BLUE, GREEN, GREY, ORANGE, arrow_in_space, axes_in_space


def bricks():
    """The two reference bricks with the numbers of their nodes, from the end points of their edges."""
    figure = Figure(figsize=(7.5, 3.6))
    for place, (name, nodes) in zip((121, 122), BRICKS.items()):
        ax = axes_in_space(figure, place)
        for i, j in EDGES:
            hidden = 3 in (i, j)
            ax.plot(*CORNERS[[i, j]].T, "--" if hidden else "-", color=GREY, lw=1.1)
        ax.plot(*nodes.T, "o", ms=5)
        for number, node in enumerate(nodes, 1):
            ax.text(*(1.17 * node), str(number), ha="center", va="center")
        if name == "hex8":
            for axis, label in zip(np.eye(3), ("ξ₁", "ξ₂", "ξ₃")):
                arrow_in_space(ax, np.zeros(3), 0.6 * axis, label, GREEN)
        ax.set_title(name, y=0.98)
        ax.set_box_aspect((1, 1, 1), zoom=1.0)
    return figure


# The two axes of each side of a brick as a face, x_min to z_max (brick-sides).
SIDE_AXES = (
    ((0, -1, 0), (0, 0, 1)),
    ((0, 1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, 0, 1)),
    ((-1, 0, 0), (0, 0, 1)),
    ((-1, 0, 0), (0, 1, 0)),
    ((1, 0, 0), (0, 1, 0)),
)


def sides():
    """The six sides of a brick with their own axes: three in front, and the three opposite ones."""
    figure = Figure(figsize=(7.5, 3.5))
    for place, shown, azim, title in (
        (121, (1, 2, 5), -50, "ξ₁ = 1, ξ₂ = −1, ξ₃ = 1"),
        (122, (0, 3, 4), 130, "ξ₁ = −1, ξ₂ = 1, ξ₃ = −1, seen from behind and below"),
    ):
        ax = axes_in_space(figure, place, elev=24 if place == 121 else -24, azim=azim)
        draw_edges(ax, CORNERS, lw=0.8)
        for side in shown:
            first, second = np.array(SIDE_AXES[side], dtype=float)
            out = np.cross(first, second)
            assert out[side // 2] == (1 if side % 2 else -1)
            corner = 1.02 * out - 0.8 * first - 0.8 * second
            arrow_in_space(ax, corner, 1.2 * first, "1", ORANGE)
            arrow_in_space(ax, corner, 1.2 * second, "2", BLUE)
            arrow_in_space(ax, out, 0.4 * out, "n", GREEN)
        ax.set_title(title, fontsize=9, y=1.08)
        ax.set_box_aspect((1, 1, 1), zoom=0.95)
    return figure
