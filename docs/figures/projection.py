"""Pictures of the chapter on the closest point."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, arrow_in_space, axes_in_space
from shared.faces import ARCH, POINT, SQUARE, bent_face, draw_face, outline, squares

import libcontact as ct


def closest():
    """Fig. 1 of the paper, redrawn: a face, a point, its closest point, and the tangents there."""
    figure = Figure(figsize=(6.0, 3.1))
    ax = axes_in_space(figure, elev=24, azim=-62)
    nodes = ARCH
    xi = np.array([0.25, 0.1])
    step = 1e-5
    near = ct.face_points("Q8", nodes, xi + step * np.array([[0, 0], [1, 0], [0, 1]]))
    nearest, tangents = near[0], (near[1:] - near[0]) / step
    normal = np.cross(*tangents)
    normal /= np.linalg.norm(normal)
    point = nearest + 1.1 * normal
    found = ct.project("Q8", nodes, [point])
    assert np.allclose(found.xi[0], xi, atol=1e-4)
    draw_face(ax, "Q8", nodes)
    ax.plot(*np.array([point, nearest]).T, "k--", lw=1)
    ax.plot(*point, "o", color=ORANGE, ms=7)
    ax.plot(*nearest, "o", color=BLUE, ms=7)
    ax.text(*(point + [0.12, 0, 0.05]), r"$\mathbf{y}_s$")
    ax.text(*(nearest + [-0.35, 0, -0.12]), r"$\bar{\mathbf{y}}$")
    for tangent, name in zip(tangents, (r"$\mathbf{t}_1$", r"$\mathbf{t}_2$")):
        arrow_in_space(ax, nearest, 0.55 * tangent, name, GREEN)
    ax.text(*(0.5 * (point + nearest) + [-0.28, 0, 0]), r"$g_n$")
    ax.text(*nodes[3] + [0, 0, 0.15], r"$\gamma_c$")
    ax.set_box_aspect((3, 3, 1.7), zoom=1.1)
    figure.set_layout_engine("none")
    # The box of the axes is larger than what is drawn in it: the picture ends where the figure does.
    ax.get_tightbbox = lambda *_, **__: figure.bbox
    ax.set_position([-0.1, -0.226, 1.2, 1.684])
    return figure


def stationary(nodes, point, reach=1.0):
    """Stationary points of f on a Q8 face: coordinates, and how many curvatures are negative."""
    starts = np.stack(np.meshgrid(*[np.linspace(-reach, reach, 15)] * 2), -1).reshape(-1, 2)
    found, step = [], 1e-4
    for xi in starts:
        for _ in range(40):
            around = xi + step * np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])
            f = squares(nodes, point, around).reshape(3, 3)
            g = np.array([f[2, 1] - f[0, 1], f[1, 2] - f[1, 0]]) / (2 * step)
            H = np.empty((2, 2))
            H[0, 0], H[1, 1] = f[2, 1] + f[0, 1] - 2 * f[1, 1], f[1, 2] + f[1, 0] - 2 * f[1, 1]
            H[0, 1] = H[1, 0] = (f[2, 2] + f[0, 0] - f[2, 0] - f[0, 2]) / 4
            H /= step**2
            move = np.linalg.solve(H, -g)
            xi = xi + move
            if not np.all(np.abs(xi) < 1.4):
                break
            if np.abs(move).max() < 1e-7:
                if not any(np.linalg.norm(xi - old) < 1e-3 for old, _ in found):
                    found.append((xi, int((np.linalg.eigvalsh(H) < 0).sum())))
                break
    return found


def contours(ax, nodes, point, reach=1.3, count=26):
    """Lines of equal distance on a Q8 face and somewhat beyond it, and the edges of the face."""
    grid = np.linspace(-reach, reach, 161)
    height = np.sqrt(squares(nodes, point, np.stack(np.meshgrid(grid, grid), -1)))
    levels = np.quantile(height, np.linspace(0.002, 0.97, count))
    ax.contour(grid, grid, height, np.unique(levels), colors=GREY, linewidths=0.6)
    ax.plot(*outline("Q8").T, color="black", lw=1)
    ax.set(aspect="equal", xlim=(-reach, reach), ylim=(-reach, reach))
    ax.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    ax.grid(False)


def valleys():
    """A face with eight nodes, and lines of equal distance with all stationary points."""
    nodes = bent_face()
    figure = Figure(figsize=(7.5, 3.5))
    ax = axes_in_space(figure, 121, elev=22, azim=-60)
    draw_face(ax, "Q8", nodes)
    ax.plot(*POINT, "o", color=ORANGE, ms=7)
    ax.text(*(POINT + [0.12, 0, -0.1]), r"$\mathbf{y}_s$")
    flat = figure.add_subplot(122)
    contours(flat, nodes, POINT)
    names = (("minimum", "o", GREEN), ("saddle", "D", ORANGE), ("maximum", "s", RED))
    known = set()
    for xi, negative in stationary(nodes, POINT, 1.2):
        label, mark, colour = names[negative]
        flat.plot(*xi, mark, color=colour, ms=8, label=None if label in known else label)
        known.add(label)
        if np.abs(xi).max() <= 1:
            ax.plot(*ct.face_points("Q8", nodes, xi[None])[0], mark, color=colour, ms=6)
    best = ct.project("Q8", nodes, [POINT], method="certified").xi[0]
    flat.plot(*best, "*", color="black", ms=12, label="closest point")
    flat.set(xlabel="ξ₁", ylabel="ξ₂")
    figure.legend(loc="outside lower center", ncols=4)
    ax.set_box_aspect((2.2, 2, 1.5), zoom=1.25)
    return figure


def border():
    """A minimum inside the face, on an edge, and at a corner, with the gradient there."""
    nodes = np.column_stack([SQUARE, 0.25 * SQUARE[:, 0] ** 2 + 0.1 * SQUARE[:, 1]])
    figure = Figure(figsize=(7.5, 2.9))
    points = {
        "inside": [0.3, 0.2, 0.6],
        "on an edge": [1.5, 0.1, 0.6],
        "at a corner": [1.6, 1.4, 0.6],
    }
    for ax, (title, point) in zip(figure.subplots(1, 3, sharey=True), points.items()):
        contours(ax, nodes, np.array(point), reach=2.0, count=20)
        free = ct.project("Q8", nodes, [point], method="newton").xi[0]
        best = ct.project("Q8", nodes, [point], method="certified").xi[0]
        ax.plot(*free, "o", mfc="none", color=BLUE, ms=9)
        ax.plot(*best, "*", color=GREEN, ms=12)
        step = 1e-5 * np.eye(2)
        f = squares(nodes, point, best + np.concatenate([step, -step]))
        gradient = (f[:2] - f[2:]) / 2e-5
        if np.linalg.norm(gradient) > 1e-3:
            ax.annotate(
                "",
                best - 0.55 * gradient / np.linalg.norm(gradient),
                best,
                arrowprops={"arrowstyle": "-|>", "color": RED, "lw": 2},
            )
        ax.set(title=title, xlabel="ξ₁")
    figure.axes[0].set_ylabel("ξ₂")
    return figure
