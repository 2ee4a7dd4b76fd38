"""Pictures of the chapter on contact: the two passes, and the side of a fold."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, arrow, bare, line


def passes():
    """Two passes: points of each surface measure their distance to the other one."""
    figure = Figure(figsize=(7.5, 2.5))
    x = np.linspace(0, 4, 200)
    lower, upper = lambda s: 0.12 * np.sin(1.3 * s), lambda s: 0.55 + 0.1 * np.cos(1.1 * s + 1)
    nodes = {lower: np.linspace(0, 4, 5), upper: np.linspace(0.2, 3.8, 4)}
    for ax, (own, other, colour, title) in zip(
        figure.subplots(1, 2, sharey=True),
        (
            (lower, upper, BLUE, "pass of the lower surface"),
            (upper, lower, ORANGE, "pass of the upper surface"),
        ),
    ):
        for curve in (lower, upper):
            ax.plot(nodes[curve], curve(nodes[curve]), "o-", color=GREY, ms=4, lw=1.4)
        ends = nodes[own]
        for a, b in zip(ends[:-1], ends[1:]):
            for part in (0.2113, 0.7887):
                point = np.array([a + part * (b - a), own(a) + part * (own(b) - own(a))])
                there = np.interp(x, nodes[other], other(nodes[other]))
                inside = (x >= nodes[other][0]) & (x <= nodes[other][-1])
                all_of_it = np.column_stack([x, there])[inside]
                nearest = all_of_it[((all_of_it - point) ** 2).sum(1).argmin()]
                ax.annotate(
                    "",
                    nearest,
                    point,
                    arrowprops={"arrowstyle": "->", "color": colour, "shrinkA": 0, "shrinkB": 0},
                )
                ax.plot(*point, "s", color=colour, ms=6)
        ax.set(title=title, aspect="equal", ylim=(-0.25, 0.8))
        ax.set_axis_off()
    return figure


def fold_normals(ax, slope, marks, off):
    """Two plane sides that meet at the origin, and points whose closest point is the edge."""
    sides = np.array([[-1.0, -slope], [1.0, -slope]]) / np.hypot(1, slope)
    normals = np.array([[-slope, 1.0], [slope, 1.0]]) / np.hypot(1, slope)
    low = min(-1.5, -2.0 * slope)
    body = [
        2.2 * sides[0],
        [0, 0],
        2.2 * sides[1],
        [2.2 * sides[1][0], low],
        [2.2 * sides[0][0], low],
    ]
    ax.fill(*np.array(body).T, color=GREY, alpha=0.25, lw=0)
    for side in sides:
        line(ax, (0, 0), 2.2 * side, color="black", lw=1.8)
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.4, 1.4, (700, 2))
    points = points[(points @ sides.T <= 0).all(axis=1) & (np.hypot(*points.T) < 1.35)]
    outside = (points @ normals.sum(axis=0) > 0) if slope > 0 else points @ normals.sum(axis=0) > 0
    wrong = (points @ normals[0] > 0) != outside
    ax.plot(*points[~wrong].T, "o", color=BLUE, ms=3.5)
    ax.plot(*points[wrong].T, "o", color=RED, ms=3.5)
    for normal, side, name in zip(normals, sides, ("$\\mathbf{n}_1$", "$\\mathbf{n}_2$")):
        arrow(ax, 1.5 * side, 0.6 * normal, name, off=0.1 * normal)
    arrow(ax, (0, 0), 0.45 * normals.sum(axis=0), marks, GREEN, off=off)


def wedge():
    """The wedge of a sharp ridge, with what one normal and the sum of both say; and of a valley."""
    figure = Figure(figsize=(7.5, 3.4))
    ridge, valley = figure.subplots(1, 2)
    fold_normals(ridge, 2.2, r"$\mathbf{n}_1 + \mathbf{n}_2$", (-0.95, -0.35))
    fold_normals(valley, -0.8, r"$\mathbf{n}_1 + \mathbf{n}_2$", (0.0, 0.1))
    bare(ridge, (-2.0, 2.0), (-2.1, 1.6))
    bare(valley, (-2.0, 2.0), (-2.0, 1.7))
    ridge.set_title("ridge: the wedge is outside")
    valley.set_title("valley: the wedge is inside")
    return figure
