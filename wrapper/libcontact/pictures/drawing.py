"""How one instant of a run is drawn: :class:`Drawing` chooses the field, the view and the range of colours of a run,
and draws any of its states into axes of matplotlib.

The mesh is projected orthographically; faces that point away from the viewer are left out, the others are drawn from
the back to the front.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as member
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bridge import Floats
from ..model import AXES
from ..older import tomllib
from ..schema import suggestion
from ..state import COMPONENTS, State
from ..surfaces import split_name
from .faces import Faces, outer_values, places
from .rigid import draw_directions, draw_obstacle, draw_scale, nice, patch, shape_at

if TYPE_CHECKING:
    from ..run import Run
    from ..units import Units

__all__ = ["Drawing", "check_view", "flat_axis", "label", "last_state", "tables", "title_of"]

# Letters of a title per inch.
LETTERS = 10.0

QUANTITY = {
    "stress": "stress",
    "displacement": "length",
    "velocity": "velocity",
    "contact_pressure": "stress",
}
WORDS = {
    "mises": "von Mises stress",
    "pressure": "pressure $-\\mathrm{tr}\\,\\sigma/3$",
    "contact_pressure": "contact pressure",
    "principal_max": "largest principal stress",
    "principal_mid": "middle principal stress",
    "principal_min": "smallest principal stress",
    "displacement_magnitude": "displacement",
    "velocity_magnitude": "speed",
}
# Maps of colours: of fields without a sign, and of the others.
WITHOUT_SIGN = {"mises": "viridis", "contact_pressure": "YlOrRd"}
WITHOUT_SIGN |= {"displacement_magnitude": "viridis", "velocity_magnitude": "viridis"}
SIGNED = "RdBu_r"
SIGN = {"min": -1.0, "max": 1.0}
# Weights of the three sides of a view from a corner: right, front, top.
CORNER = (0.55, 1.0, 0.6)
# The side from which a scene is seen that is flat along x, y or z, and the order in which one is chosen.
BROAD, ORDER = ("x_max", "y_min", "z_max"), (1, 2, 0)
# A scene is flat along an axis on which it has one element, or is shorter than this fraction of its
# largest size, if the rms displacement along it is below a fraction of the whole.
FLAT, STILL = 0.1, 0.3
# Displacements below a fraction of the size are magnified up to another one.
SMALL, MAGNIFIED = 0.02, 0.06
# Fraction of the contact pressure that a view must show, for the contact pressure as its field.
SHOWN = 0.5
# Width of the margin, in the size of the picture.
MARGIN = 0.06


def label(field: str) -> str:
    """A component such as ``"stress_xx"`` in words."""
    if field in WORDS:
        return WORDS[field]
    name, _, part = field.rpartition("_")
    symbol = {"stress": "\\sigma", "displacement": "u", "velocity": "v"}[name]
    return f"{name} ${symbol}_{{{part}}}$"


def readable(units: Units | None, quantity: str, largest: float) -> tuple[float, str]:
    """Factor and unit of numbers in a picture; 1 and "" without units."""
    return units.scaled(quantity, largest) if units else (1.0, "")


def with_unit(text: str, unit: str) -> str:
    """What stands at an axis."""
    return f"{text} [{unit}]" if unit else text


def colour_bar(
    patches: Any, axes: Any, field: str, units: Units | None, more: str = "", **options: Any
) -> None:
    """A colour bar of a component beside axes."""
    quantity = QUANTITY[COMPONENTS[field][0]]
    factor, unit = readable(units, quantity, float(np.abs(patches.get_clim()).max()))
    figure = np.ravel(axes)[0].get_figure()
    bar = figure.colorbar(patches, ax=axes, label=with_unit(label(field), unit) + more, **options)
    bar.formatter = lambda value, _: f"{factor * value:g}".replace("-", "−")


def title_of(run: Run, width: float) -> str:
    """Title of a run's scene, empty if there is none, in lines that fit a width [inch]."""
    return textwrap.fill(str(tables(run).get("title", "")), int(LETTERS * width))


