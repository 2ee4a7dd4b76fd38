"""A picture of a run: one field on the deformed mesh, viewed along the thinnest direction, and the
energies over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .run import COMPONENTS, BodyState, Run

Array = npt.NDArray[np.float64]
# Corners and mid-sides of a Q8 face in the order in which one walks around it.
AROUND = {4: [0, 1, 2, 3], 8: [0, 4, 1, 5, 2, 6, 3, 7]}
QUANTITY = {
    "stress": "stress",
    "displacement": "length",
    "velocity": "velocity",
    "contact_pressure": "stress",
}


def picture(run: Run, path: str | Path, field: str = "stress_xx", scale: float = 1.0) -> None:
    """
    Draw a component and the energies into an image file.

    Parameters
    ----------
    run : Run
        The run; its last state is drawn.
    path : str or Path
        The image file.
    field : str
        The component, such as ``stress_xx`` or ``velocity_z``.
    scale : float
        Magnification of the displacement.

    Raises
    ------
    ValueError
        If the run has no such component.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    shape = {"figsize": (8, 8), "height_ratios": [2, 1], "layout": "constrained"}
    figure, (above, below) = pyplot.subplots(2, 1, **shape)
    try:
        draw_field(above, run, field, scale)
        draw_energies(below, run)
        figure.savefig(path, dpi=150)
    finally:
        pyplot.close(figure)


def thinnest(run: Run) -> int:
    """Return the axis along which all bodies together are thinnest."""
    nodes = np.concatenate([body.nodes for body in _bodies(run)])
    return int(np.argmin(np.ptp(nodes, axis=0)))


def draw_field(axes: Any, run: Run, field: str, scale: float = 1.0) -> Any:
    """
    Draw the outer faces that the viewer sees, coloured by a component.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    run : Run
        The run; its last state is drawn.
    field : str
        The component: the value of a face's element, or the mean of its nodes.
    scale : float
        Magnification of the displacement.

    Returns
    -------
    matplotlib.collections.PolyCollection
        The faces.
    """
    from matplotlib.collections import PolyCollection

    axis = thinnest(run)
    across, up = (a for a in range(3) if a != axis)
    # The viewer stands where x or z is large, or y is small: so the two other axes run to the right and up.
    toward = -1.0 if axis == 1 else 1.0
    polygons: list[Array] = []
    values: list[Array] = []
    depths: list[Array] = []
    for body in _bodies(run):
        corners, colours = _faces(body, field, scale)
        a, b, c, d = (corners[:, k * (corners.shape[1] // 4)] for k in range(4))
        seen = toward * np.cross(c - a, d - b)[:, axis] > 0.0
        polygons += list(corners[seen][:, :, [across, up]])
        values.append(colours[seen])
        depths.append(toward * corners[seen][:, :, axis].mean(axis=1))
    order = np.argsort(np.concatenate(depths), kind="stable")
    style = {"linewidths": 0.4, "edgecolors": "face", "antialiaseds": False, "rasterized": True}
    faces, colours = [polygons[i] for i in order], np.concatenate(values)[order]
    patches = PolyCollection(faces, array=colours, **style)
    axes.add_collection(patches)
    axes.autoscale_view()
    length, unit = _unit(run, "length"), _unit(run, QUANTITY[COMPONENTS[field][0]])
    title = f"{field} at t = {run.state.time:.6g}" if run.state else field
    axes.set(xlabel="xyz"[across] + length, ylabel="xyz"[up] + length, title=title, aspect="equal")
    bar = {"location": "bottom", "aspect": 40, "shrink": 0.8}
    axes.figure.colorbar(patches, ax=axes, label=field + unit, **bar)
    return patches


def draw_energies(axes: Any, run: Run) -> None:
    """
    Draw kinetic, strain, contact and external energy and their total over time.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    run : Run
        The run.
    """
    for name in ("kinetic", "strain", "contact", "external", "total"):
        axes.plot(run.time, run.energy[name], "--" if name == "total" else "-", label=name)
    axes.set(xlabel="t" + _unit(run, "time"), ylabel="energy" + _unit(run, "energy"))
    axes.grid(alpha=0.3)
    place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "frameon": False}
    axes.legend(ncols=5, fontsize="small", **place)


def _bodies(run: Run) -> list[BodyState]:
    return list(run.state.values()) if run.state else []


def _faces(body: BodyState, field: str, scale: float) -> tuple[Array, Array]:
    """Corners (faces, 4 or 8, 3) of the outer faces, deformed if the displacement is known, in walking order, and a value for each."""
    faces, owners = body.mesh.faces("outer")
    values, at_elements = body.component(field)
    positions = body.nodes + scale * body.displacement if body.holds("displacement") else body.nodes
    around = faces[:, AROUND[faces.shape[1]]]
    return positions[around], values[owners] if at_elements else values[faces].mean(axis=1)


def _unit(run: Run, quantity: str) -> str:
    return f" [{run.units.label(quantity)}]" if run.units else ""
