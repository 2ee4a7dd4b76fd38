"""
Functions that draw into axes of matplotlib; they shorten the programs of the tutorials.

:func:`libcontact.pictures.picture.plot_run` draws the picture of a run. All need the extra ``plot``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import exact
from ..state import BodyState

Array = npt.NDArray[np.float64]
# Colour, line and name of each kind of wave front.
FRONTS = {
    "plane_p": ("k", "-", "plane P"),
    "circular_p": ("k", "--", "circular P"),
    "circular_s": ("tab:purple", "--", "circular S"),
    "head": ("tab:green", "-", "head waves"),
    "rayleigh": ("tab:orange", "o", "Rayleigh"),
}


def draw_curves(
    axes: Any, curves: Mapping[str, Sequence[Any]], legend: str | None = "best", **settings: Any
) -> None:
    """
    Draw curves with a grid and a legend.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    curves : dict
        ``{label: (x, y)}`` or ``{label: (x, y, style)}`` with a style of matplotlib such as ``"C3--"``. A
        label that begins with ``_`` is left out of the legend.
    legend : str, optional
        Place of the legend; ``None``: no legend; ``"below"``: under the whole figure.
    **settings
        For ``axes.set``: ``xlabel``, ``ylabel``, ``xlim``, ``title`` and so on.
    """
    for label, (x, y, *style) in curves.items():
        axes.plot(x, y, *style, lw=1.2, ms=4, label=label)
    axes.set(**settings)
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    if legend == "below":
        axes.figure.legend(loc="outside lower center", fontsize=9, frameon=False)
    elif legend:
        axes.legend(loc=legend, fontsize=9, frameon=False)


def draw_fronts(axes: Any, t: float, nu: float = 0.3) -> None:
    """
    Draw the wave fronts of the plate impact in all four quarters.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes, in units of half the thickness of a plate.
    t : float
        The time c1 t / d.
    nu : float
        Poisson's ratio.
    """
    for kind, curves in exact.fronts(t, nu).items():
        colour, style, label = FRONTS[kind]
        for i, (x, z) in enumerate(curve.T for curve in curves):
            for side in (1, -1):
                name = label if i == 0 and side == 1 else None
                look = {"color": colour, "lw": 1.2, "ms": 7, "mec": "k", "label": name}
                axes.plot(side * x, z, style, clip_on=style != "o", **look)


def draw_faces(
    axes: Any,
    body: BodyState,
    face: str,
    values: npt.ArrayLike,
    limits: tuple[float, float],
    scale: float = 1.0,
    turn: npt.ArrayLike = ((1.0, 0.0), (0.0, 1.0)),
    **options: Any,
) -> Any:
    """
    Draw one face of a body, deformed, coloured by values of its elements.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    body : BodyState
        The body.
    face : str
        Name of the face, such as ``"y_min"``: the picture shows the two other axes.
    values : array_like, shape (elements,)
        The colours.
    limits : tuple of float
        The values at the two ends of the colours.
    scale : float
        Magnification of the displacement.
    turn : array_like, shape (2, 2)
        Matrix that the two coordinates are multiplied with from the right, such as a mirror.
    **options
        For ``PolyCollection``: ``cmap``, ``linewidths`` and so on.

    Returns
    -------
    matplotlib.collections.PolyCollection
        The faces, for a colour bar.
    """
    from matplotlib.collections import PolyCollection

    faces, owners = body.mesh.faces(face)
    corners = (body.nodes + scale * body.displacement)[faces[:, :4]]
    flat = np.delete(corners, "xyz".index(face[0]), axis=2) @ np.asarray(turn, float)
    options = {"cmap": "RdBu_r", "edgecolors": "k", "linewidths": 0.3, **options}
    patches = PolyCollection(list(flat), array=np.asarray(values)[owners], **options)
    patches.set_clim(*limits)
    axes.add_collection(patches)
    axes.autoscale_view()
    axes.set_aspect("equal")
    return patches


def draw_bar_in_time(
    axes: Any, times: Array, places: Array, values: Array, limit: float, upright: bool = False
) -> Any:
    """
    Draw the cells of a bar at each time, coloured by a value.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    times : ndarray, shape (n,)
        The times.
    places : ndarray, shape (n, cells + 1)
        Where the ends of the cells are.
    values : ndarray, shape (n, cells)
        The colours.
    limit : float
        The colours reach from minus to plus this value.
    upright : bool
        Whether time runs to the right, else up.

    Returns
    -------
    matplotlib.collections.QuadMesh
        The cells, for a colour bar.
    """
    between = (places[1:] + places[:-1]) / 2
    x = np.vstack([places[:1], between, places[-1:]])
    first = times[0] - (times[1] - times[0]) / 2
    borders = np.concatenate([[first], (times[1:] + times[:-1]) / 2, times[-1:]])
    t = np.broadcast_to(borders[:, None], x.shape)
    look = {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit, "rasterized": True}
    return axes.pcolormesh(*((t, x) if upright else (x, t)), values, **look)


def draw_map(
    axes: Any, values: Array, dots: Array, rows: Sequence[float], columns: Sequence[float]
) -> Any:
    """
    Draw a table of fractions as a map with a logarithmic scale of colours, from 0.01 % to 1000 %.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    values : ndarray, shape (rows, columns)
        The fractions; those above 1 % stand in their cells.
    dots : ndarray of bool, shape (rows, columns)
        Cells that get a dot.
    rows, columns : sequence of float
        What stands beside each row and under each column.

    Returns
    -------
    matplotlib.image.AxesImage
        The map.
    """
    shown = np.log10(np.maximum(values, 1e-4))
    look = {"origin": "lower", "aspect": "auto", "cmap": "YlOrRd", "vmin": -4, "vmax": 1}
    image = axes.imshow(shown, **look)
    axes.plot(*np.nonzero(dots)[::-1], "k.", ms=4)
    for i, j in zip(*np.nonzero(values > 0.01)):
        text = f"{100 * values[i, j]:.0f} %"
        axes.text(j, i + 0.22, text, ha="center", va="center", fontsize=8.5)
    axes.set_xticks(range(len(columns)), columns)
    axes.set_yticks(range(len(rows)), rows)
    bar = axes.figure.colorbar(image, ax=axes, ticks=range(-4, 2))
    bar.ax.set_yticklabels(["≤ 0.01 %", "0.1 %", "1 %", "10 %", "100 %", "1000 %"])
    return image
