"""A picture of a mesh and its sets, for ``libcontact mesh FILE --plot``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..bridge import Floats
from ..mesh import Mesh
from ..meshes.raw import BRICK

if TYPE_CHECKING:
    from ..meshes import MeshData

# Directions to the viewer: in front, at the right, above; and from the opposite corner.
VIEWS = ((0.55, -1.0, 0.6), (-0.55, 1.0, -0.6))
NAMES = ("from the right, front and top", "from the left, back and bottom")
PLAIN = ("#d9d9d9", "#c6dbef", "#d4e8c5", "#f3e2c3", "#e6d5ec", "#cfe6e3")
MOST_SETS = 20


def draw_mesh(data: MeshData, title: str = "") -> Any:
    """
    Draw the outer faces of a mesh from two opposite corners. Sets of faces have strong colours, sets of elements pale
    ones.

    Parameters
    ----------
    data : MeshData
        The mesh.
    title : str
        Title of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    faces, colours, legend = _coloured(data)
    figure = Figure(figsize=(10.0, 5.2), layout="constrained")
    for axes, toward, name in zip(figure.subplots(1, 2), VIEWS, NAMES):
        _draw(axes, data.nodes, faces, colours, np.array(toward))
        axes.set_title(name, fontsize="small")
    figure.suptitle(title, fontsize="medium")
    patches = [Patch(facecolor=colour, edgecolor="k", label=name) for name, colour in legend]
    if patches:
        columns = min(5, len(patches))
        figure.legend(handles=patches, loc="outside lower center", ncols=columns, fontsize="small")
    return figure


def _coloured(data: MeshData) -> tuple[Any, list[Any], list[tuple[str, Any]]]:
    """Outer faces, their colours, and the names of the colours."""
    from matplotlib import colormaps

    faces, owners = Mesh.copy(data.nodes, data.elements).faces("outer")
    body, legend = np.zeros(len(data.elements), int), list[tuple[str, Any]]()
    if 1 < len(data.element_sets) <= MOST_SETS:
        for i, (name, found) in enumerate(data.element_sets.items(), 1):
            body[found] = i
            legend.append((name, PLAIN[i % len(PLAIN)]))
    colours: list[Any] = [PLAIN[i % len(PLAIN)] for i in body[owners]]
    at = {frozenset(face[:4].tolist()): i for i, face in enumerate(faces)}
    strong = colormaps["tab20" if len(data.face_sets) > 10 else "tab10"]
    for i, (name, pairs) in enumerate(list(data.face_sets.items())[:MOST_SETS]):
        colour = strong(i % strong.N)
        legend.append((name, colour))
        for corners in face_corners(data, pairs).tolist():
            if frozenset(corners) in at:
                colours[at[frozenset(corners)]] = colour
    return faces, colours, legend


def face_corners(data: MeshData, pairs: Any) -> Any:
    """Corner nodes of faces of elements, shape (m, 4)."""
    return data.elements[pairs[:, 0, None], np.array(BRICK)[pairs[:, 1]]]


def _draw(axes: Any, nodes: Floats, faces: Any, colours: list[Any], toward: Floats) -> None:
    """Draw the faces that look at the viewer, from the back to the front."""
    from matplotlib.collections import PolyCollection

    toward = toward / np.linalg.norm(toward)
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    plane = np.column_stack([nodes @ right, nodes @ np.cross(toward, right)])
    x = nodes[faces[:, :4]]
    normals = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    seen = np.flatnonzero(normals @ toward > 0.0)
    seen = seen[np.argsort((x[seen] @ toward).mean(axis=1), kind="stable")]
    width = faces.shape[1]
    # A quadratic face has its mid-side nodes between its corners.
    around = [i // 2 + 4 * (i % 2) for i in range(8)] if width == 8 else list(range(4))
    shown = PolyCollection(
        list(plane[faces[seen][:, around]]),
        facecolors=[colours[i] for i in seen],
        edgecolors="k",
        linewidths=min(0.5, 15.0 / max(len(seen), 1) ** 0.5),
    )
    axes.add_collection(shown)
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set_axis_off()
