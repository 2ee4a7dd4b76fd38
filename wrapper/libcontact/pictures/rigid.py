"""Obstacles, directions and a scale in a picture of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..bridge import Floats
from ..model import AXES

if TYPE_CHECKING:
    from ..state import State
    from .drawing import Drawing

GREY = "0.45"
# Thickness of a wall seen along its plane, in the size of the bodies.
WALL = 0.03
# Sine of the angle below which a plane is seen along itself.
EDGE_ON = 0.05


def nice(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above a positive number."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(k for k in (1, 2, 5) if k * power <= value * (1 + 1e-12)))


def displacement_at(obstacle: dict[str, Any], time: float) -> Floats:
    """Displacement (3,) of an obstacle at a time [length]."""
    moved = time * np.array(obstacle.get("velocity", (0, 0, 0)), float)
    history = obstacle.get("history")
    if history:
        factor = np.interp(time, history["time"], history["value"])
        moved = moved + factor * np.array(obstacle["travel"], float)
    return moved


def shape_at(obstacle: dict[str, Any], state: State) -> tuple[str, dict[str, Any]]:
    """The shape of an obstacle, and its table as it is in a state; it moves as given, or with its carrier."""
    name = next(name for name in ("plane", "sphere", "cylinder") if name in obstacle)
    shape = obstacle[name]
    point, axis = ("point", "normal") if name == "plane" else ("centre", "axis")
    turn, moved = np.eye(3), displacement_at(obstacle, state.time)
    if "carrier" in obstacle:
        body = state[obstacle["carrier"]]
        middle, shift = body.nodes.mean(axis=0), body.displacement.mean(axis=0)
        r, u = body.nodes - middle, body.displacement - shift
        turn = np.eye(3) + np.linalg.lstsq(r, u, rcond=None)[0].T
        arm = np.array(shape[point], float) - middle
        moved = shift + turn @ arm - arm
    axes = {axis: turn @ np.array(shape[axis], float)} if axis in shape else {}
    return name, {**shape, point: np.array(shape[point], float) + moved, **axes}


def patch(plane: dict[str, Any], box: Floats) -> Floats:
    """The corners (4, 3) of a rectangle around the projection of the bodies, with bounds ``box`` (2, 3), on a
    plane."""
    normal = np.array(plane["normal"], float)
    normal /= np.linalg.norm(normal)
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    point = np.array(plane["point"], float)
    corners = np.array(np.meshgrid(*box.T)).reshape(3, -1).T - point
    wide = 0.06 * float(np.linalg.norm(box[1] - box[0]))
    u, v = corners @ first, corners @ second
    ends = [(u.min() - wide, v.min() - wide), (u.max() + wide, v.min() - wide)]
    ends += [(u.max() + wide, v.max() + wide), (u.min() - wide, v.max() + wide)]
    return np.array([point + a * first + b * second for a, b in ends])


def draw_obstacle(axes: Any, drawing: Drawing, obstacle: dict[str, Any], state: State) -> None:
    """Draw an obstacle as it is in a state."""
    name, shape = shape_at(obstacle, state)
    if name == "plane":
        _draw_plane(axes, drawing, shape)
    elif name == "sphere":
        _draw_disc(axes, drawing.project(shape["centre"])[:2], shape["radius"])
    else:
        _draw_cylinder(axes, drawing, shape)


def _draw_plane(axes: Any, drawing: Drawing, plane: dict[str, Any]) -> None:
    """A plane from its front or back, or the edge of a wall."""
    normal = np.array(plane["normal"], float)
    normal /= np.linalg.norm(normal)
    corners, facing = patch(plane, drawing.box), float(normal @ drawing.toward)
    look = {"facecolor": "0.9", "edgecolor": GREY, "lw": 0.8, "zorder": 1}
    if abs(facing) < EDGE_ON:
        across = corners[np.argsort(drawing.project(corners) @ _along(drawing, normal))[[0, -1]]]
        deep = WALL * float(np.linalg.norm(drawing.box[1] - drawing.box[0]))
        corners = np.array([*across, *(across[::-1] - deep * normal)])
        look |= {"hatch": "////", "lw": 0.0}
        axes.plot(*drawing.project(across)[:, :2].T, color="0.2", lw=1.2, zorder=1)
    elif facing < 0.0:
        look |= {"facecolor": "none", "ls": "--", "zorder": 3}
    axes.fill(*drawing.project(corners)[:, :2].T, **look)


def _along(drawing: Drawing, normal: Floats) -> Floats:
    """The direction in the picture of a plane that is seen along itself."""
    flat = drawing.project(normal)
    return np.array([-flat[1], flat[0], 0.0])


def _draw_disc(axes: Any, centre: Floats, radius: float) -> None:
    from matplotlib.patches import Circle

    look = {"facecolor": "0.5", "edgecolor": GREY, "ls": "--", "lw": 1.0}
    axes.add_patch(Circle(tuple(centre), radius, fill=False, zorder=3, **look))


def _draw_cylinder(axes: Any, drawing: Drawing, cylinder: dict[str, Any]) -> None:
    """A circle along its axis, or its two outlines."""
    centre = drawing.project(cylinder["centre"])
    axis = drawing.project(cylinder["axis"])
    radius, length = cylinder["radius"], float(np.hypot(*axis[:2]))
    if length < EDGE_ON * abs(axis[2]):
        _draw_disc(axes, centre[:2], radius)
        return
    along = axis[:2] / length
    aside = radius * np.array([-along[1], along[0]])
    far = float(np.linalg.norm(drawing.box[1] - drawing.box[0]))
    for side in (aside, -aside):
        ends = np.array([centre[:2] + side - far * along, centre[:2] + side + far * along])
        axes.plot(*ends.T, color=GREY, ls="--", lw=1.0, zorder=3)


def draw_directions(axes: Any, drawing: Drawing, polygons: Floats) -> None:
    """Draw arrows along x, y and z into a corner on the left in which no ``polygons`` (n, m, 2) are."""
    left, right, bottom, top = drawing.bounds
    size = 0.08 * max(right - left, top - bottom)
    low = (left + 1.2 * size, bottom + 0.8 * size)
    origin = _freer(polygons, low, (low[0], top - 1.6 * size), 2.0 * size)
    for name, end in zip(AXES, drawing.project(np.eye(3))[:, :2] * size):
        arrow = {"arrowstyle": "-|>", "lw": 0.9, "color": "0.25", "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", origin + end, origin, arrowprops=arrow, zorder=5)
        where = origin + 1.3 * end
        axes.text(*where, name, ha="center", va="center", fontsize=8, color="0.25", zorder=5)


def draw_scale(axes: Any, drawing: Drawing, polygons: Floats) -> None:
    """Draw a bar with its length into a corner on the right in which no ``polygons`` (n, m, 2) are."""
    left, right, bottom, top = drawing.bounds
    length, gap = nice(0.3 * (right - left)), 0.03 * (right - left)
    high = (right - gap - length / 2, top - 4.0 * gap)
    x, y = _freer(polygons, (high[0], bottom + gap), high, length)
    axes.plot(
        [x - length / 2, x + length / 2],
        [y, y],
        color="0.25",
        lw=2.0,
        solid_capstyle="butt",
        zorder=5,
    )
    unit = drawing.units.length if drawing.units else ""
    text = f"{length:g} {unit}".rstrip()
    axes.text(x, y + 0.4 * gap, text, ha="center", va="bottom", fontsize=8, zorder=5)


def _freer(
    polygons: Floats, one: tuple[float, float], other: tuple[float, float], size: float
) -> Floats:
    """The one of two places with fewer nodes of polygons around it."""
    points = polygons.reshape(-1, 2)
    count = [int((np.abs(points - place).max(axis=1) < size).sum()) for place in (one, other)]
    return np.array(one if count[0] <= count[1] else other)
