"""Pictures of the chapters on faces, closest points, time steps and energy."""

import numpy as np
from libcontact.plot_projection import draw_path
from matplotlib.figure import Figure

import libcontact as ct

SQUARE = np.array(
    [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], dtype=float
)
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
FACES = {"Q4": SQUARE[:4], "Q8": SQUARE, "T3": TRIANGLE[:3], "T6": TRIANGLE}


def bent_face():
    """The distorted Q8 face of the tutorial on the closest point, and its point (0.1, 0.1, -0.1)."""
    s = 1.1 * SQUARE[:, 0] + 0.35 * SQUARE[:, 1]
    t = SQUARE[:, 1] + 0.11 * SQUARE.prod(axis=1)
    return np.column_stack([np.sin(s), t, np.cos(s) + 0.165 * SQUARE.prod(axis=1)])


def outline(kind, edges=33):
    """Reference coordinates around a reference face."""
    corners = FACES[kind][: 4 if kind[0] == "Q" else 3]
    part = np.linspace(0, 1, edges)[:, None]
    sides = [a + part * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(sides)


def faces():
    """The four reference faces with the numbers of their nodes."""
    figure = Figure(figsize=(7.5, 2.4))
    for ax, (kind, nodes) in zip(figure.subplots(1, 4), FACES.items()):
        ax.plot(*outline(kind).T, color="black", lw=1)
        ax.plot(*nodes.T, "o", ms=5)
        for number, node in enumerate(nodes, 1):
            inwards = nodes[:3].mean(axis=0) if kind[0] == "T" else np.zeros(2)
            ax.annotate(str(number), node + 0.28 * (inwards - node), ha="center", va="center")
        ax.set(title=kind, xlabel="ξ₁", aspect="equal")
        ax.set_xticks([-1, 0, 1] if kind[0] == "Q" else [0, 1])
        ax.set_yticks([-1, 0, 1] if kind[0] == "Q" else [0, 1])
    figure.axes[0].set_ylabel("ξ₂")
    return figure


def solid_axes(figure, place=111, **view):
    """Axes in space without box and ticks."""
    ax = figure.add_subplot(place, projection="3d", computed_zorder=False)
    ax.view_init(**view)
    ax.set_axis_off()
    return ax


def draw_face(ax, kind, nodes, lines=9):
    """A face in space: its parameter lines and its nodes."""
    low = 0.0 if kind[0] == "T" else -1.0
    along, levels = np.linspace(low, 1, 41), np.linspace(low, 1, lines)
    for level in levels:
        for flip in (False, True):
            xi = np.column_stack([along, np.full_like(along, level)])
            points = ct.face_points(kind, nodes, xi[:, ::-1] if flip else xi)
            ax.plot(*points.T, color="#8a8a8a", lw=1.4 if abs(level) == 1 else 0.5)
    ax.plot(*np.asarray(nodes).T, "o", color="black", ms=4)


def arrow(ax, start, along, name, colour):
    ax.quiver(*start, *along, color=colour, arrow_length_ratio=0.12, lw=1.8)
    ax.text(*(start + 1.12 * along), name, color=colour, ha="center", va="center")


def closest():
    """Fig. 1 of the paper, redrawn: a face, a point, its closest point, and the tangents there."""
    figure = Figure(figsize=(6.0, 2.8))
    ax = solid_axes(figure, elev=24, azim=-62)
    nodes = np.column_stack([1.5 * SQUARE, 0.35 - 0.5 * SQUARE[:, 0] ** 2 + 0.15 * SQUARE[:, 1]])
    xi = np.array([0.25, 0.1])
    step = 1e-5
    near = ct.face_points("Q8", nodes, xi + step * np.array([[0, 0], [1, 0], [0, 1]]))
    closest, tangents = near[0], (near[1:] - near[0]) / step
    normal = np.cross(*tangents)
    normal /= np.linalg.norm(normal)
    point = closest + 1.1 * normal
    found = ct.project("Q8", nodes, [point])
    assert np.allclose(found.xi[0], xi, atol=1e-4)
    draw_face(ax, "Q8", nodes)
    ax.plot(*np.array([point, closest]).T, "k--", lw=1)
    ax.plot(*point, "o", color="#e8762b", ms=7)
    ax.plot(*closest, "o", color="#3b8bd4", ms=7)
    ax.text(*(point + [0.12, 0, 0.05]), r"$\mathbf{y}_s$")
    ax.text(*(closest + [-0.35, 0, -0.12]), r"$\bar{\mathbf{y}}$")
    for tangent, name in zip(tangents, (r"$\mathbf{t}_1$", r"$\mathbf{t}_2$")):
        arrow(ax, closest, 0.55 * tangent, name, "#3fa34d")
    ax.text(*(0.5 * (point + closest) + [0.1, 0, 0]), r"$g_n$")
    ax.text(*nodes[3] + [0, 0, 0.15], r"$\gamma_c$")
    ax.set_box_aspect((3, 3, 1.7))
    figure.set_layout_engine("none")
    ax.set_position([-0.1, -0.25, 1.2, 1.74])
    return figure


def rolling():
    """Triangles of the reflection-only simplex, one after another, and the edge of each."""
    nodes, point = bent_face(), np.array([0.1, 0.1, -0.1])
    value = lambda xi: ((ct.face_points("Q8", nodes, xi) - point) ** 2).sum(-1)
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
            colors="#8a8a8a",
            linewidths=0.5,
        )
        ax.plot(*outline("Q8").T, color="black", lw=1)
        for i, triangle in enumerate(triangles[:count]):
            last = i == count - 1
            ax.fill(
                *triangle.T,
                facecolor="#e8762b" if last else "none",
                alpha=0.9 if last else 0.5,
                edgecolor="#e8762b",
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


PATHS = (
    "simplex",
    "nelder_mead",
    "newton",
    "least_squares",
    "steepest_descent",
    "broyden",
    "bfgs",
    "robust",
)


def paths():
    """The path of each method from one start."""
    nodes, point = bent_face(), np.array([0.1, 0.1, -0.1])
    figure = Figure(figsize=(7.5, 4.4))
    for ax, method in zip(figure.subplots(2, 4, sharex=True, sharey=True).flat, PATHS):
        count = draw_path(ax, "Q8", nodes, point, method, start=(-0.2, 0.7))
        ax.set_title(f"{method}: {count}", fontsize=9)
        ax.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1])
        ax.grid(False)
    return figure


