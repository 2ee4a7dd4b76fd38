"""Pictures of the chapter on bricks as shapes."""

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import proj3d
from shared.bricks import BRICKS, CORNERS, EDGES, draw_edges
from shared.drawing import BLUE, GREEN, GREY, ORANGE, arrow_in_space, axes_in_space


def number_nodes(ax, nodes):
    """The numbers of the nodes, each in the widest gap between the edges that are drawn from its node."""
    flat = np.column_stack(proj3d.proj_transform(*nodes.T, ax.get_proj())[:2])
    for n, node in enumerate(nodes):
        on = [e for e in EDGES if np.cross(CORNERS[e[0]] - node, CORNERS[e[1]] - node).any() == 0]
        ends = np.unique([end for e in on for end in e if np.abs(CORNERS[end] - node).any()])
        angle = np.sort(np.arctan2(*(flat[ends] - flat[n]).T[::-1]))
        gap = np.diff(angle, append=angle[0] + 2 * np.pi)
        middle = angle + gap / 2
        way = np.column_stack([np.cos(middle), np.sin(middle)])
        best = way[np.argmax(gap + 0.1 * way @ (flat[n] - flat.mean(axis=0)))]
        if len(ends) == 2:  # aslant, as hidden edges may end behind the middle of an edge
            best = best @ [[0.87, -0.5], [0.5, 0.87]]
        ax.annotate(
            str(n + 1), flat[n], 11 * best, textcoords="offset points", ha="center", va="center"
        )


def bricks():
    """The two reference bricks with the numbers of their nodes, from the end points of their edges."""
    figure = Figure(figsize=(7.5, 3.6))
    for place, (name, nodes) in zip((121, 122), BRICKS.items()):
        ax = axes_in_space(figure, place)
        for i, j in EDGES:
            hidden = 3 in (i, j)
            ax.plot(*CORNERS[[i, j]].T, "--" if hidden else "-", color=GREY, lw=1.1)
        ax.plot(*nodes.T, "o", ms=5)
        if name == "hex8":
            for axis, label in zip(np.eye(3), ("ξ₁", "ξ₂", "ξ₃")):
                arrow_in_space(ax, np.zeros(3), 0.6 * axis, label, GREEN)
        ax.set_title(name, y=1.02)
        ax.set_box_aspect((1, 1, 1), zoom=1.0)
        number_nodes(ax, nodes)
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