def check_view(view: str) -> list[str]:
    """The sides of a view, which are joined by ``+``; a ValueError if they are no sides, or two of them are of
    one axis."""
    sides = view.split("+")
    known = all(re.fullmatch("[xyz]_(min|max)", side) for side in sides)
    if not known or len({side[0] for side in sides}) < len(sides):
        text = f'"{view}" is no view; name a side such as y_min, '
        raise ValueError(text + "or sides of different axes such as x_max+y_min+z_max")
    return sides


def tables(run: Run) -> dict[str, Any]:
    """The tables of a run's scene without the values of meshes; empty if the run has no scene."""
    try:
        return tomllib.loads(run.scene)
    except tomllib.TOMLDecodeError:
        return {}


def last_state(run: Run) -> list[State]:
    """The last state of a run, with the contact pressure if it is known; nothing if it has none."""
    if run.state and len(run.states) and run.states[-1].step == run.state.step:
        return [run.states[-1]]
    return [run.state] if run.state else []


@dataclass(frozen=True, eq=False)
class Drawing:
    """
    How the states of a run are drawn: made by :meth:`of` for a run, used by :meth:`draw` for each instant.

    Attributes
    ----------
    field : str
        The component that gives the colours.
    view : str
        The sides that the viewer sees: one such as ``"y_min"``, or two or three joined by ``+``, such as
        ``"x_max+y_min+z_max"``.
    scale : float
        Magnification of the displacements.
    up : str
        The axis that points up in the picture.
    limits : tuple of float
        The values at the two ends of the colours.
    bounds : tuple of float
        What the axes show, in the coordinates of the picture: left, right, lower and upper end [length].
    box : ndarray, shape (2, 3)
        The smallest and largest coordinates of the bodies [length].
    units : Units or None
        Units of the scene.
    obstacles : list of dict
        The obstacles of the scene.
    surfaces : dict
        Names of the surfaces of each body that are in contact.
    """

    field: str
    view: str
    scale: float = 1.0
    up: str = "z"
    limits: tuple[float, float] = (0.0, 1.0)
    bounds: tuple[float, float, float, float] = (0.0, 1.0, 0.0, 1.0)
    box: Floats = member(default_factory=lambda: np.array([[0.0] * 3, [1.0] * 3]))
    units: Units | None = None
    obstacles: list[dict[str, Any]] = member(default_factory=list)
    surfaces: dict[str, list[str]] = member(default_factory=dict)

    @classmethod
    def of(
        cls,
        run: Run,
        field: str | None = None,
        view: str | None = None,
        scale: float | None = None,
        states: Iterable[State] | None = None,
    ) -> Drawing:
        """
        Choose how a run is drawn.

        A scene that is flat along an axis is seen along it; its default field is the stress along the
        main direction of motion, or the von Mises stress without such a direction. Other scenes are
        seen from the corner that shows the largest contact pressures and stresses, with the contact
        pressure as default field if that corner shows it, or else the von Mises stress.

        Parameters
        ----------
        run : Run
            The run.
        field : str, optional
            The component, as for :meth:`libcontact.state.BodyState.component`.
        view : str, optional
            The sides that the viewer sees, such as ``"y_min"`` or ``"x_max+y_min+z_max"``.
        scale : float, optional
            Magnification of the displacements; by default 1, or more if they are small and nothing is in
            contact.
        states : iterable of State, optional
            The states whose colours and places must fit into the picture; by default the last one.

        Returns
        -------
        Drawing
            Field, view, scale, colours and bounds.

        Raises
        ------
        ValueError
            There is no state, no such component, no such view, or the component was not recorded.
        """
        shown = last_state(run) if states is None else list(states)
        if not shown:
            raise ValueError("this run has no state to draw")
        if field is not None and field not in COMPONENTS:
            raise ValueError(f'no component is named "{field}"' + suggestion(field, COMPONENTS))
        scene = tables(run)
        magnified = _magnified(scene, shown) if scale is None else scale
        rigid = {"obstacles": scene.get("obstacle", []), "surfaces": _surfaces(scene)}
        new = cls("", view or "", magnified, _up(scene), units=run.units, **rigid)
        new = replace(new, view=view or _best_view(new, shown))
        return replace(new, field=field or _best_field(new, scene, shown))._fitted(shown)

    @property
    def flat(self) -> bool:
        """Whether the viewer looks along an axis, so that the axes of the picture have coordinates."""
        return "+" not in self.view

    @cached_property
    def toward(self) -> Floats:
        """Direction to the viewer."""
        sides = check_view(self.view)
        out = np.zeros(3)
        order = {axis: k for k, axis in enumerate(_across(self.up) + self.up)}
        for side in sides:
            weight = CORNER[order[side[0]]] if len(sides) > 1 else 1.0
            out["xyz".index(side[0])] = weight * SIGN[side[2:]]
        return out / float(np.linalg.norm(out))

    @cached_property
    def axes(self) -> Floats:
        """The directions right, up and to the viewer, shape (3, 3)."""
        up = np.eye(3)["xyz".index(self.up)]
        if abs(self.toward @ up) > 0.999:
            up = np.eye(3)["xyz".index("y" if self.up != "y" else "z")]
        right = np.cross(up, self.toward)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(self.toward, right), self.toward])

    def project(self, points: Floats) -> Floats:
        """Points (..., 3) in the picture: coordinates right and up, and the depth towards the viewer
        [length]."""
        return points @ self.axes.T

    def draw(self, axes: Any, state: State, marks: bool = True) -> Any:
        """
        Draw one state into given axes, deformed and coloured, with the obstacles.

        The axes get the bounds of the drawing, and all states the same colours: instants, or the frames of a
        film, can be compared.

        Parameters
        ----------
        axes : matplotlib.axes.Axes
            Where to draw; what they contain stays.
        state : State
            The state.
        marks : bool
            Whether to draw the directions x, y, z and a scale, in a view that is not along an axis.

        Returns
        -------
        matplotlib.collections.PolyCollection
            The faces, for a colour bar.
        """
        from matplotlib.collections import PolyCollection

        faces = Faces.of(self, state)
        polygons, colours, edges = faces.painted()
        patches: Any = PolyCollection([], cmap=self.colours, zorder=2)
        patches.set_clim(*self.limits)
        rgba = patches.cmap(patches.norm(colours[:, 0]))
        rgba[:, :3] *= colours[:, 1:]
        rgba[edges, 3] = 0.0
        # Edges are white on dark colours.
        dark = rgba[:, :3].mean(axis=1) < 0.33
        line = np.where(dark[:, None], (1.0, 1.0, 1.0, 0.2), (0.0, 0.0, 0.0, 0.35))
        lines = np.where(edges[:, None], line, rgba)
        patches.set(
            verts=polygons, facecolors=rgba, edgecolors=lines, linewidths=0.3, rasterized=True
        )
        patches.set_in_layout(False)
        axes.add_collection(patches, autolim=False)
        for obstacle in self.obstacles:
            draw_obstacle(axes, self, obstacle, state)
        self._frame(axes, polygons if marks else None)
        return patches

    @property
    def colours(self) -> str:
        """The map of colours."""
        return WITHOUT_SIGN.get(self.field, SIGNED)

    def colour_bar(self, patches: Any, axes: Any, **options: Any) -> None:
        """A colour bar of what :meth:`draw` returned, beside axes."""
        more = f"; displacements × {self.scale:g}" if self.scale != 1.0 else ""
        colour_bar(patches, axes, self.field, self.units, more, **options)

    def _fitted(self, states: Sequence[State]) -> Drawing:
        """The drawing with colours and bounds for some states."""
        every = [Faces.of(self, state) for state in states]
        values = np.concatenate([faces.values[faces.shown() > 0.0].ravel() for faces in every])
        low, high = float(values.min()), float(values.max())
        if self.field in WITHOUT_SIGN:
            low, high = min(0.0, low), high or 1.0
        else:
            high = max(abs(low), abs(high)) or 1.0
            low = -high
        points = np.concatenate([places(body, self.scale) for s in states for body in s.values()])
        box = np.array([points.min(axis=0), points.max(axis=0)])
        drawing = replace(self, limits=(low, high), box=box)
        flat = np.concatenate([drawing.project(points), *drawing._floors(states)])[:, :2]
        low2, high2 = flat.min(axis=0), flat.max(axis=0)
        margin = MARGIN * float((high2 - low2).max()) or 1.0
        (left, bottom), (right, top) = low2 - margin, high2 + margin
        return replace(drawing, bounds=(left, right, bottom, top))

    def _floors(self, states: Sequence[State]) -> list[Floats]:
        """The projected patches of the planes among the obstacles that are near the bodies."""
        planes = [obstacle for obstacle in self.obstacles if "plane" in obstacle]
        patches = [patch(shape_at(each, s)[1], self.box) for each in planes for s in states]
        reach = 0.2 * float(np.linalg.norm(self.box[1] - self.box[0]))
        low, high = self.box[0] - reach, self.box[1] + reach
        near = [p for p in patches if ((p >= low) & (p <= high)).all()]
        return [self.project(p) for p in near]

    def _frame(self, axes: Any, polygons: Floats | None) -> None:
        left, right, bottom, top = self.bounds
        axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
        if self.flat:
            length = f" [{self.units.length}]" if self.units else ""
            across, up = (_axis_name(direction) for direction in self.axes[:2])
            axes.set(xlabel=across + length, ylabel=up + length)
            return
        axes.set_axis_off()
        if polygons is not None:
            draw_directions(axes, self, polygons)
            draw_scale(axes, self, polygons)


