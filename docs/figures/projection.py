"""Pictures of the chapters on faces, rules, closest points and the search for them."""

import sys
from pathlib import Path

import numpy as np
from libcontact.plot_projection import draw_starts, legend_of_ends
from matplotlib.figure import Figure

import libcontact as ct

sys.path.insert(0, str(Path(__file__).resolve().parent))
from method import SQUARE, arrow, bent_face, draw_face, outline, solid_axes  # noqa: E402

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
    ax = solid_axes(figure, 121, elev=22, azim=-60)
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


def basins():
    """Where three methods end from every start."""
    figure = Figure(figsize=(7.5, 3.1))
    for ax, method in zip(figure.subplots(1, 3, sharey=True), ("newton", "simplex", "bfgs")):
        found = draw_starts(ax, "Q8", bent_face(), POINT, method, cells=121)
        ax.set_title(f"{method}: {100 * found:.0f} %")
        ax.set_xlabel("ξ₁")
        ax.grid(False)
    figure.axes[0].set_ylabel("ξ₂")
    legend_of_ends(figure)
    return figure


def ordinary_faces(count=200):
    """Slightly bent Q8 faces at random, and a point near each."""
    random = np.random.default_rng(5)
    flat = np.column_stack([SQUARE, np.zeros(8)])
    for _ in range(count):
        yield (
            flat + random.uniform(-0.1, 0.1, (8, 3)),
            [*random.uniform(-0.6, 0.6, 2), random.uniform(-0.4, 0.4)],
        )


