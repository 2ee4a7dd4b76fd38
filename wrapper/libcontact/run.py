"""Results of a run: tables, the state of each body, sampling along a line, saving and loading."""

from __future__ import annotations

import copy
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._core import ffi, lib
from .errors import BlowupError, EnergyError, Error, GeometryError, StepError, check, new_error
from .mesh import Mesh
from .parts import Material
from .problem import c_material
from .schema import is_number, suggestion
from .units import Units

ENERGY = np.dtype(
    [
        (name, "f8")
        for name in ("time", "kinetic", "strain", "contact", "external", "total", "balance")
    ]
)
MOMENTUM = np.dtype(
    [
        ("time", "f8"),
        ("body", "i4"),
        ("p", "f8", 3),
        ("L", "f8", 3),
        ("contact_impulse", "f8", 3),
        ("support_impulse", "f8", 3),
    ]
)
STRESS = ("xx", "yy", "zz", "xy", "yz", "zx")
COMPONENTS = {
    **{f"stress_{name}": ("stress", i) for i, name in enumerate(STRESS)},
    **{
        f"{field}_{axis}": (field, i)
        for field in ("displacement", "velocity")
        for i, axis in enumerate("xyz")
    },
}


# Effects whose energy or work stands in the columns of ENERGY; others have a column of their own.
IN_ENERGY = ("solid", "contact", "support")


def energy_dtype(effects: Sequence[str]) -> np.dtype:
    """The fields of ``Run.energy`` for the effects of a problem: a column for the name of each that has none yet."""
    own = dict.fromkeys(name for name in effects if name not in IN_ENERGY)
    return np.dtype(ENERGY.descr + [(name, "f8") for name in own])


class RunError(Error, RuntimeError):
    """
    A run that failed in the middle. ``run`` holds what was recorded before, with the last good state; None if there is none. ``time`` and ``step`` tell when it was
    noticed, ``body`` (a number, its name is ``body_name``), ``element`` and ``node`` where; each is None where the fault has no such place. ``checkpoint`` is the results
    file that holds the last good state, for ``Scene.run(restart=...)``, or None.
    """

    def __init__(
        self,
        message: str,
        run: Run | None = None,
        *,
        code: int | None = None,
        body: int | None = None,
        element: int | None = None,
        point: int | None = None,
    ):
        super().__init__(message, code, body, element, point)
        self.run = run
        # The point of an inverted element is one of Gauss's.
        self.node = None if code == lib.CT_ERROR_GEOMETRY else point
        self.time: float | None = None
        self.step: int | None = None
        self.body_name: str | None = None
        self.checkpoint: Path | None = None


class InvertedElement(RunError, GeometryError):
    """An element was turned inside out; ``element`` is its number in the body."""


class NotFinite(RunError, BlowupError):
    """The motion, a force or the energy stopped being a finite number."""


class StepTooLarge(RunError, StepError):
    """The solid has become too stiff for the time step."""


class EnergyBlowup(RunError, EnergyError):
    """More energy appeared from nothing than ``time.energy_limit`` allows."""


FAULTS = {
    lib.CT_ERROR_GEOMETRY: InvertedElement,
    lib.CT_ERROR_BLOWUP: NotFinite,
    lib.CT_ERROR_STEP: StepTooLarge,
    lib.CT_ERROR_ENERGY: EnergyBlowup,
}


