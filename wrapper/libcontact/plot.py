"""A picture of a run: one field over the deformed mesh, seen along the thinnest direction, and the energies over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .mesh import Mesh
from .run import BodyState, Run

# Corners and mid-sides of a Q8 face in the order in which one walks around it.
AROUND = {4: [0, 1, 2, 3], 8: [0, 4, 1, 5, 2, 6, 3, 7]}


def picture(run: Run, path: str | Path, field: str = "stress_xx", scale: float = 1.0) -> None:
    """Draw one component (``stress_xx``, ``velocity_z``, ...) and the energies into an image file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (above, below) = pyplot.subplots(
        2, 1, figsize=(8, 8), height_ratios=[2, 1], layout="constrained"
    )
    try:
        draw_field(above, run, field, scale)
        draw_energies(below, run)
        figure.savefig(path, dpi=150)
    except KeyError as error:
        raise ValueError(str(error)) from None
    finally:
        pyplot.close(figure)


def thinnest(run: Run) -> int:
    """Axis along which all bodies together are thinnest."""
    low = np.min([body.nodes.min(axis=0) for body in run.state.values()], axis=0)
    high = np.max([body.nodes.max(axis=0) for body in run.state.values()], axis=0)
    return int(np.argmin(high - low))


def draw_field(axes: Any, run: Run, field: str, scale: float = 1.0) -> Any:
    """Outer faces that look at the viewer, coloured by the component of their element, or the mean of their nodes."""
    from matplotlib.collections import PolyCollection

    axis = thinnest(run)
    across, up = [a for a in range(3) if a != axis]
    polygons, values, depths = [], [], []
    for body in run.state.values():
        corners, colours = _faces(body, field, scale)
        seen = _normal_along(corners, axis) > 0.0
        polygons += list(corners[seen][:, :, [across, up]])
        values.append(colours[seen])
        depths.append(_toward(axis) * corners[seen][:, :, axis].mean(axis=1))
    order = np.argsort(np.concatenate(depths), kind="stable")
    patches = PolyCollection(
        [polygons[i] for i in order],
        array=np.concatenate(values)[order],
        cmap="viridis",
        linewidths=0.4,
        edgecolors="face",
        antialiaseds=False,
        rasterized=True,
    )
    axes.add_collection(patches)
    axes.autoscale_view()
    axes.set_aspect("equal")
    length, unit = (f" [{run.units.length}]", _unit(run, field)) if run.units else ("", "")
    axes.set(
        xlabel="xyz"[across] + length,
        ylabel="xyz"[up] + length,
        title=f"{field} at t = {run.state.time:.6g}",
    )
    axes.figure.colorbar(
        patches, ax=axes, label=field + unit, location="bottom", aspect=40, shrink=0.8
    )
    return patches


def _faces(body: BodyState, field: str, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners (faces, 4 or 8, 3) of the outer faces, deformed if the displacement is known, in walking order, and a value for each."""
    mesh: Mesh = body.mesh
    faces, owners = mesh.faces("outer")
    values, at_elements = body.component(field)
    positions = body.nodes + scale * body.displacement if body.holds("displacement") else body.nodes
    around = faces[:, AROUND[faces.shape[1]]]
    return positions[around], values[owners] if at_elements else values[faces].mean(axis=1)


def _toward(axis: int) -> float:
    """The viewer stands where x or z is large, or y is small: so the two other axes run to the right and up."""
    return -1.0 if axis == 1 else 1.0


def _normal_along(corners: np.ndarray, axis: int) -> np.ndarray:
    """How much each face looks at the viewer."""
    step = corners.shape[1] // 4
    normal = np.cross(corners[:, 2 * step] - corners[:, 0], corners[:, 3 * step] - corners[:, step])
    return _toward(axis) * normal[:, axis]


def _unit(run: Run, field: str) -> str:
    quantity = {"stress": "stress", "displacement": "length", "velocity": "velocity"}[
        field.split("_")[0]
    ]
    return f" [{run.units.label(quantity)}]"


def draw_energies(axes: Any, run: Run) -> None:
    """Kinetic, strain, contact and external energy and their total over time."""
    for name in ("kinetic", "strain", "contact", "external", "total"):
        axes.plot(
            run.time, run.energy[name], label=name, linestyle="--" if name == "total" else "-"
        )
    time, energy = (
        (f" [{run.units.time}]", f" [{run.units.label('energy')}]") if run.units else ("", "")
    )
    axes.set(xlabel="t" + time, ylabel="energy" + energy)
    axes.grid(alpha=0.3)
    axes.legend(
        ncols=5, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False
    )
