"""Pictures of the chapter on the rolling simplex."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE, RED
from shared.faces import POINT, SQUARE, bent_face, outline, squares

import libcontact as ct


def rolling():
    """Triangles of the reflection-only simplex, one after another, and the edge of each."""
    nodes = bent_face()
    value = lambda xi: squares(nodes, POINT, xi)
    x = np.array([-0.9, -0.8]) + 0.5 * np.array([[-1 / 2, -0.2887], [1 / 2, -0.2887], [0, 0.5774]])
    age, edge, all_of_them = np.zeros(3), 0.5, [x.copy()]
    while edge > 0.05:
        order = np.argsort(-value(x))
        for worst in order[:2]:
            others = np.delete(x, worst, axis=0)
            new = others.sum(axis=0) - x[worst]
            if value(new) < value(x[worst]) or worst == order[1]:
                break
        x[worst], age = new, age + 1
        age[worst] = 0
        if age.max() >= 4:
            x = x[age.argmax()] + (x - x[age.argmax()]) / 2
            age, edge = np.zeros(3), edge / 2
        all_of_them.append(x.copy())
    return value, np.array(all_of_them)


def simplex():
    """The rolling triangle of the paper in six frames."""
    value, triangles = rolling()
    figure = Figure(figsize=(7.5, 5.0))
    grid = np.linspace(-1.6, 1.6, 161)
    height = value(np.stack(np.meshgrid(grid, grid), -1))
    frames = np.unique(np.linspace(1, len(triangles), 6).astype(int))
    for ax, count in zip(figure.subplots(2, 3, sharex=True, sharey=True).flat, frames):
        ax.contour(
            grid,
            grid,
            height,
            np.quantile(height, np.linspace(0.01, 0.95, 16)),
            colors=GREY,
            linewidths=0.5,
        )
        ax.plot(*outline("Q8").T, color="black", lw=1)
        for i, triangle in enumerate(triangles[:count]):
            last = i == count - 1
            ax.fill(
                *triangle.T,
                facecolor=ORANGE if last else "none",
                alpha=0.9 if last else 0.5,
                edgecolor=ORANGE,
                lw=0.8,
            )
        ax.set(
            title=f"after {count - 1} iterations",
            aspect="equal",
            xlim=(-1.6, 1.3),
            ylim=(-1.5, 1.2),
        )
        ax.grid(False)
    figure.supxlabel("ξ₁", fontsize=10)
    figure.supylabel("ξ₂", fontsize=10)
    return figure


def moving_simplex():
    """The triangle on its way, over the lines of equal distance and the places where it has been."""
    value, triangles = rolling()
    figure = Figure(figsize=(5.0, 4.2), layout="constrained")
    ax = figure.subplots()
    grid = np.linspace(-1.6, 1.6, 81)
    height = value(np.stack(np.meshgrid(grid, grid), -1))
    levels = np.quantile(height, np.linspace(0.01, 0.95, 16))
    ax.contour(grid, grid, height, levels, colors=GREY, linewidths=0.5)
    ax.plot(*outline("Q8").T, color="black", lw=1)
    for triangle in triangles:
        ax.fill(*triangle.T, facecolor="none", alpha=0.3, edgecolor=ORANGE, lw=0.6)
    (shown,) = ax.fill(*triangles[0].T, color=ORANGE)
    ax.set(xlabel="ξ₁", ylabel="ξ₂", aspect="equal", xlim=(-1.6, 1.3), ylim=(-1.5, 1.2))
    ax.grid(False)
    closed = np.concatenate([triangles, triangles[:, :1]], axis=1)
    return figure, 0.25 * len(triangles), {shown: np.repeat(closed, 2, axis=0)}


def moves():
    """The three moves of the rolling simplex, with the lines of equal height of a plane valley."""
    figure = Figure(figsize=(7.5, 2.7))
    unit = np.array([[-0.5, -(3**0.5) / 6], [0.5, -(3**0.5) / 6], [0, 3**0.5 / 3]])
    axes = figure.subplots(1, 3)
    shown = (
        ("reflect the highest", np.array([1.2, 0.9]), 2.6),
        ("reflect the second highest", np.array([0.25, -0.1]), 0.0),
        ("halve", np.array([0.25, -0.1]), 0.0),
    )
    for ax, (title, minimum, turn) in zip(axes, shown):
        turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        x = unit @ turned.T
        f = ((x - minimum) ** 2 * [1.0, 1.5]).sum(1)
        low, second, high = np.argsort(f)
        image = x[low] + x[second] - x[high]
        value = ((image - minimum) ** 2 * [1.0, 1.5]).sum()
        grid = np.linspace(-1.1, 1.6, 101)
        a, b = np.meshgrid(grid, grid)
        height = (a - minimum[0]) ** 2 + 1.5 * (b - minimum[1]) ** 2
        ax.contour(a, b, np.sqrt(height), 12, colors=GREY, linewidths=0.5)
        ax.fill(*x.T, facecolor=ORANGE, alpha=0.35, edgecolor=ORANGE)
        new = x.copy()
        if title == "halve":
            new = x[low] + (x - x[low]) / 2
        elif value < f[high]:
            new[high] = image
        else:
            ax.plot(*image, "x", color=RED, ms=7)
            new[second] = x[low] + x[high] - x[second]
        assert (value < f[high]) == (title == "reflect the highest")
        ax.fill(*new.T, facecolor="none", edgecolor=BLUE, lw=2)
        middle = x.mean(axis=0)
        for vertex, name in ((low, "l"), (second, "s"), (high, "h")):
            ax.text(*(x[vertex] + 0.28 * (x[vertex] - middle)), name, ha="center", va="center")
        ax.set(title=title, aspect="equal", xlim=(-0.9, 1.4), ylim=(-0.9, 1.1))
        ax.set_axis_off()
    return figure


def lowest():
    """Error of the simplex over the gap, and the floor that it cannot pass."""
    figure = Figure(figsize=(5.6, 3.0))
    ax = figure.subplots()
    nodes = np.column_stack([SQUARE[:4], np.zeros(4)])
    gaps = 10.0 ** np.arange(-6, 4.1, 0.5)
    points = np.column_stack([np.full((len(gaps), 2), [0.3125, -0.4]), gaps])
    for method, colour, mark in (("simplex", ORANGE, "o"), ("robust", BLUE, "s")):
        found = ct.project("Q4", nodes, points, method=method)
        error = np.abs(found.xi - points[:, :2]).max(axis=1)
        ax.loglog(gaps, np.maximum(error, 1e-17), mark, color=colour, ms=4, label=method)
    ax.loglog(
        gaps, np.sqrt(2.2e-16) * gaps, "-", color="black", lw=1, label=r"$2\sqrt{\epsilon}\,g_n/h$"
    )
    ax.set(xlabel="gap / half-width of the face", ylabel="error of ξ")
    ax.legend()
    return figure