class BodyState:
    """
    One body at one time. ``displacement`` and ``velocity`` have shape (nodes, 3), ``stress`` (elements, 6) in the order
    xx yy zz xy yz zx at element centres; all arrays are read-only. A field that a file does not hold is a ValueError.
    """

    def __init__(
        self,
        name: str,
        mesh: Mesh,
        material: Material | None,
        displacement: Any,
        velocity: Any,
        stress: Any = None,
    ):
        self.name, self.mesh, self.material = name, mesh, material
        self._displacement, self._velocity, self._stress = displacement, velocity, stress

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        for values in (self._displacement, self._velocity, self._stress):
            if values is not None:
                values.flags.writeable = False

    def _recorded(self, field: str, values: Any) -> np.ndarray:
        if values is None:
            raise ValueError(
                f'body "{self.name}": {field} was not recorded; name it in [output] fields'
            )
        return values

    def holds(self, field: str) -> bool:
        """Whether ``displacement``, ``velocity`` or ``stress`` can be had."""
        has = {
            "displacement": self._displacement is not None,
            "velocity": self._velocity is not None,
        }
        return has.get(
            field,
            self._stress is not None
            or (self._displacement is not None and self.material is not None),
        )

    @property
    def nodes(self) -> np.ndarray:
        """Reference coordinates (nodes, 3)."""
        return self.mesh.nodes

    @property
    def elements(self) -> np.ndarray:
        """Node numbers of the elements (elements, 8 or 20), in VTK's order."""
        return self.mesh.elements

    @property
    def centres(self) -> np.ndarray:
        """Reference coordinates of the element centres (elements, 3)."""
        return self.mesh.centres()

    @property
    def displacement(self) -> np.ndarray:
        return self._recorded("displacement", self._displacement)

    @property
    def velocity(self) -> np.ndarray:
        return self._recorded("velocity", self._velocity)

    @property
    def positions(self) -> np.ndarray:
        """Current coordinates (nodes, 3)."""
        return self.nodes + self.displacement

    @property
    def stress(self) -> np.ndarray:
        if self._stress is None:
            if not self.holds("stress"):
                self._recorded("stress", None)
            self._stress = np.empty((len(self.elements), 6))
            error = new_error()
            check(
                lib.ct_solid_stress(
                    self.mesh.pointer,
                    c_material(self.material),
                    _doubles(self._displacement),
                    _doubles(self._stress),
                    error,
                ),
                error,
            )
            self._stress.flags.writeable = False
        return self._stress

    def component(self, name: str) -> tuple[np.ndarray, bool]:
        """The values of ``stress_xx``, ``velocity_z``, ..., and whether they belong to elements (else to nodes)."""
        if name not in COMPONENTS:
            raise ValueError(f'no component is named "{name}"' + suggestion(name, COMPONENTS))
        field, column = COMPONENTS[name]
        return getattr(self, field)[:, column], field == "stress"

    def sample(self, name: str, points: np.ndarray) -> np.ndarray:
        """A component at points (m, 3) of the reference configuration; NaN outside the body. See ``Run.line``."""
        values, at_elements = self.component(name)
        elements, xi = self.mesh.locate(points)
        out = np.full(len(points), np.nan)
        for i in np.flatnonzero(elements >= 0):
            e = elements[i]
            out[i] = values[e] if at_elements else self.mesh.shape(xi[i]) @ values[self.elements[e]]
        return out


class State(Mapping):
    """The bodies at one time, by name: ``run.state["right"].displacement``."""

    def __init__(self, time: float, step: int, bodies: dict[str, BodyState]):
        self.time, self.step, self._bodies = time, step, bodies

    def __getitem__(self, name: str) -> BodyState:
        if name not in self._bodies:
            raise KeyError(f'no body is named "{name}"' + suggestion(name, self._bodies))
        return self._bodies[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bodies)

    def __len__(self) -> int:
        return len(self._bodies)

    def __repr__(self) -> str:
        return f"State(time={self.time:g}, step={self.step}, bodies={list(self)})"


