"""Results of a run: its tables and states, sampling along a line, pictures, saving and loading."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import html, results
from ._core import lib
from .bridge import Floats, Rows
from .errors import BlowupError, EnergyError, Error, GeometryError, StepError
from .schema import is_number, suggestion
from .state import State
from .tables import Table
from .units import Units

__all__ = ["EnergyBlowup", "InvertedElement", "NotFinite", "Run", "RunError", "StepTooLarge"]


class RunError(Error, RuntimeError):
    """
    A run that failed in the middle.

    Attributes
    ----------
    run : Run or None
        The run up to the error, with the last good state.
    time : float or None
        When the error was detected [time].
    step : int or None
        The step at which it was detected.
    body, element, node : int or None
        Where it happened; each is None if the error has no such place.
    body_name : str or None
        Name of the body.
    checkpoint : Path or None
        The results file with the last good state, for ``Scene.run(restart=...)``.
    """

    time: float | None = None
    step: int | None = None
    body_name: str | None = None
    checkpoint: Path | None = None

    def __init__(self, message: str, run: Run | None = None, *, code: int | None = None, **at: Any):
        super().__init__(message, code, **at)
        self.run = run
        # The point of an inverted element is one of its integration points.
        self.node = None if code == lib.CT_ERROR_GEOMETRY else self.point


class InvertedElement(RunError, GeometryError):
    """An element was inverted; ``element`` is its number in the body."""


class NotFinite(RunError, BlowupError):
    """The motion, a force or the energy became NaN or infinite."""


class StepTooLarge(RunError, StepError):
    """The time step is too large, although it was divided as often as a run may: the solid has become too
    stiff for it, or surfaces could pass through each other within it."""


class EnergyBlowup(RunError, EnergyError):
    """Spurious energy exceeds ``time.energy_limit``."""


FAULTS: dict[int, type[RunError]] = {
    lib.CT_ERROR_GEOMETRY: InvertedElement,
    lib.CT_ERROR_BLOWUP: NotFinite,
    lib.CT_ERROR_STEP: StepTooLarge,
    lib.CT_ERROR_ENERGY: EnergyBlowup,
}


@dataclass(kw_only=True, eq=False, repr=False)
class Run:
    """The results of a run.

    A run can be copied and pickled with its tables and its state. A pickled run without a file
    can't be saved as a results file, because such a file needs more of the state than the pickle
    contains.
    """

    #: Names of the bodies.
    bodies: list[str]
    #: Units of the scene.
    units: Units | None
    #: Steps of the records, shape (records,).
    steps: NDArray[np.int64]
    #: Structured array, one row per record: time, kinetic, strain, contact, reserve, external, total,
    #: and a field for each further effect with its name: the energy that it stores, or its work if it
    #: stores none. ``to_pandas()`` converts this table and the others to pandas.
    energy: Table
    #: Structured array, one row per record and body: time, body (number in ``bodies``), p, L,
    #: contact_impulse, obstacle_impulse, support_impulse.
    momentum: Table
    #: The last recorded state.
    state: State | None
    #: Recorded states in the order of time, the last one included: those of the results file, read when
    #: they are used, or without a file as many as fit into 24 MB, at equal intervals. They hold the
    #: contact pressure if the file has it or if there is no file. Empty in the runs passed to ``watch``.
    states: Sequence[State] = field(default_factory=list)
    #: The results file, None if there is none.
    path: Path | None = None
    #: The scene as TOML.
    scene: str = ""
    #: Whether Ctrl-C ended the run.
    interrupted: bool = False
    #: Duration of the run [s].
    seconds: float = 0.0
    #: Time spent in each effect by name, in the "time loop" around them, and in the "output" [s];
    #: ``Scene.costs`` compares it with the prediction.
    costs: dict[str, float] = field(default_factory=dict)
    #: Fraction of the element forces that were computed; the others were asleep. None for a run that
    #: was read from a file.
    computed: float | None = None
    #: The loop that saves a run without a file; not part of a pickle.
    writer: Any = None
    #: For each contact of the scene the points of both surfaces in the last state: side, face, point,
    #: other (the closest face of the other surface, or -1), position, closest [length], xi, gap
    #: [length] (in the contact law: negative in contact, NaN if ``other`` is -1), raw_pressure
    #: [stress], weight [area], start_gap [length] (the value from which ``gap`` is measured; the true
    #: distance is ``gap + start_gap``), friction [stress] (its force over the weight), slip (0 without
    #: friction or force, 1 where the point sticks, 2 where it slips). Raw pressures are uneven from
    #: point to point: show ``pressure`` instead. Empty for a run that was read from a file.
    contact: list[Rows] = field(default_factory=list)
    #: Pressure at the nodes of each "contact" and each "obstacle", in the order of the scene, in the
    #: last state: side, body (number in ``bodies``), node (of the body), position [length], area [area]
    #: (the part of the faces around the node that takes its force), traction [stress] (force on the
    #: surface per reference area, averaged over both passes and the faces around the node), pressure
    #: [stress] (its magnitude without friction), :eq:`recovered-traction`, friction [stress] (its part
    #: of the traction), :eq:`recovered-friction`, slip (0, 1 or 2 as for a point; 2 if one of the
    #: node's points slips). The sum of area times traction is the resultant of a probe. Empty for a run
    #: that was read from a file, and in the runs passed to ``watch``; results files have it as the
    #: field ``contact_pressure``.
    pressure: dict[str, list[Rows]] = field(default_factory=dict)
    #: Impulse of each effect on all bodies together since t = 0, shape (3,), by name; their sum is the
    #: change of momentum. Empty for a run that was read from a file.
    impulse: dict[str, Floats] = field(default_factory=dict)
    #: The time step [time]; if it was divided, the last one.
    dt: float | None = None
    #: Each division of the time step, :eq:`step-change`: its time, and into how many parts the step with
    #: which the run began is divided from then on. Steps are counted in the present, divided step.
    divisions: list[tuple[float, int]] = field(default_factory=list)
    #: The history of each ``[[probe]]`` by name, a table with one row per ``every`` steps:
    #: time, and the recorded quantities at that time, shape (rows, 3), stress (rows, 6) and pressure
    #: (rows,). The runs passed to ``watch`` have the last row only.
    probes: dict[str, Table] = field(default_factory=dict)
    #: Penetration of each contact, and then of each obstacle, in the last state, a dict by place:
    #: "points", "corners" and "edges" of all faces; a surface in contact with itself has "points" only.
    #: Each place has the numbers ``inside`` and ``buried`` (inside, but not in contact because they
    #: never came from outside), and ``deepest`` (true distance), ``surface``, ``face`` and ``position``
    #: of the deepest one. Depths up to ``touching`` are not counted. ``late`` and ``late_depth``: at
    #: the points, how many were found inside without having come in through the surface, as over the
    #: border of an open surface, and the deepest of them.
    penetration: list[dict[str, dict[str, Any]]] = field(default_factory=list)

    @property
    def time(self) -> Floats:
        """Times of the records [time], shape (records,)."""
        time: Floats = self.energy["time"]
        return time

    def body_momentum(self, name: str) -> Table:
        """
        Select the rows of ``momentum`` that belong to one body.

        Parameters
        ----------
        name : str
            Name of the body.

        Returns
        -------
        ndarray, shape (records,)
            The rows.

        Raises
        ------
        KeyError
            No body has this name.
        """
        if name not in self.bodies:
            raise KeyError(f'no body is named "{name}"' + suggestion(name, self.bodies))
        rows: Table = self.momentum[self.momentum["body"] == self.bodies.index(name)]
        return rows

    def line(
        self,
        name: str,
        start: Any,
        end: Any,
        n: int = 401,
        body: str | None = None,
        filtered: bool = False,
    ) -> tuple[Floats, Floats]:
        """
        Sample a component along a line of the reference configuration, in the last state.

        A stress has in each element the value at its centre. Displacements and velocities are
        interpolated with the shape functions. A point on a border belongs to the first body and the
        lowest element that contains it.

        Parameters
        ----------
        name : str
            ``stress_xx``, ``velocity_z``, ``mises`` and the others of :meth:`libcontact.state.BodyState.component`.
        start, end : array_like, shape (3,)
            The ends of the line [length], both included.
        n : int
            Number of points.
        body : str, optional
            The only body to sample.
        filtered : bool
            Whether to sample the filtered fields, :attr:`libcontact.state.BodyState.filtered`.

        Returns
        -------
        s : ndarray, shape (n,)
            Distances from ``start`` [length].
        values : ndarray, shape (n,)
            The values; NaN outside all bodies.

        Raises
        ------
        ValueError
            The component, an end or ``n`` is invalid, or the component was not recorded.
        KeyError
            No body has this name.
        """
        for what, value in (("start", start), ("end", end)):
            entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
            if len(entries) != 3 or not all(is_number(x) and np.isfinite(x) for x in entries):
                raise ValueError(f"{what} is {value!r}; three finite numbers x, y, z are needed")
        start, end = np.array(start, np.float64), np.array(end, np.float64)
        if isinstance(n, bool) or not isinstance(n, (int, np.integer)) or n < 1:
            raise ValueError(f"n is {n!r}; it must be a whole number of at least 1")
        if self.state is None:
            raise ValueError("this run has no state")
        # Between the two ends from both sides, so that a reversed line has the same points.
        i = np.arange(n)[:, None]
        last = max(n - 1, 1)
        points = ((last - i) * start + i * end) / last
        s = np.arange(n) / last * np.linalg.norm(end - start)
        values = np.full(n, np.nan)
        for state in self.state.values() if body is None else [self.state[body]]:
            open_points = np.flatnonzero(np.isnan(values))
            shown = state.filtered if filtered else state
            values[open_points] = shown.sample(name, points[open_points])
        return s, values

    def plot(
        self,
        field: str | None = None,
        view: str | None = None,
        scale: float | None = None,
        instants: int = 4,
        figure: Any = None,
    ) -> Any:
        """
        Draw a row of instants and the energies, as :func:`libcontact.pictures.picture.plot_run`.

        Parameters
        ----------
        field : str, optional
            The component, such as ``"mises"``; by default chosen by what the scene does.
        view : str, optional
            The sides that the viewer sees, such as ``"y_min"`` or ``"x_max+y_min+z_max"``.
        scale : float, optional
            Magnification of the displacements.
        instants : int
            Number of instants, at most that of the recorded states.
        figure : matplotlib.figure.Figure, optional
            An empty figure; by default a new one.

        Returns
        -------
        matplotlib.figure.Figure
            The picture; a notebook shows it.
        """
        from .pictures.picture import plot_run

        return plot_run(self, field, view, scale, instants, figure)

    def save(self, path: str | Path) -> Path:
        """
        Write the run to a VTKHDF file: a copy of its own file, or for a run in memory the last state and
        all tables.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ValueError
            The run has no file and no state to write.
        OSError
            The file can't be written.
        """
        path = Path(path)
        if self.path is not None:
            if path.resolve() != self.path.resolve():
                shutil.copyfile(self.path, path)
            return path
        if self.writer is None:
            raise ValueError("this run has no file and no state to write")
        self.writer.write(self, path)
        return path

    @classmethod
    def load(cls, path: str | Path, record: int = -1) -> Run:
        """
        Read a run from its VTKHDF file.

        Parameters
        ----------
        path : str or Path
            The file.
        record : int
            Number of the record that ``state`` is read from, the last one by default.

        Returns
        -------
        Run
            The run.

        Raises
        ------
        ValueError
            The file can't be read, is damaged or holds no run.
        NotBuiltIn
            h5py is not installed.
        """
        return cls(**results.read(Path(path).absolute(), record))

    def _repr_html_(self) -> str:
        """The run in a notebook: its energies at the start and at the end."""
        names = [name for name in self.energy.dtype.names or () if self.energy[name].any()]
        ends = self.energy[[0, -1]] if len(self.energy) else self.energy
        units = {name: "energy" for name in names} | {"time": "time"}
        heads = [
            f"{name} [{self.units.label(units[name])}]" if self.units else name for name in names
        ]
        rows = [[float(row[name]) for name in names] for row in ends]
        note = f"{len(self.steps)} records of {', '.join(self.bodies)}, computed in {self.seconds:.3g} s"
        note += f"\nfile {self.path}" if self.path else ""
        note += "\ninterrupted" if self.interrupted else ""
        return html.titled("Run", html.table(heads, rows), html.lines(note))

    def __repr__(self) -> str:
        where = f", file {str(self.path)!r}" if self.path else ""
        stopped = ", interrupted" if self.interrupted else ""
        time = self.time[-1] if len(self.energy) else 0.0
        return f"<Run of {', '.join(self.bodies)} to t = {time:g} in {len(self.steps)} records{where}{stopped}>"
