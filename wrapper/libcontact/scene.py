"""Scenes: the input of a run, read from TOML, given as a dictionary, or built step by step."""

from __future__ import annotations

import copy
import difflib
import math
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, Protocol, cast, overload

import numpy as np
import tomli_w

from . import html
from .bridge import index
from .checks.warned import during, known
from .effects.absorb import Absorb
from .effects.damping import Damping
from .effects.gravity import Gravity
from .effects.load import Load
from .effects.obstacle import Obstacle
from .effects.own import Own, View
from .effects.rigid import Rigid
from .effects.tie import Tie
from .effects.viscosity import Viscosity
from .errors import NotBuiltIn, issue
from .loop import Loop, follow, record_count, schedule
from .model import SHAPES, Body, Contact, ContactKeys, Material, Output, Probe, Support, Time
from .model import Run as RunKeys
from .older import tomllib
from .parts import EFFECTS, MANY, NO_TABLE, Parts, read
from .pieces import Pieces, planned
from .problem import Problem, new_state
from .problem_part import Part
from .results import origin
from .run import Run
from .schema import FileName, Place, SceneError, Source, Table, check_file, describe, suggestion
from .source import Text, set_values
from .state import State
from .tables import ENERGY, IN_ENERGY

if TYPE_CHECKING:
    # A run needs no planning, which is imported where it is called.
    from .planning.explain import Explanation
    from .planning.plan import Cost
    from .planning.planner import Plan

# Tables that may differ between a scene and the one whose run it continues, in addition to ``free``
# keys.
FREE_ON_RESTART = ("title", "output", "probe", "run", "units")
# Endings of file formats that are not that of the results, and those to which results can be converted.
EXPORTS = (".csv", ".vtu", ".xdmf")
OTHER_FORMATS = (*EXPORTS, *".vtk .vtp .pvd .pvtu .xmf .exo .npz .mat".split())
OTHER_FORMATS += tuple(".txt .json .png .gif .mp4 .pdf .svg".split())
# The largest scene file that is read.
MOST_BYTES = 256e6
# The largest one whose text is kept, for the lines in messages.
MOST_WITH_LINES = 1e6


def example(name: str) -> Path:
    """
    File of a scene that comes with the package.

    Parameters
    ----------
    name
        "plates", "hertz" and the others of the tutorials (``tutorials/scenes`` in the repository).

    Returns
    -------
    Path
        The file.

    Examples
    --------
    >>> scene = Scene.load(example("plates"))
    """
    folder = Path(__file__).parent / "scenes"
    names = sorted(path.stem for path in folder.glob("*.toml"))
    if name not in names:
        raise ValueError(f'there is no example "{name}"; the examples are {", ".join(names)}')
    return folder / f"{name}.toml"


P = ParamSpec("P")


def _call(call: str, table: Any, *pair: str) -> Any:
    """Make a method of ``Scene``, such as ``add_body``, that takes the keys of a table. The arguments
    ``pair`` are two surfaces, in place of the key ``surfaces``."""
    _, _, name = call.partition("_")
    lead = [Parameter("self", Parameter.POSITIONAL_OR_KEYWORD)]
    lead += [Parameter(word, Parameter.POSITIONAL_OR_KEYWORD, default=None) for word in pair]
    keys = [*signature(table).parameters.values()]
    keys = [
        each.replace(default=None) if pair and each.name == "surfaces" else each for each in keys
    ]
    whole = Signature([*lead, *keys], return_annotation="Scene")

    def method(*values: Any, **entries: Any) -> Scene:
        try:
            given = whole.bind(*values, **entries).arguments
        except TypeError as error:
            known = [*whole.parameters][1:]
            wrong = [suggestion(each, known) for each in entries if each not in whole.parameters]
            hint = wrong[0] if wrong else f"; by name it takes {', '.join(known)}"
            raise TypeError(f"{call}: {error}{hint}") from None
        scene: Scene = given.pop("self")
        two = [given.pop(word) for word in pair if word in given]
        if pair and (len(two) == 2) == ("surfaces" in given) or len(two) == 1:
            raise TypeError(f"{call}: give two surfaces, either a and b or surfaces = [a, b]")
        entries = {**given, "surfaces": two} if two else given
        return scene.add(name, **entries) if name in EFFECTS else scene._put(name, entries)

    docs = {**{word: f'A surface, such as ``"{word}.x_max"``.' for word in pair}, **table.docs()}
    text = "\n".join(f"{key}\n    {docs[key]}" for key in [*whole.parameters][1:])
    about = f"Add a ``[[{name}]]``" if name in MANY else f"Give the ``[{name}]``"
    ends = "Returns\n-------\nScene\n    The scene itself."
    method.__doc__ = f"{about}.\n\nParameters\n----------\n{text}\n\n{ends}\n"
    method.__name__, method.__qualname__ = call, f"Scene.{call}"
    method.__signature__ = whole  # type: ignore[attr-defined]
    return method