class Run:
    """
    What a run recorded. ``dt`` is its time step; ``time`` (records,) and ``steps`` (records,); ``energy``, a structured array with the fields time, kinetic, strain,
    contact, external, total, balance, and one of the name of each further effect (the energy that it stores, or the work that it did if it stores
    none), a row a record; ``momentum``, with time, body (number in ``bodies``), p, L,
    contact_impulse, support_impulse, a row a record and body. ``state`` is the last recorded state. ``contact`` has for each contact of
    the scene the Gauss points of both surfaces in that state: side, face, gauss, other (the face that was met, or -1), position, closest, xi,
    gap (what the contact law sees: negative in contact, NaN where nothing was met), pressure, weight, start_gap (what ``gap`` counts from; the true distance is ``gap + start_gap``); it is empty for a run that was read from a file. ``penetration`` has for each
    contact a dict of the places "points", "corners" and "edges" (of all faces; a surface in contact with itself has "points" only), and for each place the numbers of those
    ``inside`` and ``buried`` (inside, but not in contact as they never came from outside), and depth ``deepest``, ``surface``, ``face`` and ``position`` of the deepest, by true distances; up to the depth ``touching`` surfaces only touch. ``costs`` are the seconds of each
    effect by name, of the "time loop" around them and of the "output"; ``Scene.costs`` puts them beside what was predicted. ``computed`` is the share of the elements' forces
    that were computed, as the others were quiet (None for a run that was read from a file).
    ``impulse`` is what each effect has given to all bodies together since t = 0 (3,), by name: their sum is the change of momentum. It is empty for a run that was
    read from a file. A run can be copied and pickled with its tables and its state. What goes on as a pickle of a run without a file can't be saved as a results file
    any more, as that holds more of the state than the run does.
    """

    def __init__(
        self,
        *,
        bodies: list[str],
        units: Units | None,
        steps: Any,
        energy: np.ndarray,
        momentum: np.ndarray,
        state: State | None,
        path: Path | None = None,
        scene: str = "",
        interrupted: bool = False,
        seconds: float = 0.0,
        costs: Mapping[str, float] | None = None,
        computed: float | None = None,
        writer: Any = None,
        contact: Sequence[np.ndarray] = (),
        impulse: Mapping[str, np.ndarray] | None = None,
        dt: float | None = None,
        penetration: Sequence[dict[str, dict[str, Any]]] = (),
    ):
        self.bodies, self.units, self.state = bodies, units, state
        self.steps = np.asarray(steps, np.int64)
        self.energy, self.momentum = energy, momentum
        self.path, self.scene = path, scene
        self.interrupted, self.seconds, self.dt = interrupted, seconds, dt
        self.contact = list(contact)
        self.penetration = list(penetration)
        self.costs, self.computed = dict(costs or {}), computed
        self.impulse = dict(impulse or {})
        self._writer = writer

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_writer": None}

    def __copy__(self) -> Run:
        new = object.__new__(type(self))
        new.__dict__.update(self.__dict__)
        return new

    def __deepcopy__(self, memo: dict[int, Any]) -> Run:
        new = memo[id(self)] = object.__new__(type(self))
        new.__dict__.update(copy.deepcopy(self.__getstate__(), memo), _writer=self._writer)
        return new

    @property
    def time(self) -> np.ndarray:
        """Times of the records (records,)."""
        return self.energy["time"]

    def body_momentum(self, name: str) -> np.ndarray:
        """The rows of ``momentum`` that belong to one body."""
        if name not in self.bodies:
            raise KeyError(f'no body is named "{name}"' + suggestion(name, self.bodies))
        return self.momentum[self.momentum["body"] == self.bodies.index(name)]

    def line(
        self, name: str, start: Any, end: Any, n: int = 401, body: str | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """
        Sample a component at ``n`` points from ``start`` to ``end`` (both included) of the reference configuration, in the last state.

        Returns the distance from ``start`` (n,) and the values (n,); NaN where no body is. Stresses are constant in each element: the value
        at its centre. Displacements and velocities are interpolated with the shape functions. A point on a
        border belongs to the first body and the lowest element that contains it, or to ``body`` alone, if one is named.
        """
        start, end = _point(start, "start"), _point(end, "end")
        if isinstance(n, bool) or not isinstance(n, (int, np.integer)) or n < 1:
            raise ValueError(f"n is {n!r}; it must be a whole number of at least 1")
        # Between the two ends from both sides, so that a reversed line has the same points.
        i = np.arange(n)[:, None] if n > 1 else np.zeros((1, 1))
        last = max(n - 1, 1)
        points = ((last - i) * start + i * end) / last
        s = np.arange(n) / last * np.linalg.norm(end - start)
        values = np.full(n, np.nan)
        for state in self.state.values() if body is None else [self.state[body]]:
            open_points = np.flatnonzero(np.isnan(values))
            values[open_points] = state.sample(name, points[open_points])
        return s, values

    def save(self, path: str | Path) -> Path:
        """Write the run to a VTKHDF file: a copy of its own file, or the last state and all tables of a run in memory."""
        path = Path(path)
        if self.path is not None:
            if path.resolve() != self.path.resolve():
                shutil.copyfile(self.path, path)
            return path
        if self._writer is None:
            raise ValueError("this run has no file and no state to write")
        self._writer(self, path)
        return path

    @classmethod
    def load(cls, path: str | Path, record: int = -1) -> Run:
        """
        Read a run from its VTKHDF file (with h5py); ``state`` is that of the given record, the last one by default. A ValueError
        says what is wrong with the file.
        """
        from .results import load

        return load(Path(path).absolute(), record)

    def __repr__(self) -> str:
        where = f", file {str(self.path)!r}" if self.path else ""
        stopped = ", interrupted" if self.interrupted else ""
        time = self.energy["time"][-1] if len(self.energy) else 0.0
        return f"<Run of {', '.join(self.bodies)} to t = {time:g} in {len(self.steps)} records{where}{stopped}>"


def _point(value: Any, what: str) -> np.ndarray:
    entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if len(entries) != 3 or not all(is_number(entry) and np.isfinite(entry) for entry in entries):
        raise ValueError(f"{what} is {value!r}; three finite numbers x, y, z are needed")
    return np.array(entries, np.float64)


def _doubles(array: np.ndarray) -> Any:
    """A C pointer to a contiguous float64 array, which the caller keeps alive."""
    if array.dtype != np.float64:
        raise TypeError(f"an array of {array.dtype} can't be handed to C as double")
    return ffi.from_buffer("double[]", array)
