"""Pictures of projections in the plane of the reference face: lines of equal distance, the path of a method, and where
it ends from each start."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..projection import Projection, Status, face_points, project, project_path

Array = npt.NDArray[np.float64]
CORNERS = {"Q": [(-1, -1), (1, -1), (1, 1), (-1, 1)], "T": [(0, 0), (1, 0), (0, 1)]}
#: Where a search may end, and its colour in :func:`draw_starts`.
ENDS = {
    "the closest point": "#2a9d5c",
    "another point of the face": "#f0a13a",
    "outside": "#4a7fb5",
    "nowhere": "0.6",
}
COLOURS = list(ENDS.values())


def draw_path(
    axes: Any,
    kind: str,
    nodes: npt.ArrayLike,
    point: npt.ArrayLike,
    method: str,
    start: npt.ArrayLike | None = None,
    tolerance: float = 1e-8,
    reach: float = 1.5,
) -> int:
    """
    Draw the iterates of one search in the colour of its end (``ENDS``), over lines of equal distance from the point.

    A ring is at their beginning, a star at the closest point.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    kind : str
        Kind of the face, such as ``"Q8"``.
    nodes : array_like, shape (n, 3)
        Nodes of the face.
    point : array_like, shape (3,)
        The point that is projected.
    method : str
        Method of the projection.
    start : array_like, shape (2,), optional
        Where the search begins.
    tolerance : float
        Tolerance of the method.
    reach : float
        Width of the picture over that of the face.

    Returns
    -------
    int
        How often the method evaluated the distance.
    """
    x, y = _grid(kind, reach, 121)
    points = face_points(kind, nodes, np.stack([x, y], -1))
    distance = np.linalg.norm(points - np.asarray(point, float), axis=-1)
    levels = np.quantile(distance, np.linspace(0.002, 0.9, 24))
    axes.contour(x, y, distance, levels=levels, colors="0.5", alpha=0.45, linewidths=0.6)
    best = _finish(axes, kind, nodes, point, x, y)
    iterates, found = project_path(kind, nodes, point, method, tolerance, start)
    colour = COLOURS[_ends(found, best)[0]]
    axes.plot(*iterates.T, ".-", color=colour, lw=1.4, ms=5)
    axes.plot(*iterates[0], "o", color=colour, mfc="none", mew=1.4, ms=7)
    return int(found.evaluations[0])


def draw_starts(
    axes: Any,
    kind: str,
    nodes: npt.ArrayLike,
    point: npt.ArrayLike,
    method: str,
    tolerance: float = 1e-8,
    reach: float = 1.5,
    cells: int = 61,
) -> float:
    """
    Colour each start by where the search from it ends (``ENDS``).

    Parameters
    ----------
    axes, kind, nodes, point, method, tolerance, reach
        As in :func:`draw_path`.
    cells : int
        Starts along each side of the picture.

    Returns
    -------
    float
        The fraction of the starts from which the closest point is found.
    """
    from matplotlib.colors import to_rgb

    x, y = _grid(kind, reach, cells)
    starts = np.stack([x, y], -1).reshape(-1, 2)
    points = np.broadcast_to(np.asarray(point, float), (len(starts), 3))
    found = project(kind, nodes, points, method, tolerance, starts)
    best = _finish(axes, kind, nodes, point, x, y)
    end = _ends(found, best)
    image = np.array([to_rgb(colour) for colour in COLOURS])[end].reshape(*x.shape, 3)
    extent = (x.min(), x.max(), y.min(), y.max())
    axes.imshow(image, origin="lower", extent=extent, interpolation="nearest")
    return float(np.mean(end == 0))


def legend_of_ends(figure: Any) -> None:
    """Put the colours of :func:`draw_starts` beneath a figure."""
    from matplotlib.patches import Patch

    handles = [Patch(color=colour, label=name) for name, colour in ENDS.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(ENDS), frameon=False)


def _ends(found: Projection, best: Array) -> npt.NDArray[np.int_]:
    """Number in ``ENDS`` of where each search has ended."""
    right = np.abs(found.xi - best).max(axis=1) < 1e-4
    ended = [right, found.status >= Status.NO_CONVERGENCE, found.where == "outside"]
    return np.select(ended, [0, 3, 2], 1)


def _grid(kind: str, reach: float, cells: int) -> tuple[Array, Array]:
    """Reference coordinates of a square about the face that is ``reach`` times as wide as it."""
    middle, half = (0.0, reach) if kind[0] == "Q" else (0.5, 0.5 * reach)
    line = np.linspace(middle - half, middle + half, cells)
    x, y = np.meshgrid(line, line)
    return x, y


def _finish(axes: Any, kind: str, nodes: Any, point: Any, x: Array, y: Array) -> Array:
    """Draw the edges of the face and a star at the closest point, and return the latter."""
    best = np.asarray(project(kind, nodes, [point]).xi[0])
    corners = CORNERS[kind[0]]
    axes.plot(*np.array([*corners, corners[0]]).T, "k", lw=0.9)
    axes.plot(*best, "*", color="k", mec="white", mew=0.5, ms=11)
    ticks = [-1, 0, 1] if kind[0] == "Q" else [0, 1]
    limits = {"xlim": (x.min(), x.max()), "ylim": (y.min(), y.max())}
    axes.set(**limits, aspect="equal", xticks=ticks, yticks=ticks)
    return best