def leapfrog():
    """Where the leapfrog stores what."""
    figure = Figure(figsize=(7.5, 2.2))
    ax = figure.subplots()
    for n in range(4):
        ax.plot(n, 0, "o", color="#3b8bd4", ms=11)
        ax.text(n, -0.42, ["$t_{n-1}$", "$t_n$", "$t_{n+1}$", "$t_{n+2}$"][n], ha="center")
        ax.text(n, 0.28, r"$\mathbf{u},\ \mathbf{f}(\mathbf{u})$", ha="center", color="#3b8bd4")
    for n in range(3):
        ax.plot(n + 0.5, 1, "s", color="#e8762b", ms=10)
        ax.text(n + 0.5, 1.28, r"$\mathbf{v}$", ha="center", color="#e8762b")
        curve = {"arrowstyle": "->", "lw": 1.4, "shrinkA": 10, "shrinkB": 10}
        ax.annotate(
            "",
            (n + 1, 0),
            (n, 0),
            arrowprops=curve | {"connectionstyle": "arc3,rad=0.35", "color": "#3b8bd4"},
        )
    for n in range(2):
        ax.annotate(
            "",
            (n + 1.5, 1),
            (n + 0.5, 1),
            arrowprops=curve | {"connectionstyle": "arc3,rad=-0.35", "color": "#e8762b"},
        )
    ax.set(xlim=(-0.3, 3.3), ylim=(-0.75, 1.75))
    ax.set_axis_off()
    return figure


def ledger():
    """Energies of a bar that hits a wall."""
    scene = ct.Scene(title="bar on a wall", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("elastic", young=1.0, poisson=0.0, density=1.0)
    box = {"origin": [0.02, 0, 0], "size": [1, 0.05, 0.05], "cells": [40, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, velocity=[-1, 0, 0])
    scene.add("obstacle", surface="bar.x_min", plane={"point": [0, 0, 0], "normal": [1, 0, 0]})
    scene.set_time(end=2.6, fraction=0.9).set_output(every=1, fields=[])
    run = scene.run(progress=False, output=False)
    figure = Figure(figsize=(7.5, 3.2))
    ax, off = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    start = run.energy["total"][0]
    for name, colour in (("kinetic", "#3b8bd4"), ("strain", "#e8762b"), ("contact", "#3fa34d")):
        if name in run.energy.dtype.names:
            ax.plot(run.time, run.energy[name] / start, color=colour, label=name)
    ax.plot(run.time, run.energy["total"] / start, color="black", label="total")
    ax.legend(ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    ax.set(ylabel="energy / start", ylim=(-0.05, 1.1))
    off.plot(run.time, 1e3 * (run.energy["total"] / start - 1), color="black")
    off.set(xlabel="time c t / L", ylabel="loss, ‰")
    return figure


LOWER = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]], dtype=float)
UPPER = LOWER * [1, 1, -1]


