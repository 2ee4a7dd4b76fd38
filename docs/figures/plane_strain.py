"""Picture of the chapter on plane strain."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import CORNERS, draw_edges, moduli, stiffness
from shared.drawing import BLUE, GREEN, GREY, ORANGE, axes_in_space, bare, line
from shared.faces import FACES


def layers():
    """The nodal forces of a cube that is stretched in its plane, and the displacements along ξ that are left of a
    brick."""
    young, poisson = 1.0, 0.3
    lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    nodes = 0.5 * (CORNERS + 1)
    pull = np.zeros((8, 3))
    pull[:, 0] = nodes[:, 0]
    force = -stiffness("hex8", nodes, 2, moduli(young, poisson)) @ pull.ravel()
    force = force.reshape(8, 3)
    assert np.allclose(force[nodes[:, 0] == 1, 0], -0.25 * (lame + 2 * shear))
    assert np.allclose(force[:, 1], -0.25 * lame * (2 * nodes[:, 1] - 1))
    figure = Figure(figsize=(7.5, 2.7))
    ax = axes_in_space(figure, 121, elev=22, azim=-66)
    draw_edges(ax, nodes, ls=":")
    moved = nodes + 0.25 * pull
    draw_edges(ax, moved)
    ax.plot(*moved.T, "o", color="black", ms=4)
    for node, f in zip(moved, force):
        for axis, colour in ((0, BLUE), (1, ORANGE), (2, GREEN)):
            along = 1.3 * f * np.eye(3)[axis]
            ax.quiver(*node, *along, color=colour, arrow_length_ratio=0.2, lw=1.8)
    ax.set_box_aspect((1.3, 1, 1), zoom=1.15)
    xi, _, zeta = CORNERS[[0, 1, 5, 4]].T
    for place, mode, name in ((4, xi, "ξ"), (5, zeta, "ζ"), (6, zeta * xi, "ζξ")):
        flat = figure.add_subplot(1, 6, place)
        for shift, colour, width in ((0.0, GREY, 0.8), (0.3, ORANGE, 1.8)):
            square = FACES["Q4"] + shift * np.outer(mode, [1, 0])
            for a, b in zip(square, np.roll(square, -1, axis=0)):
                line(flat, a, b, color=colour, lw=width)
        flat.set_title(f"$u_x$ = {name}")
        bare(flat, (-1.4, 1.4), (-1.3, 1.3))
    return figure
