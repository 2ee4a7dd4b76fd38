"""The outer faces of a state as polygons of a picture: projected, sorted from the back to the front, with a value
each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..bridge import Floats
from ..schema import FACES
from ..state import BodyState, State

if TYPE_CHECKING:
    from .drawing import Drawing

# Corners and mid-sides of a face.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
# Parts of an edge into which the faces of a nodal field are divided, and the number of polygons allowed.
PARTS, POLYGONS = 4, 40_000
# Faces up to which the edges of the mesh are drawn; pixels of the picture that finds the faces in front.
EDGES, PIXELS = 4000, 600
# Light from above on the left, and the brightness of faces turned away from it.
LIGHT, AMBIENT = np.array([-0.3, 0.55, 0.78]), 0.72
# Bodies whose boxes overlap by less than this fraction of their size are apart.
APART = 0.02


def places(body: BodyState, scale: float) -> Floats:
    """Coordinates (nodes, 3) of the nodes with magnified displacements [length]; without recorded displacements
    the nodes stay in place."""
    return body.nodes + scale * body.displacement if body.holds("displacement") else body.nodes


def outer_values(body: BodyState, field: str, drawing: Drawing) -> tuple[Floats, Floats]:
    """Normals (faces, 3) of the outer faces, as long as their areas [length²], and a value for each: that of
    the element, or the mean of the nodes."""
    faces, owners = body.mesh.faces("outer")
    values, at_elements = body.component(field)
    corners = places(body, drawing.scale)[faces[:, :4]]
    each = values[owners] if at_elements else values[faces[:, :4]].mean(axis=1)
    return _normals(corners), each * _bears(body, faces, field, drawing)


def _bears(body: BodyState, faces: Any, field: str, drawing: Drawing) -> Any:
    """For the contact pressure whether each face belongs to a surface in contact; 1 for other fields."""
    if field != "contact_pressure":
        return 1.0
    # A results file has no sets.
    names = drawing.surfaces.get(body.name, ("outer",))
    known = [name if name in FACES or body.mesh.sets.kinds(name) else "outer" for name in names]
    nodes = [body.mesh.face_nodes(name) for name in known]
    return np.any([np.isin(faces[:, :4], each).all(axis=1) for each in nodes], axis=0)


def _normals(corners: Floats) -> Floats:
    """Half the cross product of the diagonals, shape (faces, 3)."""
    a, b, c, d = (corners[:, k] for k in range(4))
    return 0.5 * np.cross(c - a, d - b)


def _shape(width: int, xi: Floats) -> Floats:
    """Shape functions of a Q4 or Q8 face at points (n, 2), shape (n, width)."""
    r, s = xi[:, :1], xi[:, 1:]
    a, b = CORNERS[:4].T
    bilinear: Floats = (1 + a * r) * (1 + b * s) / 4
    if width == 4:
        return bilinear
    a, b = CORNERS[4:].T
    middle = np.where(a == 0, (1 - r**2) * (1 + b * s), (1 - s**2) * (1 + a * r)) / 2
    return np.hstack([bilinear - (middle + np.roll(middle, 1, axis=1)) / 2, middle])


def _border(width: int) -> Floats:
    """Shape functions at points around a face, from corner to corner along its edges: the corners of a Q4, and
    four points per edge of a Q8, whose edges are parabolas; shape (4 or 16, width)."""
    corners = CORNERS[:4]
    steps = np.arange(1 if width == 4 else PARTS) / (1 if width == 4 else PARTS)
    around = [a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0)) for t in steps]
    return _shape(width, np.array(around))


def _parts(width: int, parts: int) -> tuple[Floats, Floats]:
    """Shape functions at the corners (parts², 4, width) and the centres (parts², width) of the parts of a
    face."""
    ends = np.linspace(-1.0, 1.0, parts + 1)
    r, s = (x.ravel() for x in np.meshgrid(ends[:-1], ends[:-1]))
    step = 2.0 / parts
    corner = [_shape(width, np.stack([r + i, s + j], 1)) for i, j in _around(step)]
    return np.stack(corner, axis=1), _shape(width, np.stack([r + step / 2, s + step / 2], 1))


def _around(step: float) -> list[tuple[float, float]]:
    return [(0.0, 0.0), (step, 0.0), (step, step), (0.0, step)]


@dataclass(frozen=True, eq=False)
class Faces:
    """
    The faces of a state that are turned to the viewer, from the back to the front.

    Attributes
    ----------
    outlines : ndarray, shape (faces, 4 or 16, 2)
        Points around each face, projected [length]: the corners of a Q4, four per curved edge of a Q8.
    cells : ndarray, shape (faces, parts, 4 or 16, 2)
        The parts of each face that have one colour [length].
    values : ndarray, shape (faces, parts)
        The values of the parts.
    light : ndarray, shape (faces,)
        The brightness of each face.
    """

    outlines: Floats
    cells: Floats
    values: Floats
    light: Floats

    @classmethod
    def of(cls, drawing: Drawing, state: State) -> Faces:
        """The faces of a state that are turned to the viewer."""
        bodies = list(state.values())
        count = sum(len(body.mesh.faces("outer")[0]) for body in bodies)
        parts = max(1, min(PARTS, int(np.sqrt(POLYGONS / max(count, 1)))))
        ranks = _ranks([places(body, drawing.scale) for body in bodies], drawing.toward)
        rows = [_of_body(drawing, body, rank, parts) for body, rank in zip(bodies, ranks)]
        wide = max(outline.shape[1] for outline, *_ in rows)
        rows = [(_widened(line, wide), _widened(cell, wide), *rest) for line, cell, *rest in rows]
        outlines, cells, values, light, keys = (np.concatenate(part) for part in zip(*rows))
        order = np.lexsort((keys[:, 1], keys[:, 0]))
        return cls(outlines[order], cells[order], values[order], light[order])

    def painted(self) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """The polygons of a picture (polygons, 4 or 16, 2): the parts of each face, and after them its outline,
        if there are not too many; value and brightness (polygons, 2) of each; and whether it is an outline."""
        count, parts = self.values.shape
        lined = int(count <= EDGES)
        polygons = np.concatenate([self.cells, self.outlines[:, None][:, :lined]], axis=1)
        values = np.hstack([self.values, self.values[:, :lined]]).ravel()
        lines = np.zeros((count, parts + lined), bool)
        lines[:, parts:] = True
        light = np.repeat(self.light, parts + lined)
        flat = polygons.reshape(-1, *polygons.shape[2:])
        return flat, np.stack([values, light], axis=1), lines.ravel()

    def shown(self) -> Floats:
        """How much of each face no other face covers, about: 0 for a face that is covered entirely. It is found
        from a small picture in which each face has its number as colour."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import PolyCollection
        from matplotlib.figure import Figure

        number = np.arange(len(self.outlines))
        colours = np.stack([number >> 16, number >> 8 & 255, number & 255], axis=1) / 255.0
        figure = Figure(figsize=(1, 1), dpi=PIXELS, facecolor="white")
        figure.set_layout_engine("none")
        axes = figure.add_axes((0, 0, 1, 1), frameon=False)
        look: dict[str, Any] = {"edgecolors": "none", "linewidths": 0, "antialiaseds": False}
        faces: Any = PolyCollection([], **look)
        faces.set(verts=self.outlines, facecolors=colours)
        axes.add_collection(faces, autolim=False)
        low, high = self.outlines.min(axis=(0, 1)), self.outlines.max(axis=(0, 1))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        axes.set_axis_off()
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        pixels = np.asarray(canvas.buffer_rgba())[:, :, :3].astype(np.intp)
        found = pixels.reshape(-1, 3) @ np.array([1 << 16, 1 << 8, 1])
        count = np.bincount(found[found < len(number)], minlength=len(number))
        pixel = float(np.prod(high - low)) / PIXELS**2
        return np.minimum(count * pixel / np.maximum(self.areas(), pixel), 1.0)

    def areas(self) -> Floats:
        """The areas of the projected faces [length²]."""
        x, y = self.outlines[..., 0], self.outlines[..., 1]
        turned = x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)
        area: Floats = 0.5 * np.abs(turned.sum(axis=1))
        return area


