"""Picture of the chapter on the projection along a line."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
from shared.faces import SQUARE, bent_face, coefficients, derivatives

import libcontact as ct


def rays():
    """A gap along a line and the distance; the curves whose crossings are the hits, with the squares of the search."""
    figure = Figure(figsize=(7.5, 3.3))
    side, flat = figure.subplots(1, 2)
    x = np.linspace(-1.2, 1.5, 200)
    bend = lambda s: 0.35 * s**2
    side.plot(x, bend(x), color="black", lw=2)
    point, direction = np.array([0.2, 0.9]), np.array([0.55, -1.0])
    roots = np.roots(
        [0.35, -direction[1] / direction[0], direction[1] / direction[0] * point[0] - point[1]]
    )
    hit = min((r for r in roots.real), key=lambda r: abs(r - point[0]))
    near = x[((np.column_stack([x, bend(x)]) - point) ** 2).sum(1).argmin()]
    for end, colour, name in ((near, BLUE, "closest point"), (hit, ORANGE, "along the line")):
        side.plot([point[0], end], [point[1], bend(end)], color=colour)
        side.plot(end, bend(end), "o", color=colour, ms=8, label=name)
    side.plot(*point, "o", color="black", ms=8)
    side.set(aspect="equal", xlim=(-1.2, 1.6), ylim=(-0.2, 1.3))
    side.set_axis_off()
    side.legend(loc="upper left", bbox_to_anchor=(0.0, 1.15))
    nodes, start, e = bent_face(), np.array([-1.5, 0.2, 0.72]), np.array([1.0, 0.05, -0.05])
    e /= np.linalg.norm(e)
    u1 = np.cross(e, [0, 0, 1])
    u1 /= np.linalg.norm(u1)
    u = np.array([u1, np.cross(e, u1)])
    c = coefficients(nodes, start)
    grid = np.linspace(-1, 1, 161)
    points = ct.face_points("Q8", nodes, np.stack(np.meshgrid(grid, grid), -1)) - start
    stack, cut = [(np.zeros(2), 1.0)], []
    while stack:
        centre, w = stack.pop()
        d, t1, t2, *_ = derivatives(c, centre)
        G, J = u @ d, np.column_stack([u @ t1, u @ t2])
        p = np.abs(u @ c.T)
        bends = 2 * (p[:, 4] + p[:, 6]) + 2 * (p[:, 5] + p[:, 7])
        spread = 0.5 * (bends + 2 * (p[:, 3] + 2 * (p[:, 6] + p[:, 7]))) * w**2
        inverse = np.linalg.inv(J)
        empty = np.any(np.abs(G) > np.abs(J).sum(axis=1) * w + spread)
        empty |= np.any(np.abs(inverse @ G) > w + np.abs(inverse) @ spread)
        single = np.max(2 / w * np.abs(inverse) @ spread) < 0.5
        if empty or single:
            cut.append((centre, w, empty))
        else:
            stack += [(centre + w / 2 * np.array(s), w / 2) for s in SQUARE[:4]]
    for centre, w, empty in cut:
        corner = centre + w * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        colour = "none" if empty else GREEN
        flat.fill(*corner.T, facecolor=colour, alpha=0.35, edgecolor=GREY, lw=0.5)
    for i, colour in ((0, BLUE), (1, ORANGE)):
        flat.contour(grid, grid, points @ u[i], [0.0], colors=colour, linewidths=1.6)
    hit = ct.project_ray("Q8", nodes, [start], [e])
    flat.plot(*hit.xi[0], "*", color="black", ms=11)
    flat.set(xlabel="ξ₁", ylabel="ξ₂", aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    flat.grid(False)
    return figure
