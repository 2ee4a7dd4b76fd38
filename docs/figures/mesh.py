"""Pictures of the chapter on meshes."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import BRICKS, gradient, shape
from shared.drawing import BLUE, GREY, RED


def maps():
    """The upper side of three hex20 bricks: lines of constant reference coordinates, and where the determinant is
    negative."""
    bricks = []
    for move in (
        {},
        {6: (1.25, 1.3), 18: (1.12, 1.15), 13: (1.22, 0.1), 14: (0.1, 1.3)},
        {14: (0.72, 1.0)},
    ):
        nodes = BRICKS["hex20"].copy()
        for node, xy in move.items():
            nodes[node, :2] = xy
        bricks.append(nodes)
    figure = Figure(figsize=(7.5, 2.7))
    t = np.linspace(-1, 1, 41)
    for ax, nodes, title in zip(
        figure.subplots(1, 3),
        bricks,
        ("reference cube", "a brick of the mesh", "mid-side node too far"),
    ):
        xi = np.stack(np.meshgrid(t, t), -1)
        xi = np.concatenate([xi, np.ones_like(xi[..., :1])], -1)
        place = np.array([[shape("hex20", p) @ nodes for p in row] for row in xi])
        det = np.array([[np.linalg.det(nodes.T @ gradient("hex20", p)) for p in row] for row in xi])
        for k in range(0, 41, 5):
            for line in (place[k], place[:, k]):
                ax.plot(
                    *line[:, :2].T,
                    color="black" if k in (0, 40) else GREY,
                    lw=1.3 if k in (0, 40) else 0.6,
                )
        ax.plot(*place[det < 0][:, :2].T, "s", ms=3, color=RED)
        top = [4, 5, 6, 7, 12, 13, 14, 15]
        ax.plot(*nodes[top][:, :2].T, "o", ms=5, color=BLUE)
        ax.set(title=title, aspect="equal", xlim=(-1.3, 1.5), ylim=(-1.3, 1.5))
        ax.set_axis_off()
    return figure


def blocks():
    """A core with four arms of layers: on the lattice, and as a disc."""
    n, m = 4, 4  # half cells from the middle of the core, and half layers

    def place(x, y):
        base = np.clip([x, y], -n, n)
        layer = max(abs(x), abs(y)) - n
        u = 11 * base * n / (14 * n * n - 3 * base**2)
        core = u * (10 - u[::-1] ** 2) / 20
        return core if layer <= 0 else ((m - layer) * core + layer * u / np.hypot(*u)) / m

    figure = Figure(figsize=(7.5, 3.6))
    cross, disc = figure.subplots(1, 2)
    ends = range(-n - m, n + m + 1, 2)
    for a in ends:
        for b in ends[:-1]:
            for x, y in (
                (np.full(9, a), np.linspace(b, b + 2, 9)),
                (np.linspace(b, b + 2, 9), np.full(9, a)),
            ):
                if (np.minimum(abs(x), abs(y)) > n).any():
                    continue
                glued = abs(x[4]) == n and abs(y[4]) > n or abs(y[4]) == n and abs(x[4]) > n
                style = {"color": RED if glued else BLUE, "lw": 1.6 if glued else 0.9}
                cross.plot(x, y, **style)
                disc.plot(*np.array([place(*at) for at in zip(x, y)]).T, **style)
    cross.set_title("on the lattice")
    disc.set_title("in the body")
    for ax in (cross, disc):
        ax.set_aspect("equal")
        ax.set_axis_off()
    return figure
