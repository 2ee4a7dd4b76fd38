"""Pictures of the chapters on faces, rules, closest points and the search for them."""

import sys
from pathlib import Path

import numpy as np
from libcontact.plot_projection import draw_starts, legend_of_ends
from matplotlib.figure import Figure

import libcontact as ct

sys.path.insert(0, str(Path(__file__).resolve().parent))
from method import FACES, SQUARE, arrow, bent_face, draw_face, outline, solid_axes  # noqa: E402

BLUE, ORANGE, GREEN, RED, VIOLET, GREY = (
    "#3b8bd4",
    "#e8762b",
    "#3fa34d",
    "#d64550",
    "#9b6fd0",
    "#8a8a8a",
)
POINT = np.array([0.1, 0.1, -0.1])


def squares(nodes, point, xi):
    """The squared distance of the point from the points xi of a Q8 face."""
    return ((ct.face_points("Q8", nodes, xi) - point) ** 2).sum(-1)


def mapping():
    """The reference square, and the curved face that it becomes."""
    figure = Figure(figsize=(7.5, 3.0))
    flat = figure.add_subplot(121)
    nodes = np.column_stack([1.5 * SQUARE, 0.35 - 0.5 * SQUARE[:, 0] ** 2 + 0.15 * SQUARE[:, 1]])
    for level in np.linspace(-1, 1, 9):
        width = 1.4 if abs(level) == 1 else 0.5
        flat.plot([-1, 1], [level, level], color=GREY, lw=width)
        flat.plot([level, level], [-1, 1], color=GREY, lw=width)
    flat.plot(*SQUARE.T, "o", color="black", ms=4)
    low, high = np.array([0.25, 0.0]), np.array([0.5, 0.25])
    cell = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    flat.fill(*cell.T, color=ORANGE, alpha=0.8)
    flat.text(0.37, 0.37, "dξ₁ dξ₂", ha="center")
    flat.set(xlabel="ξ₁", ylabel="ξ₂", aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    flat.grid(False)
    ax = solid_axes(figure, 122, elev=30, azim=-62)
    draw_face(ax, "Q8", nodes)
    edge = ct.face_points("Q8", nodes, cell)
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    ax.add_collection3d(Poly3DCollection([edge], facecolor=ORANGE, alpha=0.8))
    step = 1e-5
    near = ct.face_points("Q8", nodes, low + step * np.array([[0, 0], [1, 0], [0, 1]]))
    tangents = (near[1:] - near[0]) / step
    normal = np.cross(*tangents)
    for along, name in zip(tangents, (r"$\mathbf{t}_1$", r"$\mathbf{t}_2$")):
        arrow(ax, near[0], 0.6 * along, name, GREEN)
    arrow(ax, near[0], 0.9 * normal / np.linalg.norm(normal), r"$\mathbf{n}$", BLUE)
    ax.set_box_aspect((3, 3, 1.7))
    figure.set_layout_engine("none")
    flat.set_position([0.08, 0.17, 0.32, 0.76])
    ax.set_position([0.40, -0.22, 0.66, 1.5])
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
    box = np.array([[-1, -1, -1], [1, 1, 1]], dtype=float)
    for place, shown, azim, title in (
        (121, (1, 2, 5), -50, "ξ₁ = 1, ξ₂ = −1, ξ₃ = 1"),
        (122, (0, 3, 4), 130, "ξ₁ = −1, ξ₂ = 1, ξ₃ = −1, seen from behind and below"),
    ):
        ax = solid_axes(figure, place, elev=24 if place == 121 else -24, azim=azim)
        for axis in range(3):
            for a in (-1, 1):
                for b in (-1, 1):
                    ends = np.repeat(box[:1], 2, axis=0)
                    ends[:, axis] = [-1, 1]
                    ends[:, (axis + 1) % 3], ends[:, (axis + 2) % 3] = a, b
                    ax.plot(*ends.T, color=GREY, lw=0.8)
        for side in shown:
            first, second = np.array(SIDE_AXES[side], dtype=float)
            out = np.cross(first, second)
            assert out[side // 2] == (1 if side % 2 else -1)
            corner = 1.02 * out - 0.8 * first - 0.8 * second
            arrow(ax, corner, 1.2 * first, "1", ORANGE)
            arrow(ax, corner, 1.2 * second, "2", BLUE)
            arrow(ax, out, 0.4 * out, "n", GREEN)
        ax.set_title(title, fontsize=9, y=1.08)
        ax.set_box_aspect((1, 1, 1), zoom=0.95)
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