def _of_body(drawing: Drawing, body: BodyState, rank: int, parts: int) -> Any:
    """The outlines, cells, values, brightness and sorting keys (rank of the body, depth) of a body's faces
    that are turned to the viewer."""
    faces, owners = body.mesh.faces("outer")
    values, at_elements = body.component(drawing.field)
    x = drawing.project(places(body, drawing.scale))
    normals = _normals(x[faces[:, :4]])
    turned = normals[:, 2] > 0.0
    faces, owners, normals = faces[turned], owners[turned], normals[turned]
    outline = np.einsum("pn,fnk->fpk", _border(faces.shape[1]), x[faces])
    keys = np.stack([np.full(len(faces), rank), outline[:, :, 2].mean(axis=1)], axis=1)
    if at_elements:
        cells, each = outline[:, None, :, :2], values[owners][:, None]
    else:
        bears = _bears(body, faces, drawing.field, drawing)
        corner, centre = _parts(faces.shape[1], parts)
        cells = np.einsum("pcn,fnk->fpck", corner, x[faces][:, :, :2])
        each = values[faces] @ centre.T * np.reshape(bears, (-1, 1))
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    light = np.ones(len(faces))
    if not drawing.flat:
        light = AMBIENT + (1.0 - AMBIENT) * np.maximum(unit @ LIGHT, 0.0)
    return outline[:, :, :2], cells, each, light, keys