# Choices.


def _up(scene: dict[str, Any]) -> str:
    """The axis that points up: that of gravity, or z."""
    pull = scene.get("gravity", {}).get("acceleration")
    return AXES[int(np.abs(pull).argmax())] if pull is not None and np.any(pull) else "z"


def _surfaces(scene: dict[str, Any]) -> dict[str, list[str]]:
    """Names of the surfaces of each body that are in contact."""
    named = [name for contact in scene.get("contact", []) for name in contact["surfaces"]]
    out: dict[str, list[str]] = {}
    for name in named + [obstacle["surface"] for obstacle in scene.get("obstacle", [])]:
        body, surface = split_name(name, [body["name"] for body in scene["body"]])
        out.setdefault(body, []).append(surface)
    return out


def _magnified(scene: dict[str, Any], states: Sequence[State]) -> float:
    """Magnification of small displacements, 1 where bodies move or touch."""
    moves = any(any(body.get("velocity", ())) for body in scene.get("body", []))
    if moves or "contact" in scene or "obstacle" in scene:
        return 1.0
    bodies = [body for state in states for body in state.values() if body.holds("displacement")]
    size = max((float(np.ptp(body.nodes, axis=0).max()) for body in bodies), default=0.0)
    most = max((float(np.abs(body.displacement).max()) for body in bodies), default=0.0)
    if not 0.0 < most < SMALL * size:
        return 1.0
    return nice(MAGNIFIED * size / most)


