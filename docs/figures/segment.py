"""Pictures of the chapter on faces."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, arrow_in_space, axes_in_space
from shared.faces import ARCH, FACES, SQUARE, draw_face, outline

import libcontact as ct


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


def mapping():
    """The reference square, and the curved face that it becomes."""
    figure = Figure(figsize=(7.5, 3.0))
    flat = figure.add_subplot(121)
    nodes = ARCH
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
    ax = axes_in_space(figure, 122, elev=30, azim=-62)
    draw_face(ax, "Q8", nodes)
    edge = ct.face_points("Q8", nodes, cell)
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    ax.add_collection3d(Poly3DCollection([edge], facecolor=ORANGE, alpha=0.8))
    step = 1e-5
    near = ct.face_points("Q8", nodes, low + step * np.array([[0, 0], [1, 0], [0, 1]]))
    tangents = (near[1:] - near[0]) / step
    normal = np.cross(*tangents)
    for along, name in zip(tangents, (r"$\mathbf{t}_1$", r"$\mathbf{t}_2$")):
        arrow_in_space(ax, near[0], 0.6 * along, name, GREEN)
    arrow_in_space(ax, near[0], 0.75 * normal / np.linalg.norm(normal), r"$\mathbf{n}$", BLUE)
    ax.set_box_aspect((3, 3, 1.7))
    figure.set_layout_engine("none")
    flat.set_position([0.08, 0.17, 0.32, 0.76])
    ax.set_position([0.40, -0.26, 0.66, 1.5])
    return figure