def _widened(polygons: Floats, count: int) -> Floats:
    """Polygons (..., n, 2) with so many nodes: the last one is repeated."""
    more = np.repeat(polygons[..., -1:, :], count - polygons.shape[-2], axis=-2)
    return np.concatenate([polygons, more], axis=-2)


def _ranks(bodies: Sequence[Floats], toward: Floats) -> list[int]:
    """The order in which bodies are drawn, from the back to the front. Bodies whose boxes overlap have the
    same rank: their faces are sorted together."""
    boxes = [np.array([x.min(axis=0), x.max(axis=0)]) for x in bodies]
    before = [[_behind(a, b, toward) for b in boxes] for a in boxes]
    groups = list(range(len(boxes)))
    for i in range(len(boxes)):
        for j in range(i):
            if before[i][j] is None:
                groups = [groups[j] if g == groups[i] else g for g in groups]
    left, ranks = set(groups), [0] * len(groups)
    for rank in range(len(left)):
        # The next group has nothing behind it; in a circle the first one is taken.
        free = [g for g in left if not any(_any_behind(before, groups, h, g) for h in left - {g})]
        group = min(free or left)
        ranks = [rank if g == group else r for g, r in zip(groups, ranks)]
        left.remove(group)
    return ranks


def _any_behind(before: Any, groups: Sequence[int], one: int, other: int) -> bool:
    return any(
        before[i][j]
        for i, g in enumerate(groups)
        for j, h in enumerate(groups)
        if (g, h) == (one, other)
    )


def _behind(a: Floats, b: Floats, toward: Floats) -> bool | None:
    """Whether box a is behind box b and can be covered by it; None if they overlap."""
    slack = APART * float(np.linalg.norm(b[1] - b[0]) + np.linalg.norm(a[1] - a[0]))
    # Distances of a below b, and above b, along each axis.
    below, above = b[0] - a[1], a[0] - b[1]
    if max(below.max(), above.max()) < -slack:
        return None
    axis = int(np.maximum(below, above).argmax())
    return bool((toward[axis] > 0.0) == (below[axis] > above[axis]))
