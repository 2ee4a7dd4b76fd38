"""Pictures of runs: :func:`plot_run` draws a row of instants and the energies over time.

The extra ``plot`` installs matplotlib for them. :class:`libcontact.pictures.drawing.Drawing` draws one instant
into axes of your own.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bridge import Floats
from ..model import AXES
from ..progress import in_notebook
from ..state import State
from ..tables import ENERGY
from .drawing import (
    Drawing,
    colour_bar,
    flat_axis,
    last_state,
    readable,
    tables,
    title_of,
    with_unit,
)
from .plot import draw_bar_in_time
from .rigid import displacement_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..run import Run

__all__ = ["draw_energies", "picture", "plot_run"]

# Size of a picture, and of its parts [inch]: width, the height that instants may have, and the rest.
WIDTH, INSTANTS_HEIGHT, BAR_HEIGHT, ENERGY_HEIGHT, TITLE_HEIGHT = 9.0, 5.4, 0.75, 2.4, 0.35
MARGIN = 0.05  # above a picture without a title
LINE_HEIGHT = 0.25
BARS_HEIGHT = 4.4
COLOUR_BAR: dict[str, Any] = {"location": "bottom", "aspect": 50, "shrink": 0.7}
# Fraction of the largest energy below which a curve lies on the axis.
HIDDEN = 5e-3
# Most instants in the picture of a bar.
COLUMNS = 400
# Fraction of the largest size of an instant that fewer rows may have.
NEARLY = 0.75
# Instants in a picture by default.
INSTANTS = 4


def plot_run(
    run: Run,
    field: str | None = None,
    view: str | None = None,
    scale: float | None = None,
    instants: int = INSTANTS,
    figure: Any = None,
) -> Any:
    """
    Draw a row of instants and the energies.

    Bars of one element in their cross section are drawn over position and time instead of instants, if
    no view is given. :meth:`libcontact.pictures.drawing.Drawing.of` says what is chosen by default.

    Parameters
    ----------
    run : Run
        The run.
    field : str, optional
        The component, such as ``"mises"``, ``"contact_pressure"``, ``"principal_max"`` or ``"velocity_z"``
        (:meth:`libcontact.state.BodyState.component`).
    view : str, optional
        The sides that the viewer sees, such as ``"y_min"`` or ``"x_max+y_min+z_max"``.
    scale : float, optional
        Magnification of the displacements.
    instants : int
        Number of instants, at most that of the recorded states: the last one, the one with the largest
        contact or strain energy, and others between.
    figure : matplotlib.figure.Figure, optional
        An empty figure; by default a new one, which a notebook shows, or ``pyplot.show()``.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    ValueError
        As for :meth:`libcontact.pictures.drawing.Drawing.of`.
    """
    if instants < 1:
        raise ValueError(f"instants is {instants}; at least one is needed")
    title = title_of(run, WIDTH)
    axis = bar_axis(run) if (field, view, scale) == (None, None, None) else None
    if axis is not None and len(run.states) > 2:
        head, *above, below = _divided(figure or new_figure(), title, [BARS_HEIGHT])
        draw_bars(above[0].subplots(), run, axis)
    else:
        drawn = _drawings(run, field, view, scale, chosen(run, instants))
        head, below = _draw_rows(figure or new_figure(), title, *drawn)
    head.text(0.5, 0.4, title, fontsize="large", ha="center", va="center")
    draw_energies(below.subplots(), run)
    return below.get_figure(root=True)


def picture(run: Run, path: str | Path, **options: Any) -> None:
    """Draw a run into an image file, with the options of :func:`plot_run`."""
    from matplotlib.figure import Figure

    plot_run(run, figure=Figure(), **options).savefig(path, dpi=180)


def new_figure() -> Figure:
    """A figure of pyplot, which a notebook shows once, also with a backend that shows nothing; the backend
    stays as it is."""
    from matplotlib import get_backend, pyplot
    from matplotlib.figure import Figure

    class Shown(Figure):
        """A figure of a notebook."""

        def _ipython_display_(self) -> None:
            shell: Any = import_module("IPython.display")
            backend = get_backend().lower()
            if pyplot.fignum_exists(self.number) and "inline" not in backend and backend != "agg":
                return  # in a canvas of its own
            held = io.BytesIO()
            self.savefig(held, format="png", dpi=100)
            shell.display(shell.Image(held.getvalue()))
            # Otherwise the end of the cell shows it again.
            pyplot.close(self)

    return pyplot.figure(FigureClass=Shown) if in_notebook() else pyplot.figure()


def chosen(run: Run, count: int) -> list[State]:
    """States at about equal intervals, of which one is that of the largest contact energy (without contact:
    strain energy), and one the last."""
    states, last = run.states, len(run.states) - 1
    if count == 1 or last < 1:
        return last_state(run)
    numbers = np.unique(np.linspace(0, last, count).round().astype(int))
    peak = _peak(run, last + 1)
    inner = numbers[1:-1]
    if len(inner) and peak not in numbers:
        inner[np.abs(inner - peak).argmin()] = peak
    return [states[i] for i in sorted({*numbers.tolist(), *inner.tolist()})]


def _peak(run: Run, count: int) -> int:
    """The number of the state, of so many at equal intervals, with the largest contact or strain energy."""
    energy = run.energy["contact"] if run.energy["contact"].any() else run.energy["strain"]
    return round(int(energy.argmax()) / max(len(energy) - 1, 1) * (count - 1))


def _divided(figure: Any, title: str, heights: Sequence[float]) -> Any:
    """Parts of a figure: for the lines of the title, with these heights [inch], and for the energies."""
    head = TITLE_HEIGHT + LINE_HEIGHT * title.count("\n") if title else MARGIN
    heights = [head, *heights, ENERGY_HEIGHT]
    figure.set_size_inches(WIDTH, sum(heights))
    figure.set_layout_engine("constrained")
    return figure.subfigures(len(heights), 1, height_ratios=heights)


def _grid(drawing: Drawing, count: int, most: float) -> tuple[tuple[int, int], float]:
    """Rows and columns in which instants become largest, within a height [inch], and the height."""
    left, right, bottom, top = drawing.bounds
    # In inches: room for labels and titles around each instant.
    aside, above = (0.6, 0.75) if drawing.flat else (0.1, 0.35)
    sizes = {}
    for rows in range(1, count + 1):
        columns = -(-count // rows)
        wide, high = WIDTH / columns - aside, most / rows - above
        inch = min(wide / (right - left), high / (top - bottom))
        sizes[rows, columns] = inch
    # Fewer rows are preferred.
    best = next(key for key, size in sizes.items() if size >= NEARLY * max(sizes.values()))
    return best, best[0] * (max(sizes[best], 0.0) * (top - bottom) + above)


def _drawings(
    run: Run, field: str | None, view: str | None, scale: float | None, states: list[State]
) -> tuple[list[Drawing], list[State]]:
    """The drawings of some states: of the field, and below a contact pressure of the von Mises stress."""
    first = Drawing.of(run, field, view, scale, states)
    if field is None and first.field == "contact_pressure":
        return [first, Drawing.of(run, "mises", first.view, scale, states)], states
    return [first], states


def _draw_rows(
    figure: Any, title: str, drawings: Sequence[Drawing], states: Sequence[State]
) -> Any:
    """Draw the instants; return the parts of the figure for the title and the energies."""
    grid, height = _grid(drawings[0], len(states), INSTANTS_HEIGHT / len(drawings))
    head, *above, below = _divided(figure, title, [height + BAR_HEIGHT] * len(drawings))
    for part, drawing in zip(above, drawings):
        _draw_instants(part, drawing, states, *grid)
    return head, below


def _draw_instants(
    figure: Any, drawing: Drawing, states: Sequence[State], rows: int, columns: int
) -> None:
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    factor, unit = readable(drawing.units, "time", states[-1].time)
    for k, (axes, state) in enumerate(zip(grid, states)):
        patches = drawing.draw(axes, state, marks=k == 0)
        axes.set_title(f"t = {state.time * factor:.4g} {unit}".rstrip(), fontsize="medium")
        axes.label_outer()
    for axes in grid[len(states) :]:
        axes.remove()
    drawing.colour_bar(patches, list(grid[: len(states)]), **COLOUR_BAR)


def draw_energies(axes: Any, run: Run) -> None:
    """Draw the energy balance over time: each column that can be seen, and the total. ``reserve`` is a part of what
    contacts store, dotted as it often covers their line; the first row has that of half a step later, of which only
    this part is drawn."""
    own = [name for name in run.energy.dtype.names or () if name not in (ENERGY.names or ())]
    names = ("kinetic", "strain", "contact", "reserve", "external", *own)
    lines = {name: run.energy[name] for name in (*names, "total")}
    stored = sum(lines[name] for name in ("contact", "obstacle") if name in lines)
    lines["reserve"] = np.minimum(lines["reserve"], stored)
    most = max(float(np.abs(line).max()) for line in lines.values())
    (factor, unit), (scale, energy) = (
        readable(run.units, "time", float(run.time[-1])),
        readable(run.units, "energy", most),
    )
    for name, line in lines.items():
        if name == "total" or np.abs(line).max() > HIDDEN * most:
            style = {"total": "k--", "reserve": ":"}.get(name, "-")
            axes.plot(factor * run.time, scale * line, style, label=name, zorder=2 + (style == ":"))
    axes.set(xlabel=with_unit("t", unit), ylabel=with_unit("energy", energy))
    axes.grid(alpha=0.3)
    place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "frameon": False}
    count = len(axes.lines)
    axes.legend(ncols=-(-count // -(-count // 8)), fontsize="small", **place)
    axes.margins(x=0.0)


# Bars.


def bar_axis(run: Run) -> int | None:
    """The axis along which all bodies lie that have one element in their cross section, and along which they
    move; None without such bodies."""
    bodies = list(run.state.values()) if run.state else []
    for axis in range(3) if flat_axis([run.state] if run.state else []) is not None else ():
        layers = [
            len(body.mesh.faces(f"{name}_min")[0]) == len(body.elements) > 1
            for body in bodies
            for name in AXES
            if name != AXES[axis]
        ]
        if layers and all(layers):
            return axis
    return None


def draw_bars(axes: Any, run: Run, axis: int) -> None:
    """Draw the axial stress of bars along an axis over position and time, with the planes that they hit."""
    records = np.linspace(0, len(run.states) - 1, min(len(run.states), COLUMNS)).round()
    states = [run.states[i] for i in records.astype(int).tolist()]
    times, field = np.array([state.time for state in states]), f"stress_{2 * AXES[axis]}"
    factor, unit = readable(run.units, "time", float(times[-1]))
    rows = {name: [_bar(state[name], field, axis) for state in states] for name in run.bodies}
    most = max(float(np.abs(values).max()) for row in rows.values() for _, values in row)
    for row in rows.values():
        ends, values = (np.array(part) for part in zip(*row))
        cells = draw_bar_in_time(axes, factor * times, ends, values, most or 1.0, upright=True)
    for point in _walls(run, axis, times):
        axes.plot(factor * times, point, color="0.2", lw=1.5)
    length = run.units.length if run.units else ""
    axes.set(xlabel=with_unit("t", unit), ylabel=with_unit(AXES[axis], length))
    colour_bar(cells, axes, field, run.units, **COLOUR_BAR)


def _bar(body: Any, field: str, axis: int) -> tuple[Floats, Floats]:
    """The ends of the elements of a bar, and the values in them, along its axis."""
    corners = body.elements[:, :8]
    x, now = body.nodes[:, axis], body.positions[:, axis]
    middle = x[corners].mean(axis=1)
    order = np.argsort(middle)
    low = x[corners] < middle[:, None]
    first = [now[nodes[side]].mean() for nodes, side in zip(corners[order], low[order])]
    last = now[corners[order[-1]][~low[order[-1]]]].mean()
    return np.array([*first, last]), body.component(field)[0][order]


def _walls(run: Run, axis: int, times: Floats) -> Iterator[Floats]:
    """Positions over time of the planes across an axis."""
    for obstacle in tables(run).get("obstacle", []):
        normal = np.abs(obstacle.get("plane", {}).get("normal", np.zeros(3)))
        if "carrier" not in obstacle and normal[axis] > 0.99 * np.linalg.norm(normal) > 0.0:
            point = obstacle["plane"]["point"][axis]
            yield point + np.array([displacement_at(obstacle, t)[axis] for t in times])