def bricks():
    """The two reference bricks with the numbers of their nodes, from the end points of their edges."""
    corners = np.concatenate([LOWER, UPPER])
    edges = [(i, (i + 1) % 4) for i in range(4)]
    edges += [(4 + i, 4 + j) for i, j in edges] + [(i, 4 + i) for i in range(4)]
    middles = np.array([(corners[i] + corners[j]) / 2 for i, j in edges])
    figure = Figure(figsize=(7.5, 3.6))
    for place, nodes, name in (
        (121, corners, "hex8"),
        (122, np.concatenate([corners, middles]), "hex20"),
    ):
        ax = solid_axes(figure, place, elev=18, azim=-64)
        for i, j in edges:
            hidden = 3 in (i, j)
            ax.plot(*corners[[i, j]].T, "--" if hidden else "-", color="#8a8a8a", lw=1.1)
        ax.plot(*nodes.T, "o", ms=5)
        for number, node in enumerate(nodes, 1):
            ax.text(*(1.17 * node), str(number), ha="center", va="center")
        if name == "hex8":
            for axis, label in zip(np.eye(3), ("ξ₁", "ξ₂", "ξ₃")):
                arrow(ax, np.zeros(3), 0.6 * axis, label, "#3fa34d")
        ax.set_title(name, y=0.98)
        ax.set_box_aspect((1, 1, 1), zoom=1.0)
    return figure


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


def setup():
    """Fig. 2 of the paper: the two plates before the impact, and the half that is computed."""
    figure = Figure(figsize=(6.4, 3.2))
    ax = figure.subplots()
    for x, colour, way, name in ((-1, "#3b8bd4", 1, "left"), (0, "#e8762b", -1, "right")):
        for z, alpha in ((-1, 0.25), (0, 0.6)):
            ax.fill([x, x + 1, x + 1, x], [z, z, z + 1, z + 1], color=colour, alpha=alpha, lw=0)
        middle = x + 0.5
        ax.annotate(
            "",
            (middle + 0.2 * way, 0.5),
            (middle - 0.2 * way, 0.5),
            arrowprops={"arrowstyle": "-|>", "lw": 2},
        )
        ax.text(middle, 0.62, "$v_0$", ha="center")
        ax.text(middle, -0.55, name, ha="center")
    ax.plot([-1.15, 1.15], [0, 0], "-.", color="black", lw=0.9)
    ax.text(1.18, 0, "symmetry", va="center")
    ax.plot([0, 0], [-1, 1], color="black", lw=1.4)
    ax.text(0.02, 1.05, "plane of contact")
    ax.text(-0.95, 1.05, "free")
    ax.annotate("", (-1.1, 0), (-1.1, 1), arrowprops={"arrowstyle": "<->", "lw": 1})
    ax.text(-1.17, 0.5, "$d$", ha="center", va="center")
    ax.set(xlim=(-1.3, 1.6), ylim=(-1.05, 1.2), aspect="equal")
    ax.set_axis_off()
    return figure


def passes():
    """Two passes: points of each surface measure their distance to the other one."""
    figure = Figure(figsize=(7.5, 2.5))
    x = np.linspace(0, 4, 200)
    lower, upper = lambda s: 0.12 * np.sin(1.3 * s), lambda s: 0.55 + 0.1 * np.cos(1.1 * s + 1)
    nodes = {lower: np.linspace(0, 4, 5), upper: np.linspace(0.2, 3.8, 4)}
    for ax, (own, other, colour, title) in zip(
        figure.subplots(1, 2, sharey=True),
        (
            (lower, upper, "#3b8bd4", "pass of the lower surface"),
            (upper, lower, "#e8762b", "pass of the upper surface"),
        ),
    ):
        for curve in (lower, upper):
            ax.plot(nodes[curve], curve(nodes[curve]), "o-", color="#8a8a8a", ms=4, lw=1.4)
        ends = nodes[own]
        for a, b in zip(ends[:-1], ends[1:]):
            for part in (0.2113, 0.7887):
                point = np.array([a + part * (b - a), own(a) + part * (own(b) - own(a))])
                line = np.interp(x, nodes[other], other(nodes[other]))
                inside = (x >= nodes[other][0]) & (x <= nodes[other][-1])
                all_of_it = np.column_stack([x, line])[inside]
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
