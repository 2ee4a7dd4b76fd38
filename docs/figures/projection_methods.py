"""Pictures of the chapter on the methods of projection."""

import numpy as np
from libcontact.pictures.plot_projection import draw_path, draw_starts, legend_of_ends
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, ORANGE, RED, VIOLET
from shared.faces import POINT, SQUARE, bent_face

import libcontact as ct

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
    nodes, point = bent_face(), POINT
    figure = Figure(figsize=(7.5, 4.4))
    for ax, method in zip(figure.subplots(2, 4, sharex=True, sharey=True).flat, PATHS):
        count = draw_path(ax, "Q8", nodes, point, method, start=(-0.2, 0.7))
        ax.set_title(f"{method}: {count}", fontsize=9)
        ax.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1])
        ax.grid(False)
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
