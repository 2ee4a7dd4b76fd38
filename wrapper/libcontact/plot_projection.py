"""Pictures of projections in the plane of the reference face: lines of equal distance, the path of a method, and where it ends from each start."""

from __future__ import annotations

from typing import Any

import numpy as np

from .projection import Projection, Status, face_points, project, project_path

CORNERS = {"Q": [(-1, -1), (1, -1), (1, 1), (-1, 1)], "T": [(0, 0), (1, 0), (0, 1)]}
#: What a search may end at, and its colour in :func:`draw_starts`.
ENDS = {
    "the closest point": "#2a9d5c",
    "another point of the face": "#f0a13a",
    "outside": "#4a7fb5",
    "nowhere": "0.6",
}


def draw_levels(axes: Any, kind: str, nodes: Any, point: Any, reach: float = 1.5) -> None:
    """Lines of equal distance from the point over the reference face and a border around it, and the edges of the face."""
    x, y = _grid(kind, reach, 121)
    distance = np.linalg.norm(
        face_points(kind, nodes, np.stack([x, y], -1)) - np.asarray(point, float), axis=-1
    )
    axes.contour(
        x,
        y,
        distance,
        levels=np.quantile(distance, np.linspace(0.002, 0.9, 24)),
        colors="0.75",
        linewidths=0.6,
    )
    _outline(axes, kind, x, y)


def draw_path(
    axes: Any,
    kind: str,
    nodes: Any,
    point: Any,
    method: str,
    start: Any = None,
    tolerance: float = 1e-8,
    reach: float = 1.5,
) -> int:
    """The iterates of one search in the colour of its end (``ENDS``), a ring at their beginning, a star at the closest point; answers the evaluations."""
    draw_levels(axes, kind, nodes, point, reach)
    best = project(kind, nodes, [point]).xi[0]
    _star(axes, best)
    iterates, found = project_path(kind, nodes, point, method, tolerance, start)
    colour = list(ENDS.values())[_ends(found, best)[0]]
    axes.plot(*iterates.T, ".-", color=colour, lw=1.4, ms=5)
    axes.plot(*iterates[0], "o", color=colour, mfc="white", mew=1.4, ms=7)
    return int(found.evaluations[0])


def draw_starts(
    axes: Any,
    kind: str,
    nodes: Any,
    point: Any,
    method: str,
    tolerance: float = 1e-8,
    reach: float = 1.5,
    cells: int = 61,
) -> float:
    """Colour each start by where the search from it ends (``ENDS``); answers the share that finds the closest point."""
    x, y = _grid(kind, reach, cells)
    starts = np.stack([x, y], -1).reshape(-1, 2)
    best = project(kind, nodes, [point]).xi[0]
    found = project(
        kind,
        nodes,
        np.broadcast_to(np.asarray(point, float), (len(starts), 3)),
        method,
        tolerance,
        starts,
    )
    end = _ends(found, best)
    image = np.array([_rgb(colour) for colour in ENDS.values()])[end].reshape(*x.shape, 3)
    axes.imshow(
        image, origin="lower", extent=(x.min(), x.max(), y.min(), y.max()), interpolation="nearest"
    )
    _outline(axes, kind, x, y)
    _star(axes, best)
    return float(np.mean(end == 0))


def legend_of_ends(figure: Any) -> None:
    """The colours of :func:`draw_starts`, beneath a figure."""
    from matplotlib.patches import Patch

    figure.legend(
        handles=[Patch(color=colour, label=name) for name, colour in ENDS.items()],
        loc="outside lower center",
        ncols=len(ENDS),
        frameon=False,
    )


def _ends(found: Projection, best: np.ndarray) -> np.ndarray:
    """Number in ``ENDS`` of where each search has ended."""
    right = np.abs(found.xi - best).max(axis=1) < 1e-4
    return np.select(
        [right, found.status >= Status.NO_CONVERGENCE, found.where == "outside"], [0, 3, 2], 1
    )


def _grid(kind: str, reach: float, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Reference coordinates of a square about the face that is ``reach`` times as wide as it."""
    middle, half = (0.0, reach) if kind[0] == "Q" else (0.5, 0.5 * reach)
    return np.meshgrid(*2 * [np.linspace(middle - half, middle + half, cells)])


def _outline(axes: Any, kind: str, x: np.ndarray, y: np.ndarray) -> None:
    corners = CORNERS[kind[0]]
    axes.plot(*np.array([*corners, corners[0]]).T, "k", lw=0.9)
    ticks = [-1, 0, 1] if kind[0] == "Q" else [0, 1]
    axes.set(
        xlim=(x.min(), x.max()), ylim=(y.min(), y.max()), aspect="equal", xticks=ticks, yticks=ticks
    )


def _star(axes: Any, xi: np.ndarray) -> None:
    axes.plot(*xi, "*", color="k", mec="white", mew=0.5, ms=11)


def _rgb(colour: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