def flat_axis(states: Sequence[State]) -> int | None:
    """The axis along which a scene is flat; of two such axes the one with the least motion."""
    bodies = list(states[-1].values())
    nodes = np.concatenate([body.nodes for body in bodies])
    sizes = np.ptp(nodes, axis=0)
    moved = [body.displacement for s in states for body in s.values() if body.holds("displacement")]
    rms = np.sqrt(np.mean(np.concatenate(moved) ** 2, axis=0)) if moved else np.zeros(3)
    found = []
    for axis in ORDER:
        layer = all(
            len(body.mesh.faces(f"{AXES[axis]}_min")[0]) == len(body.elements) for body in bodies
        )
        thin = layer or sizes[axis] < FLAT * sizes.max()
        if thin and rms[axis] <= STILL * float(np.linalg.norm(rms)):
            found.append(axis)
    return min(found, key=lambda axis: rms[axis], default=None)


def _best_view(drawing: Drawing, states: Sequence[State]) -> str:
    """Along the axis on which a scene is flat, or from the upper corner that shows the most: contact
    pressure and von Mises stress on the faces that it sees."""
    axis = flat_axis(states)
    if axis is not None:
        return BROAD[axis]
    right, front = _across(drawing.up)[:1], _across(drawing.up)[1:]
    corners = [
        f"{right}_{a}+{front}_{b}+{drawing.up}_max" for b in ("min", "max") for a in ("max", "min")
    ]
    fields = [field for field in ("contact_pressure", "mises") if _holds(states, field)]
    shares = [sum(_share(drawing, corner, field, states) for field in fields) for corner in corners]
    # The first corner is the usual one; another one must show more.
    return next(c for c, share in zip(corners, shares) if share >= max(shares) - 0.02)