def cost():
    """Evaluations over the tolerance, the median of all faces, for each method."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = figure.subplots()
    faces_and_points = list(ordinary_faces(80))
    tolerances = 10.0 ** -np.arange(1, 11)
    styles = {
        "simplex": (ORANGE, "-", "o"),
        "nelder_mead": (ORANGE, "--", "s"),
        "simplex_newton": (ORANGE, ":", "D"),
        "steepest_descent": (RED, "-", "o"),
        "bfgs": (RED, "--", "s"),
        "broyden": (VIOLET, "-", "o"),
        "least_squares": (GREEN, "-", "o"),
        "newton": (BLUE, "-", "o"),
        "robust": ("black", "-", "s"),
    }
    for method, (colour, line, mark) in styles.items():
        looks = [
            np.median(
                [
                    ct.project("Q8", nodes, [point], method=method, tolerance=t).evaluations[0]
                    for nodes, point in faces_and_points
                ]
            )
            for t in tolerances
        ]
        ax.loglog(tolerances, looks, line, marker=mark, ms=4, color=colour, label=method)
    ax.invert_xaxis()
    ax.set(xlabel="tolerance", ylabel="evaluations", yticks=[3, 10, 30, 100, 300])
    ax.set_yticklabels(["3", "10", "30", "100", "300"])
    ax.legend(bbox_to_anchor=(1.0, 1.0), loc="upper left")
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
        gaps, np.sqrt(2.2e-16) * gaps, "-", color="black", lw=1, label=r"$\sqrt{\epsilon}\,g_n/h$"
    )
    ax.set(xlabel="gap / half-width of the face", ylabel="error of ξ")
    ax.legend()
    return figure


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


def models():
    """A section of a bent face, its tangent and its circle of curvature at an iterate, and where each leads."""
    figure = Figure(figsize=(6.4, 3.3))
    ax = figure.subplots()
    bend, at, point = 0.8, 0.9, np.array([0.0, 0.8])
    x = np.linspace(-1.1, 1.6, 200)
    ax.plot(x, bend * x**2 / 2, color="black", lw=2)
    y = np.array([at, bend * at**2 / 2])
    tangent = np.array([1.0, bend * at]) / np.hypot(1.0, bend * at)
    normal = np.array([-tangent[1], tangent[0]])
    radius = (1 + (bend * at) ** 2) ** 1.5 / bend
    flat = y + ((point - y) @ tangent) * tangent
    centre = y + radius * normal
    away = (point - centre) / np.linalg.norm(point - centre)
    round_ = centre + radius * away
    ax.plot(*(y + np.outer([-1.6, 0.9], tangent)).T, color=GREEN, lw=1.2, label="tangent")
    angle = np.linspace(-0.95, 0.5, 100)
    circle = centre + radius * (np.outer(np.sin(angle), tangent) - np.outer(np.cos(angle), normal))
    ax.plot(*circle.T, color=BLUE, lw=1.2, label="circle")
    for end, mark, colour in ((flat, "s", GREEN), (round_, "^", BLUE), ([0, 0], "*", "black")):
        ax.plot(*np.array([point, end]).T, "--", color=colour, lw=0.9)
        ax.plot(*end, mark, color=colour, ms=11 if mark == "*" else 8)
    ax.plot(*y, "o", mfc="none", color="black", ms=9)
    ax.plot(*point, "o", color=ORANGE, ms=8)
    ax.set(aspect="equal", ylim=(-0.75, 1.15), xlim=(-1.1, 1.6))
    ax.set_axis_off()
    ax.legend(loc="lower right")
    return figure


def trust():
    """The lowest point of a quadratic model inside a box of allowed steps, in three cases."""
    figure = Figure(figsize=(7.5, 2.7))
    cases = (
        ("allowed", [[2.0, 0.4], [0.4, 1.2]], [-0.8, 0.4]),
        ("cut by a side", [[2.0, 0.9], [0.9, 1.2]], [-2.8, -0.4]),
        ("at a saddle", [[2.0, 0.5], [0.5, -1.0]], [0.0, 0.0]),
    )
    grid = np.linspace(-1.6, 1.6, 321)
    steps = np.stack(np.meshgrid(grid, grid), -1)
    box = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    for ax, (title, hessian, gradient) in zip(figure.subplots(1, 3), cases):
        model = steps @ gradient + 0.5 * np.einsum("xyi,ij,xyj->xy", steps, hessian, steps)
        ax.contour(grid, grid, model, 22, colors=GREY, linewidths=0.6)
        inside = np.where(np.abs(steps).max(-1) <= 1 + 1e-9, model, np.inf)
        lowest_ = np.argwhere(inside <= inside.min() + 1e-9)
        ax.plot(*box.T, color="black", lw=1.2)
        ax.plot(0, 0, "o", mfc="none", color=BLUE, ms=9)
        for i, j in lowest_:
            ax.plot(grid[j], grid[i], "*", color=GREEN, ms=12)
        ax.set(title=title, aspect="equal", xlabel="s₁", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
        ax.grid(False)
    figure.axes[0].set_ylabel("s₂")
    return figure


def coefficients(nodes, point):
    """The vectors c_0 to c_7 of a Q8 face as seen from the point, by solving for them."""
    powers = lambda xi: np.stack(
        [
            np.ones(len(xi)),
            xi[:, 0],
            xi[:, 1],
            xi[:, 0] * xi[:, 1],
            xi[:, 0] ** 2,
            xi[:, 1] ** 2,
            xi[:, 0] ** 2 * xi[:, 1],
            xi[:, 0] * xi[:, 1] ** 2,
        ],
        axis=1,
    )
    return np.linalg.solve(powers(SQUARE), nodes - point)


def derivatives(c, xi):
    """d, the tangents, and the second derivatives 11, 22, 12 at one point."""
    x, y = xi
    d = c[0] + c[1] * x + c[2] * y + c[3] * x * y + c[4] * x**2 + c[5] * y**2
    d = d + c[6] * x**2 * y + c[7] * x * y**2
    t1 = c[1] + c[3] * y + 2 * c[4] * x + y * (2 * c[6] * x + c[7] * y)
    t2 = c[2] + c[3] * x + 2 * c[5] * y + x * (c[6] * x + 2 * c[7] * y)
    return d, t1, t2, 2 * (c[4] + c[6] * y), 2 * (c[5] + c[7] * x), c[3] + 2 * (c[6] * x + c[7] * y)


def secant_bound(c, base, centre, w):
    """Gradient at the base, and the quadratic form that lies below f on the piece (certified-spread)."""
    d, t1, t2, t11, t22, t12 = derivatives(c, base)
    x, y = centre - base
    a1 = t1 + (x * t11 + y * t12) / 2 + x * y * c[6]
    a2 = t2 + (y * t22 + x * t12) / 2 + x * y * c[7]
    v = abs(x) * w + abs(y) * w + w * w
    m11 = a1 @ a1 + d @ (t11 + 2 * c[6] * y)
    m22 = a2 @ a2 + d @ (t22 + 2 * c[7] * x)
    m12 = a1 @ a2 + d @ t12
    m11 -= abs(a1 @ t11) * w + abs(a1 @ t12 + 2 * d @ c[6]) * w + 2 * abs(a1 @ c[6]) * v
    m22 -= abs(a2 @ t22) * w + abs(a2 @ t12 + 2 * d @ c[7]) * w + 2 * abs(a2 @ c[7]) * v
    spread = abs(a1 @ t22 + a2 @ t12) / 2 * w + abs(a1 @ t12 + a2 @ t11) / 2 * w
    spread += abs(a1 @ c[7] + a2 @ c[6]) * v
    g = 2 * np.array([d @ t1, d @ t2])
    return d @ d, g, m11, m22, abs(m12) + spread


def pieces(c, best, target):
    """The pieces of a face, each with the bound that settles it: 0 from the closest point, 1 from its own centre."""
    stack, done = [(np.zeros(2), 1.0)], []
    while stack:
        centre, w = stack.pop()
        _, _, m11, m22, twist = secant_bound(c, best, centre, w)
        if m11 >= 0 and m22 >= 0 and m11 * m22 >= twist**2:
            done.append((centre, w, 0))
            continue
        f, g, m11, m22, twist = secant_bound(c, centre, centre, w)
        worst = (m11 + m22) / 2 - np.hypot((m11 - m22) / 2, twist)
        if f - np.abs(g).sum() * w + min(worst, 0) * 2 * w**2 >= target:
            done.append((centre, w, 1))
            continue
        stack += [(centre + w / 2 * np.array(s), w / 2) for s in SQUARE[:4]]
        assert len(done) < 3000
    return done


def certificate():
    """A section of f with the parabola below it, and the pieces of a face with their bounds."""
    nodes = bent_face()
    best = ct.project("Q8", nodes, [POINT], method="certified").xi[0]
    c = coefficients(nodes, POINT)
    lowest_ = squares(nodes, POINT, best)
    target = (np.sqrt(lowest_) - 1e-6) ** 2
    figure = Figure(figsize=(7.5, 3.4))
    section, flat = figure.subplots(1, 2)
    across = np.linspace(-1, 1, 200)
    along = np.column_stack([across, np.full(200, best[1])])
    section.plot(across, squares(nodes, POINT, along), color="black", label="f")
    centre, w = np.array([0.75, best[1]]), 0.25
    f0, g, m11, _, _ = secant_bound(c, best, centre, w)
    x = np.linspace(0.5, 1, 50)
    bound = f0 + g[0] * (x - best[0]) + m11 * (x - best[0]) ** 2
    section.plot(x, bound, color=BLUE, label="from the closest point")
    centre = np.array([0.25, best[1]])
    f1, g, m11, _, _ = secant_bound(c, centre, centre, w)
    x = np.linspace(0, 0.5, 50)
    section.plot(
        x,
        f1 + g[0] * (x - centre[0]) + m11 * (x - centre[0]) ** 2,
        color=ORANGE,
        label="from the centre",
    )
    section.axhline(target, color=GREY, ls="--", lw=1, label="target")
    section.set(xlabel="ξ₁", ylabel="f", ylim=(0.8 * lowest_, 1.6 * lowest_))
    section.legend(fontsize=9)
    for centre, w, kind in pieces(c, best, target):
        corner = centre + w * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        colour = (BLUE, ORANGE)[kind]
        flat.fill(*corner.T, facecolor=colour, alpha=0.45, edgecolor="black", lw=0.4)
    flat.plot(*best, "*", color="black", ms=12)
    flat.set(xlabel="ξ₁", ylabel="ξ₂", aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    flat.grid(False)
    return figure


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


def lanes():
    """Evaluations in three blocks of eight lanes."""
    figure = Figure(figsize=(7.5, 2.6))
    random = np.random.default_rng(11)
    flat = np.column_stack([SQUARE, np.zeros(8)])
    for ax, title in zip(
        figure.subplots(1, 3, sharey=True, sharex=True), ("block 1", "block 2", "block 3")
    ):
        looks = []
        for _ in range(8):
            nodes = flat + random.uniform(-0.2, 0.2, (8, 3))
            point = [*random.uniform(-0.9, 0.9, 2), random.uniform(-0.3, 0.3)]
            looks.append(ct.project("Q8", nodes, [point]).evaluations[0])
        ax.barh(range(1, 9), looks, color=BLUE)
        ax.plot([0, max(looks), max(looks), 0, 0], [0.4, 0.4, 8.6, 8.6, 0.4], color="black", lw=1)
        ax.set(title=title, xlabel="evaluations", yticks=[1, 4, 8])
        ax.grid(False)
    figure.axes[0].set_ylabel("lane")
    return figure
