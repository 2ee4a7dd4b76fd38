"""Pictures of the chapter on the search for faces."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, ORANGE


def control():
    """An edge with a mid-side node, its control points, and its two boxes."""
    figure = Figure(figsize=(5.6, 3.0))
    ax = figure.subplots()
    nodes = np.array([[0.0, 0.0], [2.5, 1.3], [1.0, 1.0]])
    knots = np.array([nodes[0], 2 * nodes[2] - (nodes[0] + nodes[1]) / 2, nodes[1]])
    xi = np.linspace(-1, 1, 100)[:, None]
    bernstein = np.hstack([(1 - xi) ** 2, 2 * (1 - xi**2), (1 + xi) ** 2]) / 4
    ax.plot(*(bernstein @ knots).T, color="black", lw=2)
    ax.plot(*knots.T, "--s", color=ORANGE, lw=0.9, ms=7, label="control points")
    ax.plot(*nodes.T, "o", color="black", ms=6, label="nodes")
    low, high = knots.min(axis=0), knots.max(axis=0)
    box = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low])
    ax.plot(*box.T, color=BLUE, lw=1.2, label="box along the axes")
    first = (nodes[1] - nodes[0]) / np.linalg.norm(nodes[1] - nodes[0])
    frame = np.array([first, [-first[1], first[0]]])
    turned = knots @ frame.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    box = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low]) @ frame
    ax.plot(*box.T, color=GREEN, lw=1.2, label="box along the face")
    ax.set(aspect="equal", xlim=(-0.6, 2.8), ylim=(-0.2, 2.2))
    ax.set_axis_off()
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def tree():
    """Four levels of a tree of boxes over a wavy line, and the boxes that a query opens."""
    figure = Figure(figsize=(7.5, 3.9))
    x = np.linspace(0, 8, 65)
    line = np.column_stack([x, 0.7 * np.sin(1.3 * x) + 0.25 * np.sin(3.1 * x)])
    point = np.array([5.1, 1.35])
    faces = [line[i : i + 2] for i in range(64)]

    def box(part):
        return np.concatenate(part).min(axis=0), np.concatenate(part).max(axis=0)

    def far(part):
        low, high = box(part)
        return np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0))

    levels = [[faces]]
    for _ in range(3):
        count = len(levels[-1][0]) // 4
        levels.append(
            [part[i : i + count] for part in levels[-1] for i in range(0, len(part), count)]
        )
    fine = np.concatenate([a + np.linspace(0, 1, 50)[:, None] * (b - a) for a, b in faces])
    best = np.linalg.norm(fine - point, axis=1).min()
    for ax, level in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, levels):
        ax.plot(*line.T, color="black", lw=1.2)
        opened = 0
        for part in level:
            low, high = box(part)
            corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
            near = far(part) <= best
            opened += near
            ax.fill(
                *corners.T,
                facecolor=BLUE if near else "none",
                alpha=0.4 if near else 1.0,
                edgecolor=BLUE,
                lw=0.8,
            )
        ax.plot(*point, "o", color=ORANGE, ms=7)
        ax.set_title(
            f"{len(level)} box{'es' if len(level) > 1 else ''}, {opened} opened", fontsize=10
        )
        ax.set(aspect="equal", ylim=(-1.1, 1.7))
        ax.set_axis_off()
    return figure
