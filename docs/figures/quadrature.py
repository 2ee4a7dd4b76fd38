"""Pictures of the chapter on rules of integration."""

import numpy as np
from matplotlib.figure import Figure
from shared.faces import outline


def gauss():
    """Points of Gauss's rules with two and three points along each axis, areas as weights."""
    figure = Figure(figsize=(5.6, 2.9))
    rules = {
        "2 × 2": ([-((1 / 3) ** 0.5), (1 / 3) ** 0.5], [1, 1]),
        "3 × 3": ([-(0.6**0.5), 0, 0.6**0.5], [5 / 9, 8 / 9, 5 / 9]),
    }
    for ax, (name, (points, weights)) in zip(figure.subplots(1, 2), rules.items()):
        ax.plot(*outline("Q4").T, color="black", lw=1)
        x, y = np.meshgrid(points, points)
        ax.scatter(x, y, s=220 * np.multiply.outer(weights, weights), alpha=0.8)
        ax.set(title=name, xlabel="ξ₁", aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    figure.axes[0].set_ylabel("ξ₂")
    return figure


def rules():
    """Rules of a triangle and rules with points at the corners; the area of a point is its weight."""
    figure = Figure(figsize=(7.5, 2.5))
    root, part = np.sqrt(38 - 44 * np.sqrt(0.4)), np.sqrt(213125 - 53320 * np.sqrt(10))
    orbit = lambda a: [(a, a), (1 - 2 * a, a), (a, 1 - 2 * a)]
    six = [orbit((8 - np.sqrt(10) + sign * root) / 18) for sign in (1, -1)]
    weights = [(620 + sign * part) / 7440 for sign in (1, -1)]
    x, y = np.meshgrid([-1, 0, 1], [-1, 0, 1])
    simpson = np.array([1, 4, 1]) / 3
    shown = {
        "triangle, 3 points": ("T3", orbit(1 / 6), [1 / 6] * 3),
        "triangle, 6 points": ("T3", six[0] + six[1], np.repeat(weights, 3)),
        "ends, triangle": (
            "T3",
            orbit(0.0) + orbit(0.5) + [(1 / 3, 1 / 3)],
            [1 / 40] * 3 + [1 / 15] * 3 + [9 / 40],
        ),
        "ends, square": (
            "Q4",
            np.column_stack([x.ravel(), y.ravel()]),
            np.outer(simpson, simpson).ravel(),
        ),
    }
    for ax, (title, (kind, points, weight)) in zip(figure.subplots(1, 4), shown.items()):
        area = 0.5 if kind == "T3" else 4.0
        assert abs(sum(weight) - area) < 1e-14
        ax.plot(*outline(kind).T, color="black", lw=1)
        ax.scatter(*np.array(points).T, s=600 * np.array(weight) / area, alpha=0.8)
        ticks = [0, 1] if kind == "T3" else [-1, 0, 1]
        room = (-0.15, 1.1) if kind == "T3" else (-1.3, 1.3)
        ax.set(xlabel="ξ₁", aspect="equal", xticks=ticks, yticks=ticks, xlim=room, ylim=room)
        ax.set_title(title, fontsize=9)
    figure.axes[0].set_ylabel("ξ₂")
    return figure