def _adding(call: str, table: Callable[P, Table]) -> Callable[Concatenate[Scene, P], Scene]:
    """Make a method that takes the keys of a table."""
    return cast("Callable[Concatenate[Scene, P], Scene]", _call(call, table))


class _AddsPair(Protocol[P]):
    """A method that takes two surfaces, ``a`` and ``b`` or ``surfaces``, and the other keys of a table."""

    @overload
    def __call__(self, a: str, b: str, *values: P.args, **keys: P.kwargs) -> Scene: ...
    @overload
    def __call__(self, *, surfaces: Sequence[str], **keys: Any) -> Scene: ...


def _adding_pair(call: str, table: type[Table], keys: Callable[P, Table]) -> _AddsPair[P]:
    """Make a method that takes two surfaces; ``keys`` are those of the table without them."""
    return cast("_AddsPair[P]", _call(call, table, "a", "b"))


class Scene:
    """
    A scene: units, materials, bodies, effects, time and output, with the keys of the scene file (chapter "The scene
    file").

    Every table is checked when it is added; an error is a SceneError with file, key and reason.

    Parameters
    ----------
    data
        All tables of the scene.
    title, units
        Title and units of a scene that is built step by step, instead of ``data``.
    file
        The file of the scene, for messages; paths of meshes are relative to its folder.

    Examples
    --------
    >>> scene = Scene.load("plates.toml")
    >>> scene = Scene({"units": {"length": "mm", "mass": "t", "time": "s"}, "body": [...]})
    >>> scene = Scene(units={"length": "mm", "mass": "t", "time": "s"})
    >>> scene.add_material("steel", young=2.1e5, poisson=0.3, density=7.8e-9)
    """

    def __init__(
        self,
        data: dict[str, Any] | None = None,
        *,
        title: str | None = None,
        units: dict[str, str] | None = None,
        file: str | Path | None = None,
    ):
        if data is not None and (title is not None or units is not None):
            raise TypeError("give either the whole data or title and units")
        self._file = file if file is None or isinstance(file, Source) else str(file)
        self._problem: Problem | None = None
        self._own: list[Own] = []
        if data is None and units is None:
            raise SceneError("is missing; give length, mass and time", "units", self._file)
        tables = {"title": title or "", "units": units} if data is None else data
        self._is_whole = data is not None
        self._parts = read(tables, self._file, whole=self._is_whole)
        self._data = _plain(tables)

    def __getstate__(self) -> dict[str, Any]:
        """Content of a pickle of the scene: its tables, and the Python functions of its effects by
        name, as usual in pickle."""
        for own in self._own:
            own.check_pickle()
        file = None if self._file is None else os.path.abspath(self._file)
        return {"data": self._data, "file": file, "own": self._own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._data, self._file, self._own = state["data"], state["file"], state["own"]
        self._problem, self._is_whole = None, False
        self._parts = read(self._data, self._file, whole=False)

    def __copy__(self) -> Scene:
        """A deep copy of the scene."""
        new = object.__new__(type(self))
        own = [replace(own) for own in self._own]
        new.__setstate__({"file": self._file, "data": self.data, "own": own})
        return new

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        new = copy.copy(self)
        new._own = copy.deepcopy(self._own, memo)
        return new

    @property
    def file(self) -> str | None:
        """The file of the scene, if it has one."""
        return None if self._file is None else str(self._file)

    @property
    def data(self) -> dict[str, Any]:
        """A copy of the scene's tables, which may be changed and passed to another
        ``Scene(data)``."""
        return copy.deepcopy(self._data)

    @classmethod
    def load(cls, path: str | Path, changes: Mapping[str, Any] | None = None) -> Scene:
        """
        Read a scene file.

        Parameters
        ----------
        path
            A TOML file in UTF-8 of at most 256 MB; larger meshes need a file of their own.
        changes
            Values that replace those of the file, by keys such as ``"time.end"`` and ``"contact.0.beta"``.

        Returns
        -------
        Scene
            The scene.
        """
        path = str(path)
        try:
            check_file(path, MOST_BYTES)
            text = Path(path).read_bytes().decode("utf-8")
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            found = re.search(r"at line (\d+)", str(error))
            line = int(found[1]) if found else None
            raise SceneError(f"is not valid TOML: {error}", "", path, line) from None
        except (OSError, ValueError, RecursionError) as error:
            no_text = "no text in UTF-8" if isinstance(error, UnicodeDecodeError) else None
            reason = no_text or getattr(error, "strerror", None) or error
            raise SceneError(f"can't be read: {reason}", "", path) from None
        changed = set_values(data, changes or {}, path)
        return cls(data, file=path if len(text) > MOST_WITH_LINES else Text(path, text, changed))

    def save(self, path: str | Path) -> None:
        """
        Write the scene as TOML, with all arrays of nodes and elements.

        Parameters
        ----------
        path
            The new file; paths of meshes become relative to its folder.
        """
        self._whole()
        if self._own:
            reason = "is a Python function, which a scene file can't hold"
            raise SceneError(reason, self._own[0].name, self._file)
        old, new = Path(self._file or "scene").resolve().parent, Path(path).resolve().parent
        data = self.data
        for body in data["body"]:
            if old != new and "mesh" in body and not os.path.isabs(body["mesh"]):
                body["mesh"] = os.path.relpath(old / body["mesh"], new)
        Path(path).write_text(_toml(data), encoding="utf-8")

    def toml(self, arrays: bool = True) -> str:
        """
        The scene as TOML.

        Parameters
        ----------
        arrays
            False: leave out the values of nodes and elements, which a results file contains anyway.

        Returns
        -------
        str
            The text.
        """
        return _toml(self.data, arrays)

    # Building step by step: each call takes the keys of its table.

    add_material = _adding("add_material", Material)
    add_body = _adding("add_body", Body)
    add_contact = _adding_pair("add_contact", Contact, ContactKeys)
    add_support = _adding("add_support", Support)
    add_obstacle = _adding("add_obstacle", Obstacle)
    add_gravity = _adding("add_gravity", Gravity)
    add_load = _adding("add_load", Load)
    add_damping = _adding("add_damping", Damping)
    add_absorb = _adding("add_absorb", Absorb)
    add_viscosity = _adding("add_viscosity", Viscosity)
    add_tie = _adding("add_tie", Tie)
    add_rigid = _adding("add_rigid", Rigid)
    add_probe = _adding("add_probe", Probe)
    set_time = _adding("set_time", Time)
    set_output = _adding("set_output", Output)
    set_run = _adding("set_run", RunKeys)

    def add(self, effect: str, **entries: Any) -> Scene:
        """
        Add an effect of the library by its name; ``add("gravity", ...)`` is ``add_gravity(...)``.

        Parameters
        ----------
        effect
            Its table: "gravity", "load" and the others of ``libcontact.effects``.
        entries
            The keys of the table.

        Returns
        -------
        Scene
            The scene itself.

        Examples
        --------
        >>> scene.add("gravity", acceleration=[0, 0, -9810])
        """
        at = Place("", self._file)
        if effect in NO_TABLE:
            raise (at / effect).error(NO_TABLE[effect])
        if effect not in EFFECTS:
            raise at.error(f'no effect is named "{effect}"' + suggestion(effect, EFFECTS))
        if effect not in MANY and effect in self._data:
            raise (at / effect).error("is given twice; a scene may have it once")
        return self._put(effect, entries)

    def add_effect(
        self,
        name: str,
        body: str,
        nodes: Any,
        force: Callable[[View], Any],
        *,
        energy: Callable[[View], float] | None = None,
        omega_squared: float = 0.0,
        rate: float = 0.0,
    ) -> Scene:
        """
        Add an effect of your own, a Python function.

        Forces and energies must be real numbers. An exception of the function ends the run with a
        RunError that names the effect; SystemExit, KeyboardInterrupt and similar exceptions pass
        through ``run``.

        Parameters
        ----------
        name
            Its column in the energy balance.
        body, nodes
            The body, and numbers of its nodes, or a face such as ``"x_max"``, or the name of a set.
        force
            ``force(view)`` returns the forces (n, 3) on the nodes; ``view`` has ``time``, ``dt``, ``reference``,
            ``displacement`` and ``velocity`` of them (:class:`libcontact.effects.own.View`).
        energy
            ``energy(view)`` returns the stored energy; without it the work of the effect counts as
            external.
        omega_squared
            The largest ω² [1/time²] of a stiffness (k / m of a spring on a node), for the stable step.
        rate
            The largest c / m [1/time] of a dashpot, for the stable step.

        Returns
        -------
        Scene
            The scene itself.

        Examples
        --------
        >>> scene.add_effect("spring", "bar", "x_max", lambda view: -k * view.displacement, omega_squared=k / m)
        """
        own = Own(name, body, nodes, force, energy, omega_squared, rate)
        if name in {*IN_ENERGY, *(ENERGY.names or ()), *(other.name for other in self._own)}:
            raise SceneError(
                "is already the name of another column of the energy balance", name, self._file
            )
        self._own.append(own)
        self._problem = None
        return self

    def _put(self, name: str, entries: dict[str, Any]) -> Scene:
        """Add a table, or set a table that a scene has once."""
        new = {
            key: os.fspath(value) if isinstance(value, os.PathLike) else value
            for key, value in entries.items()
            if value is not None
        }
        if isinstance(new.get("fix"), str):
            new["fix"] = list(new["fix"])
        table = [*self._data.get(name, []), new] if name in MANY else new
        data = {**self._data, name: table}
        self._file = self.file  # what is added has no line in it
        self._parts = read(data, self._file, whole=False)
        self._data = _plain(data)
        self._problem, self._is_whole = None, False
        return self

    # Computing.

    def explain(self, pieces: int | None = None, partition: Any = None) -> Explanation:
        """Describe what will be computed, what will not, and why.

        Parameters
        ----------
        pieces
            Number of processes, to show what each of them would compute and exchange (:doc:`/theory/pieces`).
        partition
            As for :meth:`run`.

        Returns
        -------
        Explanation
            A text, with the same facts as a dictionary in its ``data``.
        """
        from .planning.explain import explain

        problem = self._built(None)
        rows = None
        if pieces is not None:
            rows = planned(problem, new_state(problem), index("pieces", pieces), partition)
        return explain(problem, schedule(problem)[0], record_count(problem), rows)

    def costs(self, run: Run | None = None) -> list[Cost]:
        """Predict the cost of each effect of the scene; ``print(scene.cost_table(run))`` shows the
        same.

        Parameters
        ----------
        run
            A run of the scene, to add its measured costs.

        Returns
        -------
        list of Cost
            The costs, predicted from a trial of a few steps.
        """
        from .planning.plan import predict

        problem = self._built(None)
        if run is None:
            return list(predict(problem, record_count(problem)).costs)
        costs, done = predict(problem, len(run.steps)).costs, {"solid": run.computed}
        return [replace(c, measured=run.costs.get(c.name), done=done.get(c.name)) for c in costs]

    def cost_table(self, run: Run | None = None) -> str:
        """
        The costs as a table.

        Parameters
        ----------
        run
            A run of the scene, to add its measured costs.

        Returns
        -------
        str
            The table.
        """
        from .planning.plan import table

        return table(self.costs(run), self._built(None).stable.dt)

    def plan(
        self,
        error: float | None = None,
        seconds: float | None = None,
        functional: str | None = None,
        trials: float = 10.0,
        progress: bool = True,
    ) -> Plan:
        """Choose mesh, step, integrator, mass, bulk viscosity and contact law for a given error or
        run time (chapter "The planner").

        The scene itself does not change; ``plan.scene`` is the chosen scene.

        Parameters
        ----------
        error
            The requested relative error, such as 0.05; or give ``seconds``.
        seconds
            The longest run time [s]; or give ``error``.
        functional
            The number whose error is meant, such as ``"wall.force_x.max"`` of a probe,
            ``"bar.p_x.end"`` of a body's momentum, or ``"energy.kinetic.end"``. It may be left out
            for two plates in plane strain that hit along their length, whose stress has a closed
            form.
        trials
            Approximate time for trial runs [s]; the first trials run in any case.
        progress
            Show a bar in a terminal or a notebook.

        Returns
        -------
        Plan
            The choice and its neighbours, with expected errors and times; ``print`` shows them. Ctrl-C ends the trials,
            and the plan is made from those so far.

        Raises
        ------
        SceneError
            The functional is missing or unknown, or no feasible mesh meets the request.
        """
        from .planning.planner import plan

        return plan(self, error, seconds, functional, trials, progress)

    def run(
        self,
        progress: bool | str = True,
        restart: str | Path | None = None,
        until: float | None = None,
        output: str | Path | bool | None = None,
        threads: int | None = None,
        watch: Callable[[Run], object] | None = None,
        observers: Iterable[tuple[Callable[[State], object], int]] = (),
        comm: Any = None,
        partition: Any = None,
    ) -> Run:
        """
        Compute the scene.

        An error of the input is a SceneError before the first step; a later error is a RunError.

        Parameters
        ----------
        progress
            Show a bar in a terminal or a notebook; "always": everywhere.
        restart
            A results file; the run continues from its newest record with the same bits and the same
            step, also to a later end. If this scene has a smaller step, the file's step is divided
            by a whole number.
        until
            Time at which the run ends; the step does not change.
        output
            Results file, instead of the scene's; False writes none.
        threads
            Number of threads, instead of the scene's.
        watch
            Function called at every record with a Run of this record only. Copy arrays that you
            want to keep.
        observers
            Pairs of a function and a number of steps: the function is called with the State at the
            start, after each so many steps, and at the end. It may keep the State, and what it
            raises ends the run. A run that divides its step goes back and calls it again.
        comm
            A communicator of mpi4py whose processes all make this call: each computes a piece, and all return
            the Run with the bits of one process (:doc:`/theory/pieces`). The first one has the whole model: it
            calls ``watch`` and the observers and writes the file. The Runs of the others have all tables, but
            ``state``, ``contact`` and ``pressure`` are empty, and ``states`` are those of the file.
        partition
            How the elements are given to the processes: ``"metis"`` (needs pymetis), ``"coordinates"``, or
            the number of a process for each element, those of all bodies one after another; by default METIS
            if it is installed.

        Returns
        -------
        Run
            The results. The first Ctrl-C ends the run after a last record, and the Run has
            ``interrupted`` set.
        """

        pieces = Pieces(comm, partition) if comm is not None and comm.size > 1 else None
        given = restart, until, output, threads, watch, observers, pieces
        if pieces is None:
            return self._led(progress, given)
        with pieces.together():
            if pieces.rank > 0:
                return follow(pieces, partial(self._followed, threads))
            return pieces.lead(lambda: self._led(progress, given))

    def _led(self, progress: bool | str, given: tuple[Any, ...]) -> Run:
        """The run of the first of several processes."""
        loop, path = self._prepared(*given)
        return loop.run(progress, path)

    def _followed(
        self, threads: int | None, dt: float, text: str, effects: list[str], part: Part | None
    ) -> Problem:
        """The C problem of another process, or its part, with a step that the first one has checked, whose scene has
        this ``text`` and these ``effects``."""
        parts, other = self._whole(), "is not that of the first process"
        one, own = (_model(tomllib.loads(each)) for each in (text, self.toml(arrays=False)))
        for key in {**one, **own}:
            if one.get(key) != own.get(key):
                raise SceneError(f"{other}; give all processes the same scene", key, self._file)
        wanted = parts.run.threads if threads is None else threads
        problem = Problem(parts, self._file, wanted, self._own, dt, False, part)
        if problem.effects != effects:
            reason = f"the list of effects {problem.effects} {other}, {effects}"
            raise SceneError(reason, file=self._file)
        return problem

    def _prepared(
        self,
        restart: Any,
        until: Any,
        output: Any,
        threads: int | None,
        watch: Any,
        observers: Any,
        pieces: Pieces | None,
    ) -> tuple[Loop, Any]:
        """The loop of a run before its first step, and its file."""
        if threads is not None:
            RunKeys.keys()["threads"].metadata["kind"].read(
                threads, Place("run.threads", self._file)
            )
        path: Any = self._whole().output.file if output is None else (output or None)
        if path is not None:
            self._check_output(path, restart)
        dt, parts = (None, 1) if restart is None else self._check_restart(restart, threads)
        problem = self._built(threads, dt and dt / parts)
        built, text = partial(self._built, threads), self.toml(arrays=False)
        loop = Loop(problem, text, watch, until, built, during(problem), observers, pieces)
        loop.begin()
        for warning in known(loop.problem, path, state=loop.state):
            issue(warning)
        if restart is not None:
            loop.restart(restart, parts)
        return loop, path

    def _whole(self) -> Parts:
        """The parts of a complete scene; otherwise the error names what is missing."""
        if not self._is_whole:
            self._parts = read(self._data, self._file)
            self._is_whole = True
        return self._parts

    def _built(self, threads: int | None, dt: float | None = None) -> Problem:
        """The C problem, kept until the scene changes; ``dt`` is the step of a run that is continued."""
        parts = self._whole()
        wanted = parts.run.threads if threads is None else threads
        kept = self._problem
        if kept is not None and kept.threads == wanted and dt in (None, kept.dt):
            return kept
        problem = Problem(parts, self._file, wanted, self._own, dt)
        if dt is None:
            self._problem = problem
        return problem

    def _check_output(self, path: Any, restart: Any) -> None:
        """Raise an error if the output would overwrite the restart, a mesh, or a file that is not a
        results file."""
        at, folder = Place("output.file", self._file), Path(self._file or "").parent
        if not isinstance(path, (str, os.PathLike)):
            raise at.error(f"is {describe(path)}; it must be a path")
        path, reason = FileName().read(os.fspath(path), at), ""
        ending, like = os.path.splitext(path)[1].lower(), [".vtkhdf"]
        misspelt = ending not in like and difflib.get_close_matches(ending, like, cutoff=0.75)
        if misspelt or ending in OTHER_FORMATS:
            whole = os.path.splitext(path)[0] + ".vtkhdf"
            reason = f'results are in VTKHDF, not in {ending}; write "{whole}"'
            if ending in EXPORTS:
                reason += f" and convert it: libcontact export {whole} --to {ending[1:]}"
        if restart is not None and _one_file(path, restart):
            reason = "is the file that the restart is read from, whose earlier records would be lost; choose another file"
        for body in self._parts.bodies.values():
            if body.mesh is not None and _one_file(path, folder / body.mesh):
                reason = f'is the mesh of body "{body.name}"'
        if not reason and os.path.isfile(path):
            with open(path, "rb") as file:
                if file.read(4) not in (b"", b"\x89HDF"):
                    reason = "exists and is not a results file; choose another file, or remove it"
        if reason:
            raise at.error(f'"{path}" can\'t be written: {reason}')

    def _check_restart(self, path: Any, threads: int | None) -> tuple[float | None, int]:
        """Raise an error for a run of another scene; return the step of the run, and the number of parts
        into which this scene divides it."""
        at = Place("restart", self._file)
        try:
            text, dt = origin(Path(path).absolute())
            before, step = _fixed(text)
        except NotBuiltIn:
            # Without h5py only the C library compares bodies, effects, step and nodes.
            return None, 1
        except (ValueError, TypeError) as error:
            raise at.error(str(error)) from None
        now, requested_step = _fixed(self.toml(arrays=False))
        for key in {**before, **now}:
            if before.get(key) != now.get(key):
                raise at.error(f'"{path}" comes from another scene: [{key}] differs')
        if step == requested_step:
            return dt, 1
        asked = self._built(threads).dt
        if asked > dt * (1.0 + 1e-9):
            raise at.error(
                f'"{path}" was written with the step {dt:.6g}; this scene asks for {asked:.6g}, and only a smaller step is possible'
            )
        return dt, math.ceil(dt / asked * (1.0 - 1e-9))

    def _repr_html_(self) -> str:
        """The scene in a notebook: its bodies, and its other tables by number."""
        keys = ("name", "material", "element", "velocity")
        bodies = [[body.get(key, "") for key in keys] for body in self._data.get("body", [])]
        shapes = [_shape_of(body) for body in self._data.get("body", [])]
        rows = [[*row, shape] for row, shape in zip(bodies, shapes)]
        known = ("title", "units", "body")
        others = [
            f"{name} × {len(value)}" if isinstance(value, list) else name
            for name, value in self._data.items()
            if name not in known and value
        ]
        parts = (
            html.table([*keys, "mesh"], rows),
            html.lines("also: " + ", ".join(others)) if others else "",
        )
        return html.titled(self._parts.title or "Scene without a title", *parts)

    def __repr__(self) -> str:
        return f"<Scene {self._parts.title!r}: {', '.join(self._parts.bodies) or 'no bodies yet'}>"


def _shape_of(body: dict[str, Any]) -> str:
    """The mesh of a body in words."""
    for kind in SHAPES:
        if kind in body:
            return f"{kind}, {' × '.join(map(str, body[kind]['cells']))} cells"
    if "inertia" in body:
        return "mass and moments of inertia"
    return str(body["mesh"]) if "mesh" in body else f"{len(body['elements'])} elements"


def _model(data: dict[str, Any]) -> dict[str, Any]:
    """The tables of a scene that all processes of a run share; each may have its own files and threads."""
    shared = {key: value for key, value in data.items() if key not in ("title", "output", "run")}
    bodies = [{**body, "mesh": "mesh" in body} for body in data["body"]]
    return {**shared, "body": bodies}


def _toml(data: dict[str, Any], arrays: bool = True) -> str:
    for body in data.get("body", []):
        for table in (body, *body.get("sets", {}).values()):
            for key in ARRAYS.keys() & table.keys():
                rows = table[key]
                table[key] = rows.tolist() if arrays else f"array of shape {rows.shape}"
    return tomli_w.dumps(data)


def _fixed(text: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The tables of a scene without those that may differ in a scene that continues its run, and the keys
    that give its step."""
    scene = tomllib.loads(text)
    time: dict[str, Any] = scene.get("time", {})
    step = {key: time.pop(key, None) for key in Time.rivals[0]}
    free = {key for key, field in Time.keys().items() if field.metadata["free"]}
    scene["time"] = {key: value for key, value in time.items() if key not in free}
    return {key: value for key, value in scene.items() if key not in FREE_ON_RESTART}, step


def _one_file(one: str | Path, other: str | Path) -> bool:
    return os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)


# Arrays, and what they are kept as.
ARRAYS = {"nodes": None, "elements": np.int32, "faces": np.int32}


def _plain(value: Any) -> Any:
    """A deep copy of tables in plain Python types (TOML's); nodes, faces and elements are copied as arrays."""
    if isinstance(value, dict):
        return {
            str(key): _plain(item)
            if key not in ARRAYS or isinstance(item, dict)  # a set may have such a name, too
            else np.array(item, ARRAYS[key])
            for key, item in value.items()
        }
    if isinstance(value, (list, tuple, np.ndarray)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    return str(value) if isinstance(value, str) else value