def _share(drawing: Drawing, view: str, field: str, states: Sequence[State]) -> float:
    """The share of a field on the outer faces that a view shows, weighted by area."""
    seen = whole = 0.0
    for state in states:
        toward = replace(drawing, view=view).toward
        for body in state.values():
            normals, values = outer_values(body, field, drawing)
            weights = np.linalg.norm(normals, axis=1) * np.abs(values)
            seen += float(weights[normals @ toward > 0.0].sum())
            whole += float(weights.sum())
    return seen / whole if whole else 1.0


def _holds(states: Sequence[State], field: str) -> bool:
    """Whether all states have a component."""
    return all(body.holds(COMPONENTS[field][0]) for state in states for body in state.values())


def _best_field(drawing: Drawing, scene: dict[str, Any], states: Sequence[State]) -> str:
    """Contact pressure where the view shows it, the stress along an impact in a flat scene, or the von
    Mises stress."""
    velocities = [np.abs(body.get("velocity", np.zeros(3))) for body in scene.get("body", [])]
    speed = np.max(velocities, axis=0) if velocities else np.zeros(3)
    order = np.argsort(speed)
    if not _holds(states, "mises"):
        return "velocity_magnitude" if _holds(states, "velocity_x") else "displacement_magnitude"
    if drawing.flat:
        along = speed[order[2]] > 3.0 * speed[order[1]]
        return f"stress_{2 * AXES[order[2]]}" if along else "mises"
    if _holds(states, "contact_pressure") and _pressure_shown(drawing, states) >= SHOWN:
        return "contact_pressure"
    return "mises"


def _pressure_shown(drawing: Drawing, states: Sequence[State]) -> float:
    """The fraction of the contact pressure, over the projected area of all faces, that is not covered."""
    given, whole, seen = replace(drawing, field="contact_pressure"), 0.0, 0.0
    for state in states:
        faces = Faces.of(given, state)
        seen += float((faces.areas() * faces.shown() * faces.values.mean(axis=1)).sum())
        for body in state.values():
            normals, values = outer_values(body, "contact_pressure", given)
            whole += float((np.abs(normals @ given.toward) * values).sum())
    return seen / whole if whole else 0.0


def _across(up: str) -> str:
    """The axes to the right and to the back of a picture with an axis that points up, such as x and y."""
    return {"x": "yz", "y": "zx", "z": "xy"}[up]


def _axis_name(direction: Floats) -> str:
    axis = int(np.abs(direction).argmax())
    return ("" if direction[axis] > 0.0 else "−") + AXES[axis]
